//! Stores the 64 rows of voxels in a row of bricks as spans along x, and converts them to brick masks.
//!
//! A convex solid meets a row in one span, so spans are all that a solid has to compute. A mask is built without
//! visiting single voxels: a table gives the eight bits of a row for each start, and 32 rows at a time are looked up
//! and permuted to the order of the brick's words.

use std::ops::Range;

use fearless_simd::{Simd, i16x16, i32x8, prelude::*, u8x32, u16x16, u64x4};

use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_WORDS, Brick};
use crate::sculpture::region::RowReach;

/// Ends of 16 rows: four along y for each of two along z, then the next four along y.
type EndsOfPair = [i16; 16];

/// Spans along x of the rows of voxels in a row of bricks, 8 along y for each of 8 along z.
#[derive(Clone, Debug, Default)]
pub struct RowSpans {
    /// First voxel of each row, in grid coordinates, for each two steps along z.
    from: [EndsOfPair; 4],
    /// One past the last voxel. A row where this is not above the first voxel is empty.
    to: [EndsOfPair; 4],
}

impl RowSpans {
    /// Makes all rows empty.
    pub fn clear(&mut self) {
        *self = RowSpans::default();
    }

    /// Sets the eight rows along y for each of two steps along z, `2 * pair` and the next. All ends lie in 0..=8192; a
    /// row where `to` is not above `from` is empty.
    #[inline(always)]
    pub fn set<S: Simd>(&mut self, simd: S, pair: usize, from: [i32x8<S>; 2], to: [i32x8<S>; 2]) {
        ordered(simd, from).store_array(&mut self.from[pair]);
        ordered(simd, to).store_array(&mut self.to[pair]);
    }

    /// Sets the row at `y`, `z` of the row of bricks.
    pub(crate) fn set_row(&mut self, y: usize, z: usize, span: Range<i32>) {
        let (pair, row) = (z / 2, y / 4 * 8 + z % 2 * 4 + y % 4);
        (self.from[pair][row], self.to[pair][row]) = (span.start as i16, span.end as i16);
    }

