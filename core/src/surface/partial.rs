//! The pixels that an edit may change while nothing moves: the projections of the changed bricks.
//!
//! Takes changed bricks and the rays of a picture, returns a few rectangles that cover all affected pixels. A pixel's
//! voxel changes only if its ray crosses a changed brick. Its shade also depends on the voxels around the visible one,
//! and so on bricks within some voxels of it. Works by whole bricks, not voxels.

use glam::{UVec3, Vec3};

use super::index_map::PixelRect;
use super::pixel_rects::PixelRects;
use super::raycast::Projection;
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::view::PixelRays;

/// With more runs of bricks than this, one box around all of them is projected instead.
const MAX_RUNS: usize = 4096;

/// Pixels by which rectangles are wider than exact rays need: samplers on the GPU round differently.
const MARGIN_PX: u32 = 1;

/// Returns the pixels of `rays` whose voxel, or a voxel within `reach_vx` of it on every axis, may lie in one of the
/// `changed` bricks (linear indices, ascending).
///
/// With a reach of 0 these are the pixels to resample; with the reach of the normals or of a wider filter, those to
/// reshade.
pub fn changed_pixels(grid: &Grid, changed: &[u32], rays: &PixelRays, reach_vx: u32) -> PixelRects {
    let mut rects = PixelRects::NONE;
    let picture = PixelRect::of_picture(rays.size);
    let Some(projection) = Projection::new(rays) else {
        if !changed.is_empty() {
            rects.add(picture);
        }
        return rects;
    };
    let pixels_of = |low: UVec3, high: UVec3| {
        let reach = Vec3::splat(reach_vx as f32);
        let low = (low * BRICK_EDGE_VX).as_vec3() - reach;
        let high = (high * BRICK_EDGE_VX).as_vec3() + reach;
        projection.pixels_of_box(low, high, rays.size).grown(MARGIN_PX).intersect(picture)
    };
    let width = grid.brick_dims().x;
    let in_row = |a: &u32, b: &u32| *b == a + 1 && !b.is_multiple_of(width);
    if changed.chunk_by(in_row).nth(MAX_RUNS).is_some() {
        let (low, high) = changed.iter().fold((UVec3::MAX, UVec3::ZERO), |(low, high), &index| {
            let b = grid.brick_coords(index as usize);
            (low.min(b), high.max(b + 1))
        });
        rects.add(pixels_of(low, high));
        return rects;
    }
    for run in changed.chunk_by(in_row) {
        let first = grid.brick_coords(run[0] as usize);
        rects.add(pixels_of(first, first + UVec3::new(run.len() as u32, 1, 1)));
    }
    rects.without_overlap()
}

/// Returns the pixels of `rays` in which any part of `grid` may be visible.
pub fn pixels_of_grid(grid: &Grid, rays: &PixelRays) -> PixelRect {
    let picture = PixelRect::of_picture(rays.size);
    let Some((low, high)) = grid.bounds_vx() else { return PixelRect::EMPTY };
    let Some(projection) = Projection::new(rays) else { return picture };
    let rect = projection.pixels_of_box(low.as_vec3(), high.as_vec3(), rays.size);
    rect.grown(MARGIN_PX).intersect(picture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use crate::sculpture::Placement;
    use crate::view::Camera;
    use glam::UVec2;

    #[test]
    fn a_small_edit_and_its_mirror_image_are_two_small_rectangles() {
        let grid = scenes::solid_cube(512).unwrap();
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), Vec3::ONE);
        let camera = Camera { eye: Vec3::Z * 900.0, ..Camera::default() };
        let rays = camera.eye(UVec2::new(640, 480)).pixel_rays(&world_from_grid);
        let brick = |x: u32| grid.brick_index(UVec3::new(x, 20, 63)) as u32;
        let rects = changed_pixels(&grid, &[brick(5), brick(6), brick(57), brick(58)], &rays, 2);
        assert_eq!(rects.as_slice().len(), 2);
        assert!(rects.pixel_count() < 2 * 32 * 20, "{rects:?}");
        assert!(changed_pixels(&grid, &[], &rays, 2).is_empty());
        let all: Vec<u32> = (0..grid.brick_count() as u32).collect();
        let whole = changed_pixels(&grid, &all, &rays, 2);
        assert!(whole.as_slice().len() == 1 && whole.pixel_count() > 200 * 200);
    }
}
