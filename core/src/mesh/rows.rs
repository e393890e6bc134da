//! The voxels of some layers of a grid as rows of bits along x, the form in which surfaces are found: a shift compares
//! 64 voxels with their neighbours.
//!
//! Takes a grid and a range of layers, which may extend beyond it; returns rows, empty beyond the grid.

use std::ops::Range;

use glam::{UVec2, UVec3};

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, BrickKind};

/// A box of cells of the lattice of voxel corners, identified by their lowest corners. It may end with the lattice.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LatticeCells {
    /// Along x: starting at the first voxel of a brick, at most [`LatticeCells::MOST_ALONG_X`].
    pub x: Range<u32>,
    /// Along y.
    pub y: Range<u32>,
    /// Along z.
    pub z: Range<u32>,
}

impl LatticeCells {
    /// Makes a row of cells, with a brick before and one after it, fit into one word.
    pub const MOST_ALONG_X: u32 = 64 - 2 * BRICK_EDGE_VX;

    /// Returns whether the cell of this corner is in the box.
    pub fn contains(&self, [x, y, z]: [u16; 3]) -> bool {
        self.x.contains(&x.into()) && self.y.contains(&y.into()) && self.z.contains(&z.into())
    }

    /// Returns whether earlier cells may have the corner, too, which must belong to one of these.
    pub(crate) fn is_shared(&self, [x, y, z]: [u16; 3]) -> bool {
        let starts = [self.x.start, self.y.start, self.z.start];
        [x, y, z].map(u32::from).iter().zip(starts).any(|(at, start)| *at == start)
    }
}

/// Rows of voxels of the layers `first_z..`: all of them, or those around a box of cells. In the latter case, rows
/// count from the box, and along x from the brick before it.
pub struct VoxelRows {
    first_z: i64,
    /// The first voxel of the rows, a multiple of a brick's edge; the first existing row; and the row that counts as 0;
    /// all in the grid.
    first_x: i64,
    first_y: i64,
    y_0: i64,
    /// Rows of a layer.
    height: usize,
    /// Words of a row: one bit more than voxels, for the corners of the lattice.
    width: usize,
    bits: Vec<u64>,
    empty: Vec<u64>,
    /// The corners that count, and those whose faces count, by words.
    pub corner_mask: Vec<u64>,
    pub face_mask: Vec<u64>,
    /// The number of rows of corners, and of those whose faces count.
    pub corner_rows: usize,
    pub face_rows: usize,
    /// The voxels beside the corners, along x and y, and beyond the grid.
    beside: [Range<i64>; 2],
}

/// Returns the words of a row of the corners of a lattice around `dims` voxels.
pub(crate) fn row_words(dims: UVec3) -> usize {
    (dims.x as usize + 1).div_ceil(64)
}

impl VoxelRows {
    /// Returns the voxels of `grid` in the layers `layers` along z.
    pub fn of(grid: &Grid, layers: Range<i64>) -> VoxelRows {
        let dims = grid.dims();
        let all = VoxelRows::read(grid, layers, 0, row_words(dims), 0..dims.y.into());
        let corner_rows = dims.y as usize + 1;
        VoxelRows { corner_rows, face_rows: corner_rows, ..all }
    }

    /// Returns the voxels around the corners of some cells.
    pub fn around(grid: &Grid, cells: &LatticeCells) -> VoxelRows {
        let dims = grid.dims();
        let layers = i64::from(cells.z.start) - 1..i64::from(cells.z.end) + 1;
        let first_x = i64::from(cells.x.start) - i64::from(BRICK_EDGE_VX);
        let (first, end) = (i64::from(cells.y.start), i64::from(cells.y.end));
        let mut rows = VoxelRows::read(grid, layers, first_x, 1, first - 1..end + 1);
        rows.y_0 = first;
        rows.face_rows = cells.y.len();
        rows.corner_rows = cells.y.len() + usize::from(cells.y.end <= dims.y);
        let bits = |count: u32| (u64::MAX >> (64 - count)) << BRICK_EDGE_VX;
        let length = cells.x.end - cells.x.start;
        rows.face_mask = vec![bits(length)];
        // With the lowest corners of the next cells.
        rows.corner_mask = vec![bits(length + 1)];
        rows.beside =
            [i64::from(cells.x.start) - 1..i64::from(cells.x.end) + 1, first - 1..end + 1];
        rows
    }

