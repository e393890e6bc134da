//! Index maps of large sculptures on the device, where a voxel has no linear index: the time at which each pixel's ray
//! enters its voxel, which the composite turns into a depth.

use rayon::prelude::*;

use crate::sculpture::NO_VOXEL;
use crate::surface::{IndexMap, PixelRect};
use crate::view::PixelRays;

/// Returns the times of all rows that `rect` touches, in lengths of the rays, as the bits of a float each; [`NO_VOXEL`]
/// where a pixel shows no voxel. 0: the eye is inside the voxel.
pub(super) fn entry_times(map: &IndexMap, rect: PixelRect) -> Vec<u32> {
    let width = map.rays.size.x as usize;
    let PixelRays { corner, step_x, step_y, .. } = map.rays;
    let normal = step_x.cross(step_y);
    // Times a position relative to the eye: its distance along the view.
    let across = normal / normal.dot(corner);
    let mut times = rect.rows_of(&map.voxels, map.rays.size.x).to_vec();
    times.par_chunks_mut(width.max(1)).zip(rect.rows().into_par_iter()).for_each(|(row, y)| {
        for (x, time) in (0..).zip(row).filter(|(_, time)| **time != NO_VOXEL) {
            let low = map.numbering.coords(*time).as_vec3() - map.rays.origin;
            let inverse = map.rays.direction(x, y).recip();
            let (a, b) = (low * inverse, (low + 1.0) * inverse);
            // A ray along a face crosses none of its axis: not a number, which `max` and `min` ignore.
            let enter = a.min(b).to_array().into_iter().fold(0.0, f32::max);
            let leave = a.max(b).to_array().into_iter().fold(f32::INFINITY, f32::min);
            // A ray that misses its voxel, which stands for a brick, meets it as far away as its middle.
            let enter = if enter > leave { across.dot(low + 0.5) } else { enter };
            *time = if enter.is_finite() { enter.to_bits() } else { 0 };
        }
    });
    times
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::{Grid, Placement};
    use crate::surface::raycast;
    use crate::view::Camera;
    use glam::{UVec2, UVec3, Vec3};

    #[test]
    fn times_are_those_of_the_ray_caster() {
        let dims = UVec3::new(4096, 4096, 512);
        let mut grid = Grid::new(dims, Vec3::ONE, u64::MAX).unwrap();
        grid.fill_bricks(|_| crate::sculpture::Brick::FULL);
        let world_from_grid = Placement::default().world_from_grid(dims, Vec3::ONE);
        let camera = Camera::framing(3000.0, Vec3::new(0.4, 0.3, 1.0), Vec3::Y);
        let rays = camera.eye(UVec2::new(90, 70)).pixel_rays(&world_from_grid);
        let mut map = IndexMap::new(rays);
        raycast::sample(&grid, &rays, &mut map);
        let rect = PixelRect { min: UVec2::new(0, 10), max: UVec2::new(90, 60) };
        let times = entry_times(&map, rect);
        let mut seen = 0;
        for (i, time) in times.into_iter().enumerate() {
            let (x, y) = (i as u32 % 90, 10 + i as u32 / 90);
            match raycast::cast_pixel(&grid, &rays, x, y) {
                Some(hit) => {
                    let time = f32::from_bits(time);
                    // Another voxel may stand for the brick that the ray meets.
                    let brick = 8.0 * 3f32.sqrt() / rays.direction(x, y).length();
                    let error = (time - hit.t).abs();
                    assert!(error <= brick + 1e-4 * hit.t, "{time}, not {}", hit.t);
                    seen += 1;
                }
                None => assert_eq!(time, NO_VOXEL),
            }
        }
        assert!(seen > 1000, "{seen}");
    }
}
