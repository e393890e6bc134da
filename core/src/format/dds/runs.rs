//! The runs of a DDS stream: finding, decoding and writing them.
//!
//! A run is a head (7 bits count, 3 bits width code) and `count` residuals of equal width, each stored as residual +
//! 2^(width-1). A count of 0 ends the stream. Knows no predictor.

use super::bits::{BitSink, BitSource};

/// Bits of a run's head.
pub const HEAD_BITS: u32 = 10;
/// Greatest number of samples in a run.
pub const RUN_SAMPLES: usize = 127;
/// Width in bits that each width code stands for. There is no width 1.
pub const WIDTHS: [u32; 8] = [0, 2, 3, 4, 5, 6, 7, 8];

/// Residuals of one run, with room for a group of eight that is only partly needed.
type RunBuffer = [u8; RUN_SAMPLES + 1];

/// The head of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RunHead {
    /// Samples in the run; 0 at the end of the stream.
    pub count: usize,
    /// Index into [`WIDTHS`].
    pub code: usize,
}

impl RunHead {
    #[inline(always)]
    pub fn at(source: BitSource, position: u64) -> RunHead {
        let head = source.field(position, HEAD_BITS) as usize;
        RunHead { count: head >> 3, code: head & 7 }
    }

    /// Returns the bits of the run including its head.
    #[inline(always)]
    pub(crate) fn total_bits(self) -> u64 {
        u64::from(HEAD_BITS) + self.count as u64 * u64::from(WIDTHS[self.code])
    }
}

/// Writes the residuals of the runs from `position` on to `out` and returns the position after them. `out` must end at
/// the end of a run, or be shorter than the total of the runs from there on: the excess of the last run is discarded.
#[inline(always)]
pub(crate) fn decode_runs(source: BitSource, mut position: u64, out: &mut [u8]) -> u64 {
    let mut at = 0;
    let mut buffer: RunBuffer = [0; RUN_SAMPLES + 1];
    while at < out.len() {
        let head = RunHead::at(source, position);
        if head.count == 0 {
            break;
        }
        let from = position + u64::from(HEAD_BITS);
        // Whole groups of eight are written, so close to the end only into a buffer.
        match out[at..].first_chunk_mut::<{ RUN_SAMPLES + 1 }>() {
            Some(room) => decode_run(source, from, head, room),
            None => {
                decode_run(source, from, head, &mut buffer);
                let count = head.count.min(out.len() - at);
                out[at..at + count].copy_from_slice(&buffer[..count]);
            }
        }
        at += head.count;
        position += head.total_bits();
    }
    position
}

#[inline(always)]
fn decode_run(source: BitSource, from: u64, head: RunHead, out: &mut RunBuffer) {
    match head.code {
        0 => out.fill(0),
        1 => decode_groups::<2>(source, from, head.count, out),
        2 => decode_groups::<3>(source, from, head.count, out),
        3 => decode_groups::<4>(source, from, head.count, out),
        4 => decode_groups::<5>(source, from, head.count, out),
        5 => decode_groups::<6>(source, from, head.count, out),
        6 => decode_groups::<7>(source, from, head.count, out),
        _ => decode_groups::<8>(source, from, head.count, out),
    }
}

/// Decodes groups of eight residuals of `W` bits, `8 * W` bits a group.
#[inline(always)]
fn decode_groups<const W: u32>(source: BitSource, from: u64, count: usize, out: &mut RunBuffer) {
    let mut position = from;
    for group in out.chunks_exact_mut(8).take(count.div_ceil(8)) {
        let fields = if W == 8 {
            // 64 bits at any position are more than one read returns.
            source.field(position, 32) << 32 | source.field(position + 32, 32)
        } else {
            source.field(position, 8 * W)
        };
        group.copy_from_slice(&residuals::<W>(fields).to_be_bytes());
        position += u64::from(8 * W);
    }
}

/// Expands eight fields of `W` bits, the first one highest, to eight residuals as bytes, the first one highest: 8 W
/// bits in a word, 4 W in each half, 2 W in each quarter, W in each byte.
#[inline(always)]
fn residuals<const W: u32>(fields: u64) -> u64 {
    let mut v = fields;
    v = (v & lanes(64, 4 * W)) | (v & !lanes(64, 4 * W)) << (32 - 4 * W);
    v = (v & lanes(32, 2 * W)) | (v & !lanes(32, 2 * W)) << (16 - 2 * W);
    v = (v & lanes(16, W)) | (v & !lanes(16, W)) << (8 - W);
    let bias = EACH_BYTE << (W - 1);
    if W == 8 {
        v ^ bias
    } else {
        // Subtracts byte by byte: the borrowed top bit keeps the bytes apart.
        ((v | EACH_BYTE << 7) - bias) ^ EACH_BYTE << 7
    }
}

