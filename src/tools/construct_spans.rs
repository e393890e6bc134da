//! Owns the 64 rows of voxels in a row of bricks, each cut to one span along x, and turns them
//! into brick masks.
//!
//! A solid that is convex meets a row in one span, so this is all that a solid has to work out.
//! A mask is made without a look at single voxels: a layer of 4x4 voxels of a brick word is one
//! comparison of 16 bytes, its sign bits are the layer's 16 bits.

use std::ops::Range;

use wide::{i8x16, i16x8, i16x16, u8x16};

use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_WORDS, Brick};
use crate::sculpture::region::RowReach;

/// Spans along x of the rows of voxels in a row of bricks, 8 along y for each of 8 along z.
#[derive(Clone, Debug)]
pub struct RowSpans {
    /// First voxel of each row, in grid coordinates; [`i16::MAX`] in an empty row.
    from: [i16x8; 8],
    /// One past the last voxel. Also [`i16::MAX`] in an empty row, so that one that ends early
    /// does not make a left border look like a right one.
    to: [i16x8; 8],
}

impl Default for RowSpans {
    fn default() -> RowSpans {
        RowSpans { from: [NEVER; 8], to: [NEVER; 8] }
    }
}

/// Where an empty row begins and ends.
const NEVER: i16x8 = i16x8::splat(i16::MAX);

impl RowSpans {
    /// Makes all rows empty.
    pub fn clear(&mut self) {
        *self = RowSpans::default();
    }

    /// Sets the eight rows at `z` of the row of bricks. All ends lie in 0..=4096; a row where
    /// `to` is not above `from` is empty.
    #[inline(always)]
    pub fn set(&mut self, z: usize, from: i16x8, to: i16x8) {
        let never = NEVER & !to.simd_gt(from);
        (self.from[z], self.to[z]) = (from | never, to | never);
    }

    /// Bricks along x that the spans touch and fill.
    #[inline(always)]
    pub fn reach(&self) -> RowReach {
        let (mut first, mut last) = (NEVER, i16x8::ZERO);
        let (mut all_from, mut all_to) = (i16x8::ZERO, NEVER);
        for (&from, &to) in self.from.iter().zip(&self.to) {
            first = first.min(from);
            all_from = all_from.max(from);
            last = last.max(to & !to.simd_eq(NEVER));
            all_to = all_to.min(to);
        }
        let last = last.reduce_max() as u32;
        if last == 0 {
            return RowReach::NONE;
        }
        let edge = BRICK_EDGE_VX;
        let all_from = all_from.reduce_max() as u32;
        RowReach {
            touched: first.reduce_min() as u32 / edge..last.div_ceil(edge),
            whole: all_from.div_ceil(edge)..all_to.reduce_min() as u32 / edge,
        }
    }

    /// The voxels of a touched brick that lie in the spans. `whole` is that of [`RowSpans::reach`].
    #[inline(always)]
    pub fn mask(&self, brick_x: u32, whole: &Range<u32>) -> Brick {
        // A brick at or after the first whole one has no row that begins in it, and one before
        // the last none that ends.
        match (brick_x < whole.start, brick_x >= whole.end) {
            (true, false) => self.mask_of::<true, false>(brick_x),
            (false, true) => self.mask_of::<false, true>(brick_x),
            _ => self.mask_of::<true, true>(brick_x),
        }
    }

    #[inline(always)]
    fn mask_of<const BEGINS: bool, const ENDS: bool>(&self, brick_x: u32) -> Brick {
        let origin = i16x16::splat((brick_x * BRICK_EDGE_VX) as i16);
        let mut words = [0; BRICK_WORDS];
        for (upper, words) in words.chunks_exact_mut(4).enumerate() {
            // The layers of words at z 0 and 1, then at 2 and 3, of the lower or upper half.
            let z = 4 * upper;
            let first = self.layers::<BEGINS, ENDS>(z, origin);
            let second = self.layers::<BEGINS, ENDS>(z + 2, origin);
            for (i, word) in words.iter_mut().enumerate() {
                let (y, x) = (i / 2, i % 2);
                *word = first[y][x]
                    | first[2 + y][x] << 16
                    | second[y][x] << 32
                    | second[2 + y][x] << 48;
            }
        }
        Brick { words }
    }

