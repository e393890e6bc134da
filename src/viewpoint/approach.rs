//! The distance of the camera from the surface that it would reach, and its exit from inside the sculpture.
//!
//! Takes an eye and the grid; gives distances along the view direction, in world units.

use glam::{Affine3A, Vec2};

use crate::sculpture::Grid;
use crate::surface::raycast;
use crate::view::Eye;

/// Returns the distance of the surface at the pixel `at` from the eye plane; `None` without a surface, 0 inside the
/// sculpture.
pub fn surface_depth(grid: &Grid, eye: &Eye, world_from_grid: &Affine3A, at: Vec2) -> Option<f32> {
    let rays = eye.pixel_rays(world_from_grid);
    let direction = rays.direction_at(at.x, at.y);
    let hit = raycast::cast(grid, rays.origin, direction)?;
    let point = eye.eye_from_world * *world_from_grid;
    Some((-point.transform_point3(rays.origin + direction * hit.t).z).max(0.0))
}

/// Returns whether the eye is inside the sculpture, where nothing is visible.
pub fn is_inside(grid: &Grid, eye: &Eye, world_from_grid: &Affine3A) -> bool {
    let origin = eye.pixel_rays(world_from_grid).origin;
    origin.is_finite() && grid.get(origin.floor().as_ivec3())
}

/// Returns how far an eye inside the sculpture must move straight back to leave a distance of `gap` to the last voxel;
/// `None` if it is not inside.
pub fn exit_distance(grid: &Grid, eye: &Eye, world_from_grid: &Affine3A, gap: f32) -> Option<f32> {
    if !is_inside(grid, eye, world_from_grid) {
        return None;
    }
    let rays = eye.pixel_rays(world_from_grid);
    let ahead = rays.direction_at(0.5 * rays.size.x as f32, 0.5 * rays.size.y as f32);
    let world_per_length = {
        let eye_from_grid = eye.eye_from_world * *world_from_grid;
        -eye_from_grid.transform_vector3(ahead).z
    };
    // Half a voxel per step, so that no voxel is skipped.
    let step = 0.5 / ahead.abs().max_element().max(f32::MIN_POSITIVE);
    let most = 4 * grid.dims().max_element();
    let needed = (gap / (step * world_per_length)).ceil().max(1.0) as u32;
    let (mut free, mut steps) = (0, 0);
    while free < needed && steps < most + needed {
        steps += 1;
        let at = rays.origin - ahead * (steps as f32 * step);
        free = if grid.get(at.floor().as_ivec3()) { 0 } else { free + 1 };
    }
    Some(steps as f32 * step * world_per_length)
}
