//! The form in which near voxels are shown, their smooth surface or their cubes: a part of the contents, so that files, undo and
//! orientations take it along. Changes no voxel.

use std::sync::Arc;

use super::{Applied, CommandError, Document};
use crate::command::Command;
use crate::sculpture::history::{Change, State, Step, SurfaceKind};

impl Document {
    /// Shows another kind of surface, as one undo step.
    pub(super) fn show_surface(
        &mut self,
        kind: SurfaceKind,
        command: &Command,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke(command.verb())?;
        if kind == self.contents.surface {
            return Ok(Applied::default());
        }
        let label = command.label();
        self.require_room(&label, 0)?;
        let change = Change::Surface(self.swap_surface(kind));
        let number = self.new_state();
        let State { sculpture, .. } = self.state;
        let state = std::mem::replace(&mut self.state, State { sculpture, number });
        self.settled = self.state;
        self.history.push(Step { label, change, state });
        Ok(Applied::default())
    }

    /// Shows a kind of surface and returns the one that was shown.
    pub(super) fn swap_surface(&mut self, kind: SurfaceKind) -> SurfaceKind {
        self.revision += 1;
        std::mem::replace(&mut Arc::make_mut(&mut self.contents).surface, kind)
    }
}