    /// Returns the voxels of some layers and rows of the grid, or beyond it, and of `width` words along x.
    fn read(
        grid: &Grid,
        layers: Range<i64>,
        first_x: i64,
        width: usize,
        rows: Range<i64>,
    ) -> VoxelRows {
        let dims = grid.dims();
        let height = (rows.end - rows.start) as usize;
        let depth = (layers.end - layers.start) as usize;
        let edge = i64::from(BRICK_EDGE_VX);
        let bricks = |voxels: Range<i64>, axis: u32| {
            let inside = voxels.start.max(0)..voxels.end.min(axis.into());
            inside.start.div_euclid(edge)..(inside.end + edge - 1).div_euclid(edge)
        };
        let end_x = first_x + 64 * width as i64;
        let (bricks_x, bricks_y) = (bricks(first_x..end_x, dims.x), bricks(rows.clone(), dims.y));
        let mut read = VoxelRows {
            first_z: layers.start,
            first_x,
            first_y: rows.start,
            y_0: rows.start,
            height,
            width,
            bits: vec![0; width * height * depth],
            empty: vec![0; width],
            corner_mask: vec![u64::MAX; width],
            face_mask: vec![u64::MAX; width],
            corner_rows: 0,
            face_rows: 0,
            beside: [0..dims.x.into(), 0..dims.y.into()],
        };
        let inside = layers.start.max(0)..layers.end.min(dims.z.into());
        for brick_z in bricks(layers, dims.z) {
            let from = inside.start.max(brick_z * edge);
            let to = inside.end.min((brick_z + 1) * edge);
            for y in bricks_y.clone() {
                for x in bricks_x.clone() {
                    read.put(grid, UVec3::new(x as u32, y as u32, brick_z as u32), from..to);
                }
            }
        }
        read
    }

    /// Returns the number of words of a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the position of x = 0 and y = 0 in the grid.
    pub fn origin(&self) -> [i32; 2] {
        [self.first_x as i32, self.y_0 as i32]
    }

    /// Returns the bricks along x and y, among `brick_dims`, that have voxels beside the corners.
    pub(crate) fn bricks_beside(&self, brick_dims: UVec2) -> [Range<u32>; 2] {
        let edge = i64::from(BRICK_EDGE_VX);
        let bricks = |voxels: &Range<i64>, most: u32| {
            let of = |voxel: i64| voxel.div_euclid(edge).clamp(0, most.into()) as u32;
            of(voxels.start)..of(voxels.end + edge - 1)
        };
        let [x, y] = &self.beside;
        [bricks(x, brick_dims.x), bricks(y, brick_dims.y)]
    }

    /// Sets the voxels of a brick in `layers`.
    fn put(&mut self, grid: &Grid, b: UVec3, layers: Range<i64>) {
        let slices = match grid.brick_kind(grid.brick_index(b)) {
            BrickKind::Empty => return,
            BrickKind::Full => [u64::MAX; 8],
            BrickKind::Mixed => grid.brick(b).to_rows(),
        };
        let x = (i64::from(b.x * BRICK_EDGE_VX) - self.first_x) as usize;
        let (word, shift) = (x / 64, x % 64);
        let first_y = i64::from(b.y * BRICK_EDGE_VX) - self.first_y;
        let rows = (-first_y).max(0)..(self.height as i64 - first_y).min(BRICK_EDGE_VX.into());
        for z in layers {
            let slice = slices[z as usize % 8];
            let layer = (z - self.first_z) * self.height as i64 + first_y;
            for y in rows.clone() {
                let byte = slice >> (8 * y) & 0xFF;
                self.bits[(layer + y) as usize * self.width + word] |= byte << shift;
            }
        }
    }

    /// Returns the number of faces between an existing voxel and an empty one, among the lower faces of the voxels of
    /// some layers along each axis.
    pub fn faces(&self, layers: Range<u32>) -> usize {
        let mut faces = 0;
        let ys = 0..self.face_rows as i64;
        for (z, y) in layers.flat_map(|z| ys.clone().map(move |y| (i64::from(z), y))) {
            let (here, below, before) = (self.row(y, z), self.row(y, z - 1), self.row(y - 1, z));
            for i in 0..self.width {
                let others = [moved_up(here, i), below[i], before[i]];
                let mask = self.face_mask[i];
                let counts = others.map(|other| ((other ^ here[i]) & mask).count_ones());
                faces += counts.iter().sum::<u32>() as usize;
            }
        }
        faces
    }

    /// Returns the row at (y, z): bit x of its words is the voxel at x. Empty beyond the grid.
    #[inline]
    pub fn row(&self, y: i64, z: i64) -> &[u64] {
        let layers = (self.bits.len() / (self.width * self.height)) as i64;
        let layer = z - self.first_z;
        let y = y + self.y_0 - self.first_y;
        if !(0..self.height as i64).contains(&y) || !(0..layers).contains(&layer) {
            return &self.empty;
        }
        let first = (layer as usize * self.height + y as usize) * self.width;
        &self.bits[first..first + self.width]
    }
}

