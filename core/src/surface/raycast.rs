//! Owns the exact ray caster: the first existing voxel along a ray, and the index map of a view.
//!
//! Takes a grid and rays in grid coordinates. What is exact is laid down in [`ray`]: a ray meets
//! voxels in the order of its crossings of voxel boundaries, and the caster returns the first
//! existing one of those, the very voxel that a walk voxel by voxel from the eye returns.
//!
//! There are two ways to it. [`walk`] takes one ray and skips what is empty: blocks of 4^3 bricks,
//! bricks, words of 4^3 voxels. [`sweep`] takes a tile of a picture and goes the other way round:
//! it visits the cubes of the grid front to back, each once for all pixels of the tile that may
//! see it, and walks sixteen rays at once through a brick ([`packet`]). At usual distances a
//! brick covers some thirty pixels, so that nearly all decisions are shared.
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
use super::tiles::for_each_tile;
use crate::sculpture::vectors::vectorised;
use crate::sculpture::{Grid, NO_VOXEL};
use crate::view::PixelRays;

/// What a ray met first.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hit {
    /// The voxel.
    pub voxel: UVec3,
    /// Outward normal of the face by which the ray entered the voxel; zero if it started inside.
    pub face: IVec3,
    /// Where the ray entered the voxel, in lengths of the direction; 0 if it started inside.
    pub t: f32,
}

/// The first existing voxel along `origin + t * direction`, `t >= 0`, in grid coordinates.
/// The voxel around the origin counts as met at `t = 0`. Nothing is met where the numbers are not
/// finite or the direction is zero.
pub fn cast(grid: &Grid, origin: Vec3, direction: Vec3) -> Option<Hit> {
    let ray = Ray::new(origin, direction)?;
    let (voxel, event) = Walk::enter(grid, ray)?.first_voxel()?;
    let mut face = IVec3::ZERO;
    if event.axis < 3 {
        face[event.axis] = -ray.step[event.axis];
    }
    Some(Hit { voxel, face, t: event.t })
}

/// Fills `map` with the voxels that `rays` meet first. Keeps the map's memory.
pub fn sample(grid: &Grid, rays: &PixelRays, map: &mut IndexMap) {
    map.reset(*rays);
    sample_rect(grid, map, PixelRect::of_picture(rays.size));
}

/// Samples anew the pixels of `rect` (cut to the picture) with the rays that `map` was made with.
pub fn sample_rect(grid: &Grid, map: &mut IndexMap, rect: PixelRect) {
    sample_rect_at(Level::new(), grid, map, rect);
}

fn sample_rect_at(level: Level, grid: &Grid, map: &mut IndexMap, rect: PixelRect) {
    match Projection::new(&map.rays) {
        Some(projection) => {
            let sweep = Sweep { grid, rays: map.rays, projection, level };
            for_each_tile(map, rect, |tile| sweep.run(tile));
        }
        // Pixels in a line or a point: no picture that anybody looks at.
        None => sample_each(grid, map, rect, |origin, direction| {
            Some(cast(grid, origin, direction)?.voxel)
        }),
    }
}

/// Fills the pixels of `rect` with what `first_voxel` finds from an origin in a direction.
pub(super) fn sample_each(
    grid: &Grid,
    map: &mut IndexMap,
    rect: PixelRect,
    first_voxel: impl Fn(Vec3, Vec3) -> Option<UVec3> + Sync,
) {
    let rays = map.rays;
    for_each_tile(map, rect, |mut tile| {
        let PixelRect { min, max } = tile.rect;
        vectorised(
            #[inline(always)]
            || {
                for y in min.y..max.y {
                    for (pixel, x) in tile.row(y - min.y).iter_mut().zip(min.x..) {
                        let voxel = first_voxel(rays.origin, rays.direction(x, y));
                        *pixel = voxel.map_or(NO_VOXEL, |voxel| grid.voxel_index(voxel));
                    }
                }
            },
        );
    });
}

#[cfg(test)]
pub(crate) mod tests;
