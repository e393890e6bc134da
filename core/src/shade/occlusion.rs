//! Ambient occlusion: the share of ambient light that reaches a voxel, estimated from the bits around
//! it.
//!
//! In front of a plane half of the surroundings is empty, and all of the light arrives; in a corner
//! or a crevice less is. The surroundings are the cube of 8^3 voxels about the voxel's middle. It
//! cuts 27 words of 4^3, of which each counts by its share of existing voxels times its part within
//! the cube: so the value changes gradually from voxel to voxel, at the price of 27 counts.
//! (After the volumetric obscurance of Loos and Sloan, 2010, with a box for the sphere.)

use glam::{IVec3, UVec3};

use crate::sculpture::Grid;
use crate::sculpture::brick::WORD_EDGE_VX;

/// Half the edge of the cube, in voxels: the edge of a word.
const REACH_VX: i32 = WORD_EDGE_VX as i32;

/// The share of ambient light that reaches a voxel: 0 if it is buried, 1 on a plane or an edge.
pub fn openness(grid: &Grid, voxel: UVec3) -> f32 {
    let low = voxel.as_ivec3() - REACH_VX;
    let corner = low & -REACH_VX;
    // The cube begins half a voxel behind the lower corner of `low`.
    let cut = (low - corner).as_vec3() + 0.5;
    let part = |axis: usize, word: i32| match word {
        0 => REACH_VX as f32 - cut[axis],
        1 => REACH_VX as f32,
        _ => cut[axis],
    };
    let mut filled = 0.0;
    for z in 0..3 {
        for y in 0..3 {
            let across = part(1, y) * part(2, z);
            for x in 0..3 {
                let at = corner + IVec3::new(x, y, z) * REACH_VX;
                filled += word_count(grid, at) as f32 * (part(0, x) * across);
            }
        }
    }
    // A full word counts 64 times its part of the cube.
    (2.0 - filled * (2.0 / (64.0 * 512.0))).clamp(0.0, 1.0)
}

/// Existing voxels of the word whose lower corner is `at`; 0 outside the grid.
fn word_count(grid: &Grid, at: IVec3) -> u32 {
    if !grid.contains(at) {
        return 0;
    }
    let at = at.as_uvec3();
    let word = at >> UVec3::splat(2) & 1;
    let brick = grid.brick(at >> UVec3::splat(3));
    brick.words[(word.x | word.y << 1 | word.z << 2) as usize].count_ones()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{self, Random};

    /// Voxel by voxel: the share of each word, times how far it reaches into the cube.
    fn naive(grid: &Grid, voxel: UVec3) -> f32 {
        let middle = voxel.as_vec3() + 0.5;
        let mut filled = 0.0;
        let first = (voxel.as_ivec3() - 8) & -4;
        for z in (0..24).step_by(4) {
            for y in (0..24).step_by(4) {
                for x in (0..24).step_by(4) {
                    let low = first + IVec3::new(x, y, z);
                    let inside =
                        (low.as_vec3() + 4.0).min(middle + 4.0) - low.as_vec3().max(middle - 4.0);
                    let volume = inside.max(glam::Vec3::ZERO).element_product();
                    let count = (0..64)
                        .filter(|i| grid.get(low + IVec3::new(i & 3, i >> 2 & 3, i >> 4)))
                        .count();
                    filled += count as f32 / 64.0 * volume;
                }
            }
        }
        (2.0 * (1.0 - filled / 512.0)).clamp(0.0, 1.0)
    }

    #[test]
    fn openness_is_its_definition() {
        let grid = scenes::cheese(61, 40, 4).unwrap();
        let mut random = Random(2);
        for _ in 0..2000 {
            let v = random.voxel(grid.dims()).as_uvec3();
            let (found, expected) = (openness(&grid, v), naive(&grid, v));
            assert!((found - expected).abs() < 1e-5, "{v}: {found}, not {expected}");
        }
    }

    #[test]
    fn planes_are_nearly_open_and_buried_voxels_dark() {
        let grid = scenes::solid_cube(64).unwrap();
        for x in 20..40 {
            let face = openness(&grid, UVec3::new(x, 33, 63));
            assert!(face > 0.85, "{face}");
        }
        assert_eq!(openness(&grid, UVec3::splat(30)), 0.0);
        assert_eq!(openness(&grid, UVec3::splat(63)), 1.0);
    }
}
