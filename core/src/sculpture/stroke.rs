//! Collects the undo record of a stroke while it is in progress: for each brick that an edit changes for the first
//! time, its earlier bits and colours.
//!
//! One recorder serves all strokes of a sculpture, so that a stroke allocates only its resulting record. Knows no
//! history.

use super::brick::Brick;
use super::brick_set::{BrickMask, BrickSet};
use super::edit_stats::EditStats;
use super::grid::Grid;
use super::record::BrickRecord;

/// Collects the record of the stroke in progress.
#[derive(Debug, Default)]
pub struct StrokeRecorder {
    bands: Vec<BandRecord>,
    bits_kept: BrickSet,
    pages_kept: BrickSet,
    /// The recorder of the mask, once the stroke changes it.
    mask: Option<Box<StrokeRecorder>>,
}

/// Values that one band of the grid keeps during a stroke, and reports after each edit of it.
#[derive(Debug, Default)]
pub struct BandRecord {
    /// Earlier values, from the whole stroke.
    pub earlier: BrickRecord,
    /// Bricks whose bits the current edit has changed.
    pub bits_changed: Vec<BrickMask>,
    /// Bricks whose page the current edit has changed.
    pub pages_changed: Vec<BrickMask>,
    /// Voxels that the current edit has yet to paint, by brick.
    pub to_paint: Vec<(u32, Brick)>,
    /// Counts of the current edit's changes.
    pub stats: EditStats,
}

impl AsMut<BrickRecord> for BandRecord {
    fn as_mut(&mut self) -> &mut BrickRecord {
        &mut self.earlier
    }
}

/// The bands to record into, with the bricks whose earlier state has been kept.
pub struct StrokeBands<'a> {
    /// A record per band of the grid.
    pub bands: &'a mut [BandRecord],
    /// Bricks whose earlier bits the stroke has kept.
    pub bits_kept: &'a BrickSet,
    /// Bricks whose earlier page the stroke has kept.
    pub pages_kept: &'a BrickSet,
}

impl StrokeRecorder {
    /// Returns a recorder for sculptures of the size of `grid`.
    pub fn new(grid: &Grid) -> StrokeRecorder {
        StrokeRecorder {
            bands: std::iter::repeat_with(BandRecord::default).take(grid.band_count()).collect(),
            bits_kept: BrickSet::new(grid.brick_count()),
            pages_kept: BrickSet::new(grid.brick_count()),
            mask: None,
        }
    }

    /// Returns the recorder of the mask of `grid`.
    pub(crate) fn for_mask(&mut self, grid: &Grid) -> &mut StrokeRecorder {
        self.mask.get_or_insert_with(|| Box::new(StrokeRecorder::new(grid)))
    }

    /// Lends the bands out for one edit.
    pub fn recording(&mut self) -> StrokeBands<'_> {
        StrokeBands {
            bands: &mut self.bands,
            bits_kept: &self.bits_kept,
            pages_kept: &self.pages_kept,
        }
    }

    /// Ends an edit: marks the recorded bricks as kept, adds the changed bricks to `dirty`, and
    /// returns the sum of the bands' counts.
    pub(crate) fn close_edit(&mut self, dirty: &mut BrickSet) -> EditStats {
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

    /// Returns the bytes that the stroke's record takes so far.
    pub fn bytes(&self) -> usize {
        let own: usize = self.bands.iter().map(|band| band.earlier.gathered_bytes()).sum();
        own + self.mask.as_ref().map_or(0, |mask| mask.bytes())
    }

    /// Resumes an ended stroke from its record.
    pub(crate) fn resume(&mut self, mut record: BrickRecord, grid: &Grid) {
        if let Some(mask) = record.take_mask() {
            self.for_mask(grid).resume(mask, grid);
        }
        for bricks in record.kinds().into_iter().flatten() {
            self.bits_kept.insert_mask(*bricks);
        }
        for (index, _) in record.pages() {
            self.pages_kept.insert(*index);
        }
        if let Some(band) = self.bands.first_mut() {
            band.earlier = record;
        }
    }

    /// Ends the stroke and returns its record.
    pub fn finish(&mut self) -> BrickRecord {
        self.bits_kept.clear();
        self.pages_kept.clear();
        let record = BrickRecord::gather(&mut self.bands);
        match self.mask.take() {
            Some(mut mask) => record.with_mask(mask.finish()),
            None => record,
        }
    }
}