    /// The 16 bits of each layer of words at `z` and `z + 1`: those at y 0 and 4 for one z, then
    /// for the other, each for the words at x 0 and 4.
    #[inline(always)]
    fn layers<const BEGINS: bool, const ENDS: bool>(
        &self,
        z: usize,
        origin: i16x16,
    ) -> [[u64; 2]; 4] {
        let ends = |ends: &[i16x8; 8]| four_times_each(local(ends, z, origin));
        let from = if BEGINS { ends(&self.from) } else { [i8x16::ZERO; 4] };
        let to = if ENDS { ends(&self.to) } else { [i8x16::ZERO; 4] };
        let mut bits = [[0; 2]; 4];
        for layer in 0..4 {
            for (bits, x) in bits[layer].iter_mut().zip(X_IN_LAYER) {
                let begun = (x + i8x16::ONE).simd_gt(from[layer]);
                let not_ended = to[layer].simd_gt(x);
                let inside = match (BEGINS, ENDS) {
                    (true, false) => begun,
                    (false, true) => not_ended,
                    _ => begun & not_ended,
                };
                *bits = u64::from(inside.to_bitmask());
            }
        }
        bits
    }
}

/// The brick-local x of the 16 voxels of a word's layer, for the lower and upper word along x.
const X_IN_LAYER: [i8x16; 2] = [
    i8x16::new([0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]),
    i8x16::new([4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7]),
];

/// The ends at `z` and `z + 1` relative to `origin`; what does not fit a byte keeps its side.
#[inline(always)]
fn local(ends: &[i16x8; 8], z: usize, origin: i16x16) -> u8x16 {
    let ends: i16x16 = bytemuck::cast([ends[z], ends[z + 1]]);
    bytemuck::cast(i8x16::from_i16x16_saturate(ends - origin))
}

/// Repeats each of 16 bytes four times.
#[inline(always)]
fn four_times_each(v: u8x16) -> [i8x16; 4] {
    let (low, high) = (u8x16::unpack_low(v, v), u8x16::unpack_high(v, v));
    [
        bytemuck::cast(u8x16::unpack_low(low, low)),
        bytemuck::cast(u8x16::unpack_high(low, low)),
        bytemuck::cast(u8x16::unpack_low(high, high)),
        bytemuck::cast(u8x16::unpack_high(high, high)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spans(from: impl Fn(usize) -> i16, to: impl Fn(usize) -> i16) -> RowSpans {
        let mut spans = RowSpans::default();
        for z in 0..8 {
            let rows = |f: &dyn Fn(usize) -> i16| i16x8::new(std::array::from_fn(|y| f(8 * z + y)));
            spans.set(z, rows(&from), rows(&to));
        }
        spans
    }

    proptest! {
        #[test]
        fn masks_and_ranges_say_what_the_spans_say(
            base in 0i16..4000,
            spread in 1i16..90,
            ends in prop::collection::vec((0i16..1000, 0i16..1000), 64),
        ) {
            let from = |row: usize| base + ends[row].0 % spread;
            let to = |row: usize| base + ends[row].1 % spread;
            let spans = spans(from, to);
            let RowReach { touched, whole } = spans.reach();
            for bx in 0..512u32 {
                let mut naive = Brick::EMPTY;
                for (row, x) in (0..64).flat_map(|row| (0..8).map(move |x| (row, x))) {
                    let v = (bx * 8 + x) as i16;
                    let inside = from(row) <= v && v < to(row);
                    naive.set(x, row as u32 % 8, row as u32 / 8, inside);
                }
                prop_assert_eq!(whole.contains(&bx), naive.is_full(), "brick {}", bx);
                if touched.contains(&bx) {
                    prop_assert_eq!(spans.mask(bx, &whole), naive, "brick {}", bx);
                } else {
                    prop_assert!(naive.is_empty(), "brick {}", bx);
                }
            }
        }
    }

    #[test]
    fn no_voxel_touches_no_brick() {
        assert_eq!(spans(|_| 9, |_| 9).reach(), RowReach::NONE);
        assert_eq!(spans(|_| 4096, |_| 0).reach(), RowReach::NONE);
    }

    #[test]
    fn all_of_the_longest_row_is_whole() {
        let spans = spans(|_| 0, |_| 4096);
        assert_eq!(spans.reach(), RowReach { touched: 0..512, whole: 0..512 });
        assert_eq!(spans.mask(511, &(0..512)), Brick::FULL);
    }
}
