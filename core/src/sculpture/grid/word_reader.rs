//! Looks up words of 4^3 voxels by their coordinates, for kernels that read small neighbourhoods.

use glam::IVec3;

use super::Grid;

/// Read access to the words of a grid.
#[derive(Clone, Copy, Debug)]
pub struct WordReader<'a> {
    grid: &'a Grid,
    /// Size of the grid in words.
    dims: IVec3,
}

impl<'a> WordReader<'a> {
    /// Returns read access to the words of `grid`.
    #[inline]
    pub fn new(grid: &'a Grid) -> WordReader<'a> {
        WordReader { grid, dims: grid.brick_dims().as_ivec3() * 2 }
    }

    /// Returns the eight words of the cube whose lower corner is the word at `corner`, x fastest; 0 outside the grid.
    #[inline]
    pub fn cube(&self, corner: IVec3) -> [u64; 8] {
        std::array::from_fn(|i| {
            let w = corner + (IVec3::splat(i as i32) >> IVec3::new(0, 1, 2) & 1);
            let exists = w.cmpge(IVec3::ZERO).all() && w.cmplt(self.dims).all();
            let in_brick = (w & 1).as_uvec3();
            let word = in_brick.x | in_brick.y << 1 | in_brick.z << 2;
            match exists {
                true => self.grid.brick(IVec3::as_uvec3(w >> 1)).words[word as usize & 7],
                false => 0,
            }
        })
    }
}
