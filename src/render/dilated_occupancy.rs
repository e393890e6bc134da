//! Dilated occupancy: the bricks that are in use or touch one in use by a side, an edge or a corner. A bundle of rays
//! up to a brick wide to either side meets nothing in a region without any of them (shaders/beam.comp.wgsl).
//!
//! Takes the occupancy of a grid; returns words of 4^3 bricks, a bit each, like [`Grid::occupancy_word`], with a margin
//! of one block at each side of the grid for bricks outside of it. Knows no device.

use std::ops::Range;

use glam::UVec3;

use crate::sculpture::Grid;

/// The bits of the lowest and the highest bricks of a word along each axis, and the distance of
/// neighbours.
const AXES: [(u64, u64, u32); 3] = [
    (0x1111_1111_1111_1111, 0x8888_8888_8888_8888, 1),
    (0x000F_000F_000F_000F, 0xF000_F000_F000_F000, 4),
    (0x0000_0000_0000_FFFF, 0xFFFF_0000_0000_0000, 16),
];

/// The dilated occupancy of a grid.
pub struct DilatedOccupancy {
    words: Vec<u64>,
    dims: UVec3,
    /// A slab in progress; reused allocation.
    slab: Vec<u64>,
}

impl DilatedOccupancy {
    /// Computes the dilated occupancy of `grid`.
    pub fn new(grid: &Grid) -> DilatedOccupancy {
        let dims = grid.occupancy_dims() + 2;
        let slab = (dims.x * dims.y) as usize;
        let words = vec![0; slab * dims.z as usize];
        let mut dilated = DilatedOccupancy { words, dims, slab: vec![0; slab] };
        dilated.update(grid, 0..grid.occupancy_dims().z);
        dilated
    }

    /// Updates it after a change in `slabs` of blocks of a grid of the same size. Returns the slabs
    /// of the words that may have changed.
    pub fn update(&mut self, grid: &Grid, slabs: Range<u32>) -> Range<u32> {
        let changed = slabs.start..(slabs.end + 2).min(self.dims.z);
        for z in changed.clone() {
            self.make_slab(grid, z);
        }
        changed
    }

    /// Returns one word per block.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// Returns the size of the words along each axis.
    pub fn dims(&self) -> UVec3 {
        self.dims
    }

    fn make_slab(&mut self, grid: &Grid, z: u32) {
        let blocks = grid.occupancy_dims();
        let width = self.dims.x as usize;
        // Words of the grid's blocks; nothing beyond it.
        let word_at = |x: u32, y: u32, z: Option<u32>| match z {
            Some(z) if z < blocks.z => grid.occupancy_word(UVec3::new(x, y, z)),
            _ => 0,
        };
        self.slab.fill(0);
        for y in 0..blocks.y {
            let first = (y as usize + 1) * width + 1;
            for (x, word) in (0..).zip(&mut self.slab[first..first + blocks.x as usize]) {
                let [below, here, above] =
                    [z.checked_sub(2), z.checked_sub(1), Some(z)].map(|z| word_at(x, y, z));
                *word = spread(2, below, here, above);
            }
        }
        let size = self.slab.len();
        let target = &mut self.words[z as usize * size..(z as usize + 1) * size];
        let at = |slab: &[u64], i: Option<usize>| i.and_then(|i| slab.get(i)).copied().unwrap_or(0);
        for (i, word) in target.iter_mut().enumerate() {
            let [before, after] = [i.checked_sub(width), Some(i + width)];
            *word = spread(1, at(&self.slab, before), self.slab[i], at(&self.slab, after));
        }
        // The outermost words of a row reach no further: the ends of rows only meet words of the margin, whose bits
        // point inwards.
        let mut before = 0;
        for i in 0..size {
            let here = target[i];
            let after = if i + 1 < size { target[i + 1] } else { 0 };
            target[i] = spread(0, before, here, after);
            before = here;
        }
    }
}

/// Returns a word dilated along `axis`; `before` and `after` are its neighbours.
fn spread(axis: usize, before: u64, here: u64, after: u64) -> u64 {
    let (lowest, highest, distance) = AXES[axis];
    here | (here & !highest) << distance
        | (here & !lowest) >> distance
        | (after & lowest) << (3 * distance)
        | (before & highest) >> (3 * distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::Brick;
    use glam::IVec3;
    use proptest::prelude::*;

    fn bit(words: &[u64], dims: UVec3, brick: UVec3) -> bool {
        let block = brick / 4;
        let word = words[(block.x + dims.x * (block.y + dims.y * block.z)) as usize];
        word >> (brick.x % 4 + brick.y % 4 * 4 + brick.z % 4 * 16) & 1 != 0
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Checks the state at first, and after changes in some slabs.
        #[test]
        fn bricks_that_touch_one_in_use_are_set(
            bricks in (1u32..10, 1u32..10, 1u32..14),
            used in prop::collection::vec(any::<prop::sample::Index>(), 0..12),
            later in prop::collection::vec(any::<prop::sample::Index>(), 0..4),
        ) {
            let bricks = UVec3::from(bricks);
            let mut grid = Grid::new(bricks * 8, glam::Vec3::ONE, 1 << 30).unwrap();
            let count = grid.brick_count();
            for index in &used {
                grid.set_brick(index.index(count), Brick::FULL);
            }
            let mut dilated = DilatedOccupancy::new(&grid);
            for index in &later {
                let index = index.index(count);
                let brick = if grid.brick_at(index).is_empty() { Brick::FULL } else { Brick::EMPTY };
                grid.set_brick(index, brick);
                let slab = grid.brick_coords(index).z / 4;
                dilated.update(&grid, slab..slab + 1);
            }
            let size = dilated.dims() * 4;
            for z in 0..size.z {
                for y in 0..size.y {
                    for x in 0..size.x {
                        let at = UVec3::new(x, y, z).as_ivec3() - 4;
                        let mut expected = false;
                        for i in 0..27 {
                            let beside = at + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
                            let inside = beside.cmpge(IVec3::ZERO).all()
                                && beside.cmplt(bricks.as_ivec3()).all();
                            expected |= inside && {
                                !grid.brick(beside.as_uvec3()).is_empty()
                            };
                        }
                        let found = bit(dilated.words(), dilated.dims(), UVec3::new(x, y, z));
                        prop_assert_eq!(found, expected, "{}", at);
                    }
                }
            }
        }
    }
}
