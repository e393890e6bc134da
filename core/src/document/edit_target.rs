//! The contents that commands edit, with the restrictions on an edit and its traces: selection, symmetry, mask and
//! memory limits; the record of earlier values, the dirty bricks and the revision.
//!
//! All tools change voxels through [`EditTarget::edit`] and [`EditTarget::paint`], and the mask through
//! [`EditTarget::edit_mask`]. These apply selection and mask. Takes regions; returns counts of changes. Knows no
//! command, no stroke and no history.

use std::sync::Arc;

use glam::UVec3;

use super::CommandError;
use super::changes::SubscribedChanges;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::bits_growth::bits_growth;
use crate::sculpture::brick_set::BrickSet;
use crate::sculpture::edit::{self, EditOp, EditStats};
use crate::sculpture::edit_scope::{EditScope, ScopedRegion};
use crate::sculpture::history::{Contents, StepChange};
use crate::sculpture::paint::paint_each;
use crate::sculpture::region::{ListedBricks, Region};
use crate::sculpture::selection::{BoxStack, Selection};
use crate::sculpture::stroke::StrokeRecorder;
use crate::sculpture::to_paint::{PaintedWith, growth, growth_of_bricks};
use crate::sculpture::{ColourDepth, Grid, Limits, Material, Rgb};
use crate::tools::symmetry::{Symmetry, SymmetryTransform};

use memory::BitsInUse;

mod memory;
mod swap;

pub(super) use swap::SetAside;

/// The contents that commands edit.
#[derive(Debug)]
pub(super) struct EditTarget {
    /// Shared with a save in progress; an edit during the save works on a copy, which costs nothing.
    pub contents: Arc<Contents>,
    /// In grid coordinates.
    pub selection: Selection,
    /// In signed coordinates, which stay what they are when the box grows.
    pub symmetry: Symmetry,
    pub limits: Limits,
    /// Rises with every change of voxels: a cheap test whether a copy is current.
    pub revision: u64,
    recorder: StrokeRecorder,
    /// The changes of the open stroke before the recorded edits, in order: edits and growths.
    earlier: Vec<StepChange>,
    dirty: BrickSet,
    bits: BitsInUse,
    /// Whether the whole sculpture has been replaced since changes were last published.
    all_dirty: bool,
}

impl EditTarget {
    /// Creates a target with nothing selected or recorded.
    pub fn new(contents: Contents, limits: Limits) -> EditTarget {
        EditTarget {
            selection: Selection::of(&contents.frame),
            symmetry: Symmetry::default(),
            limits,
            revision: 0,
            recorder: StrokeRecorder::default(),
            earlier: Vec::new(),
            dirty: BrickSet::default(),
            bits: BitsInUse::default(),
            all_dirty: true,
            contents: Arc::new(contents),
        }
    }

    pub fn grid(&self) -> &Grid {
        &self.contents.grid
    }

    pub fn material(&self) -> &Material {
        &self.contents.material
    }

    /// Returns the protected voxels, if there are any.
    pub fn mask(&self) -> Option<&Grid> {
        self.contents.mask.as_deref()
    }

    /// Returns the images of tools under the present symmetry, the identity first.
    pub fn images(&self) -> Vec<SymmetryTransform> {
        self.symmetry.images_in(&self.contents.frame, self.grid().voxel_size())
    }

    /// Returns the selected boxes; an error if there are none.
    pub fn selected(&self) -> Result<BoxStack, CommandError> {
        match self.selection.stack().is_empty() {
            true => Err(CommandError::NothingSelected),
            false => Ok(self.selection.stack().clone()),
        }
    }

