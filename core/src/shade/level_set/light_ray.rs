//! Single rays to the smooth surface, and the field at a point, for light tracing.
//!
//! Takes rays and points in grid coordinates; returns points on the surface, signed distances and their gradient. Knows
//! no light.

use glam::{IVec3, UVec3, Vec3};

use super::ray::{CellCache, LevelScene, Naming, SurfaceHit, trilinear};
use super::{LevelSet, in_cells};
use crate::sculpture::Grid;
use crate::shade::NormalField;
use crate::shade::normal_field::PackedDepth;
use crate::surface::raycast;

/// The farthest that the surface may lie outside the voxels' cubes, in voxels: it ends at the centres of the empty
/// voxels beside them.
pub const BEYOND_VOXELS_VX: f32 = 0.5;

impl LevelSet {
    /// Returns the first cell on a ray in which the surface may be; [`LevelSet::hit`] starts from it.
    pub(crate) fn first_cell(&self, origin: Vec3, direction: Vec3) -> Option<UVec3> {
        let origin = in_cells(origin);
        let own = cell_of(origin);
        // A ray that continues from the surface starts in a cell with surface.
        match self.cells.get(own) {
            true => Some(own.as_uvec3()),
            false => raycast::cast(&self.cells, origin, direction).map(|hit| hit.voxel),
        }
    }

    /// Returns the first point on the surface along a ray whose first cell is known. In the mean of many rays, the
    /// reported voxels have the weights of the corners of the cell, so that colours change gradually.
    pub fn hit(
        &self,
        (grid, normals): (&Grid, &NormalField),
        (origin, direction): (Vec3, Vec3),
        first: UVec3,
        cache: &mut CellCache,
    ) -> Option<SurfaceHit> {
        let scene = LevelScene { grid, normals, levels: self };
        scene.hit(naming(origin, direction), in_cells(origin), direction, first, cache)
    }

    /// Returns the signed distance of a point from the surface in voxels, positive outside. Inaccurate more than a
    /// voxel from it.
    pub fn distance_vx(&self, grid: &Grid, point: Vec3, cache: &mut CellCache) -> f32 {
        let point = in_cells(point);
        let cell = cell_of(point);
        let corners = cache.levels(grid, self, cell);
        trilinear(corners, point - cell.as_vec3()) / PackedDepth::PER_VX
    }

    /// Returns the gradient of the distance at a point, of any length.
    pub fn slope(&self, grid: &Grid, point: Vec3, cache: &mut CellCache) -> Vec3 {
        let point = in_cells(point);
        let cell = cell_of(point);
        let (corners, place) = (cache.levels(grid, self, cell), point - cell.as_vec3());
        let along = |axis: usize| {
            let (mut before, mut beyond) = (place, place);
            (before[axis], beyond[axis]) = (0.0, 1.0);
            trilinear(corners, beyond) - trilinear(corners, before)
        };
        Vec3::new(along(0), along(1), along(2))
    }
}

/// Returns a random choice that depends only on the ray.
#[inline(always)]
fn naming(origin: Vec3, direction: Vec3) -> Naming {
    let bits = origin.to_array().into_iter().chain(direction.to_array()).map(f32::to_bits);
    let number = bits.fold(0u32, |number, bits| {
        let mixed = (number ^ bits).wrapping_mul(0x9E37_79B1);
        mixed ^ mixed >> 15
    });
    Naming::ByShare((number >> 8) as f32 / (1 << 24) as f32)
}

/// Returns the cell around a point near the grid, in coordinates of cells. (Baseline processors have no instruction to
/// round down.)
#[inline(always)]
fn cell_of(point: Vec3) -> IVec3 {
    (point + 64.0).as_ivec3() - 64
}
