//! Light on the smooth surface of a sculpture instead of its voxels.
//!
//! The surface is the zero set of a [`LevelSet`], whose normals are those of ordinary pictures. It is trilinear from
//! voxel to voxel, so it ripples by hundredths of a voxel around the shape that it approximates, which low light would
//! show. Further rays therefore start a little above it, along the normal, less where the surface is aligned with the
//! grid and is exact: never within the sculpture, and never beyond what lies above.
//!
//! Takes points on the surface; returns [`PathVertex`]s. Knows no light.

use glam::Vec3;

use super::scene::{OTHER_SIDE, PathScene, PathVertex};
use crate::shade::level_set::{CellCache, SurfaceHit};
use crate::shade::{LevelSet, ShadeSource};

/// The height above a sloping surface at which rays start: above its ripples.
const CLEARANCE_VX: f32 = 0.4;
/// The clearance on surfaces along the grid.
const LEAST_CLEARANCE_VX: f32 = 0.02;
/// Clearance per slope against the grid.
const CLEARANCE_PER_SLOPE: f32 = 10.0;
/// The number of times that the clearance is halved if there is no room for it.
const HALVINGS: u32 = 5;

impl PathScene<'_> {
    /// Returns the first point on the smooth surface along a ray, nearer than `reach`.
    pub(super) fn smooth_on(
        &self,
        levels: &LevelSet,
        (origin, along): (Vec3, Vec3),
        reach: f32,
        cache: &mut CellCache,
    ) -> Option<SurfaceHit> {
        if self.passes_box(origin, along, reach) {
            return None;
        }
        let ShadeSource { grid, normals, .. } = self.source;
        let first = levels.first_cell(origin, along)?;
        let hit = levels.hit((grid, normals), (origin, along), first, cache)?;
        (hit.t < reach).then_some(hit)
    }

    /// Returns the surface at a point of the smooth surface.
    pub(super) fn smooth_surface(
        &self,
        levels: &LevelSet,
        hit: &SurfaceHit,
        point: Vec3,
        cache: &mut CellCache,
    ) -> PathVertex {
        let outwards = levels.slope(self.source.grid, point, cache).normalize_or(Vec3::Y);
        let smooth = hit.normal.unpack();
        let normal = smooth.filter(|normal| normal.dot(outwards) >= OTHER_SIDE).unwrap_or(outwards);
        PathVertex {
            start: self.clear_of_waves(levels, point, [normal, outwards], cache),
            normal: (self.world_from_normal * normal).normalize_or(self.up),
            albedo: self.albedo(hit.voxel),
        }
    }

    fn clear_of_waves(
        &self,
        levels: &LevelSet,
        point: Vec3,
        [normal, outwards]: [Vec3; 2],
        cache: &mut CellCache,
    ) -> Vec3 {
        let mut is_outside = |point: Vec3| levels.distance_vx(self.source.grid, point, cache) > 0.0;
        let size = normal.abs();
        let slope = size.x.max(size.y).min(size.x.min(size.y).max(size.z));
        let mut clearance = (CLEARANCE_PER_SLOPE * slope).clamp(LEAST_CLEARANCE_VX, CLEARANCE_VX);
        for _ in 0..HALVINGS {
            let start = point + normal * clearance;
            if is_outside(start) && is_outside(point + normal * (0.5 * clearance)) {
                return start;
            }
            clearance *= 0.5;
        }
        point + outwards * LEAST_CLEARANCE_VX
    }
}
