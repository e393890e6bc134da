//! Picking: which voxel and which point of the grid lie under a pixel of the picture.
//!
//! [`Picker`] is the view of the last picture as a value: where the eye is relative to the grid,
//! and the index map that the renderer reported. The geometry is in [`geometry`]. Knows no tool, no
//! window and no Vulkan.

pub mod geometry;

use std::sync::Arc;

use glam::{UVec3, Vec2, Vec3};

use crate::sculpture::Grid;
use crate::shade::normal;
use crate::surface::IndexMap;
pub use geometry::{ScreenAxes, Sight, SurfacePoint};

/// The view of one grid from one eye.
#[derive(Clone)]
pub struct Picker {
    sight: Sight,
    map: Option<Arc<IndexMap>>,
}

impl Picker {
    /// `map`: the voxels of the last picture; none before there is one.
    pub fn new(sight: Sight, map: Option<Arc<IndexMap>>) -> Picker {
        Picker { sight, map }
    }

    /// Returns the view of the grid that the next picture will have.
    pub fn sight(&self) -> &Sight {
        &self.sight
    }

    /// Returns the voxels of the last picture.
    pub fn map(&self) -> Option<&Arc<IndexMap>> {
        self.map.as_ref()
    }

    /// Returns the point of the grid under a pixel: on the surface that was seen, or, while the grid is empty, in the
    /// plane of the view through `last`, as far as that lies in the grid.
    pub fn target(&self, grid: &Grid, at: Vec2, last: Vec3) -> Option<Vec3> {
        if grid.opaque_count() == 0 {
            return geometry::box_point(&self.sight, grid.dims(), at, last);
        }
        Some(geometry::surface_point(self.map.as_ref()?, grid, at)?.point)
    }

    /// Returns the voxel under a pixel.
    pub fn voxel(&self, grid: &Grid, at: Vec2) -> Option<UVec3> {
        Some(grid.voxel_coords(geometry::voxel_at(self.map.as_ref()?, grid, at)?))
    }

    /// Returns the direction out of the surface under a pixel: of the face of the voxel, or with `smooth` of the
    /// surface around it. Zero beside the surface.
    pub fn normal(&self, grid: &Grid, at: Vec2, smooth: bool) -> Vec3 {
        let Some(map) = &self.map else { return Vec3::ZERO };
        let voxel = self.voxel(grid, at).filter(|_| smooth);
        voxel
            .and_then(|voxel| normal::gradient(grid, voxel).try_normalize())
            .or_else(|| geometry::surface_point(map, grid, at).map(|seen| seen.face))
            .unwrap_or(Vec3::ZERO)
    }
}
