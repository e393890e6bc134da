//! Edits the bricks of one row: sets their bits and counts, keeps the old bits for undo, and reports the changed
//! bricks.
//!
//! Bricks come in ascending order, so that the masks of 64 of them are gathered in registers and written once. Knows no
//! tool and no colour.

use fearless_simd::Simd;
use glam::UVec3;

use super::brick::{BRICK_VOXELS, Brick};
use super::brick_set::{BrickMask, BrickSet};
use super::grid::{GridBand, WordKinds};
use super::region::{Region, RowReach};
use super::stroke::BandRecord;

const FULL: u16 = BRICK_VOXELS as u16;

/// Bricks of a row that an edit covers alike.
pub enum RowPiece<'a, S: Simd, R: Region> {
    /// `len` bricks along x from `first` on, all of them.
    Whole { first: UVec3, len: u32 },
    /// The part of one brick that the region, cut by the row, covers.
    Part { simd: S, brick: UVec3, region: &'a R, cut: &'a R::Row, reach: &'a RowReach },
}

impl<S: Simd, R: Region> RowPiece<'_, S, R> {
    /// Calls `f` with each brick.
    #[inline(always)]
    pub fn each(&self, mut f: impl FnMut(UVec3)) {
        let (first, len) = match *self {
            RowPiece::Whole { first, len } => (first, len),
            RowPiece::Part { brick, .. } => (brick, 1),
        };
        for i in 0..len {
            f(first + UVec3::X * i);
        }
    }

    /// Returns the covered voxels of a brick.
    #[inline(always)]
    pub fn mask(&self, brick: UVec3) -> Brick {
        match self {
            RowPiece::Whole { .. } => Brick::FULL,
            RowPiece::Part { simd, region, cut, reach, .. } => {
                region.mask(*simd, cut, reach, brick.x)
            }
        }
    }
}

/// An edit in progress along one row of bricks.
pub struct RowEdit<'a, 'g> {
    grid: &'a mut GridBand<'g>,
    record: &'a mut BandRecord,
    kept_before: &'a BrickSet,
    /// The current word of 64 bricks, and those of them that the stroke has already kept.
    word: u32,
    kept_of_word: u64,
    kept: WordKinds,
    changed: u64,
}

impl<'a, 'g> RowEdit<'a, 'g> {
    pub fn new(
        grid: &'a mut GridBand<'g>,
        record: &'a mut BandRecord,
        kept_before: &'a BrickSet,
    ) -> Self {
        RowEdit {
            grid,
            record,
            kept_before,
            word: u32::MAX,
            kept_of_word: 0,
            kept: WordKinds::default(),
            changed: 0,
        }
    }

    /// Removes the covered voxels.
    #[inline(always)]
    pub fn subtract(&mut self, piece: RowPiece<impl Simd, impl Region>) {
        match piece {
            RowPiece::Whole { first, len } => {
                self.each_run(
                    first,
                    len,
                    FULL,
                    #[inline(always)]
                    |edit, b, index| {
                        let count = edit.grid.count(index);
                        if count != 0 {
                            edit.replace(b, index, count, &Brick::EMPTY, 0);
                        }
                    },
                );
            }
            RowPiece::Part { simd, brick: b, region, cut, reach } => {
                let index = self.grid.brick_index(b);
                let count = self.grid.count(index);
                if count == 0 {
                    return;
                }
                let mask = region.mask(simd, cut, reach, b.x);
                let old = if count == FULL { &Brick::FULL } else { self.grid.brick(index) };
                let bits = old.and_not(&mask);
                let left = bits.count();
                if left != count {
                    self.replace(b, index, count, &bits, left);
                }
            }
        }
    }

    /// Makes the covered voxels exist. With `paint`, new ones are listed to be painted.
    #[inline(always)]
    pub fn add(&mut self, piece: RowPiece<impl Simd, impl Region>, paint: bool) {
        match piece {
            RowPiece::Whole { first, len }
                if !paint && self.grid.valid_mask(first + UVec3::X * (len - 1)).is_full() =>
            {
                self.each_run(
                    first,
                    len,
                    0,
                    #[inline(always)]
                    |edit, b, index| edit.add_to(&piece, b, index, paint),
                );
            }
            _ => piece.each(
                #[inline(always)]
                |b| self.add_to(&piece, b, self.grid.brick_index(b), paint),
            ),
        }
    }

