//! Replaces up to 64 bricks at once, those of one word of a brick set. Undo restores whole words.
//!
//! Takes a [`BrickMask`] and the new bricks, returns the kinds of the old ones. Keeps counts and occupancy consistent.

use super::{Grid, unflatten};
use crate::sculpture::brick::{Brick, BrickKind};
use crate::sculpture::brick_set::BrickMask;

/// The bricks of one word by kind: a bit per brick.
#[derive(Clone, Copy, Default, Debug)]
pub struct WordKinds {
    /// Empty bricks.
    pub empty: u64,
    /// Full bricks.
    pub full: u64,
    /// Bricks that are neither.
    pub mixed: u64,
}

/// Returns the number of bricks that are neither empty nor full.
#[inline(always)]
pub(in crate::sculpture) fn count_mixed(grid: &Grid, bricks: BrickMask) -> usize {
    let mut mixed = 0;
    for index in bricks.indices() {
        mixed += usize::from(BrickKind::of_count(grid.counts[index as usize]) == BrickKind::Mixed);
    }
    mixed
}

/// Sets bricks to successive values of `bits`, with their counts. Returns the kinds of the old bricks and passes those
/// that are neither empty nor full to `keep_mixed`.
#[inline(always)]
pub(in crate::sculpture) fn swap_word(
    grid: &mut Grid,
    bricks: BrickMask,
    mut bits: impl FnMut() -> (Brick, u16),
    mut keep_mixed: impl FnMut(&Brick),
) -> WordKinds {
    let mut kept = WordKinds::default();
    let (mut flipped, mut opaque) = (0, grid.opaque);
    for index in bricks.indices() {
        let (at, bit) = (index as usize, 1 << (index % 64));
        let (brick, before) = (&mut grid.bricks[at], &mut grid.counts[at]);
        match BrickKind::of_count(*before) {
            BrickKind::Empty => kept.empty |= bit,
            BrickKind::Full => kept.full |= bit,
            BrickKind::Mixed => {
                kept.mixed |= bit;
                keep_mixed(brick);
            }
        }
        let (now, count) = bits();
        debug_assert_eq!(count, now.count());
        opaque = opaque + u64::from(count) - u64::from(*before);
        if (*before == 0) != (count == 0) {
            flipped |= bit;
        }
        (*brick, *before) = (now, count);
    }
    grid.opaque = opaque;
    flip_occupancy(grid, BrickMask { word: bricks.word, mask: flipped });
    kept
}

/// Flips the occupancy of bricks.
#[inline(always)]
fn flip_occupancy(grid: &mut Grid, bricks: BrickMask) {
    let (mut index, mut mask) = (bricks.word * 64, bricks.mask);
    while mask != 0 {
        let empty = mask.trailing_zeros();
        (index, mask) = (index + empty, mask >> empty);
        let b = unflatten(index, grid.brick_dims);
        // No further than the row, and with room to begin at a whole block.
        let run = (grid.brick_dims.x - b.x).min(60);
        let mut bits = (mask & (u64::MAX >> (64 - run))) << (b.x & 3);
        let (mut word, bit) = grid.occupancy_place(b.with_x(b.x & !3));
        while bits != 0 {
            grid.occupancy[word] ^= (bits & 0xF) << bit;
            (word, bits) = (word + 1, bits >> 4);
        }
        (index, mask) = (index + run, mask >> run);
    }
}
