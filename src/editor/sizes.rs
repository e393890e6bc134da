//! The unit of the sizes of all brushes: pixels of the screen, so that a brush keeps its size in the picture at any
//! distance, or the sculpture's own voxels, so that it keeps its size there.
//!
//! The size of a pixel depends on where the brush works, and comes from the view of the last picture.

use std::ops::RangeInclusive;

use glam::{Vec2, Vec3};

use crate::picking::Picker;
use crate::sculpture::Grid;
use crate::tools::brush::footprint::MAX_FOOTPRINT;
use crate::tools::brush::kernel::grab::{MAX_RADIUS, MIN_RADIUS};

/// The unit of the sizes of brushes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum SizeUnit {
    /// Pixels of the picture; in a headset, virtual pixels at arm's length.
    #[default]
    Screen,
    /// The smallest edge of a voxel.
    Sculpture,
}

impl SizeUnit {
    pub const ALL: [SizeUnit; 2] = [SizeUnit::Screen, SizeUnit::Sculpture];

    /// Returns its name in the remembered state.
    pub const fn name(self) -> &'static str {
        match self {
            SizeUnit::Screen => "screen",
            SizeUnit::Sculpture => "sculpture",
        }
    }

    /// Returns the suffix of a size.
    pub const fn suffix(self) -> &'static str {
        match self {
            SizeUnit::Screen => " px",
            SizeUnit::Sculpture => " vx",
        }
    }

    /// Returns the valid radii of a brush.
    pub const fn radii(self) -> RangeInclusive<f32> {
        match self {
            SizeUnit::Screen => 1.0..=MAX_FOOTPRINT,
            SizeUnit::Sculpture => MIN_RADIUS..=MAX_RADIUS,
        }
    }
}

/// Assumed size of a pixel before a picture, in units of the smallest edge.
pub(super) const FIRST_GAUGE: f32 = 0.25;

/// Returns the size of a pixel at a point, in units of the smallest edge.
pub(super) fn gauge_at(grid: &Grid, point: Vec3, picker: &Picker) -> f32 {
    let (sight, size) = (picker.sight(), grid.voxel_size());
    let depth = sight.depth(point);
    let across = sight.at_depth(Vec2::X, depth) - sight.at_depth(Vec2::ZERO, depth);
    (across * size / size.min_element()).length()
}
