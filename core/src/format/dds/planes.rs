//! The order of bytes in a DDS stream: the bytes of a block with index 0 modulo `skip` come first, then those with
//! index 1 modulo `skip`, and so on, so that similar bytes are adjacent.
//!
//! Where the length of a block is no multiple of `skip`, its first planes are one byte longer. Works on bytes, whatever
//! they contain.

use std::ops::Range;

use rayon::prelude::*;

/// Bytes of one unit of parallel work.
const PIECE_BYTES: usize = 1 << 18;

/// The division of the bytes of a stream.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StreamLayout {
    /// Number of planes, 1 to 4.
    pub skip: usize,
    /// Bytes of a block, each of which is split separately; `None`: all bytes are one block.
    pub block_bytes: Option<usize>,
}

impl StreamLayout {
    fn block(&self, total: usize) -> usize {
        self.block_bytes.unwrap_or(total).max(1)
    }

    /// Returns the ranges of the stream that hold the first `count` bytes of the first block, plane by plane. `total`:
    /// size of the stream in bytes.
    pub(crate) fn prefix_ranges(&self, total: u64, count: u64) -> Vec<Range<u64>> {
        let block = self.block_bytes.map_or(total, |b| total.min(b as u64));
        let planes = 0..self.skip as u64;
        let mut start = 0;
        planes
            .map(|plane| {
                let range = start..start + plane_len(count.min(block), self.skip as u64, plane);
                start += plane_len(block, self.skip as u64, plane);
                range
            })
            .collect()
    }

    /// Converts plane order to natural order.
    pub fn merge(&self, planar: &[u8], out: &mut [u8]) {
        debug_assert_eq!(planar.len(), out.len());
        let block = self.block(out.len());
        for (planar, out) in planar.chunks(block).zip(out.chunks_mut(block)) {
            let planes = planes_of(planar, self.skip);
            let piece = PIECE_BYTES / self.skip;
            out.par_chunks_mut(piece * self.skip).enumerate().for_each(|(i, out)| {
                let parts: Vec<&[u8]> =
                    planes.iter().map(|p| &p[(i * piece).min(p.len())..]).collect();
                merge_piece(&parts, out);
            });
        }
    }

    /// Converts natural order to plane order.
    pub fn split(&self, natural: &[u8], out: &mut [u8]) {
        debug_assert_eq!(natural.len(), out.len());
        let block = self.block(out.len());
        for (natural, mut out) in natural.chunks(block).zip(out.chunks_mut(block)) {
            for plane in 0..self.skip {
                let len = plane_len(natural.len() as u64, self.skip as u64, plane as u64);
                let (this, rest) = out.split_at_mut(len as usize);
                out = rest;
                this.par_chunks_mut(PIECE_BYTES).enumerate().for_each(|(i, part)| {
                    let from = &natural[plane + i * PIECE_BYTES * self.skip..];
                    split_piece(from, self.skip, part);
                });
            }
        }
    }
}

/// Returns the bytes of `plane` in a block of `len` bytes.
fn plane_len(len: u64, skip: u64, plane: u64) -> u64 {
    (len + skip - 1 - plane) / skip
}

fn planes_of(mut block: &[u8], skip: usize) -> Vec<&[u8]> {
    let len = block.len() as u64;
    (0..skip)
        .map(|plane| {
            let (this, rest) = block.split_at(plane_len(len, skip as u64, plane as u64) as usize);
            block = rest;
            this
        })
        .collect()
}

fn merge_piece(planes: &[&[u8]], out: &mut [u8]) {
    match *planes {
        [a] => out.copy_from_slice(&a[..out.len()]),
        [a, b] => interleave([a, b], out),
        [a, b, c] => interleave([a, b, c], out),
        [a, b, c, d] => interleave([a, b, c, d], out),
        _ => {}
    }
}

fn interleave<const N: usize>(planes: [&[u8]; N], out: &mut [u8]) {
    let (groups, rest) = out.as_chunks_mut::<N>();
    let planes = planes.map(|p| (&p[..groups.len()], &p[groups.len()..]));
    for (i, group) in groups.iter_mut().enumerate() {
        *group = planes.map(|(p, _)| p[i]);
    }
    for (byte, (_, end)) in rest.iter_mut().zip(planes) {
        *byte = end[0];
    }
}

fn split_piece(from: &[u8], skip: usize, out: &mut [u8]) {
    match skip {
        1 => out.copy_from_slice(&from[..out.len()]),
        2 => take_every::<2>(from, out),
        3 => take_every::<3>(from, out),
        _ => take_every::<4>(from, out),
    }
}

fn take_every<const N: usize>(from: &[u8], out: &mut [u8]) {
    let (groups, rest) = from.as_chunks::<N>();
    let whole = groups.len().min(out.len());
    for (byte, group) in out.iter_mut().zip(groups) {
        *byte = group[0];
    }
    for byte in &mut out[whole..] {
        *byte = rest[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn planes_hold_every_skipth_byte_of_each_block(
            natural in prop::collection::vec(any::<u8>(), 0..600),
            skip in 1usize..=4,
            block in prop::option::of(1usize..200),
        ) {
            let layout = StreamLayout { skip, block_bytes: block };
            let mut expected: Vec<u8> = Vec::new();
            for block in natural.chunks(block.unwrap_or(natural.len()).max(1)) {
                for plane in 0..skip {
                    expected.extend(block.iter().skip(plane).step_by(skip));
                }
            }
            let mut planar = vec![0; natural.len()];
            layout.split(&natural, &mut planar);
            prop_assert_eq!(&planar, &expected);
            let mut back = vec![0; natural.len()];
            layout.merge(&planar, &mut back);
            prop_assert_eq!(&back, &natural);

            let count = natural.len().min(37).min(block.unwrap_or(37));
            let ranges = layout.prefix_ranges(natural.len() as u64, count as u64);
            let parts: Vec<u8> = ranges
                .iter()
                .flat_map(|r| &planar[r.start as usize..r.end as usize])
                .copied()
                .collect();
            let mut prefix = vec![0; count];
            StreamLayout { skip, block_bytes: None }.merge(&parts, &mut prefix);
            prop_assert_eq!(&prefix[..], &natural[..count]);
        }
    }

    #[test]
    fn pieces_of_parallel_work_meet() {
        let natural: Vec<u8> = (0..3 * PIECE_BYTES + 5).map(|i| (i * 7 + i / 251) as u8).collect();
        for skip in 1..=4 {
            let layout = StreamLayout { skip, block_bytes: None };
            let mut planar = vec![0; natural.len()];
            layout.split(&natural, &mut planar);
            let expected: Vec<u8> =
                (0..skip).flat_map(|p| natural.iter().skip(p).step_by(skip)).copied().collect();
            assert_eq!(planar, expected);
            let mut back = vec![0; natural.len()];
            layout.merge(&planar, &mut back);
            assert_eq!(back, natural);
        }
    }
}
