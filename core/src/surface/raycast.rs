//! The ray caster: the first existing voxel along a ray, and the index map of a view.
//!
//! Takes a grid and rays in grid coordinates. `ray` defines exactness: a ray visits voxels in the order of its
//! crossings of voxel boundaries, and the caster returns the first existing one, the same as a voxel-by-voxel traversal
//! from the eye.
//!
//! There are two implementations. `walk` traces one ray and skips empty space: blocks of 4^3 bricks, bricks, words of
//! 4^3 voxels. `sweep` samples a tile of a picture with the loops exchanged: it visits the cubes of the grid front to
//! back, each once for all pixels of the tile that may see it, and traces sixteen rays at once through a brick
//! ([`packet`]). At usual distances a brick covers some thirty pixels, so that nearly all decisions are shared.
//!
//! Pictures are exact where a pixel is smaller than a brick. Bricks smaller than a pixel are hit as a whole
//! ([`SmallBricks`]).
//!
//! Knows no colours, no light and no cameras beyond the rays of their pixels.

pub mod packet;
mod projection;
pub(super) mod ray;
mod sweep;
pub(super) mod walk;

use fearless_simd::Level;
use glam::{IVec3, UVec3, Vec3};

pub(super) use self::projection::Projection;
use self::ray::Ray;
use self::sweep::Sweep;
use self::walk::Walk;
use super::index_map::{IndexMap, PixelRect};
use super::numbering::VoxelNamer;
use super::small_bricks::SmallBricks;
use super::tiles::for_each_tile;
use crate::sculpture::vectors::vectorised;
use crate::sculpture::{Grid, NO_VOXEL};
use crate::view::PixelRays;

/// The first voxel on a ray.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hit {
    /// The voxel.
    pub voxel: UVec3,
    /// Outward normal of the face by which the ray entered the voxel; zero if it started inside.
    pub face: IVec3,
    /// The position at which the ray entered the voxel, in lengths of the direction; 0 if it started inside.
    pub t: f32,
}

/// Returns the first existing voxel along `origin + t * direction`, `t >= 0`, in grid coordinates. The voxel around the
/// origin is hit at `t = 0`. `None` if there is no voxel, a number is not finite, or the direction is zero.
pub fn cast(grid: &Grid, origin: Vec3, direction: Vec3) -> Option<Hit> {
    cast_among(grid, &SmallBricks::NONE, origin, direction)
}

/// Returns what [`sample`] shows in pixel (x, y) of a picture. In a brick that is hit as a whole, face and time are those
/// at which the ray enters the brick.
pub fn cast_pixel(grid: &Grid, rays: &PixelRays, x: u32, y: u32) -> Option<Hit> {
    cast_among(grid, &SmallBricks::new(rays), rays.origin, rays.direction(x, y))
}

fn cast_among(grid: &Grid, small: &SmallBricks, origin: Vec3, direction: Vec3) -> Option<Hit> {
    let ray = Ray::new(origin, direction)?;
    let (voxel, event) = Walk::enter(grid, ray)?.first_voxel(small)?;
    let mut face = IVec3::ZERO;
    if event.axis < 3 {
        face[event.axis] = -ray.step[event.axis];
    }
    Some(Hit { voxel, face, t: event.t })
}

/// Fills `map` with the voxels seen along `rays`. Keeps the map's memory.
pub fn sample(grid: &Grid, rays: &PixelRays, map: &mut IndexMap) {
    map.reset(grid.dims(), *rays);
    sample_rect(grid, map, PixelRect::of_picture(rays.size));
}

/// Resamples the pixels of `rect` (cut to the picture) with the rays that `map` was made with.
pub fn sample_rect(grid: &Grid, map: &mut IndexMap, rect: PixelRect) {
    sample_rect_at(Level::new(), grid, SmallBricks::new(&map.rays), map, rect);
}

/// Fills `map` with the first voxels on `rays`, however small they are.
pub(crate) fn sample_exact(grid: &Grid, rays: &PixelRays, map: &mut IndexMap) {
    map.reset(grid.dims(), *rays);
    sample_exact_rect(grid, map, PixelRect::of_picture(rays.size));
}

/// Performs [`sample_exact`] for the pixels of `rect` (cut to the picture), with the rays that `map` was made with.
pub(crate) fn sample_exact_rect(grid: &Grid, map: &mut IndexMap, rect: PixelRect) {
    sample_rect_at(Level::new(), grid, SmallBricks::NONE, map, rect);
}

fn sample_rect_at(
    level: Level,
    grid: &Grid,
    small: SmallBricks,
    map: &mut IndexMap,
    rect: PixelRect,
) {
    match Projection::new(&map.rays) {
        Some(projection) => {
            let sweep = Sweep { grid, rays: map.rays, projection, small, level };
            map.renew(grid.dims(), rect);
            for_each_tile(map, rect, |tile, numbering| sweep.run(tile, numbering));
        }
        // Degenerate: all pixels in a line or a point.
        None => sample_each(grid, map, rect, |origin, direction| {
            Some(cast(grid, origin, direction)?.voxel)
        }),
    }
}

/// Fills the pixels of `rect` with the voxels that `first_voxel` finds for their origins and directions.
pub(super) fn sample_each(
    grid: &Grid,
    map: &mut IndexMap,
    rect: PixelRect,
    first_voxel: impl Fn(Vec3, Vec3) -> Option<UVec3> + Sync,
) {
    let rays = map.rays;
    map.renew(grid.dims(), rect);
    for_each_tile(map, rect, |mut tile, numbering| {
        let PixelRect { min, max } = tile.rect;
        vectorised(
            #[inline(always)]
            || {
                let mut namer = VoxelNamer::new(numbering);
                for y in min.y..max.y {
                    for (pixel, x) in tile.row(y - min.y).iter_mut().zip(min.x..) {
                        let voxel = first_voxel(rays.origin, rays.direction(x, y));
                        *pixel = voxel.map_or(NO_VOXEL, |voxel| namer.number(voxel));
                    }
                }
            },
        );
    });
}

#[cfg(test)]
pub(crate) mod tests;
