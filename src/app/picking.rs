//! What the pointer points at: the point of the grid below a pixel of the picture and the way out of
//! the surface there, from the voxels of the last picture.
//!
//! The geometry is `aim`'s; which picture was seen last and which tool is in hand are the workspace's.

use glam::{Vec2, Vec3};

use super::aim::{self, Sight};
use super::workspace::Workspace;
use crate::shade::normal;

impl Workspace {
    /// The view of the grid that the next picture will have.
    pub(super) fn sight(&self) -> Sight {
        Sight::new(&self.eye(), &self.world_from_grid())
    }

    /// The point of the grid that the pointer points at: on the surface that was seen, or
    /// anywhere in the grid while it is empty.
    pub(super) fn target(&self, at: Vec2) -> Option<Vec3> {
        let grid = self.session.document().grid();
        if grid.opaque_count() == 0 {
            return aim::box_point(&self.sight().rays, grid.dims(), at);
        }
        Some(aim::surface_point(self.seen.as_ref()?, grid, at)?.point)
    }

    /// The way out of the surface that the pointer points at: of the face of the voxel, or of the
    /// surface around it if the tool leans.
    pub(super) fn normal(&self, at: Vec2) -> Vec3 {
        let grid = self.session.document().grid();
        let Some(map) = &self.seen else { return Vec3::ZERO };
        let voxel = aim::voxel_at(map, grid, at).map(|index| grid.voxel_coords(index));
        let smooth = voxel.filter(|_| self.ui.hand.lean).map(|v| normal::gradient(grid, v));
        smooth
            .and_then(|normal| normal.try_normalize())
            .or_else(|| aim::surface_point(map, grid, at).map(|seen| seen.face))
            .unwrap_or(Vec3::ZERO)
    }
}
