//! Commands about areas: fill, clear, dye and tint them, flood patches of one colour; copy, cut and move the marker's contents.

use std::sync::Arc;

use glam::{IVec3, UVec3};

use super::{Applied, CommandError, Document};
use crate::command::{Area, Command};
use crate::refusal::InvalidValue;
use crate::sculpture::Rgb;
use crate::sculpture::clip::Clip;
use crate::sculpture::edit::EditOp;
use crate::sculpture::edit_scope::EditScope;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::{Everywhere, Region};
use crate::sculpture::selection::Selection;
use crate::tools::flood;
use crate::tools::tint::{Tint, Tinter};

impl Document {
    /// Edits all voxels of an area.
    pub(super) fn edit_area(
        &mut self,
        area: Area,
        op: EditOp,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        if matches!(op, EditOp::Recolour(_)) && !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        match area {
            Area::Grid => self.edit_region(&Everywhere, op, command),
            Area::Marker => self.edit_region(&self.selection.marker(), op, command),
            Area::Selection if self.selection.stack().is_empty() => {
                Err(CommandError::NothingSelected)
            }
            Area::Selection => self.edit_region(&self.selection.stack().clone(), op, command),
        }
    }

    fn edit_region(
        &mut self,
        region: &impl Region,
        op: EditOp,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.check_colour_memory(|document, exact| document.new_pages(region, op, exact))?;
        let stats = self.edit(region, op);
        self.applied(stats, command)
    }

    /// Changes the colours of an area.
    pub(super) fn tint(
        &mut self,
        area: Area,
        tint: &Tint,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        tint.check()?;
        if !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        match area {
            Area::Grid => self.tint_region(&Everywhere, tint, command),
            Area::Marker => self.tint_region(&self.selection.marker(), tint, command),
            Area::Selection if self.selection.stack().is_empty() => {
                Err(CommandError::NothingSelected)
            }
            Area::Selection => self.tint_region(&self.selection.stack().clone(), tint, command),
        }
    }

    fn tint_region(
        &mut self,
        region: &impl Region,
        tint: &Tint,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let (voxel_size, base) = (self.grid().voxel_size(), self.material().base());
        let tinter = Tinter::new(tint, voxel_size, base);
        if !tinter.keeps_base() {
            let any = EditOp::Recolour(self.new_colour());
            self.check_colour_memory(|document, exact| document.new_pages(region, any, exact))?;
        }
        let stats = self.paint(region, |v, now| tinter.colour(v, now));
        self.applied(stats, command)
    }

    /// Recolours the patch of one colour on the surface around a voxel, and those around its mirror images.
    pub(super) fn flood(
        &mut self,
        at: UVec3,
        colour: Rgb,
        tolerance: f32,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        InvalidValue::check_share("tolerance", tolerance)?;
        if !self.has_colour() {
            return Err(CommandError::NoColour);
        }
        let starts = self.surface_images(at)?;
        let patch = flood::patch(&self.contents, &starts, tolerance);
        self.edit_region(&patch, EditOp::Recolour(colour), command)
    }

    /// Copies the marker's contents to the clipboard.
    pub(super) fn copy(&mut self) -> Result<(), CommandError> {
        // Copying leaves masked voxels as they are, so the mask does not limit it.
        let scope = EditScope { mask: None, ..self.scope() };
        self.clip = Some(Arc::new(self.marked(scope)?));
        Ok(())
    }

    /// Cuts the marker's contents to the clipboard.
    pub(super) fn cut(&mut self, command: &Command) -> Result<Applied, CommandError> {
        let kept = self.clip.replace(Arc::new(self.marked(self.scope())?));
        let stats = self.edit(&self.selection.marker(), EditOp::Subtract);
        let applied = self.applied(stats, command);
        if applied.is_err() {
            self.clip = kept;
        }
        applied
    }

    /// Turns the marker's contents about their centre and moves them, with the marker.
    pub(super) fn move_marked(
        &mut self,
        by: IVec3,
        orientation: Orientation,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        let clip = self.marked(self.scope())?;
        let from = self.selection.marker().min.max(IVec3::ZERO);
        let (size, turned) = (clip.size().as_ivec3(), orientation.size(clip.size()).as_ivec3());
        // Rounded towards zero, so that turning there and back leads back.
        let to = from.saturating_add(by).saturating_add((size - turned) / 2);
        self.pasted(&clip, to, orientation)?;
        let marker = clip.bounds(to, orientation);
        Selection::check_marker(marker)?;
        let upright = clip.voxels(from, Orientation::UPRIGHT, self.grid().brick_dims());
        let mut stats = self.edit(&upright, EditOp::Subtract);
        let kept = self.clip.replace(Arc::new(clip));
        let pasted = self.paste(to, orientation);
        self.clip = kept;
        stats += pasted?;
        let before = self.selection.marker();
        self.selection.set_marker(marker)?;
        let applied = self.applied(stats, command);
        if applied.is_err() {
            self.selection.set_marker(before)?;
        }
        applied
    }

    /// The marker's contents where they may be changed, or copied.
    fn marked(&self, scope: EditScope<'_>) -> Result<Clip, CommandError> {
        let clip = Clip::cut(
            &self.contents,
            self.selection.marker(),
            |v| scope.allows(v),
            self.limits.grid_bytes,
        )?;
        let why = match scope {
            EditScope { mask: Some(_), .. } => " that may be changed: the rest is masked",
            EditScope { stack: Some(_), .. } => " that are selected",
            _ => "",
        };
        clip.filter(|clip| clip.voxel_count() > 0).ok_or(CommandError::NothingMarked(why))
    }
}
