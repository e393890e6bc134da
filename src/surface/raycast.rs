//! Owns the exact ray caster: the first existing voxel along a ray, and the index map of a view.
//!
//! Takes a grid and rays in grid coordinates. What is exact is laid down in [`ray`]: a ray meets
//! voxels in the order of its crossings of voxel boundaries, and the caster returns the first
//! existing one of those, the very voxel that a walk voxel by voxel from the eye returns. It
//! merely skips what is empty: blocks of 4^3 bricks, bricks, words of 4^3 voxels.
//!
//! Knows no colours, no light and no cameras beyond the rays of their pixels.

pub mod ray;
mod walk;

use glam::{IVec3, UVec2, UVec3, Vec3};
use rayon::prelude::*;

use self::ray::Ray;
use self::walk::Walk;
use super::IndexMap;
use crate::sculpture::{Grid, NO_VOXEL};
use crate::view::PixelRays;

/// Rows of pixels that one task of a parallel sampling takes.
const BAND_ROWS: u32 = 16;

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

/// A rectangle of pixels, `min` inclusive and `max` exclusive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PixelRect {
    pub min: UVec2,
    pub max: UVec2,
}

impl PixelRect {
    /// The whole of a picture of `size` pixels.
    pub fn of_picture(size: UVec2) -> PixelRect {
        PixelRect { min: UVec2::ZERO, max: size }
    }
}

/// Fills `map` with the voxels that `rays` meet first. Keeps the map's memory.
pub fn sample(grid: &Grid, rays: &PixelRays, map: &mut IndexMap) {
    map.reset(*rays);
    sample_rect(grid, map, PixelRect::of_picture(rays.size));
}

/// Samples anew the pixels of `rect` (cut to the picture) with the rays that `map` was made with.
pub fn sample_rect(grid: &Grid, map: &mut IndexMap, rect: PixelRect) {
    let rays = map.rays;
    let max = rect.max.min(rays.size);
    if !rect.min.cmplt(max).all() {
        return;
    }
    let width = rays.size.x as usize;
    let rows = rect.min.y as usize * width..max.y as usize * width;
    map.voxels[rows]
        .par_chunks_mut(width * BAND_ROWS as usize)
        .zip((rect.min.y..max.y).into_par_iter().step_by(BAND_ROWS as usize))
        .for_each(|(band, top)| {
            for (row, y) in band.chunks_exact_mut(width).zip(top..) {
                for x in rect.min.x..max.x {
                    let hit = cast(grid, rays.origin, rays.direction(x, y));
                    row[x as usize] = hit.map_or(NO_VOXEL, |hit| grid.voxel_index(hit.voxel));
                }
            }
        });
}

#[cfg(test)]
mod tests;
