//! Options of gamepads: mode, response of sticks, speeds and rumble.

use serde::Deserialize;

use super::PadMode;
use super::rumble::RumbleCurve;
use super::stick::Response;
use crate::options::{InvalidOption, require_in};

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GamepadOptions {
    /// The mode at the start.
    pub mode: PadMode,
    pub dead_zone: f32,
    pub curve: f32,
    /// Points a second.
    pub pointer_speed: f32,
    /// Viewport heights a second.
    pub move_speed: f32,
    pub turn_speed_deg: f32,
    pub rumble: bool,
    pub rumble_limit: f32,
    pub rumble_voxels: u32,
    pub rumble_longest_s: f32,
}

impl Default for GamepadOptions {
    fn default() -> Self {
        GamepadOptions {
            mode: PadMode::UseTool,
            dead_zone: 0.15,
            curve: 2.0,
            pointer_speed: 700.0,
            move_speed: 0.5,
            turn_speed_deg: 90.0,
            rumble: true,
            rumble_limit: 0.8,
            rumble_voxels: 4000,
            rumble_longest_s: 4.0,
        }
    }
}

impl GamepadOptions {
    pub fn response(&self) -> Response {
        Response { dead_zone: self.dead_zone, curve: self.curve }
    }

    pub fn rumble_curve(&self) -> RumbleCurve {
        RumbleCurve {
            limit: self.rumble_limit,
            full_voxels: self.rumble_voxels as f32,
            longest_s: self.rumble_longest_s,
        }
    }

    pub fn check(&self) -> Result<(), InvalidOption> {
        require_in(0.0..=0.9, "dead_zone", self.dead_zone, "must be 0 to 0.9")?;
        require_in(0.25..=5.0, "curve", self.curve, "must be 0.25 to 5")?;
        let rule = "must be 1 to 10000 points a second";
        require_in(1.0..=1e4, "pointer_speed", self.pointer_speed, rule)?;
        require_in(0.01..=10.0, "move_speed", self.move_speed, "must be 0.01 to 10")?;
        require_in(1.0..=720.0, "turn_speed_deg", self.turn_speed_deg, "must be 1 to 720")?;
        require_in(0.0..=1.0, "rumble_limit", self.rumble_limit, "must be 0 to 1")?;
        let voxels = self.rumble_voxels;
        require_in(1..=1_000_000_000, "rumble_voxels", voxels, "must be 1 to 1e9")?;
        require_in(0.1..=60.0, "rumble_longest_s", self.rumble_longest_s, "must be 0.1 to 60 s")
    }
}
