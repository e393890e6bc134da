//! Owns surface normals: the gradient of existence in the neighbourhood of a voxel.
//!
//! Takes a grid and a voxel, gives a vector that points out of the solid, in grid coordinates.

use glam::{IVec3, UVec3, Vec3};

use crate::sculpture::Grid;

/// Minus the gradient of existence about a voxel, not normalised: it points towards emptiness.
/// Zero where the neighbourhood is full, empty or symmetric.
pub fn gradient(grid: &Grid, voxel: UVec3) -> Vec3 {
    let centre = voxel.as_ivec3();
    let mut sum = IVec3::ZERO;
    for z in -2..=2 {
        for y in -2..=2 {
            for x in -2..=2 {
                let offset = IVec3::new(x, y, z);
                if grid.get(centre + offset) {
                    sum -= offset;
                }
            }
        }
    }
    sum.as_vec3()
}
