//! Ambient occlusion: the share of ambient light that reaches a voxel, estimated from the bits around
//! it.
//!
//! In front of a plane half of the surroundings is empty, and all of the light arrives; in a corner
//! or a crevice less is. The surroundings are the cube of 8^3 voxels about the voxel's middle. It
//! cuts 27 words of 4^3, of which each counts by its share of existing voxels times its part within
//! the cube: so the value changes gradually from voxel to voxel.
//! (After the volumetric obscurance of Loos and Sloan, 2010, with a box for the sphere.)
//!
//! Between the corners of words that count is trilinear. So it needs to be known there only, where the
//! cube consists of eight whole words: the 27 corners in and around a brick are the **table** of that
//! brick, and a voxel takes eight of its values. Tables are made when a picture first meets a brick
//! ([`OpennessTables`]).

use std::array::from_fn;

use glam::{IVec3, UVec3};

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, WORD_EDGE_VX};

/// How far from a voxel the voxels may be, on each axis, that its occlusion depends on.
pub const OCCLUSION_REACH_VX: u32 = 2 * WORD_EDGE_VX - 1;

/// Openness of a cube without voxels. The middle of a voxel lies half a voxel within the surface, so that 9/16 of
/// the cube are filled at a face: that is as open as it gets, with some reserve for the steps of slanted faces.
const OPENNESS_OF_NOTHING: f32 = 2.36;

/// Corners of words along an axis of a brick.
const CORNERS: usize = 3;

/// Tables that are kept, one for each remainder of the brick's coordinates.
const KEPT: usize = 64;
const KEPT_LOG2_PER_AXIS: u32 = 2;

/// Existing voxels of the cubes about the corners of a brick's words.
type Table = [[[u16; CORNERS]; CORNERS]; CORNERS];

/// The tables of the bricks that were met last. They are those of one grid, while it stays as it is.
#[derive(Clone, Debug)]
pub struct OpennessTables {
    /// The brick that each place is for; [`u32::MAX`] for none.
    bricks: [u32; KEPT],
    tables: [Table; KEPT],
}

impl Default for OpennessTables {
    fn default() -> Self {
        OpennessTables { bricks: [u32::MAX; KEPT], tables: [Table::default(); KEPT] }
    }
}

impl OpennessTables {
    /// The share of ambient light that reaches a voxel: 0 if it is buried, 1 on a plane or an edge.
    #[inline(always)]
    pub fn openness(&mut self, grid: &Grid, voxel: UVec3) -> f32 {
        let b = voxel / BRICK_EDGE_VX;
        let brick = grid.brick_index(b) as u32;
        let kept = b & ((1 << KEPT_LOG2_PER_AXIS) - 1);
        let [x, y, z] = kept.to_array().map(|c| c as usize);
        let place = x | y << KEPT_LOG2_PER_AXIS | z << (2 * KEPT_LOG2_PER_AXIS);
        if self.bricks[place] != brick {
            self.bricks[place] = brick;
            self.tables[place] = table(grid, b);
        }
        let table = &self.tables[place];
        let [x, y, z] = ((voxel / WORD_EDGE_VX) & 1).to_array().map(|c| c as usize);
        let share = ((voxel % WORD_EDGE_VX).as_vec3() + 0.5) / WORD_EDGE_VX as f32;
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let along_x = |y: usize, z: usize| {
            let row = &table[z][y];
            mix(f32::from(row[x]), f32::from(row[x + 1]), share.x)
        };
        let in_plane = |z: usize| mix(along_x(y, z), along_x(y + 1, z), share.y);
        let filled = mix(in_plane(z), in_plane(z + 1), share.z);
        const PER_VOXEL: f32 = OPENNESS_OF_NOTHING / (8 * WORD_EDGE_VX.pow(3)) as f32;
        (OPENNESS_OF_NOTHING - filled * PER_VOXEL).clamp(0.0, 1.0)
    }
}

/// Of brick `b`: sums of eight of the 4^3 words in and around it.
#[inline(always)]
fn table(grid: &Grid, b: UVec3) -> Table {
    let (words, first) = (grid.words(), b.as_ivec3() * 2 - 1);
    let mut counts = [[[0; 4]; 4]; 4];
    for part in 0..8usize {
        let [x, y, z] = [part << 1 & 2, part & 2, part >> 1 & 2];
        let cube = words.cube(first + IVec3::new(x as i32, y as i32, z as i32));
        for (i, word) in cube.into_iter().enumerate() {
            counts[z + (i >> 2)][y + (i >> 1 & 1)][x + (i & 1)] = word.count_ones() as u16;
        }
    }
    let along_x = counts.map(|plane| plane.map(|row| from_fn(|x| row[x] + row[x + 1])));
    let in_planes: [[[u16; 3]; 3]; 4] =
        along_x.map(|plane: [[u16; 3]; 4]| from_fn(|y| sum(plane[y], plane[y + 1])));
    from_fn(|z| from_fn(|y| sum(in_planes[z][y], in_planes[z + 1][y])))
}

#[inline(always)]
fn sum(a: [u16; CORNERS], b: [u16; CORNERS]) -> [u16; CORNERS] {
    from_fn(|i| a[i] + b[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{self, Random};
    use crate::sculpture::Brick;
    use glam::Vec3;

    fn openness(grid: &Grid, voxel: UVec3) -> f32 {
        OpennessTables::default().openness(grid, voxel)
    }

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
                    let volume = inside.max(Vec3::ZERO).element_product();
                    let count = (0..64)
                        .filter(|i| grid.get(low + IVec3::new(i & 3, i >> 2 & 3, i >> 4)))
                        .count();
                    filled += count as f32 / 64.0 * volume;
                }
            }
        }
        (2.36 * (1.0 - filled / 512.0)).clamp(0.0, 1.0)
    }

    #[test]
    fn openness_is_its_definition() {
        let grid = scenes::cheese(61, 40, 4).unwrap();
        let mut random = Random(2);
        // More bricks than tables are kept.
        let mut tables = OpennessTables::default();
        for _ in 0..2000 {
            let v = random.voxel(grid.dims()).as_uvec3();
            let (found, expected) = (tables.openness(&grid, v), naive(&grid, v));
            assert!((found - expected).abs() < 1e-5, "{v}: {found}, not {expected}");
        }
    }

    #[test]
    fn faces_are_open_wherever_words_begin_and_buried_voxels_dark() {
        let grid = scenes::solid_cube(64).unwrap();
        for x in 20..40 {
            assert_eq!(openness(&grid, UVec3::new(x, 33, 63)), 1.0);
        }
        for height in 20..32 {
            let mut floor = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
            floor.fill_bricks(|b| Brick::below([8, 8, u32::saturating_sub(height, b.z * 8)]));
            assert_eq!(openness(&floor, UVec3::new(33, 30, height - 1)), 1.0, "{height}");
        }
        assert_eq!(openness(&grid, UVec3::splat(30)), 0.0);
        assert_eq!(openness(&grid, UVec3::splat(63)), 1.0);
    }

    #[test]
    fn the_reach_is_how_far_a_changed_voxel_matters() {
        let full = scenes::solid_cube(64).unwrap();
        let mut farthest = 0;
        for at in 28..36 {
            let mut grid = full.clone();
            grid.set(IVec3::new(at, 31, 31), false);
            for x in 0..64 {
                let v = UVec3::new(x, 31, 31);
                if openness(&grid, v) != openness(&full, v) {
                    farthest = farthest.max(x.abs_diff(at as u32));
                }
            }
        }
        assert_eq!(farthest, OCCLUSION_REACH_VX);
    }
}
