//! Owns what is gathered between the start and the end of an undo step: for each brick that an
//! edit changes for the first time, what it held before.
//!
//! One recorder serves all strokes of a sculpture, so that a stroke allocates nothing but the
//! record it leaves. Knows no history.

use super::brick::Brick;
use super::brick_set::{BrickMask, BrickSet};
use super::edit::EditStats;
use super::grid::Grid;
use super::record::BrickRecord;

/// Collects the record of the stroke in progress.
#[derive(Debug, Default)]
pub struct StrokeRecorder {
    bands: Vec<BandRecord>,
    bits_kept: BrickSet,
    pages_kept: BrickSet,
}

/// What one band of the grid keeps during a stroke, and reports after each edit of it.
#[derive(Debug, Default)]
pub struct BandRecord {
    /// Earlier values, from the whole stroke.
    pub earlier: BrickRecord,
    /// Bricks whose bits the present edit has changed.
    pub bits_changed: Vec<BrickMask>,
    /// Bricks whose page the present edit has changed.
    pub pages_changed: Vec<BrickMask>,
    /// Voxels of bricks that the present edit is to paint.
    pub to_paint: Vec<(u32, Brick)>,
    /// What the present edit has changed.
    pub stats: EditStats,
}

impl AsMut<BrickRecord> for BandRecord {
    fn as_mut(&mut self) -> &mut BrickRecord {
        &mut self.earlier
    }
}

/// The bands to record into, with the bricks that the stroke has kept already.
pub struct Recording<'a> {
    pub bands: &'a mut [BandRecord],
    pub bits_kept: &'a BrickSet,
    pub pages_kept: &'a BrickSet,
}

impl StrokeRecorder {
    /// A recorder for sculptures of the size of `grid`.
    pub fn new(grid: &Grid) -> StrokeRecorder {
        StrokeRecorder {
            bands: std::iter::repeat_with(BandRecord::default).take(grid.band_count()).collect(),
            bits_kept: BrickSet::new(grid.brick_count()),
            pages_kept: BrickSet::new(grid.brick_count()),
        }
    }

    pub fn recording(&mut self) -> Recording<'_> {
        Recording {
            bands: &mut self.bands,
            bits_kept: &self.bits_kept,
            pages_kept: &self.pages_kept,
        }
    }

    /// Closes an edit: notes what has been kept, adds the bricks changed to `dirty`, and
    /// returns the sum of the bands' counts.
    pub fn close_edit(&mut self, dirty: &mut BrickSet) -> EditStats {
        let mut stats = EditStats::default();
        for band in &mut self.bands {
            let lists = [
                (&mut band.bits_changed, &mut self.bits_kept),
                (&mut band.pages_changed, &mut self.pages_kept),
            ];
            for (changed, kept) in lists {
                for bricks in changed.drain(..) {
                    kept.insert_mask(bricks);
                    dirty.insert_mask(bricks);
                }
            }
            stats += std::mem::take(&mut band.stats);
        }
        stats
    }

    /// What the record of the stroke takes so far.
    pub fn bytes(&self) -> usize {
        self.bands.iter().map(|band| band.earlier.gathered_bytes()).sum()
    }

    /// Ends the stroke: returns its record and is ready for the next one.
    pub fn finish(&mut self) -> BrickRecord {
        self.bits_kept.clear();
        self.pages_kept.clear();
        BrickRecord::gather(&mut self.bands)
    }
}
