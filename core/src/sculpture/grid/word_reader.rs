//! Looks up words of 4^3 voxels by their coordinates, for kernels that read small neighbourhoods.

use glam::IVec3;

use super::Grid;
use crate::sculpture::brick::BRICK_WORDS;

/// Read access to the words of a grid.
#[derive(Clone, Copy, Debug)]
pub struct WordReader<'a> {
    words: &'a [u64],
    /// Size of the grid in words.
    dims: IVec3,
    /// The distance from a brick to the next along each axis, in words.
    stride: IVec3,
}

/// The distance from a word of a brick to the next along each axis, in words.
const STEP: IVec3 = IVec3::new(1, 2, 4);

impl<'a> WordReader<'a> {
    /// Returns read access to the words of `grid`.
    #[inline]
    pub fn new(grid: &'a Grid) -> WordReader<'a> {
        let bricks = grid.brick_dims.as_ivec3();
        let stride = BRICK_WORDS as i32 * IVec3::new(1, bricks.x, bricks.x * bricks.y);
        WordReader { words: bytemuck::cast_slice(&grid.bricks), dims: bricks * 2, stride }
    }

    /// Returns the eight words of the cube whose lower corner is the word at `corner`, x fastest; 0 outside the grid.
    #[inline]
    pub fn cube(&self, corner: IVec3) -> [u64; 8] {
        std::array::from_fn(|i| {
            let w = corner + (IVec3::splat(i as i32) >> IVec3::new(0, 1, 2) & 1);
            let exists = w.cmpge(IVec3::ZERO).all() && w.cmplt(self.dims).all();
            let place: IVec3 = (w >> 1) * self.stride + (w & 1) * STEP;
            if exists { self.words[place.element_sum() as usize] } else { 0 }
        })
    }
}
