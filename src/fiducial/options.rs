//! Options of AR: the printed marker under the sculpture, its size, and the scale of the sculpture.

use serde::Deserialize;

use super::family;
use crate::options::{InvalidOption, require_in};

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArOptions {
    /// Whether the sculpture stands on the marker from the start.
    pub on: bool,
    /// The number of the printed marker.
    pub marker: u32,
    /// Width of the marker's black square.
    pub marker_mm: f64,
    pub voxel_mm: f32,
    /// Horizontal field of view of a camera whose lens is unknown.
    pub camera_fov_deg: f64,
}

impl Default for ArOptions {
    fn default() -> Self {
        ArOptions { on: false, marker: 0, marker_mm: 80.0, voxel_mm: 0.4, camera_fov_deg: 45.0 }
    }
}

impl ArOptions {
    pub fn check(&self) -> Result<(), InvalidOption> {
        require_in(0..=family::COUNT - 1, "marker", self.marker, "must be 0 to 29")?;
        require_in(5.0..=5000.0, "marker_mm", self.marker_mm, "must be 5 to 5000 mm")?;
        require_in(0.001..=1000.0, "voxel_mm", self.voxel_mm, "must be 0.001 to 1000 mm")?;
        let rule = "must be 5 to 150 degrees";
        require_in(5.0..=150.0, "camera_fov_deg", self.camera_fov_deg, rule)
    }
}
