//! The settings of a headset.

use std::ops::RangeInclusive;

use glam::{UVec2, Vec2};
use serde::Deserialize;

use crate::gpu::DeviceOptions;
use crate::input::hands::{HandSettings, HandSide};
use crate::input::pad::rumble::RumbleCurve;
use crate::input::pad::stick::Response;
use crate::screen::headset::{Blend, LinkOptions, RoomOrigin};

/// Points across the board's picture.
const BOARD_POINTS: f32 = 1000.0;
/// Height of the board by its width.
const BOARD_SHAPE: f32 = 0.64;

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeadsetSettings {
    /// Connect to a headset when the program starts.
    pub enabled: bool,
    pub hand: HandSide,
    pub blend: Blend,
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

impl Default for HeadsetSettings {
    fn default() -> Self {
        HeadsetSettings {
            enabled: false,
            hand: HandSide::Right,
            blend: Blend::Auto,
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

impl HeadsetSettings {
    pub fn hands(&self) -> HandSettings {
        HandSettings {
            main: self.hand,
            response: Response { dead_zone: self.dead_zone, curve: 2.0 },
            reach_m: self.reach_m,
        }
    }

    pub fn link(&self, device: DeviceOptions) -> LinkOptions {
        LinkOptions {
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

    /// Width and height of the board in metres.
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

    /// Key, value, what it may be, and that in words.
    pub(super) fn ranges(&self) -> [(&'static str, f32, RangeInclusive<f32>, &'static str); 11] {
        let metres = "must be 0.05 to 5 m";
        [
            ("headset.size_m", self.size_m, 0.01..=100.0, "must be 0.01 to 100 m"),
            ("headset.distance_m", self.distance_m, 0.05..=5.0, metres),
            ("headset.drop_m", self.drop_m, -2.0..=2.0, "must be -2 to 2 m"),
            ("headset.reach_m", self.reach_m, 0.0..=1.0, "must be 0 to 1 m"),
            ("headset.dead_zone", self.dead_zone, 0.0..=0.9, "must be 0 to 0.9"),
            ("headset.board_width_m", self.board_width_m, 0.05..=5.0, metres),
            ("headset.board_px", self.board_px as f32, 500.0..=4000.0, "must be 500 to 4000"),
            ("headset.resolution", self.resolution, 0.1..=2.0, "must be 0.1 to 2"),
            ("headset.haptics_limit", self.haptics_limit, 0.0..=1.0, "must be 0 to 1"),
            ("headset.haptics_voxels", self.haptics_voxels as f32, 1.0..=1e9, "must be 1 to 1e9"),
            (
                "headset.haptics_longest_s",
                self.haptics_longest_s,
                0.1..=60.0,
                "must be 0.1 to 60 s",
            ),
        ]
    }
}
