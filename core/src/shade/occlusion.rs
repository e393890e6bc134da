//! Ambient occlusion: the share of ambient light that reaches a voxel, estimated from the bits around it.
//!
//! In front of a plane, half of the surroundings is empty, and all of the light arrives; in a corner or a crevice, less
//! does. The surroundings are the cube of 8^3 voxels about the voxel's centre. It intersects 27 words of 4^3, each of
//! which counts by its share of existing voxels times its part within the cube: so the value changes gradually from
//! voxel to voxel. (After the volumetric obscurance of Loos and Sloan, 2010, with a box instead of the sphere.)
//!
//! On a slanted or curved surface, voxels form steps, and the filled part of the cube depends mainly on how deep in its
//! step a voxel lies. That would show as rings around the flats of a ball and as streaks along walls. The depth of
//! surface voxels is known, so its contribution is subtracted ([`Filled::openness_at`]); other voxels count as if they
//! lay in a face.
//!
//! Between the corners of words, that count is trilinear. So it is needed only at the corners, where the cube consists
//! of eight whole words: the 27 corners in and around a brick are the **table** of that brick, and a voxel uses eight
//! of its values. The [`super::normal_field`] keeps the openness of surface voxels; for others, tables are made when a
//! picture first meets a brick ([`OpennessTables`]).

use glam::{IVec3, UVec3};

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_VOXELS, WORD_EDGE_VX};
use crate::sculpture::grid::WordReader;

/// The distance, on each axis, of the farthest voxels that a voxel's occlusion depends on.
pub const OCCLUSION_REACH_VX: u32 = 2 * WORD_EDGE_VX - 1;

/// Openness of a cube without voxels. The centre of a voxel lies half a voxel within the surface, so that 9/16 of the
/// cube are filled at a face: that gives full openness, with some reserve for the steps of slanted faces.
const OPENNESS_OF_NOTHING: f32 = 2.36;

/// The decrease of openness per existing voxel.
const PER_VOXEL: f32 = OPENNESS_OF_NOTHING / (8 * WORD_EDGE_VX.pow(3)) as f32;

/// The increase of the filled part of the cube, in voxels, for each voxel that its centre lies deeper below the
/// surface: a layer of the cube.
const VOXELS_PER_DEPTH: f32 = (2 * WORD_EDGE_VX * 2 * WORD_EDGE_VX) as f32;

/// The depth of the centres of voxels below a face, in voxels.
const DEPTH_AT_FACE_VX: f32 = 0.5;

/// The fixed-point scale of the filled part: units per voxel.
const FILLED_PER_VOXEL: f32 = 64.0;

/// Corners of words along an axis of a brick.
const CORNERS: usize = 3;

/// The number of cached tables, one for each remainder of the brick's coordinates.
const KEPT: usize = 64;
const KEPT_LOG2_PER_AXIS: u32 = 2;

/// Existing voxels of the cubes about the corners of a brick's words: `[z][y][x]`.
pub type Table = [[[u16; CORNERS]; CORNERS]; CORNERS];

/// The 4^3 words in and around a brick: `[z][y][x]`.
pub type WordsAround = [[[u64; 4]; 4]; 4];

/// The tables of the bricks that were met last. Valid for one grid, while it does not change.
#[derive(Clone, Debug)]
pub struct OpennessTables {
    /// The brick of each slot; [`u32::MAX`] for none.
    bricks: [u32; KEPT],
    tables: [Table; KEPT],
}

impl Default for OpennessTables {
    fn default() -> Self {
        OpennessTables { bricks: [u32::MAX; KEPT], tables: [Table::default(); KEPT] }
    }
}

impl OpennessTables {
    /// Returns how much of the cube about a voxel is filled.
    #[cfg(test)]
    pub fn filled(&mut self, grid: &Grid, voxel: UVec3) -> Filled {
        Filled((filled_in(self.table_of(grid, voxel), voxel) * FILLED_PER_VOXEL + 0.5) as u16)
    }

    /// Returns the share of ambient light that reaches a voxel: 0 if it is buried, 1 on a plane or an edge.
    #[inline(always)]
    pub fn openness(&mut self, grid: &Grid, voxel: UVec3) -> f32 {
        openness_in(self.table_of(grid, voxel), voxel)
    }

    #[inline(always)]
    fn table_of(&mut self, grid: &Grid, voxel: UVec3) -> &Table {
        let b = voxel / BRICK_EDGE_VX;
        let brick = grid.brick_index(b) as u32;
        let kept = b & ((1 << KEPT_LOG2_PER_AXIS) - 1);
        let [x, y, z] = kept.to_array().map(|c| c as usize);
        let place = x | y << KEPT_LOG2_PER_AXIS | z << (2 * KEPT_LOG2_PER_AXIS);
        if self.bricks[place] != brick {
            self.bricks[place] = brick;
            self.tables[place] = table(grid, b);
        }
        &self.tables[place]
    }
}

/// Returns the share of ambient light that reaches a voxel of the brick with this table, assuming the depth of a voxel
/// in a face.
#[inline(always)]
fn openness_in(table: &Table, voxel: UVec3) -> f32 {
    openness(filled_in(table, voxel), DEPTH_AT_FACE_VX)
}

/// Returns the share of ambient light that reaches a voxel whose centre lies `depth_vx` below the surface and around
/// which `filled` voxels exist.
#[inline(always)]
fn openness(filled: f32, depth_vx: f32) -> f32 {
    let of_depth = (depth_vx.clamp(0.0, 1.0) - DEPTH_AT_FACE_VX) * VOXELS_PER_DEPTH;
    (OPENNESS_OF_NOTHING - (filled - of_depth) * PER_VOXEL).clamp(0.0, 1.0)
}

