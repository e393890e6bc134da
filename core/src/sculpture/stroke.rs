//! Collects the undo record of a stroke while it is in progress: the leaves of the grid that it has changed as it found
//! them, which bricks of them have changed, and the earlier colours of painted bricks.
//!
//! One recorder serves all strokes of a sculpture, so that a stroke allocates little but its resulting record. Knows no
//! history.

use std::collections::hash_map::Entry;

use rustc_hash::FxHashMap;

use super::brick::Brick;
use super::brick_set::{BrickSet, LeafKey};
use super::colour_record::ColourRecorder;
use super::contents::Contents;
use super::grid::{ChangedLeaf, Grid, OldLeaf};
use super::material::{Material, Painted};
use super::record::{BrickRecord, RecordSize};

/// Collects the record of the stroke in progress.
#[derive(Debug, Default)]
pub struct StrokeRecorder {
    /// The changed leaves as the stroke found them, and which of their bricks have changed.
    leaves: FxHashMap<LeafKey, (OldLeaf, Brick)>,
    /// The size of their record.
    size: RecordSize,
    colours: ColourRecorder,
    /// The recorder of the mask, once the stroke changes it.
    mask: Option<Box<StrokeRecorder>>,
}

impl StrokeRecorder {
    /// Returns the recorder of the mask.
    pub(crate) fn for_mask(&mut self) -> &mut StrokeRecorder {
        self.mask.get_or_insert_default()
    }

    /// Returns whether the stroke has kept the earlier bits of a leaf.
    #[inline(always)]
    pub(super) fn has_leaf(&self, leaf: LeafKey) -> bool {
        self.leaves.contains_key(&leaf)
    }

    /// Prepares for an edit of colours.
    pub(super) fn begin_painting(&mut self, material: &Material) {
        self.colours.begin(material);
    }

    /// Ends an edit that has changed the bits of `changed`: adds these bricks to `dirty`.
    pub(super) fn close_edit(&mut self, changed: Vec<ChangedLeaf>, dirty: &mut BrickSet) {
        for changed in changed {
            dirty.insert_in(changed.leaf, &changed.bricks);
            self.note_changed(changed);
        }
    }

    /// Ends an edit that has painted, and adds the bricks that have changed to `dirty`.
    pub(super) fn close_painting(&mut self, painted: &Painted, dirty: &mut BrickSet) {
        self.colours.note(painted);
        for (leaf, bricks) in painted.leaves.iter().chain(&painted.in_cubes) {
            dirty.insert_in(*leaf, bricks);
        }
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
        self.size.bytes() + self.colours.bytes() + self.mask.as_ref().map_or(0, |mask| mask.bytes())
    }

    /// Resumes an ended stroke from its record. `contents`: those at its end.
    pub(crate) fn resume(&mut self, mut record: BrickRecord, contents: &Contents) {
        let Contents { grid, material, mask, .. } = contents;
        if let Some(colours) = record.colours() {
            self.colours.resume(colours, material);
        }
        if let Some(record) = record.take_mask() {
            let mask = mask.as_deref().cloned().unwrap_or_else(|| grid.emptied());
            self.for_mask().resume_bits(&record, &mask);
        }
        self.resume_bits(&record, grid);
    }

    /// Resumes the bits of a stroke. `grid`: the bits at its end.
    fn resume_bits(&mut self, record: &BrickRecord, grid: &Grid) {
        let mut before = grid.clone();
        for (leaf, bricks) in record.put_bits(&mut before).leaves() {
            let before = Some(before.leaf_bits(leaf));
            self.note_changed(ChangedLeaf { leaf, bricks, before });
        }
    }

    /// Ends the stroke and returns its record.
    pub fn finish(&mut self) -> BrickRecord {
        self.size = RecordSize::default();
        let mut leaves: Vec<_> = self.leaves.drain().collect();
        leaves.sort_unstable_by_key(|(leaf, _)| *leaf);
        let mut record = BrickRecord::of_leaves(&leaves);
        record.shrink_to_fit();
        let record = record.with_colours(self.colours.finish());
        match self.mask.take() {
            Some(mut mask) => record.with_mask(mask.finish()),
            None => record,
        }
    }
}
