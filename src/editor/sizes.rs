//! The unit in which the sizes of all brushes are given, chosen once: pixels of the screen, so that a brush stays as large in
//! the picture however near the sculpture is, or the sculpture's own voxels, so that it stays as large there.
//!
//! How large a pixel is depends on where the brush works, which is asked of the view of the last picture.

use std::ops::RangeInclusive;

use glam::{Vec2, Vec3};

use crate::picking::Picker;
use crate::sculpture::Grid;
use crate::tools::brush::footprint::MAX_FOOTPRINT;
use crate::tools::brush::kernel::grab::{MAX_RADIUS, MIN_RADIUS};

/// The unit of the sizes of brushes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum SizeUnit {
    /// Pixels of the picture; in a headset what a pixel is an arm's length away.
    #[default]
    Screen,
    /// The smallest edge of a voxel.
    Sculpture,
}

impl SizeUnit {
    pub const ALL: [SizeUnit; 2] = [SizeUnit::Screen, SizeUnit::Sculpture];

    /// Returns its name in what is remembered.
    pub const fn name(self) -> &'static str {
        match self {
            SizeUnit::Screen => "screen",
            SizeUnit::Sculpture => "sculpture",
        }
    }

    /// Returns the sign that stands behind a size.
    pub const fn suffix(self) -> &'static str {
        match self {
            SizeUnit::Screen => " px",
            SizeUnit::Sculpture => " vx",
        }
    }

    /// Returns the radii that a brush may have.
    pub const fn radii(self) -> RangeInclusive<f32> {
        match self {
            SizeUnit::Screen => 1.0..=MAX_FOOTPRINT,
            SizeUnit::Sculpture => MIN_RADIUS..=MAX_RADIUS,
        }
    }
}

/// How large a pixel is before anything tells, in units of the smallest edge.
pub(super) const FIRST_GAUGE: f32 = 0.25;

/// Returns how large a pixel is at a place, in units of the smallest edge.
pub(super) fn gauge_at(grid: &Grid, point: Vec3, picker: &Picker) -> f32 {
    let (sight, size) = (picker.sight(), grid.voxel_size());
    let depth = sight.depth(point);
    let across = sight.at_depth(Vec2::X, depth) - sight.at_depth(Vec2::ZERO, depth);
    (across * size / size.min_element()).length()
}