    #[inline(always)]
    fn add_to(
        &mut self,
        piece: &RowPiece<impl Simd, impl Region>,
        b: UVec3,
        index: u32,
        paint: bool,
    ) {
        let count = self.grid.count(index);
        if count == FULL {
            return;
        }
        let mask = piece.mask(b).and(&self.grid.valid_mask(b));
        let old = *self.grid.brick(index);
        let bits = old.or(&mask);
        let now = bits.count();
        if now != count {
            if paint {
                self.record.to_paint.push((index, mask.and_not(&old)));
            }
            self.replace(b, index, count, &bits, now);
        }
    }

    /// Lists the covered, existing voxels for painting.
    #[inline(always)]
    pub fn paint(&mut self, piece: RowPiece<impl Simd, impl Region>) {
        piece.each(
            #[inline(always)]
            |b| {
                let index = self.grid.brick_index(b);
                if self.grid.count(index) == 0 {
                    return;
                }
                let mask = piece.mask(b).and(self.grid.brick(index));
                if !mask.is_empty() {
                    self.record.to_paint.push((index, mask));
                }
            },
        );
    }

    /// Fills or empties `len` bricks along x: up to 64 at once where all have `before` voxels, which is 0 to fill them
    /// or 512 to empty them; otherwise each by `one`.
    #[inline(always)]
    fn each_run(
        &mut self,
        first: UVec3,
        len: u32,
        before: u16,
        one: impl Fn(&mut Self, UVec3, u32),
    ) {
        let (mut b, end) = (first, first.x + len);
        while b.x < end {
            let index = self.grid.brick_index(b);
            let run = (end - b.x).min(64 - index % 64);
            if self.grid.counts(index, run).iter().all(|&count| count == before) {
                self.enter_word(index);
                let mask = u64::MAX >> (64 - run) << (index % 64);
                self.changed |= mask;
                let voxels = u64::from(run) * u64::from(BRICK_VOXELS);
                if before == FULL {
                    self.kept.full |= mask;
                    self.record.stats.voxels_removed += voxels;
                } else {
                    self.kept.empty |= mask;
                    self.record.stats.voxels_added += voxels;
                }
                self.grid.flip_run(b, index, run, before == 0);
            } else {
                for i in 0..run {
                    one(self, b + UVec3::X * i, index + i);
                }
            }
            b.x += run;
        }
    }

    /// Makes the word of a brick the current one.
    #[inline(always)]
    fn enter_word(&mut self, index: u32) {
        if index / 64 != self.word {
            self.close_word();
            self.word = index / 64;
            self.kept_of_word = self.kept_before.mask(self.word);
        }
    }

    /// Sets a brick to new bits, and keeps the old ones if the stroke has not kept any of it yet.
    #[inline(always)]
    fn replace(&mut self, b: UVec3, index: u32, before: u16, bits: &Brick, count: u16) {
        self.enter_word(index);
        let bit = 1 << (index % 64);
        self.changed |= bit;
        match before {
            0 => self.kept.empty |= bit,
            FULL => self.kept.full |= bit,
            _ => {
                self.kept.mixed |= bit;
                if self.kept_of_word & bit == 0 {
                    self.record.earlier.keep_mixed(self.grid.brick(index));
                }
            }
        }
        let stats = &mut self.record.stats;
        stats.voxels_added += u64::from(count.saturating_sub(before));
        stats.voxels_removed += u64::from(before.saturating_sub(count));
        self.grid.set(b, index, bits, count);
    }

    /// Writes the masks gathered for the current word. Must be called after the row's last brick.
    #[inline(always)]
    pub(crate) fn close_word(&mut self) {
        if self.changed != 0 {
            let fresh = !self.kept_of_word;
            let WordKinds { empty, full, mixed } = std::mem::take(&mut self.kept);
            let kept = WordKinds { empty: empty & fresh, full: full & fresh, mixed: mixed & fresh };
            self.record.earlier.keep_word(self.word, kept);
            self.record.stats.bricks_changed += u64::from(self.changed.count_ones());
            let mask = std::mem::take(&mut self.changed);
            self.record.bits_changed.push(BrickMask { word: self.word, mask });
        }
    }
}
