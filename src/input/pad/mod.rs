//! Gamepads: what sticks and buttons stand for ([`mapper`]), how the way of a stick becomes speed
//! ([`stick`]), how strongly the pad shakes ([`rumble`]), and the devices themselves ([`device`]).
//!
//! All but `device` are values in, values out: they know no device, no clock and no window.

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

/// Tells pads apart while the program runs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct PadId(pub usize);

/// Where sticks and buttons of a pad are.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct PadState {
    /// Right and up are positive, -1 to 1 each.
    pub left: Vec2,
    pub right: Vec2,
    /// The way of the left and the right trigger, 0 to 1.
    pub triggers: Vec2,
    pub held: PadButtons,
}

/// What sticks and shoulder buttons move.
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
    /// The mode that follows when a person switches.
    pub fn next(self) -> PadMode {
        match self {
            PadMode::OnlyMouse => PadMode::UseTool,
            PadMode::UseTool => PadMode::MoveGrid,
            PadMode::MoveGrid => PadMode::OnlyMouse,
        }
    }

    /// As the status line shows it.
    pub const fn label(self) -> &'static str {
        match self {
            PadMode::OnlyMouse => "Pointer mode",
            PadMode::UseTool => "Tool mode",
            PadMode::MoveGrid => "Sculpture mode",
        }
    }
}
