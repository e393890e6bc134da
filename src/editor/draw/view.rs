//! The view of a drawing: maps pixels to grid points, and to the space in which voxels have their true shape.
//!
//! A value, so that neither the drawing's own changes nor camera movements affect it.

use std::sync::Arc;

use glam::{UVec3, Vec2, Vec3};

use crate::picking::geometry::{lasting, surface_point};
use crate::picking::{Picker, Sight, SurfacePoint};
use crate::sculpture::Grid;
use crate::surface::IndexMap;

/// A view of one grid, as it was at the start of a drag.
#[derive(Clone, Debug)]
pub struct DrawView {
    pub sight: Sight,
    /// The visible voxels, for drags that follow the surface.
    seen: Option<Arc<IndexMap>>,
    /// The dimensions of the grid, in voxels.
    pub dims: UVec3,
    /// Edges of a voxel in units of the smallest.
    pub edges: Vec3,
}

impl DrawView {
    pub fn new(sight: &Sight, grid: &Grid) -> DrawView {
        let voxel_size = grid.voxel_size();
        DrawView {
            sight: *sight,
            seen: None,
            dims: grid.dims(),
            edges: voxel_size / voxel_size.min_element(),
        }
    }

    /// Returns the view with the surface as it is seen now.
    pub fn with_surface(mut self, picker: &Picker, grid: &Grid) -> DrawView {
        self.seen = picker.map().map(|map| lasting(map, grid));
        self
    }

    /// Returns the surface at a pixel, if it was recorded.
    pub fn surface(&self, grid: &Grid, at: Vec2) -> Option<SurfacePoint> {
        surface_point(self.seen.as_ref()?, grid, at)
    }

    /// Returns the eye, in units of the smallest edge of a voxel.
    pub fn eye(&self) -> Vec3 {
        self.sight.rays.origin * self.edges
    }

    /// Returns the direction of the ray through a pixel, in units of the smallest edge: a unit vector, or 0 if there is
    /// none.
    pub fn direction(&self, at: Vec2) -> Vec3 {
        (self.sight.rays.direction_at(at.x, at.y) * self.edges).normalize_or_zero()
    }

    /// Returns the middle of the grid, in voxels.
    pub fn middle(&self) -> Vec3 {
        self.dims.as_vec3() * 0.5
    }

    /// Returns orthogonal unit vectors across, up and towards the viewer at a pixel, in units of the smallest edge.
    pub fn frame(&self, at: Vec2) -> Option<[Vec3; 3]> {
        let ahead = self.direction(at);
        let right = self.direction(at + Vec2::X) - ahead;
        let right = (right - ahead * right.dot(ahead)).try_normalize()?;
        Some([right, right.cross(ahead), -ahead])
    }

    /// Returns a circle around a point (voxels) that faces the viewer, as lines between points.
    pub fn circle(&self, around_vx: Vec3, radius: f32) -> Vec<[Vec3; 2]> {
        let Some(at) = self.sight.pixel_of(around_vx) else { return Vec::new() };
        let Some([right, up, _]) = self.frame(at) else { return Vec::new() };
        circle(around_vx, right * radius / self.edges, up * radius / self.edges)
    }
}

/// Returns a circle as lines, from its centre and two radii.
pub fn circle(centre: Vec3, across: Vec3, up: Vec3) -> Vec<[Vec3; 2]> {
    const SEGMENTS: u32 = 32;
    let at = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / SEGMENTS as f32).sin_cos();
        centre + across * cos + up * sin
    };
    (0..SEGMENTS).map(|i| [at(i), at(i + 1)]).collect()
}

/// Returns the lines that join consecutive points.
pub fn chain(points: &[Vec3]) -> impl Iterator<Item = [Vec3; 2]> {
    points.windows(2).map(|pair| [pair[0], pair[1]])
}

#[cfg(test)]
pub mod tests {
    use glam::{Quat, UVec2};

    use super::*;
    use crate::sculpture::Placement;
    use crate::view::Camera;

    /// Returns the view of a rotated grid in a picture of 200 x 100 pixels.
    pub fn view(rotation: Quat, dims: UVec3, voxel_size: Vec3) -> DrawView {
        let size = dims.as_vec3() * voxel_size;
        let eye = Camera { eye: Vec3::new(0.0, 0.0, 2.0 * size.length()), ..Camera::default() }
            .eye(UVec2::new(200, 100));
        let placement = Placement { rotation, ..Placement::default() };
        let sight = Sight::new(&eye, &placement.world_from_grid(dims, voxel_size));
        DrawView { sight, seen: None, dims, edges: voxel_size / voxel_size.min_element() }
    }

    /// Returns views from many sides, of voxels of several shapes.
    pub fn views() -> Vec<DrawView> {
        [
            (Quat::IDENTITY, Vec3::ONE),
            (Quat::from_rotation_y(2.0), Vec3::ONE),
            (Quat::from_rotation_x(0.5) * Quat::from_rotation_y(0.8), Vec3::ONE),
            (Quat::from_rotation_x(-1.5) * Quat::from_rotation_z(3.0), Vec3::new(1.0, 2.0, 3.0)),
            (Quat::from_rotation_x(0.4) * Quat::from_rotation_y(-2.3), Vec3::new(2.0, 0.5, 1.0)),
        ]
        .into_iter()
        .map(|(turn, voxel_size)| view(turn, UVec3::new(60, 40, 50), voxel_size))
        .collect()
    }

    #[test]
    fn frames_are_right_angled_and_lie_as_the_picture_does() {
        for view in views() {
            let [right, up, near] = view.frame(Vec2::new(120.0, 30.0)).unwrap();
            assert!(right.cross(up).abs_diff_eq(near, 1e-3), "{right} {up} {near}");
            let middle = view.middle();
            let at = view.sight.pixel_of(middle).unwrap();
            let beside = view.sight.pixel_of(middle + right * 3.0 / view.edges).unwrap();
            let above = view.sight.pixel_of(middle + up * 3.0 / view.edges).unwrap();
            assert!(beside.x > at.x + 0.5 && above.y < at.y - 0.5, "{at} {beside} {above}");
        }
    }
}
