//! The pointer over the picture: its position, and the meaning of the button that it holds.
//!
//! Takes pixels of the picture; knows no tool and changes nothing.

use glam::{UVec3, Vec2};

use crate::input::Action;
use crate::picking::Picker;
use crate::sculpture::Grid;

/// The present use of a window's pointer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PointerUse {
    /// The tool follows the pointer; in some tables of keys only drags move it.
    pub leads_tool: bool,
    /// It holds something on the picture.
    pub dragging: bool,
}

/// The state of the pointer between events.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Pointer {
    /// Its position in pixels of the picture; `None` while it is elsewhere.
    pub at: Option<Vec2>,
    /// A drag of `Sculpt` that began beside the sculpture rotates it.
    pub rotates_instead: bool,
    /// The gesture of the held button was ended; the button has no effect until it is released.
    pub lifted: bool,
}

impl Pointer {
    /// Returns the action that a drag or a hold of `action` means.
    pub fn meant(&self, action: Action) -> Action {
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth
                if self.rotates_instead && !self.lifted =>
            {
                Action::TurnSculpture
            }
            _ => action,
        }
    }

    /// Releases the button.
    pub fn release(&mut self) {
        (self.rotates_instead, self.lifted) = (false, false);
    }

    /// Returns the voxel that it points at.
    pub fn voxel(&self, grid: &Grid, picker: &Picker) -> Option<UVec3> {
        self.at.and_then(|at| picker.voxel(grid, at))
    }
}