    /// Returns where tools may work.
    pub fn scope(&self) -> EditScope<'_> {
        EditScope { stack: self.selection.limit(), mask: self.mask() }
    }

    /// Edits the voxels of a region where tools may work.
    pub fn edit(&mut self, region: &impl Region, op: EditOp) -> EditStats {
        let (contents, recorder, dirty) =
            (Arc::make_mut(&mut self.contents), &mut self.recorder, &mut self.dirty);
        let mask = contents.mask.take();
        let scope = EditScope { stack: self.selection.limit(), mask: mask.as_deref() };
        let stats = match scope.is_everywhere() {
            true => edit::edit(contents, region, op, recorder, dirty),
            false => edit::edit(contents, &ScopedRegion { region, scope }, op, recorder, dirty),
        };
        contents.mask = mask;
        stats
    }

    /// Paints voxel by voxel, where tools may work.
    pub fn paint(
        &mut self,
        region: &impl Region,
        colour: impl Fn(UVec3, Rgb) -> Rgb + Sync,
    ) -> EditStats {
        let (contents, recorder, dirty) =
            (Arc::make_mut(&mut self.contents), &mut self.recorder, &mut self.dirty);
        let mask = contents.mask.take();
        let scope = EditScope { stack: self.selection.limit(), mask: mask.as_deref() };
        let stats = match scope.is_everywhere() {
            true => paint_each(contents, region, colour, recorder, dirty),
            false => paint_each(contents, &ScopedRegion { region, scope }, colour, recorder, dirty),
        };
        contents.mask = mask;
        stats
    }

    /// Adds voxels to the mask or removes them from it, within the selection if tools are limited to it.
    pub fn edit_mask(
        &mut self,
        region: &impl Region,
        adds: bool,
    ) -> Result<EditStats, CommandError> {
        let grid = self.grid();
        let new = match self.mask() {
            Some(_) => None,
            None if !adds => return Ok(EditStats::default()),
            None => Some(Box::new(grid.emptied())),
        };
        let (mask, stack) = (self.mask().or(new.as_deref()), self.selection.limit());
        if let Some(mask) = mask {
            let scope = EditScope { stack, mask: None };
            self.check_bits_memory(|is_close| match scope.is_everywhere() {
                true => bits_growth(mask, region, adds, is_close),
                false => bits_growth(mask, &ScopedRegion { region, scope }, adds, is_close),
            })?;
        }
        let contents = Arc::make_mut(&mut self.contents);
        let recorder = self.recorder.for_mask();
        let Some(mut bits) = contents.mask.take().or(new) else { return Ok(EditStats::default()) };
        let scope = EditScope { stack: self.selection.limit(), mask: None };
        let stats = match scope.is_everywhere() {
            true => edit::edit_mask(&mut bits, region, adds, recorder, &mut self.dirty),
            false => {
                let region = ScopedRegion { region, scope };
                edit::edit_mask(&mut bits, &region, adds, recorder, &mut self.dirty)
            }
        };
        contents.mask = Some(bits);
        contents.drop_empty_mask();
        Ok(stats)
    }

    /// Returns an upper bound of the bytes by which painting a region, where tools may work, makes the colours larger: a
    /// quick one, or a close one.
    pub fn colour_growth(&self, region: &impl Region, painted: PaintedWith, is_close: bool) -> u64 {
        let (contents, scope) = (&self.contents, self.scope());
        match scope.is_everywhere() {
            true => growth(contents, region, painted, is_close),
            false => growth(contents, &ScopedRegion { region, scope }, painted, is_close),
        }
    }

    /// Returns an upper bound of the bytes by which painting listed bricks in any colours makes the colours larger.
    pub fn growth_of_bricks(&self, voxels: &ListedBricks) -> u64 {
        growth_of_bricks(self.material(), voxels.bricks().iter().map(|(b, _)| *b))
    }

    /// Returns an error if a change would need more memory for colours than is allowed. `growth`: the bytes by which they
    /// become larger, as a quick upper bound (`false`) or a close one (`true`).
    pub fn check_colour_memory(&self, growth: impl Fn(bool) -> u64) -> Result<(), CommandError> {
        let needed = |is_close| self.material().heap_bytes().saturating_add(growth(is_close));
        let budget = self.limits.colour_bytes;
        if needed(false) <= budget {
            return Ok(());
        }
        let growth = growth(true);
        if growth == 0 {
            return Ok(());
        }
        let (what, purpose) = ("this may need", MemoryBudget::Colours);
        Ok(OverBudget::check(what, self.material().heap_bytes() + growth, purpose, budget)?)
    }

    pub fn has_colour(&self) -> bool {
        self.material().depth() != ColourDepth::None
    }

    /// Returns an error if the sculpture stores no colours.
    pub fn require_colours(&self) -> Result<(), CommandError> {
        if self.has_colour() { Ok(()) } else { Err(CommandError::NoColour) }
    }

    /// Returns an error if `op` only changes colours and the sculpture stores none.
    pub fn require_colours_for(&self, op: EditOp) -> Result<(), CommandError> {
        match op {
            EditOp::Recolour(_) => self.require_colours(),
            EditOp::Add(_) | EditOp::Subtract => Ok(()),
        }
    }

    /// Publishes the bricks changed since the last call to the subscribers of `changes`.
    pub fn publish(&mut self, changes: &mut SubscribedChanges) {
        let bricks = self.contents.grid.brick_dims();
        changes.publish(&mut self.dirty, std::mem::take(&mut self.all_dirty), bricks);
    }
}
