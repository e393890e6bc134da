//! Owns what each edit does to the bricks of one row: new bits, count, what is kept of the old
//! bits, and what is reported as changed.
//!
//! Bricks come in rising order, so that what concerns 64 of them is gathered in registers and
//! written once. Knows no tool and no colour.

use glam::UVec3;

use super::brick::{BRICK_VOXELS, Brick};
use super::brick_set::{BrickMask, BrickSet};
use super::grid::GridBand;
use super::record::KeptWord;
use super::region::{Region, RowReach};
use super::stroke::BandRecord;

const FULL: u16 = BRICK_VOXELS as u16;

/// How much of a brick an edit covers.
pub enum Cover<'a, R: Region> {
    Whole,
    /// What the region says of the brick at `x` of the row that is cut.
    Part {
        region: &'a R,
        cut: &'a R::Row,
        reach: &'a RowReach,
        x: u32,
    },
}

impl<R: Region> Cover<'_, R> {
    #[inline(always)]
    pub fn mask(self) -> Brick {
        match self {
            Cover::Whole => Brick::FULL,
            Cover::Part { region, cut, reach, x } => region.mask(cut, reach, x),
        }
    }
}

/// An edit on its way along one row of bricks.
pub struct RowEdit<'a, 'g> {
    grid: &'a mut GridBand<'g>,
    record: &'a mut BandRecord,
    kept_before: &'a BrickSet,
    /// The word of 64 bricks at hand, and which of them the stroke has kept already.
    word: u32,
    kept_of_word: u64,
    kept: KeptWord,
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
            kept: KeptWord::default(),
            changed: 0,
        }
    }

    /// Removes the covered voxels of the brick at `b`.
    #[inline(always)]
    pub fn subtract(&mut self, b: UVec3, cover: Cover<impl Region>) {
        let index = self.grid.brick_index(b);
        let count = self.grid.count(index);
        if count == 0 {
            return;
        }
        if let Cover::Whole = cover {
            self.replace(b, index, count, &Brick::EMPTY, 0);
            return;
        }
        let bits = match count {
            FULL => Brick::FULL.and_not(&cover.mask()),
            _ => self.grid.brick(index).and_not(&cover.mask()),
        };
        let left = bits.count();
        if left != count {
            self.replace(b, index, count, &bits, left);
        }
    }

    /// Makes the covered voxels of the brick at `b` exist. If `paint`, those that did not are
    /// handed on to be painted.
    #[inline(always)]
    pub fn add(&mut self, b: UVec3, cover: Cover<impl Region>, paint: bool) {
        let index = self.grid.brick_index(b);
        let count = self.grid.count(index);
        if count == FULL {
            return;
        }
        let mask = cover.mask().and(&self.grid.valid_mask(b));
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

    /// Hands the covered voxels that exist in the brick at `b` on to be painted.
    #[inline(always)]
    pub fn paint(&mut self, b: UVec3, cover: Cover<impl Region>) {
        let index = self.grid.brick_index(b);
        if self.grid.count(index) == 0 {
            return;
        }
        let mask = cover.mask().and(self.grid.brick(index));
        if !mask.is_empty() {
            self.record.to_paint.push((index, mask));
        }
    }

    /// Sets a brick to other bits and keeps what it was, if this is the first time.
    #[inline(always)]
    fn replace(&mut self, b: UVec3, index: u32, before: u16, bits: &Brick, count: u16) {
        if index / 64 != self.word {
            self.close_word();
            self.word = index / 64;
            self.kept_of_word = self.kept_before.mask(self.word);
        }
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

    /// Writes what has been gathered. Must be called after the row's last brick.
    #[inline]
    pub fn close_word(&mut self) {
        if self.changed != 0 {
            let fresh = !self.kept_of_word;
            let KeptWord { empty, full, mixed } = std::mem::take(&mut self.kept);
            let kept = KeptWord { empty: empty & fresh, full: full & fresh, mixed: mixed & fresh };
            self.record.earlier.keep_word(self.word, kept);
            self.record.stats.bricks_changed += u64::from(self.changed.count_ones());
            let mask = std::mem::take(&mut self.changed);
            self.record.bits_changed.push(BrickMask { word: self.word, mask });
        }
    }
}
