//! Picking: the voxel and the grid point under a pixel of the picture.
//!
//! [`Picker`] is the view of the last picture as a value: the eye relative to the grid, and the index map reported by
//! the renderer. The geometry is in [`geometry`]. Knows no tool, no window and no Vulkan.

pub mod geometry;

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec2, Vec3};

use crate::sculpture::Grid;
use crate::shade::normal;
use crate::surface::IndexMap;
pub use geometry::{ScreenAxes, Sight, SurfacePoint};

/// The view of one grid from one eye.
#[derive(Clone)]
pub struct Picker {
    sight: Sight,
    map: Option<Arc<IndexMap>>,
    origin: IVec3,
}

impl Picker {
    /// Creates a picker. `map`: the voxels of the last picture; `None` before there is one.
    /// `origin`: of the grid's coordinates, in signed ones.
    pub fn new(sight: Sight, map: Option<Arc<IndexMap>>, origin: IVec3) -> Picker {
        Picker { sight, map, origin }
    }

    /// Returns the view of the grid in the next picture.
    pub fn sight(&self) -> &Sight {
        &self.sight
    }

    /// Returns the signed coordinates of the grid's lowest corner when it was made. Later, tools may have moved it.
    pub fn origin(&self) -> IVec3 {
        self.origin
    }

    /// Returns the voxels of the last picture.
    pub fn map(&self) -> Option<&Arc<IndexMap>> {
        self.map.as_ref()
    }

    /// Returns the grid point under a pixel: on the visible surface, or, while the grid is empty, in the view plane
    /// through `last`, clamped to the grid.
    pub fn target(&self, grid: &Grid, at: Vec2, last: Vec3) -> Option<Vec3> {
        if grid.opaque_count() == 0 {
            return geometry::box_point(&self.sight, grid.dims(), at, last);
        }
        Some(geometry::surface_point(self.map.as_ref()?, grid, at)?.point)
    }

    /// Returns the voxel under a pixel.
    pub fn voxel(&self, grid: &Grid, at: Vec2) -> Option<UVec3> {
        geometry::voxel_at(self.map.as_ref()?, grid, at)
    }

    /// Returns the direction out of the surface under a pixel: the normal of the voxel's face, or with `smooth` of the
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
