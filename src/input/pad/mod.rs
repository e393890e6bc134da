//! Gamepads: the events of sticks and buttons ([`mapper`]), from stick position to speed
//! ([`stick`]), the strength of rumble ([`rumble`]), and the devices themselves ([`device`]).
//!
//! All but `device` are pure: they know no device, no clock and no window.

pub mod button;
pub mod device;
pub mod mapper;
pub mod options;
pub mod rumble;
pub mod shift_tap;
pub mod stick;

use glam::Vec2;
use serde::Deserialize;

pub use button::{PadButton, PadButtons};
pub use mapper::{Glide, PadEvent, PadMapper};
pub use options::GamepadOptions;

/// Identifies a pad while the program runs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct PadId(pub usize);

/// The state of a pad's sticks and buttons.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct PadState {
    /// Right and up are positive, -1 to 1 each.
    pub left: Vec2,
    pub right: Vec2,
    /// Travel of the left and the right trigger, 0 to 1.
    pub triggers: Vec2,
    pub held: PadButtons,
}

/// The target that sticks and shoulder buttons move.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
pub enum PadMode {
    /// The pointer.
    #[serde(rename = "mouse")]
    OnlyMouse,
    #[default]
    #[serde(rename = "tool")]
    UseTool,
    /// The sculpture.
    #[serde(rename = "grid")]
    MoveGrid,
}

impl PadMode {
    /// Returns the next mode when cycling.
    pub fn next(self) -> PadMode {
        match self {
            PadMode::OnlyMouse => PadMode::UseTool,
            PadMode::UseTool => PadMode::MoveGrid,
            PadMode::MoveGrid => PadMode::OnlyMouse,
        }
    }

    /// Returns the text in the status line.
    pub const fn label(self) -> &'static str {
        match self {
            PadMode::OnlyMouse => "Pointer mode",
            PadMode::UseTool => "Tool mode",
            PadMode::MoveGrid => "Sculpture mode",
        }
    }
}
