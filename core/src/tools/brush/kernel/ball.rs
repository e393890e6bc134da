//! The ball in which a brush works, placed in a grid.
//!
//! Gives the position of a voxel in it, the brush's share there, and a box of the voxels. Knows neither brushes nor
//! clay.

use glam::{DVec3, IVec3, Vec3};

use crate::sculpture::Grid;
use crate::sculpture::region::VoxelBox;
use crate::tools::brush::falloff::Falloff;

/// The ball of a brush or a mirror image of it, relative to the mirror planes: mirrored positions differ in signs only
/// and are rounded alike.
pub(super) struct BallImage {
    pub origin: DVec3,
    pub centre: DVec3,
    /// Voxel edges in units of the smallest.
    pub edges: DVec3,
    pub radius: f32,
    pub falloff: Falloff,
    pub normal: Vec3,
}

impl BallImage {
    /// Returns the offset of a voxel's centre from the ball's centre, in units of the smallest edge.
    #[inline(always)]
    pub fn relative(&self, v: IVec3) -> Vec3 {
        ((v.as_dvec3() + 0.5 - self.origin - self.centre) * self.edges).as_vec3()
    }

    /// Returns the brush's share of the displacement at a point relative to the centre.
    #[inline(always)]
    pub fn share(&self, p: Vec3) -> f32 {
        let p = p / self.radius;
        self.falloff.at(p.x * p.x + p.y * p.y + p.z * p.z)
    }

    /// Returns a box of the voxels of `grid` in it.
    pub fn bounds(&self, grid: &Grid) -> VoxelBox {
        let half = DVec3::splat(f64::from(self.radius)) / self.edges;
        let middle = self.centre + self.origin;
        let reached = VoxelBox {
            min: (middle - half).floor().as_ivec3(),
            max: (middle + half).ceil().as_ivec3(),
        };
        reached.intersect(VoxelBox::of_grid(grid))
    }

    /// Returns the height of a point over the plane through the centre.
    #[inline(always)]
    pub fn height(&self, p: Vec3) -> f32 {
        p.x * self.normal.x + p.y * self.normal.y + p.z * self.normal.z
    }
}
