//! The share of light that reaches the points of a [`GroundPlane`]: that of the sun, by a ray from each point, and that
//! of the sky, by some rays from fewer points ([`Openness`]), which depends only on the voxels.
//!
//! The first picture uses the centre of the sun's disc and of each texel; the further samples of an antialiased picture
//! use other points of both, so that shadows are soft in the mean. Shares do not depend on the number of threads.

use std::f32::consts::TAU;

use glam::{UVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::{GroundPlane, across};
use crate::sculpture::Grid;
use crate::shade::shadow::{ShadowSun, on_disc};
use crate::surface::raycast;
use crate::view::sample_offset_px;

/// Edge of the map in texels.
pub const MAP_EDGE: usize = 384;
/// Edge of the table of the sky's light.
const OPEN_EDGE: usize = 64;
/// Rays to the sky from each of its points.
const SKY_RAYS: u32 = 16;
/// The distance below the plane at which rays begin, so that they enter the voxels on it.
const BELOW_VX: f32 = 0.01;

/// The share of the sky's light, 0 to 1, at the points of a table over the plane.
#[derive(Clone, Default)]
pub struct Openness {
    shares: Vec<f32>,
}

impl Openness {
    /// Computes the openness of the plane below `grid`.
    pub fn new(grid: &Grid, plane: &GroundPlane) -> Openness {
        let caster = Caster { grid, plane };
        let rays: Vec<Vec3> = (0..SKY_RAYS).map(sky_direction).collect();
        let mut seen = vec![0.0; OPEN_EDGE * OPEN_EDGE];
        seen.par_chunks_mut(OPEN_EDGE).enumerate().for_each(|(y, row)| {
            for (x, share) in row.iter_mut().enumerate() {
                let origin = plane.point(place(Vec2::new(x as f32, y as f32), OPEN_EDGE));
                // Different directions at each point: the noise is smoothed below.
                let turn = Vec2::from_angle(TAU * 0.618_034 * (x + 5 * y) as f32);
                let open = |ray: &&Vec3| {
                    let level = turn.rotate(ray.truncate());
                    !caster.is_blocked(origin, caster.in_grid(level.extend(ray.z)))
                };
                *share = rays.iter().filter(open).count() as f32 / SKY_RAYS as f32;
            }
        });
        Openness { shares: smoothed(&smoothed(&seen)) }
    }

    /// Returns the share at `place`, from (-1, -1) to (1, 1).
    fn at(&self, place: Vec2) -> f32 {
        let last = (OPEN_EDGE - 1) as f32;
        let at =
            ((place * 0.5 + 0.5) * OPEN_EDGE as f32 - 0.5).clamp(Vec2::ZERO, Vec2::splat(last));
        let low = at.floor().min(Vec2::splat(last - 1.0));
        let (first, share) = (low.x as usize + OPEN_EDGE * low.y as usize, at - low);
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let row = |first: usize| mix(self.shares[first], self.shares[first + 1], share.x);
        mix(row(first), row(first + OPEN_EDGE), share.y)
    }
}

/// The share of the sun's and of the sky's light at each texel, of 255, row by row.
#[derive(Clone, Default)]
pub struct LightMap {
    /// [`MAP_EDGE`] rows of [`MAP_EDGE`] texels.
    pub texels: Vec<[u8; 2]>,
}

impl LightMap {
    /// Computes the shares on `plane` below `grid`, whose `openness` is known. Without a sun, every point has full
    /// sunlight. Keeps the map's memory.
    pub fn update(
        &mut self,
        grid: &Grid,
        plane: &GroundPlane,
        openness: &Openness,
        sun: Option<&ShadowSun>,
    ) {
        let caster = Caster { grid, plane };
        let offset = sample_offset_px(sun.map_or(0, |sun| sun.sample));
        self.texels.resize(MAP_EDGE * MAP_EDGE, [255; 2]);
        self.texels.par_chunks_mut(MAP_EDGE).enumerate().for_each(|(y, row)| {
            for (x, texel) in row.iter_mut().enumerate() {
                let at = Vec2::new(x as f32, y as f32);
                let open = openness.at(place(at, MAP_EDGE));
                let point = plane.point(place(at + offset, MAP_EDGE));
                let sunlit = sun.is_none_or(|sun| {
                    let on_sun = on_disc(UVec3::new(x as u32, y as u32, 0), sun.sample);
                    let [right, up] = sun.across;
                    let direction = sun.towards + right * on_sun.x + up * on_sun.y;
                    !caster.is_blocked(point, direction)
                });
                *texel = [if sunlit { 255 } else { 0 }, (open * 255.0 + 0.5) as u8];
            }
        });
    }
}

/// Returns the place of a texel in a map of `edge` texels, from (-1, -1) to (1, 1).
fn place(texel: Vec2, edge: usize) -> Vec2 {
    (texel + 0.5) * (2.0 / edge as f32) - 1.0
}

struct Caster<'a> {
    grid: &'a Grid,
    plane: &'a GroundPlane,
}

impl Caster<'_> {
    /// Returns the grid direction of a direction relative to the plane: two axes across it, then up.
    fn in_grid(&self, direction: Vec3) -> Vec3 {
        let GroundPlane { axis, voxel_size, .. } = *self.plane;
        let size = across(axis, voxel_size);
        let mut along = self.plane.up() * (direction.z / voxel_size[axis]);
        along[(axis + 1) % 3] = direction.x / size.x;
        along[(axis + 2) % 3] = direction.y / size.y;
        along
    }

    fn is_blocked(&self, point: Vec3, direction: Vec3) -> bool {
        let origin = point - self.plane.up() * BELOW_VX;
        // Most rays miss the box around the voxels.
        let [low, high] = self.plane.bounds;
        let per_t = 1.0 / direction;
        let (a, b) = ((low - origin) * per_t, (high - origin) * per_t);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter <= leave && leave >= 0.0 && raycast::cast(self.grid, origin, direction).is_some()
    }
}

/// Returns one of [`SKY_RAYS`] directions, distributed in proportion to the cosine with up (z).
fn sky_direction(index: u32) -> Vec3 {
    let share = (index as f32 + 0.5) / SKY_RAYS as f32;
    let level = Vec2::from_angle(TAU * 0.381_966 * index as f32) * share.sqrt();
    level.extend((1.0 - share).sqrt())
}

/// Returns the means over 3x3 points.
fn smoothed(shares: &[f32]) -> Vec<f32> {
    let last = OPEN_EDGE as i32 - 1;
    let at =
        |x: i32, y: i32| shares[x.clamp(0, last) as usize + OPEN_EDGE * y.clamp(0, last) as usize];
    let mean = |i: usize| {
        let (x, y) = ((i % OPEN_EDGE) as i32, (i / OPEN_EDGE) as i32);
        let around = (-1..2).flat_map(|dy| (-1..2).map(move |dx| (dx, dy)));
        around.map(|(dx, dy)| at(x + dx, y + dy)).sum::<f32>() / 9.0
    };
    (0..shares.len()).map(mean).collect()
}
