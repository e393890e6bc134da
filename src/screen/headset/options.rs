//! Options of the headset: controllers, placement of the sculpture, board, resolution, haptics.

use glam::{UVec2, Vec2};
use serde::Deserialize;

use super::{BlendMode, RoomOrigin, XrSessionOptions};
use crate::gpu::DeviceOptions;
use crate::input::hands::{HandSettings, HandSide};
use crate::input::pad::rumble::RumbleCurve;
use crate::input::pad::stick::Response;
use crate::options::{InvalidOption, require_in};

/// Width of the board's interface in egui points.
const BOARD_POINTS: f32 = 1000.0;
/// Height of the board as a share of its width.
const BOARD_SHAPE: f32 = 0.64;

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeadsetOptions {
    /// Connect to a headset when the program starts.
    pub enabled: bool,
    pub hand: HandSide,
    pub blend: BlendMode,
    pub origin: RoomOrigin,
    pub size_m: f32,
    pub distance_m: f32,
    pub drop_m: f32,
    pub reach_m: f32,
    pub dead_zone: f32,
    pub board_width_m: f32,
    pub board_px: u32,
    pub resolution: f32,
    pub haptics: bool,
    pub haptics_limit: f32,
    pub haptics_voxels: u32,
    pub haptics_longest_s: f32,
}

impl Default for HeadsetOptions {
    fn default() -> Self {
        HeadsetOptions {
            enabled: false,
            hand: HandSide::Right,
            blend: BlendMode::Auto,
            origin: RoomOrigin::Stage,
            size_m: 0.5,
            distance_m: 0.7,
            drop_m: 0.3,
            reach_m: 0.08,
            dead_zone: 0.2,
            board_width_m: 0.5,
            board_px: 1250,
            resolution: 1.0,
            haptics: true,
            haptics_limit: 0.8,
            haptics_voxels: 4000,
            haptics_longest_s: 4.0,
        }
    }
}

impl HeadsetOptions {
    pub fn hands(&self) -> HandSettings {
        HandSettings {
            main: self.hand,
            response: Response { dead_zone: self.dead_zone, curve: 2.0 },
            reach_m: self.reach_m,
        }
    }

    pub fn session(&self, device: DeviceOptions) -> XrSessionOptions {
        XrSessionOptions {
            blend: self.blend,
            origin: self.origin,
            resolution: self.resolution,
            board_px: self.board_size_px(),
            device,
        }
    }

    pub fn board_size_px(&self) -> UVec2 {
        (Vec2::new(1.0, BOARD_SHAPE) * self.board_px as f32).round().as_uvec2()
    }

    /// Returns the width and height of the board in metres.
    pub fn board_size_m(&self) -> Vec2 {
        Vec2::new(1.0, BOARD_SHAPE) * self.board_width_m
    }

    pub fn board_pixels_per_point(&self) -> f32 {
        self.board_px as f32 / BOARD_POINTS
    }

    pub fn haptics_curve(&self) -> RumbleCurve {
        RumbleCurve {
            limit: self.haptics_limit,
            full_voxels: self.haptics_voxels as f32,
            longest_s: self.haptics_longest_s,
        }
    }

    pub fn check(&self) -> Result<(), InvalidOption> {
        let metres = "must be 0.05 to 5 m";
        require_in(0.01..=100.0, "size_m", self.size_m, "must be 0.01 to 100 m")?;
        require_in(0.05..=5.0, "distance_m", self.distance_m, metres)?;
        require_in(-2.0..=2.0, "drop_m", self.drop_m, "must be -2 to 2 m")?;
        require_in(0.0..=1.0, "reach_m", self.reach_m, "must be 0 to 1 m")?;
        require_in(0.0..=0.9, "dead_zone", self.dead_zone, "must be 0 to 0.9")?;
        require_in(0.05..=5.0, "board_width_m", self.board_width_m, metres)?;
        require_in(500..=4000, "board_px", self.board_px, "must be 500 to 4000")?;
        require_in(0.1..=2.0, "resolution", self.resolution, "must be 0.1 to 2")?;
        require_in(0.0..=1.0, "haptics_limit", self.haptics_limit, "must be 0 to 1")?;
        let voxels = self.haptics_voxels;
        require_in(1..=1_000_000_000, "haptics_voxels", voxels, "must be 1 to 1e9")?;
        require_in(0.1..=60.0, "haptics_longest_s", self.haptics_longest_s, "must be 0.1 to 60 s")
    }
}
