//! Collects the undo record of a stroke while it is in progress: the leaves of the grid that it has changed as it found
//! them, which bricks of them have changed, and the earlier colours of painted bricks.
//!
//! One recorder serves all strokes of a sculpture, so that a stroke allocates little but its resulting record. Knows no
//! history.

use std::collections::hash_map::Entry;
use std::ops::Range;

use glam::UVec3;
use rustc_hash::FxHashMap;

use super::brick::Brick;
use super::brick_set::{BrickSet, LeafKey};
use super::edit_stats::EditStats;
use super::grid::{ChangedLeaf, Grid, OldLeaf};
use super::index_set::IndexSet;
use super::material::Page;
use super::record::{BrickRecord, RecordSize};

/// Slabs of bricks along z whose colours are edited by one task.
const BAND_SLABS: u32 = 4;

/// Collects the record of the stroke in progress.
#[derive(Debug, Default)]
pub struct StrokeRecorder {
    /// The changed leaves as the stroke found them, and which of their bricks have changed.
    leaves: FxHashMap<LeafKey, (OldLeaf, Brick)>,
    /// The size of their record.
    size: RecordSize,
    bands: Vec<PageRecord>,
    pages_kept: IndexSet,
    /// The recorder of the mask, once the stroke changes it.
    mask: Option<Box<StrokeRecorder>>,
}

/// Values that one band of the colours keeps during a stroke, and reports after each edit of it.
#[derive(Debug, Default)]
pub(super) struct PageRecord {
    /// Earlier pages with the linear indices of their bricks, from the whole stroke.
    pub earlier: Vec<(u32, Option<Page>)>,
    /// Linear indices of the bricks whose page the current edit has changed.
    pub changed: Vec<u32>,
    /// Voxels that the current edit has yet to paint, by linear index of their brick.
    pub to_paint: Vec<(u32, Brick)>,
    /// Counts of the current edit's changes.
    pub stats: EditStats,
}

/// The bands of the colours of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColourBands {
    /// Bricks in a band, the last of which may have fewer.
    pub bricks: usize,
}

impl ColourBands {
    pub fn of(grid: &Grid) -> ColourBands {
        let UVec3 { x, y, .. } = grid.brick_dims();
        ColourBands { bricks: (x * y * BAND_SLABS) as usize }
    }

    /// Returns the bands that hold the bricks of `slabs`.
    pub fn of_slabs(slabs: Range<u32>) -> Range<usize> {
        (slabs.start / BAND_SLABS) as usize..slabs.end.div_ceil(BAND_SLABS) as usize
    }
}

impl StrokeRecorder {
    /// Returns a recorder for sculptures of the size of `grid`.
    pub fn new(grid: &Grid) -> StrokeRecorder {
        let bands = grid.brick_dims().z.div_ceil(BAND_SLABS) as usize;
        StrokeRecorder {
            bands: std::iter::repeat_with(PageRecord::default).take(bands).collect(),
            pages_kept: IndexSet::new(grid.brick_count()),
            ..StrokeRecorder::default()
        }
    }

    /// Returns the recorder of the mask of `grid`.
    pub(crate) fn for_mask(&mut self, grid: &Grid) -> &mut StrokeRecorder {
        self.mask.get_or_insert_with(|| Box::new(StrokeRecorder::new(grid)))
    }

    /// Returns whether the stroke has kept the earlier bits of a leaf.
    #[inline(always)]
    pub(super) fn has_leaf(&self, leaf: LeafKey) -> bool {
        self.leaves.contains_key(&leaf)
    }

    /// Hands voxels that are to be painted to the bands that hold their bricks.
    pub(super) fn list_to_paint(&mut self, voxels: Vec<(UVec3, Brick)>, grid: &Grid) {
        for (b, mask) in voxels {
            let band = &mut self.bands[(b.z / BAND_SLABS) as usize];
            band.to_paint.push((grid.brick_index(b) as u32, mask));
        }
    }

    /// Lends out the records of the bands, with the bricks whose earlier page has been kept.
    pub(super) fn pages(&mut self) -> (&mut [PageRecord], &IndexSet) {
        (&mut self.bands, &self.pages_kept)
    }

    /// Ends an edit that has changed the bits of `changed` and the pages that the bands list: adds these bricks to
    /// `dirty`, and returns the sum of the counts.
    pub(super) fn close_edit(
        &mut self,
        grid: &Grid,
        changed: Vec<ChangedLeaf>,
        mut stats: EditStats,
        dirty: &mut BrickSet,
    ) -> EditStats {
        for changed in changed {
            dirty.insert_in(changed.leaf, &changed.bricks);
            self.note_changed(changed);
        }
        for band in &mut self.bands {
            for index in band.changed.drain(..) {
                self.pages_kept.insert(index);
                dirty.insert(grid.brick_coords(index as usize));
            }
            stats += std::mem::take(&mut band.stats);
        }
        stats
    }

    fn note_changed(&mut self, ChangedLeaf { leaf, bricks, before }: ChangedLeaf) {
        let (before, known) = match self.leaves.entry(leaf) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => match before {
                Some(before) => entry.insert((before, Brick::EMPTY)),
                None => return,
            },
        };
        let all = known.or(&bricks);
        if all != *known {
            self.size -= RecordSize::of_leaf(before, known);
            self.size += RecordSize::of_leaf(before, &all);
            *known = all;
        }
    }

    /// Returns about the bytes that the stroke's record takes so far.
    pub fn bytes(&self) -> usize {
        let pages = self.bands.iter().flat_map(|band| &band.earlier);
        let pages: usize = pages.map(BrickRecord::bytes_of_page).sum();
        self.size.bytes() + pages + self.mask.as_ref().map_or(0, |mask| mask.bytes())
    }

    /// Resumes an ended stroke of `grid` from its record.
    pub(crate) fn resume(&mut self, mut record: BrickRecord, grid: &Grid, mask: Option<&Grid>) {
        if let Some(record) = record.take_mask() {
            let mask = mask.cloned().unwrap_or_else(|| grid.emptied());
            self.for_mask(grid).resume(record, &mask, None);
        }
        for (index, _) in record.pages() {
            self.pages_kept.insert(*index);
        }
        if let Some(band) = self.bands.first_mut() {
            band.earlier = record.take_pages();
        }
        let mut before = grid.clone();
        for (leaf, bricks) in record.put_bits(&mut before).leaves() {
            let before = Some(before.leaf_bits(leaf));
            self.note_changed(ChangedLeaf { leaf, bricks, before });
        }
    }

    /// Ends the stroke and returns its record.
    pub fn finish(&mut self) -> BrickRecord {
        self.pages_kept.clear();
        self.size = RecordSize::default();
        let mut leaves: Vec<_> = self.leaves.drain().collect();
        leaves.sort_unstable_by_key(|(leaf, _)| *leaf);
        let mut record = BrickRecord::of_leaves(&leaves);
        for band in &mut self.bands {
            band.earlier.drain(..).for_each(|(index, page)| record.keep_page(index, page));
        }
        record.shrink_to_fit();
        match self.mask.take() {
            Some(mut mask) => record.with_mask(mask.finish()),
            None => record,
        }
    }
}
