//! The pointer over the picture: where it is, and what a button that it holds means.
//!
//! Takes pixels of the picture; knows no tool and changes nothing.

use glam::{UVec3, Vec2};

use crate::input::Action;
use crate::picking::Picker;
use crate::sculpture::Grid;

/// How the pointer of a window is used at the moment.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PointerUse {
    /// The tool goes where the pointer is; in some tables of keys drags alone move it.
    pub leads_tool: bool,
    /// It holds something on the picture.
    pub dragging: bool,
}

/// The state of the pointer between events.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Pointer {
    /// Where it is, in pixels of the picture; none while it is elsewhere.
    pub at: Option<Vec2>,
    /// A drag of `Sculpt` that began beside the sculpture rotates it.
    pub rotates_instead: bool,
    /// The gesture that its button holds was ended; the button does nothing until it is released.
    pub lifted: bool,
}

impl Pointer {
    /// Returns the action that a drag or a hold of `action` stands for.
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

    /// The button is released.
    pub fn release(&mut self) {
        (self.rotates_instead, self.lifted) = (false, false);
    }

    /// Returns the voxel that it points at.
    pub fn voxel(&self, grid: &Grid, picker: &Picker) -> Option<UVec3> {
        self.at.and_then(|at| picker.voxel(grid, at))
    }
}
