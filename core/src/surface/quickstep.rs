//! Quickstep, the approximate ray caster of the 2005 system (Mueller, "Volume Modelling and
//! Rendering Based on 3D Voxel Grids").
//!
//! It walks bricks exactly while they are empty. In a non-empty brick, it takes the first and the last voxel of the ray
//! and draws a digital line between them: the axis with most steps is the basis and advances with each step, the others
//! in proportion; each advance tests one voxel. No crossing is computed in between, so the line can miss a voxel that
//! the ray touches, or test one that it does not. The reported voxel exists and lies within a voxel of the ray, but may
//! not be the first. [`super::raycast`] is the exact caster.
//!
//! Its functions have the inputs and outputs of the exact caster's.

use glam::{IVec3, UVec3, Vec3};

use super::index_map::{IndexMap, PixelRect};
use super::raycast::ray::Ray;
use super::raycast::sample_each;
use super::raycast::walk::Walk;
use crate::sculpture::{Brick, Grid};
use crate::view::PixelRays;

/// Returns an existing voxel near the beginning of the solid along `origin + t * direction`, `t >= 0`, in grid
/// coordinates.
#[inline(always)]
pub fn cast(grid: &Grid, origin: Vec3, direction: Vec3) -> Option<UVec3> {
    let ray = Ray::new(origin, direction)?;
    let mut walk = Walk::enter(grid, ray)?;
    while walk.find_brick() {
        let (first, last) = (walk.cell(), walk.last_in_brick());
        if let Some(voxel) = line(walk.brick(), first, last) {
            return Some(voxel);
        }
        if !walk.leave_brick() {
            break;
        }
    }
    None
}

/// Fills `map` with the voxels that Quickstep finds along `rays`. Keeps the map's memory.
pub fn sample(grid: &Grid, rays: &PixelRays, map: &mut IndexMap) {
    map.reset(grid.dims(), *rays);
    sample_rect(grid, map, PixelRect::of_picture(rays.size));
}

/// Resamples the pixels of `rect` (cut to the picture) with the rays that `map` was made with.
pub fn sample_rect(grid: &Grid, map: &mut IndexMap, rect: PixelRect) {
    sample_each(
        grid,
        map,
        rect,
        #[inline(always)]
        |origin, direction| cast(grid, origin, direction),
    );
}

/// Returns the first existing voxel of the line from `first` to `last`, both in `brick`.
#[inline(always)]
fn line(brick: &Brick, first: IVec3, last: IVec3) -> Option<UVec3> {
    let exists = |v: IVec3| {
        let v = v.as_uvec3();
        brick.get(v.x & 7, v.y & 7, v.z & 7).then_some(v)
    };
    let (steps, direction) = ((last - first).abs(), (last - first).signum());
    let basis = if steps.x >= steps.y && steps.x >= steps.z {
        0
    } else if steps.y >= steps.z {
        1
    } else {
        2
    };
    let (second, third) = ((basis + 1) % 3, (basis + 2) % 3);
    let mut voxel = first;
    let mut found = exists(voxel);
    // Half a step ahead, so that the other axes advance midway between their turns.
    let mut turn = [steps[basis] / 2; 2];
    for _ in 0..steps[basis] {
        if found.is_some() {
            break;
        }
        voxel[basis] += direction[basis];
        found = exists(voxel);
        for (turn, axis) in turn.iter_mut().zip([second, third]) {
            *turn -= steps[axis];
            if *turn < 0 {
                *turn += steps[basis];
                voxel[axis] += direction[axis];
                found = found.or_else(|| exists(voxel));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use crate::sculpture::{NO_VOXEL, Placement};
    use crate::surface::raycast;
    use crate::view::Camera;
    use glam::UVec2;

    /// Returns the least distance, as the largest of three axes, between a ray and a voxel's box.
    fn distance_vx(origin: Vec3, direction: Vec3, voxel: UVec3) -> f32 {
        // The distance is convex along the ray: ternary search.
        let gap = |t: f32| {
            let p = origin + direction * t;
            let low = voxel.as_vec3();
            (p - p.clamp(low, low + 1.0)).abs().max_element()
        };
        let (mut low, mut high) = (0.0, 4000.0);
        for _ in 0..100 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if gap(a) < gap(b) { high = b } else { low = a }
        }
        gap(low)
    }

    #[test]
    fn quickstep_finds_existing_voxels_near_the_ray_and_mostly_near_the_first() {
        // The share of pixels where Quickstep finds the voxel of the exact caster, of those with one; and the share
        // where it finds that one or one of its 26 neighbours. Measured: cheese 0.862, 0.987; rough gyroid 0.494,
        // 0.837; engine 0.617, 0.895.
        let scenes = [
            (scenes::cheese(128, 60, 3), 0.86, 0.98),
            (scenes::gyroid(128, 3), 0.49, 0.83),
            (scenes::engine_like(128), 0.61, 0.89),
        ];
        for (grid, least_same, least_near) in scenes {
            let grid = grid.unwrap();
            let world_from_grid =
                Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
            let camera = Camera::framing(100.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y);
            let rays = camera.eye(UVec2::new(320, 240)).pixel_rays(&world_from_grid);
            let (mut exact, mut quick) = (IndexMap::new(rays), IndexMap::new(rays));
            raycast::sample(&grid, &rays, &mut exact);
            sample(&grid, &rays, &mut quick);
            for y in 0..rays.size.y {
                for x in 0..rays.size.x {
                    let Some(index) = quick.get(x, y) else { continue };
                    let voxel = grid.voxel_coords(index);
                    assert!(grid.get(voxel.as_ivec3()));
                    let distance = distance_vx(rays.origin, rays.direction(x, y), voxel);
                    assert!(distance <= 1.0, "{voxel} is {distance} voxels off the ray");
                }
            }
            let near = |&(a, b): &(&u32, &u32)| {
                let [a, b] = [*a, *b].map(|v| grid.voxel_coords(v).as_ivec3());
                (a - b).abs().max_element() <= 1
            };
            let seen = || {
                let pairs = exact.voxels.iter().zip(&quick.voxels);
                pairs.filter(|(exact, _)| **exact != NO_VOXEL)
            };
            let same = seen().filter(|(exact, quick)| exact == quick).count();
            let near = seen().filter(|pair| *pair.1 != NO_VOXEL).filter(near).count();
            let [same, near] = [same, near].map(|n| n as f32 / exact.covered() as f32);
            assert!(same >= least_same && near >= least_near, "same {same}, near {near}");
        }
    }

    #[test]
    fn quickstep_starts_at_the_eye_and_ends_with_the_grid() {
        let grid = scenes::solid_cube(16).unwrap();
        assert_eq!(cast(&grid, Vec3::splat(4.5), Vec3::X), Some(UVec3::splat(4)));
        assert_eq!(cast(&grid, Vec3::new(-5.0, 3.5, 2.5), Vec3::X), Some(UVec3::new(0, 3, 2)));
        assert_eq!(cast(&grid, Vec3::new(-5.0, 3.5, 2.5), -Vec3::X), None);
        let empty = Grid::new(UVec3::splat(16), Vec3::ONE, 1 << 20).unwrap();
        assert_eq!(cast(&empty, Vec3::splat(4.5), Vec3::ONE), None);
    }
}
