//! Reads a grid: single bricks by coordinates or linear index, the non-empty ones, rows along x, occupancy by blocks of
//! 4^3 bricks, and bounding boxes.
//!
//! Reveals nothing about how bricks are stored. Reads only; allocates nothing.

use glam::UVec3;

use super::{BRICK_EDGE_VX, Grid};
use crate::sculpture::brick::{Brick, BrickKind, local_coords, word_bounds};

impl Grid {
    /// Returns the number of bricks, empty ones included: the length of a table with an entry per brick.
    #[inline]
    pub fn brick_count(&self) -> usize {
        self.bricks.len()
    }

    /// Returns the brick at brick coordinates `b`, which must be inside.
    #[inline(always)]
    pub fn brick(&self, b: UVec3) -> &Brick {
        &self.bricks[self.brick_index(b)]
    }

    /// Returns the brick of a linear brick index ([`Grid::brick_index`]).
    #[inline(always)]
    pub fn brick_at(&self, index: usize) -> &Brick {
        &self.bricks[index]
    }

    /// Returns whether the brick of a linear brick index is empty, full or neither, without reading the bits.
    #[inline(always)]
    pub fn brick_kind(&self, index: usize) -> BrickKind {
        BrickKind::of_count(self.counts[index])
    }

    /// Returns the non-empty bricks with their brick coordinates, x fastest, then y, then z.
    pub fn nonempty_bricks(&self) -> impl Iterator<Item = (UVec3, &Brick)> {
        let UVec3 { y: height, z: depth, .. } = self.brick_dims;
        (0..depth).flat_map(move |z| {
            (0..height).flat_map(move |y| {
                self.nonempty_in_row(y, z).map(move |(x, brick)| (UVec3::new(x, y, z), brick))
            })
        })
    }

    /// Returns the non-empty bricks of the row along x at brick coordinates (y, z), each with its x, in ascending
    /// order.
    #[inline]
    pub fn nonempty_in_row(&self, y: u32, z: u32) -> impl Iterator<Item = (u32, &Brick)> {
        let start = UVec3::new(0, y, z);
        let first = self.brick_index(start);
        let (word, bit) = self.occupancy_place(start);
        let words = &self.occupancy[word..word + self.occupancy_dims.x as usize];
        (0..).step_by(4).zip(words).flat_map(move |(x, word)| {
            let bits = word >> bit & 0xF;
            let set = (0..4).filter(move |i| bits >> i & 1 != 0);
            set.map(move |i| (x + i, &self.bricks[first + (x + i) as usize]))
        })
    }

    /// Copies as many bricks along x as `target` has room for, starting at brick coordinates `first`: 64 bytes each, as
    /// they lie in memory. The row must be long enough.
    #[inline]
    pub fn copy_row(&self, first: UVec3, target: &mut [u8]) {
        let first = self.brick_index(first);
        let row = &self.bricks[first..first + target.len() / size_of::<Brick>()];
        target.copy_from_slice(bytemuck::cast_slice(row));
    }

    /// Returns the size of the grid in blocks of 4^3 bricks, the unit of occupancy words.
    #[inline]
    pub fn occupancy_dims(&self) -> UVec3 {
        self.occupancy_dims
    }

    /// Returns the occupancy of the block of 4^3 bricks at block coordinates `block`, which must be inside: a bit per
    /// brick, set if it is not empty, ordered as the voxels of a brick's word.
    #[inline(always)]
    pub fn occupancy_word(&self, block: UVec3) -> u64 {
        let UVec3 { x: width, y: height, .. } = self.occupancy_dims;
        self.occupancy[(block.x + width * (block.y + height * block.z)) as usize]
    }

    /// Returns the occupancy word of the block around the brick at `b`, and the brick's bit in it.
    #[inline(always)]
    pub(crate) fn occupancy_around(&self, b: UVec3) -> (u64, u32) {
        let (word, bit) = self.occupancy_place(b);
        (self.occupancy[word], bit)
    }

