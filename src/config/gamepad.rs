//! The settings of gamepads.

use std::ops::RangeInclusive;

use serde::Deserialize;

use crate::input::pad::PadMode;
use crate::input::pad::rumble::RumbleCurve;
use crate::input::pad::stick::Response;

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GamepadSettings {
    /// In which it begins.
    pub mode: PadMode,
    pub dead_zone: f32,
    pub curve: f32,
    /// Points a second.
    pub pointer_speed: f32,
    /// Heights of the picture a second.
    pub move_speed: f32,
    pub turn_speed_deg: f32,
    pub rumble: bool,
    pub rumble_limit: f32,
    pub rumble_voxels: u32,
    pub rumble_longest_s: f32,
}

impl Default for GamepadSettings {
    fn default() -> Self {
        GamepadSettings {
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

impl GamepadSettings {
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

    /// Key, value, what it may be, and that in words.
    pub(super) fn ranges(&self) -> [(&'static str, f32, RangeInclusive<f32>, &'static str); 8] {
        let speed = "must be 1 to 10000 points a second";
        [
            ("gamepad.dead_zone", self.dead_zone, 0.0..=0.9, "must be 0 to 0.9"),
            ("gamepad.curve", self.curve, 0.25..=5.0, "must be 0.25 to 5"),
            ("gamepad.pointer_speed", self.pointer_speed, 1.0..=1e4, speed),
            ("gamepad.move_speed", self.move_speed, 0.01..=10.0, "must be 0.01 to 10"),
            ("gamepad.turn_speed_deg", self.turn_speed_deg, 1.0..=720.0, "must be 1 to 720"),
            ("gamepad.rumble_limit", self.rumble_limit, 0.0..=1.0, "must be 0 to 1"),
            ("gamepad.rumble_voxels", self.rumble_voxels as f32, 1.0..=1e9, "must be 1 to 1e9"),
            ("gamepad.rumble_longest_s", self.rumble_longest_s, 0.1..=60.0, "must be 0.1 to 60 s"),
        ]
    }
}
