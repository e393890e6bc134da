//! Owns the 64 rows of voxels in a row of bricks, each cut to one span along x, and turns them
//! into brick masks.
//!
//! A solid that is convex meets a row in one span, so this is all that a solid has to work out.
//! A mask is made without a look at single voxels: a layer of 4x4 voxels of a brick word is one
//! comparison of 16 bytes, its sign bits are the layer's 16 bits.

use std::ops::Range;

use wide::{i8x16, i16x16, u8x16};

use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_WORDS, Brick};

/// Rows of voxels in a row of bricks: 8 along y for each of 8 along z.
pub const ROWS: usize = 64;

/// For each row of voxels `y + 8 * z` the voxels `from..to` along x, in grid coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Spans {
    pub from: [i16; ROWS],
    pub to: [i16; ROWS],
}

/// [`Spans`] with what they say of whole bricks.
#[derive(Clone, Debug)]
pub struct RowSpans {
    spans: Spans,
    touched: Range<u32>,
    whole: Range<u32>,
}

impl Spans {
    pub const EMPTY: Spans = Spans { from: [0; ROWS], to: [0; ROWS] };
}

impl RowSpans {
    /// No voxel at all.
    pub const EMPTY: RowSpans = RowSpans { spans: Spans::EMPTY, touched: 0..0, whole: 0..0 };

    /// Spans whose ends lie in 0..=4096 (`to` at or below `from` makes an empty one).
    pub fn new(mut spans: Spans) -> RowSpans {
        let (mut first, mut last) = (i16::MAX, 0);
        let (mut all_from, mut all_to) = (0, i16::MAX);
        for (from, to) in spans.from.iter_mut().zip(&mut spans.to) {
            let empty = *from >= *to;
            last = last.max(if empty { 0 } else { *to });
            // An empty row then never ends early, so that a left border stays a left border.
            *from = if empty { i16::MAX } else { *from };
            *to = if empty { i16::MAX } else { *to };
            first = first.min(*from);
            all_from = all_from.max(*from);
            all_to = all_to.min(*to);
        }
        let edge = BRICK_EDGE_VX;
        let whole = (all_from as u32).div_ceil(edge)..(all_to as u32 / edge);
        RowSpans {
            spans,
            touched: (first as u32 / edge)..(last as u32).div_ceil(edge),
            whole: if whole.start < whole.end { whole } else { 0..0 },
        }
    }

    /// Bricks along x that hold any of the spans' voxels.
    pub fn touched(&self) -> Range<u32> {
        self.touched.clone()
    }

    /// Bricks along x that the spans fill.
    pub fn whole(&self) -> Range<u32> {
        self.whole.clone()
    }

    /// The voxels of a brick that lie in the spans.
    pub fn mask(&self, brick_x: u32) -> Brick {
        let origin = (brick_x * BRICK_EDGE_VX) as i16;
        let mut words = [0; BRICK_WORDS];
        for pair in 0..4 {
            let at = pair * 16;
            let from = local_bytes(&self.spans.from[at..at + 16], origin);
            let to = local_bytes(&self.spans.to[at..at + 16], origin);
            let (from, to) = (four_times_each(from), four_times_each(to));
            for layer in 0..4 {
                // Layers come as y 0..4 and 4..8 of one z, then of the next.
                let z = 2 * pair + layer / 2;
                let word = 2 * (layer % 2) + 4 * (z / 4);
                let shift = 16 * (z % 4);
                for half in 0..2 {
                    let x = X_IN_LAYER[half];
                    let inside = !from[layer].simd_gt(x) & to[layer].simd_gt(x);
                    words[word + half] |= u64::from(inside.to_bitmask()) << shift;
                }
            }
        }
        Brick { words }
    }
}

/// The brick-local x of the 16 voxels of a word's layer, for the lower and upper word along x.
const X_IN_LAYER: [i8x16; 2] = [
    i8x16::new([0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]),
    i8x16::new([4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7, 4, 5, 6, 7]),
];

/// Positions along x relative to `origin`; what does not fit a byte keeps its side.
#[inline(always)]
fn local_bytes(x: &[i16], origin: i16) -> u8x16 {
    let x: [i16; 16] = std::array::from_fn(|i| x[i]);
    let local = i8x16::from_i16x16_saturate(i16x16::new(x) - i16x16::splat(origin));
    bytemuck::cast(local)
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

    proptest! {
        #[test]
        fn masks_and_ranges_say_what_the_spans_say(
            base in 0i16..4000,
            spread in 1i16..90,
            ends in prop::collection::vec((0i16..1000, 0i16..1000), ROWS),
        ) {
            let mut spans = Spans::EMPTY;
            for (row, (from, to)) in ends.iter().enumerate() {
                spans.from[row] = base + from % spread;
                spans.to[row] = base + to % spread;
            }
            let rows = RowSpans::new(spans);
            for bx in 0..512u32 {
                let mut naive = Brick::EMPTY;
                for row in 0..ROWS {
                    for x in 0..8 {
                        let v = (bx * 8 + x) as i16;
                        let inside = spans.from[row] <= v && v < spans.to[row];
                        naive.set(x, row as u32 % 8, row as u32 / 8, inside);
                    }
                }
                prop_assert_eq!(rows.mask(bx), naive, "brick {}", bx);
                prop_assert_eq!(rows.whole().contains(&bx), naive.is_full(), "brick {}", bx);
                prop_assert!(rows.touched().contains(&bx) || naive.is_empty(), "brick {}", bx);
            }
        }
    }

    #[test]
    fn no_voxel_touches_no_brick() {
        assert!(RowSpans::new(Spans::EMPTY).touched().is_empty());
        assert!(RowSpans::EMPTY.touched().is_empty());
        assert_eq!(RowSpans::EMPTY.mask(0), Brick::EMPTY);
    }

    #[test]
    fn all_of_the_longest_row_is_whole() {
        let rows = RowSpans::new(Spans { from: [0; ROWS], to: [4096; ROWS] });
        assert_eq!((rows.touched(), rows.whole()), (0..512, 0..512));
        assert_eq!(rows.mask(511), Brick::FULL);
    }
}