/// Returns word `i` of the row moved up by one voxel: bit x is bit x - 1 of the row.
#[inline(always)]
pub(crate) fn moved_up(row: &[u64], i: usize) -> u64 {
    row[i] << 1 | if i > 0 { row[i - 1] >> 63 } else { 0 }
}

/// Returns word `i` of the row moved down by one voxel: bit x is bit x + 1 of the row.
#[inline(always)]
pub(crate) fn moved_down(row: &[u64], i: usize) -> u64 {
    row[i] >> 1 | row.get(i + 1).map_or(0, |next| next << 63)
}

/// The positions of the set bits in the words of one row, in ascending order.
///
/// Eight positions are written at a time, needed or not: a loop with as many steps as a word has bits is mostly
/// mispredicted, and costs more than the steps. (The method of simdjson: Langdale and Lemire, "Parsing gigabytes of
/// JSON per second", 2019, section 3.2.)
pub struct BitPlaces {
    /// Entries after the first `count` are unspecified.
    places: Vec<u16>,
    count: usize,
}

impl BitPlaces {
    /// Returns an empty list for rows of `width` words, at most 1024.
    pub fn new(width: usize) -> BitPlaces {
        BitPlaces { places: vec![0; 64 * width + 8], count: 0 }
    }

    /// Begins a row.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the positions of the word `i` of the row.
    #[inline(always)]
    pub fn add(&mut self, i: usize, word: u64) {
        let (mut rest, mut at) = (word, self.count);
        self.count += word.count_ones() as usize;
        while let Some(places) = self.places[at..].first_chunk_mut::<8>() {
            for place in places {
                *place = (64 * i) as u16 + rest.trailing_zeros() as u16;
                rest &= rest.wrapping_sub(1);
            }
            if rest == 0 {
                break;
            }
            at += 8;
        }
    }

    /// Returns the positions of the words that were added since the row began.
    #[inline(always)]
    pub fn of_row(&self) -> &[u16] {
        &self.places[..self.count]
    }
}

/// Transposes 8 x 8 bits: byte `i` of the result has bit `i` of the bytes at `byte` of eight words, that of the first
/// word lowest. (Warren, "Hacker's Delight", 2nd edition, section 7-3.)
#[inline(always)]
pub fn columns(words: &[u64; 8], byte: usize) -> [u8; 8] {
    let mut bits = 0;
    for (row, word) in words.iter().enumerate() {
        bits |= (word >> (8 * byte) & 0xFF) << (8 * row);
    }
    for (distance, mask) in
        [(7, 0x00AA_00AA_00AA_00AA), (14, 0x0000_CCCC_0000_CCCC), (28, 0x0000_0000_F0F0_F0F0)]
    {
        let swapped = (bits ^ bits >> distance) & mask;
        bits ^= swapped ^ swapped << distance;
    }
    bits.to_le_bytes()
}

/// Calls `f` with the positions of the set bits, in ascending order.
#[inline(always)]
pub(crate) fn for_each_bit(mut bits: u64, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;
    use glam::{IVec3, Vec3};

    #[test]
    fn columns_are_bits_of_one_place() {
        let mut random = Random(7);
        let words: [u64; 8] = std::array::from_fn(|_| random.next_u64());
        for place in 0..64 {
            let expected = (0..8).fold(0, |all, row| all | (words[row] >> place & 1) << row);
            assert_eq!(u64::from(columns(&words, place / 8)[place % 8]), expected);
        }
    }

    #[test]
    fn rows_are_the_voxels() {
        let dims = UVec3::new(131, 11, 19);
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 20).unwrap();
        let mut random = Random(3);
        for _ in 0..4000 {
            grid.set(random.voxel(dims), true);
        }
        grid.set_brick(0, crate::sculpture::Brick::FULL);
        let rows = VoxelRows::of(&grid, -1..13);
        for z in -2..15 {
            for y in -1..12 {
                for x in 0..132 {
                    let expected = z < 13 && grid.get(IVec3::new(x, y, z));
                    let row = rows.row(y.into(), z.into());
                    assert_eq!(row[x as usize / 64] >> (x % 64) & 1 != 0, expected, "{x} {y} {z}");
                    if x > 0 {
                        let up = moved_up(row, x as usize / 64) >> (x % 64) & 1 != 0;
                        assert_eq!(up, z < 13 && grid.get(IVec3::new(x - 1, y, z)));
                    }
                    let down = moved_down(row, x as usize / 64) >> (x % 64) & 1 != 0;
                    assert_eq!(down, z < 13 && grid.get(IVec3::new(x + 1, y, z)));
                }
            }
        }
    }
}