/// Returns the number of existing voxels in the cube about a voxel of the brick with this table.
#[inline(always)]
fn filled_in(table: &Table, voxel: UVec3) -> f32 {
    let [x, y, z] = ((voxel / WORD_EDGE_VX) & 1).to_array().map(|c| c as usize);
    let share = ((voxel % WORD_EDGE_VX).as_vec3() + 0.5) / WORD_EDGE_VX as f32;
    let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
    let along_x = |y: usize, z: usize| {
        let row = &table[z][y];
        mix(f32::from(row[x]), f32::from(row[x + 1]), share.x)
    };
    let in_plane = |z: usize| mix(along_x(y, z), along_x(y + 1, z), share.y);
    mix(in_plane(z), in_plane(z + 1), share.z)
}

/// The filled part of the cube about a voxel, in fractions of a voxel.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Filled(u16);

impl Filled {
    /// Returns the share of ambient light that reaches a voxel whose centre lies `depth_vx` below the surface, 255 for
    /// all of it.
    #[inline(always)]
    pub fn openness_at(self, depth_vx: f32) -> u8 {
        let filled = f32::from(self.0) * (1.0 / FILLED_PER_VOXEL);
        (openness(filled, depth_vx) * 255.0 + 0.5) as u8
    }
}

/// The filled part of the cube about each voxel of a brick, `x + 8 y + 64 z`.
#[derive(Clone, Debug)]
pub struct BrickFilling([Filled; BRICK_VOXELS as usize]);

impl Default for BrickFilling {
    fn default() -> Self {
        BrickFilling([Filled::default(); BRICK_VOXELS as usize])
    }
}

impl std::ops::Index<usize> for BrickFilling {
    type Output = Filled;

    #[inline(always)]
    fn index(&self, local: usize) -> &Filled {
        &self.0[local]
    }
}

impl BrickFilling {
    /// Replaces the values by those of the brick with this table. Works axis by axis, and in rows of eight.
    #[inline(always)]
    pub fn fill(&mut self, table: &Table) {
        const EDGE: usize = BRICK_EDGE_VX as usize;
        const WORD: usize = WORD_EDGE_VX as usize;
        let share = |i: usize| ((i % WORD) as f32 + 0.5) / WORD as f32;
        let mut columns = [[[0.0; EDGE]; CORNERS]; CORNERS];
        for (plane, rows) in table.iter().zip(&mut columns) {
            for (corners, row) in plane.iter().zip(rows) {
                for (x, value) in row.iter_mut().enumerate() {
                    let [a, b] = [corners[x / WORD], corners[x / WORD + 1]].map(f32::from);
                    *value = a + (b - a) * share(x);
                }
            }
        }
        for (z, layer) in self.0.chunks_exact_mut(EDGE * EDGE).enumerate() {
            let mut plane = [[0.0; EDGE]; CORNERS];
            for (y, row) in plane.iter_mut().enumerate() {
                let [a, b] = [&columns[z / WORD][y], &columns[z / WORD + 1][y]];
                for x in 0..EDGE {
                    row[x] = a[x] + (b[x] - a[x]) * share(z);
                }
            }
            for (y, row) in layer.chunks_exact_mut(EDGE).enumerate() {
                let [a, b] = [&plane[y / WORD], &plane[y / WORD + 1]];
                for x in 0..EDGE {
                    let filled = a[x] + (b[x] - a[x]) * share(y);
                    row[x] = Filled((filled * FILLED_PER_VOXEL + 0.5) as u16);
                }
            }
        }
    }
}

/// Returns the table of brick `b`.
#[inline(always)]
pub(super) fn table(grid: &Grid, b: UVec3) -> Table {
    let (words, first) = (WordReader::new(grid), b.as_ivec3() * 2 - 1);
    let mut around: WordsAround = [[[0; 4]; 4]; 4];
    for part in 0..8usize {
        let [x, y, z] = [part << 1 & 2, part & 2, part >> 1 & 2];
        let cube = words.cube(first + IVec3::new(x as i32, y as i32, z as i32));
        for (i, word) in cube.into_iter().enumerate() {
            around[z + (i >> 2)][y + (i >> 1 & 1)][x + (i & 1)] = word;
        }
    }
    table_of(&around)
}

/// Returns the table of a brick: sums of eight of the words in and around it.
#[inline(always)]
pub(crate) fn table_of(around: &WordsAround) -> Table {
    let mut in_planes = [[[0; CORNERS]; CORNERS]; 4];
    for (plane, sums) in around.iter().zip(&mut in_planes) {
        let mut along_x = [[0; CORNERS]; 4];
        for (row, sums) in plane.iter().zip(&mut along_x) {
            for x in 0..CORNERS {
                sums[x] = (row[x].count_ones() + row[x + 1].count_ones()) as u16;
            }
        }
        for y in 0..CORNERS {
            for x in 0..CORNERS {
                sums[y][x] = along_x[y][x] + along_x[y + 1][x];
            }
        }
    }
    let mut table = Table::default();
    for z in 0..CORNERS {
        for y in 0..CORNERS {
            for x in 0..CORNERS {
                table[z][y][x] = in_planes[z][y][x] + in_planes[z + 1][y][x];
            }
        }
    }
    table
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

    /// Computes the definition, voxel by voxel: the share of each word, times its part within the cube.
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
        // More bricks than cached tables.
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
