//! Commands about areas: fill, clear and dye them; copy, cut and move the marker's contents.

use std::sync::Arc;

use glam::IVec3;

use super::{Applied, CommandError, Document};
use crate::command::{Area, Command};
use crate::sculpture::clip::Clip;
use crate::sculpture::edit::EditOp;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::{Everywhere, Region};
use crate::sculpture::selection::Selection;

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

    /// Copies the marker's contents to the clipboard.
    pub(super) fn copy(&mut self) -> Result<(), CommandError> {
        self.clip = Some(Arc::new(self.marked()?));
        Ok(())
    }

    /// Cuts the marker's contents to the clipboard.
    pub(super) fn cut(&mut self, command: &Command) -> Result<Applied, CommandError> {
        let kept = self.clip.replace(Arc::new(self.marked()?));
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
        let clip = self.marked()?;
        let from = self.selection.marker().min.max(IVec3::ZERO);
        let (size, turned) = (clip.size().as_ivec3(), orientation.size(clip.size()).as_ivec3());
        // Rounded towards zero, so that turning there and back leads back.
        let to = from.saturating_add(by).saturating_add((size - turned) / 2);
        self.pasted(&clip, to, orientation)?;
        let marker = clip.bounds(to, orientation);
        Selection::check_marker(marker).map_err(CommandError::Marker)?;
        let upright = clip.voxels(from, Orientation::UPRIGHT, self.grid().brick_dims());
        let mut stats = self.edit(&upright, EditOp::Subtract);
        let kept = self.clip.replace(Arc::new(clip));
        let pasted = self.paste(to, orientation);
        self.clip = kept;
        stats += pasted?;
        let before = self.selection.marker();
        self.selection.set_marker(marker).map_err(CommandError::Marker)?;
        let applied = self.applied(stats, command);
        if applied.is_err() {
            self.selection.set_marker(before).map_err(CommandError::Marker)?;
        }
        applied
    }

    /// The marker's contents within the limit to the selection.
    fn marked(&self) -> Result<Clip, CommandError> {
        let limit = self.selection.limit();
        let clip = Clip::cut(
            &self.contents,
            self.selection.marker(),
            |v| limit.is_none_or(|stack| stack.contains(v)),
            self.limits.grid_bytes,
        )?;
        let why = if limit.is_some() { " that are selected" } else { "" };
        clip.filter(|clip| clip.voxel_count() > 0).ok_or(CommandError::NothingMarked(why))
    }
}
