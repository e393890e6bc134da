//! The voxels of some layers of a grid as rows of bits along x, the form in which surfaces are found: a shift
//! compares 64 voxels with their neighbours.
//!
//! Takes a grid and a range of layers, which may reach beyond it; gives rows, empty beyond the grid.

use std::ops::Range;

use glam::UVec3;

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, BrickKind};

/// Rows of voxels of the layers `first_z..`.
pub struct Rows {
    first_z: i64,
    height: usize,
    /// Words of a row: one bit more than voxels, for the corners of the lattice.
    width: usize,
    bits: Vec<u64>,
    empty: Vec<u64>,
}

/// Words of a row of the corners of a lattice around `dims` voxels.
pub fn row_words(dims: UVec3) -> usize {
    (dims.x as usize + 1).div_ceil(64)
}

impl Rows {
    /// The voxels of `grid` in the layers `layers` along z.
    pub fn of(grid: &Grid, layers: Range<i64>) -> Rows {
        let dims = grid.dims();
        let (width, height) = (row_words(dims), dims.y as usize);
        let depth = (layers.end - layers.start) as usize;
        let mut rows = Rows {
            first_z: layers.start,
            height,
            width,
            bits: vec![0; width * height * depth],
            empty: vec![0; width],
        };
        let edge = i64::from(BRICK_EDGE_VX);
        let inside = layers.start.max(0)..layers.end.min(dims.z.into());
        for brick_z in inside.start.div_euclid(edge)..(inside.end + edge - 1).div_euclid(edge) {
            let from = inside.start.max(brick_z * edge);
            let to = inside.end.min((brick_z + 1) * edge);
            for y in 0..grid.brick_dims().y {
                for x in 0..grid.brick_dims().x {
                    rows.put(grid, UVec3::new(x, y, brick_z as u32), from..to);
                }
            }
        }
        rows
    }

    /// Sets the voxels of a brick in `layers`.
    fn put(&mut self, grid: &Grid, b: UVec3, layers: Range<i64>) {
        let slices = match grid.brick_kind(grid.brick_index(b)) {
            BrickKind::Empty => return,
            BrickKind::Full => [u64::MAX; 8],
            BrickKind::Mixed => grid.brick(b).to_rows(),
        };
        let (word, shift) = (b.x as usize / 8, b.x % 8 * 8);
        let first_y = (b.y * BRICK_EDGE_VX) as usize;
        let room = (self.height - first_y).min(BRICK_EDGE_VX as usize);
        for z in layers {
            let slice = slices[z as usize % 8];
            let layer = (z - self.first_z) as usize * self.height;
            for y in 0..room {
                let byte = slice >> (8 * y) & 0xFF;
                self.bits[(layer + first_y + y) * self.width + word] |= byte << shift;
            }
        }
    }

    /// Number of faces between an existing voxel and an empty one, of those that the voxels of some layers have below
    /// them along each axis.
    pub fn faces(&self, layers: Range<u32>) -> usize {
        let mut faces = 0;
        for (z, y) in layers.flat_map(|z| (0..=self.height as i64).map(move |y| (i64::from(z), y)))
        {
            let (here, below, before) = (self.row(y, z), self.row(y, z - 1), self.row(y - 1, z));
            for i in 0..self.width {
                let others = [moved_up(here, i), below[i], before[i]];
                faces +=
                    others.map(|other| (other ^ here[i]).count_ones()).iter().sum::<u32>() as usize;
            }
        }
        faces
    }

    /// The row at (y, z): bit x of its words is the voxel at x. Empty beyond the grid.
    #[inline]
    pub fn row(&self, y: i64, z: i64) -> &[u64] {
        let layers = (self.bits.len() / (self.width * self.height)) as i64;
        let layer = z - self.first_z;
        if !(0..self.height as i64).contains(&y) || !(0..layers).contains(&layer) {
            return &self.empty;
        }
        let first = (layer as usize * self.height + y as usize) * self.width;
        &self.bits[first..first + self.width]
    }
}

/// Bit x is bit x - 1 of the row: word `i` of the row moved up by one voxel.
#[inline(always)]
pub fn moved_up(row: &[u64], i: usize) -> u64 {
    row[i] << 1 | if i > 0 { row[i - 1] >> 63 } else { 0 }
}

/// Bit x is bit x + 1 of the row.
#[inline(always)]
pub fn moved_down(row: &[u64], i: usize) -> u64 {
    row[i] >> 1 | row.get(i + 1).map_or(0, |next| next << 63)
}

/// The places of the bits that are set in the words of one row, rising.
///
/// Eight places are written at a time, needed or not: a loop that ends after as many steps as a word has bits is
/// mostly mispredicted, and costs more than the steps. (The way of simdjson: Langdale and Lemire, "Parsing gigabytes of
/// JSON per second", 2019, section 3.2.)
pub struct Places {
    /// Those after the first `count` mean nothing.
    places: Vec<u16>,
    count: usize,
}

impl Places {
    /// For rows of `width` words, at most 1024.
    pub fn new(width: usize) -> Places {
        Places { places: vec![0; 64 * width + 8], count: 0 }
    }

    /// Begins a row.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the places of the word `i` of the row.
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

    /// The places of the words that were added since the row began.
    #[inline(always)]
    pub fn of_row(&self) -> &[u16] {
        &self.places[..self.count]
    }
}

/// Byte `i` has the bits of place `i` of the bytes at `byte` of eight words: that of the first word is its lowest.
/// (A transposition of 8 x 8 bits; Warren, "Hacker's Delight", 2nd edition, section 7-3.)
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

/// Calls `f` with the places of the bits that are set, rising.
#[inline(always)]
pub fn for_each_bit(mut bits: u64, mut f: impl FnMut(usize)) {
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
        let rows = Rows::of(&grid, -1..13);
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
