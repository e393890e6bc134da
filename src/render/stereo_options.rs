//! Options of stereo pictures on a screen: the layout, and the geometry of the two eyes.

use std::ops::RangeInclusive;

use serde::Deserialize;

use crate::options::{InvalidOption, require_in};
use crate::view::{StereoLayout, StereoRig};

/// Valid distances between the eyes, in millimetres.
pub const EYE_DISTANCE_MM: RangeInclusive<f32> = 0.0..=150.0;
/// Valid convergence distances, in percent of the distance of the sculpture's centre.
pub const CONVERGENCE_PERCENT: RangeInclusive<f32> = 20.0..=400.0;

#[derive(Clone, Copy, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StereoOptions {
    pub layout: StereoLayout,
    pub eye_distance_mm: f32,
    /// Distance between the eyes and the screen.
    pub viewing_distance_mm: f32,
    pub convergence_percent: f32,
    pub swap_eyes: bool,
}

impl Default for StereoOptions {
    fn default() -> Self {
        StereoOptions {
            layout: StereoLayout::Mono,
            eye_distance_mm: 63.0,
            viewing_distance_mm: 700.0,
            convergence_percent: 100.0,
            swap_eyes: false,
        }
    }
}

impl StereoOptions {
    /// Returns the eyes for a sculpture whose centre is `distance` away, in world units.
    pub fn rig(&self, distance: f32) -> StereoRig {
        let convergence = distance * self.convergence_percent / 100.0;
        StereoRig {
            // The convergence plane stands for the screen, so distances scale with it.
            eye_distance: convergence * self.eye_distance_mm / self.viewing_distance_mm,
            convergence,
            swap: self.swap_eyes,
        }
    }

    pub fn check(&self) -> Result<(), InvalidOption> {
        let (eyes, viewing) = (self.eye_distance_mm, self.viewing_distance_mm);
        require_in(EYE_DISTANCE_MM, "eye_distance_mm", eyes, "must be 0 to 150")?;
        require_in(100.0..=2e4, "viewing_distance_mm", viewing, "must be 100 to 20000 mm")?;
        let (key, rule) = ("convergence_percent", "must be 20 to 400");
        require_in(CONVERGENCE_PERCENT, key, self.convergence_percent, rule)
    }
}