/// Inverts [`residuals`]; residuals that do not fit lose their upper bits.
#[inline(always)]
fn fields<const W: u32>(residuals: u64) -> u64 {
    let bias = EACH_BYTE << (W - 1);
    // Adds the bias without carry between bytes.
    let top = EACH_BYTE << 7;
    let v = ((residuals & !top) + (bias & !top)) ^ ((residuals ^ bias) & top);
    let v = v & (EACH_BYTE * ((1 << W) - 1));
    let v = (v & lanes(16, W)) | (v & !lanes(16, 8)) >> (8 - W);
    let v = (v & lanes(32, 2 * W)) | (v & !lanes(32, 16)) >> (16 - 2 * W);
    (v & lanes(64, 4 * W)) | (v & !lanes(64, 32)) >> (32 - 4 * W)
}

const EACH_BYTE: u64 = 0x0101_0101_0101_0101;

/// Returns a mask of the lowest `bits` bits of every lane of `lane` bits.
const fn lanes(lane: u32, bits: u32) -> u64 {
    let mut mask = 0;
    let mut at = 0;
    while at < 64 {
        mask |= (u64::MAX >> (64 - bits)) << at;
        at += lane;
    }
    mask
}

/// Appends a run of `residuals` (1 to 127), all of which fit the width of `code`.
#[inline(always)]
pub(crate) fn encode_run(sink: &mut BitSink, code: usize, residuals: &[u8]) {
    sink.reserve(2 * (RUN_SAMPLES + 2));
    sink.push((residuals.len() << 3 | code) as u64, HEAD_BITS);
    match code {
        0 => {}
        1 => encode_groups::<2>(sink, residuals),
        2 => encode_groups::<3>(sink, residuals),
        3 => encode_groups::<4>(sink, residuals),
        4 => encode_groups::<5>(sink, residuals),
        5 => encode_groups::<6>(sink, residuals),
        6 => encode_groups::<7>(sink, residuals),
        _ => encode_groups::<8>(sink, residuals),
    }
}

#[inline(always)]
fn encode_groups<const W: u32>(sink: &mut BitSink, residuals: &[u8]) {
    let (groups, rest) = residuals.as_chunks::<8>();
    let groups = groups.iter().map(|group| fields::<W>(u64::from_be_bytes(*group)));
    if W == 8 {
        // More than one push accepts.
        sink.push_all(groups.flat_map(|v| [v >> 32, v & 0xFFFF_FFFF]), 32);
    } else {
        sink.push_all(groups, 8 * W);
    }
    if !rest.is_empty() {
        let mut group = [0; 8];
        group[..rest.len()].copy_from_slice(rest);
        let v = fields::<W>(u64::from_be_bytes(group));
        let bits = rest.len() as u32 * W;
        sink.push(v >> (8 * W - bits), bits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Decodes runs according to the description, a field at a time.
    fn naive_decode(source: BitSource, mut position: u64) -> Vec<u8> {
        let mut out = Vec::new();
        loop {
            let count = source.field(position, 7);
            let code = source.field(position + 7, 3) as usize;
            position += 10;
            if count == 0 {
                return out;
            }
            for _ in 0..count {
                out.push(match WIDTHS[code] {
                    0 => 0,
                    w => (source.field(position, w) as u8).wrapping_sub(1 << (w - 1)),
                });
                position += u64::from(WIDTHS[code]);
            }
        }
    }

    proptest! {
        #[test]
        fn runs_decode_as_described(runs in prop::collection::vec(
            (0usize..8, prop::collection::vec(any::<u8>(), 1..=RUN_SAMPLES)), 0..12)
        ) {
            let mut sink = BitSink::default();
            let mut expected = Vec::new();
            for (code, residuals) in runs {
                // Clamps the residuals to the range of the width.
                let fitting: Vec<u8> = match WIDTHS[code] {
                    0 => vec![0; residuals.len()],
                    w => residuals.iter().map(|r| ((*r as i8) >> (8 - w)) as u8).collect(),
                };
                encode_run(&mut sink, code, &fitting);
                expected.extend(fitting);
            }
            let bytes = sink.into_bytes();
            let source = BitSource::new(&bytes);
            prop_assert_eq!(&naive_decode(source, 0), &expected);
            let mut out = vec![0xAA; expected.len()];
            decode_runs(source, 0, &mut out);
            prop_assert_eq!(out, expected);
        }

        #[test]
        fn any_bytes_decode_as_described(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let source = BitSource::new(&bytes);
            let expected = naive_decode(source, 0);
            let mut out = vec![0xAA; expected.len()];
            decode_runs(source, 0, &mut out);
            prop_assert_eq!(&out, &expected);
            let mut part = vec![0xAA; expected.len() / 2];
            decode_runs(source, 0, &mut part);
            prop_assert_eq!(&part[..], &expected[..expected.len() / 2]);
        }
    }
}