    /// Returns the bounding box of the non-empty bricks, in voxels and cut to the grid: its lowest voxel and one past
    /// its highest. `None` if the grid is empty.
    pub fn bounds_vx(&self) -> Option<(UVec3, UVec3)> {
        let (mut low, mut high) = (UVec3::MAX, UVec3::ZERO);
        let UVec3 { x: width, y: height, .. } = self.occupancy_dims;
        for (row, words) in (0..).zip(self.occupancy.chunks_exact(width as usize)) {
            let mut first = UVec3::new(0, row % height, row / height) * 4;
            for &word in words {
                // Most lie within the bounds known so far.
                if word != 0 && !(first.cmpge(low).all() && (first + 4).cmple(high).all()) {
                    let (word_low, word_high) = word_bounds(word);
                    low = low.min(first + word_low);
                    high = high.max(first + word_high);
                }
                first.x += 4;
            }
        }
        let edge = BRICK_EDGE_VX;
        (low.x != u32::MAX).then(|| (low * edge, (high * edge).min(self.dims)))
    }

    /// Returns the smallest box of voxels that holds every existing one, `min` inclusive and `max` exclusive. `None` if
    /// the grid is empty.
    pub fn opaque_bounds(&self) -> Option<(UVec3, UVec3)> {
        let (mut min, mut max) = (UVec3::MAX, UVec3::ZERO);
        for (b, brick) in self.nonempty_bricks() {
            let low = b * BRICK_EDGE_VX;
            // Only a brick that extends beyond the box so far needs a closer look.
            if low.cmpge(min).all() && (low + BRICK_EDGE_VX).cmple(max).all() {
                continue;
            }
            brick.for_each(|local| {
                let v = low + UVec3::from(local_coords(local));
                min = min.min(v);
                max = max.max(v + 1);
            });
        }
        (self.opaque > 0).then_some((min, max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        /// All ways of reading bricks agree with the bricks by index.
        #[test]
        fn readers_agree(
            dims in prop::array::uniform3(1u32..90),
            writes in prop::collection::vec((any::<prop::sample::Index>(), any::<[u64; 8]>(), 0..3), 0..12),
        ) {
            let mut grid = Grid::new(UVec3::from(dims), Vec3::ONE, 1 << 30).unwrap();
            for (index, words, kind) in writes {
                let index = index.index(grid.brick_count());
                let brick = [Brick::EMPTY, Brick { words }, Brick::FULL][kind as usize];
                grid.set_brick(index, brick.and(&grid.valid_mask(grid.brick_coords(index))));
            }
            let all = || (0..grid.brick_count()).map(|index| (grid.brick_coords(index), *grid.brick_at(index)));
            let expected: Vec<_> = all().filter(|(_, brick)| !brick.is_empty()).collect();
            let found: Vec<_> = grid.nonempty_bricks().map(|(b, brick)| (b, *brick)).collect();
            prop_assert_eq!(found, expected);
            for (index, (b, brick)) in all().enumerate() {
                prop_assert_eq!(*grid.brick(b), brick);
                prop_assert_eq!(grid.brick_kind(index), BrickKind::of_count(brick.count()));
                let (word, bit) = grid.occupancy_around(b);
                prop_assert_eq!(word >> bit & 1 != 0, !brick.is_empty());
                prop_assert_eq!(word, grid.occupancy_word(b / 4));
            }
            // Rows, whole and from their second brick on.
            let UVec3 { x: width, y: height, z: depth } = grid.brick_dims();
            for first in [0, 1.min(width - 1)] {
                let mut bytes = vec![0; (width - first) as usize * size_of::<Brick>()];
                for (y, z) in (0..height).flat_map(|y| (0..depth).map(move |z| (y, z))) {
                    grid.copy_row(UVec3::new(first, y, z), &mut bytes);
                    for (x, words) in (first..).zip(bytes.chunks(size_of::<Brick>())) {
                        let brick = grid.brick(UVec3::new(x, y, z));
                        prop_assert_eq!(words, bytemuck::bytes_of(brick));
                    }
                }
            }
        }
    }
}
