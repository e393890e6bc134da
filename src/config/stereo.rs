//! The settings of stereo pictures on a screen.

use std::ops::RangeInclusive;

use serde::Deserialize;

use crate::view::{StereoLayout, StereoRig};

/// Distances between the eyes that can be chosen, in millimetres.
pub const EYE_DISTANCE_MM: RangeInclusive<f32> = 0.0..=150.0;
/// Distances of convergence that can be chosen, in percent of that of the sculpture's centre.
pub const CONVERGENCE_PERCENT: RangeInclusive<f32> = 20.0..=400.0;

#[derive(Clone, Copy, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StereoSettings {
    pub layout: StereoLayout,
    pub eye_distance_mm: f32,
    /// From the person to the screen.
    pub viewing_distance_mm: f32,
    pub convergence_percent: f32,
    pub swap_eyes: bool,
}

impl Default for StereoSettings {
    fn default() -> Self {
        StereoSettings {
            layout: StereoLayout::Mono,
            eye_distance_mm: 63.0,
            viewing_distance_mm: 700.0,
            convergence_percent: 100.0,
            swap_eyes: false,
        }
    }
}

impl StereoSettings {
    /// The eyes before a sculpture whose centre is `distance` away, in world units.
    pub fn rig(&self, distance: f32) -> StereoRig {
        let convergence = distance * self.convergence_percent / 100.0;
        StereoRig {
            // As if the plane that is seen in the screen's were as far away as the screen.
            eye_distance: convergence * self.eye_distance_mm / self.viewing_distance_mm,
            convergence,
            swap: self.swap_eyes,
        }
    }

    /// Key, value, what it may be, and that in words.
    pub(super) fn ranges(&self) -> [(&'static str, f32, RangeInclusive<f32>, &'static str); 3] {
        let distance = "must be 100 to 20000 mm";
        [
            ("stereo.eye_distance_mm", self.eye_distance_mm, EYE_DISTANCE_MM, "must be 0 to 150"),
            ("stereo.viewing_distance_mm", self.viewing_distance_mm, 100.0..=2e4, distance),
            (
                "stereo.convergence_percent",
                self.convergence_percent,
                CONVERGENCE_PERCENT,
                "must be 20 to 400",
            ),
        ]
    }
}