    /// Returns the bricks along x that the spans touch, and those that they fill.
    #[inline(always)]
    pub fn reach<S: Simd>(&self, simd: S) -> RowReach {
        let (zero, most) = (i16x16::splat(simd, 0), i16x16::splat(simd, i16::MAX));
        let (mut first, mut last) = (most, zero);
        let (mut all_from, mut all_to) = (zero, most);
        for pair in 0..4 {
            let from = i16x16::load_array_ref(simd, &self.from[pair]);
            let to = i16x16::load_array_ref(simd, &self.to[pair]);
            let some = to.simd_gt(from);
            first = first.min(some.select(from, most));
            last = last.max(some.select(to, zero));
            // An empty row leaves no whole brick, as it ends before it begins.
            all_from = all_from.max(from);
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

    /// Returns the voxels of the brick at `brick_x` that lie in the spans.
    #[inline(always)]
    pub fn mask<S: Simd>(&self, simd: S, brick_x: u32) -> Brick {
        let origin = u16x16::splat(simd, (brick_x * BRICK_EDGE_VX) as u16);
        let from_on = u8x32::load_array_ref(simd, &FROM_ON);
        let to_words = u8x32::load_array_ref(simd, &NIBBLES_TO_WORDS);
        let mut words = [0; BRICK_WORDS];
        for upper in 0..2 {
            let begun = from_on.swizzle_dyn_within_blocks(local(simd, &self.from, upper, origin));
            let ended = from_on.swizzle_dyn_within_blocks(local(simd, &self.to, upper, origin));
            // Two rows of eight bits become two times four bits of one word and two times four bits of the next.
            let rows = (begun & !ended).bitcast::<u16x16<S>>();
            let swapped = (rows ^ (rows >> 4)) & 0x00F0;
            let nibbles = rows ^ swapped ^ (swapped << 4);
            let ordered = nibbles.bitcast::<u8x32<S>>().swizzle_dyn_within_blocks(to_words);
            ordered.bitcast::<u64x4<S>>().store_slice(&mut words[4 * upper..4 * upper + 4]);
        }
        Brick { words }
    }
}

/// For each start 0..=8 the bits of a row from there on; twice, for both halves of a vector.
const FROM_ON: [u8; 32] = {
    let mut table = [0; 32];
    let mut place = 0;
    while place < 8 {
        table[place] = 0xFF << place;
        table[16 + place] = table[place];
        place += 1;
    }
    table
};

/// Source of each byte of two words: those at even positions belong to the first word.
const NIBBLES_TO_WORDS: [u8; 32] = {
    let mut places = [0; 32];
    let mut place = 0;
    while place < 16 {
        places[place] = (place % 8 * 2 + place / 8) as u8;
        places[16 + place] = places[place];
        place += 1;
    }
    places
};

/// Returns the ends of the lower or upper 32 rows along z relative to `origin`, clamped to 0..=8: the lower 4 rows
/// along y first, then the others.
#[inline(always)]
fn local<S: Simd>(simd: S, ends: &[EndsOfPair; 4], upper: usize, origin: u16x16<S>) -> u8x32<S> {
    let bytes = simd.saturating_narrow_i16x16(
        beyond(simd, &ends[2 * upper], origin),
        beyond(simd, &ends[2 * upper + 1], origin),
    );
    middle_swapped(bytes.bitcast()).bitcast::<u8x32<S>>().min(BRICK_EDGE_VX as u8)
}

/// Returns the ends minus `origin`, clamped to at least 0.
#[inline(always)]
fn beyond<S: Simd>(simd: S, ends: &EndsOfPair, origin: u16x16<S>) -> i16x16<S> {
    let ends = i16x16::load_array_ref(simd, ends).bitcast::<u16x16<S>>();
    ends.saturating_sub(origin).bitcast()
}

/// Returns the ends of eight rows along y for each of two steps along z, in storage order.
#[inline(always)]
fn ordered<S: Simd>(simd: S, [first, second]: [i32x8<S>; 2]) -> i16x16<S> {
    middle_swapped(simd.relaxed_narrow_i32x8(first, second).bitcast()).bitcast()
}

/// Swaps the second quarter with the third. Instructions that narrow two vectors leave the quarters in this order, so
/// that no reordering is needed beforehand.
#[inline(always)]
fn middle_swapped<S: Simd>(quarters: u64x4<S>) -> u64x4<S> {
    let (even, _) = quarters.unzip_low(quarters).split();
    let (odd, _) = quarters.unzip_high(quarters).split();
    even.combine(odd)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    use super::*;
    use crate::surface::raycast::tests::levels;

    fn spans(simd: impl Simd, from: impl Fn(usize) -> i32, to: impl Fn(usize) -> i32) -> RowSpans {
        let mut spans = RowSpans::default();
        for pair in 0..4 {
            let rows = |f: &dyn Fn(usize) -> i32| {
                [2 * pair, 2 * pair + 1].map(|z| {
                    i32x8::from_slice(simd, &std::array::from_fn::<_, 8, _>(|y| f(8 * z + y)))
                })
            };
            spans.set(simd, pair, rows(&from), rows(&to));
        }
        spans
    }

    fn check(
        simd: impl Simd,
        from: impl Fn(usize) -> i32,
        to: impl Fn(usize) -> i32,
    ) -> Result<(), TestCaseError> {
        let spans = spans(simd, &from, &to);
        let RowReach { touched, whole } = spans.reach(simd);
        for bx in 0..512u32 {
            let mut naive = Brick::EMPTY;
            for (row, x) in (0..64).flat_map(|row| (0..8).map(move |x| (row, x))) {
                let v = (bx * 8 + x) as i32;
                let inside = from(row) <= v && v < to(row);
                naive.set(x, row as u32 % 8, row as u32 / 8, inside);
            }
            prop_assert_eq!(whole.contains(&bx), naive.is_full(), "brick {}", bx);
            if touched.contains(&bx) {
                prop_assert_eq!(spans.mask(simd, bx), naive, "brick {}", bx);
            } else {
                prop_assert!(naive.is_empty(), "brick {}", bx);
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn masks_and_ranges_say_what_the_spans_say(
            base in 0i32..4000,
            spread in 1i32..90,
            ends in prop::collection::vec((0i32..1000, 0i32..1000), 64),
        ) {
            let from = |row: usize| base + ends[row].0 % spread;
            let to = |row: usize| base + ends[row].1 % spread;
            for level in levels() {
                dispatch!(level, simd => check(simd, from, to))?;
            }
        }

        #[test]
        fn a_row_set_alone_is_the_row_set_with_others(
            ends in prop::collection::vec((0i32..1000, 0i32..1000), 64),
        ) {
            let mut single = RowSpans::default();
            for (row, &(from, to)) in ends.iter().enumerate() {
                single.set_row(row % 8, row / 8, from..to);
            }
            let set = dispatch!(Level::new(), simd => spans(simd, |row| ends[row].0, |row| ends[row].1));
            prop_assert_eq!((single.from, single.to), (set.from, set.to));
        }
    }

    #[test]
    fn no_voxel_touches_no_brick() {
        for (from, to) in [(9, 9), (4096, 0)] {
            let reach = dispatch!(Level::new(), simd => spans(simd, |_| from, |_| to).reach(simd));
            assert_eq!(reach, RowReach::NONE);
        }
    }

    #[test]
    fn all_of_the_longest_row_is_whole() {
        dispatch!(Level::new(), simd => {
            let spans = spans(simd, |_| 0, |_| 4096);
            assert_eq!(spans.reach(simd), RowReach { touched: 0..512, whole: 0..512 });
            assert_eq!(spans.mask(simd, 511), Brick::FULL);
        });
    }
}
