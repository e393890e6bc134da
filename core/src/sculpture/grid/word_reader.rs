//! Looks up words of 4^3 voxels by their coordinates, for kernels that read small neighbourhoods.
//!
//! A word has a place, the sum of one part per axis, so that the places of sixteen neighbourhoods are
//! computed at once with vectors and neighbours share the parts of their common coordinates. What lies
//! outside of the grid has a place, too, at which nothing exists. What a place means is private to the
//! grid: here an index into its words, in a table of chunks that of a chunk and of a word in it.

use fearless_simd::{Simd, i32x16, prelude::*};
use glam::IVec3;

use super::Grid;
use crate::sculpture::brick::BRICK_WORDS;

/// Read access to the words of a grid.
#[derive(Clone, Copy, Debug)]
pub struct WordReader<'a> {
    words: &'a [u64],
    /// Size of the grid in words.
    dims: IVec3,
    /// From a brick to the next along each axis, in words.
    stride: IVec3,
}

/// From a word of a brick to the next along each axis, in words.
const STEP: IVec3 = IVec3::new(1, 2, 4);

/// Part of a place that lies outside of the grid: beyond any word that exists, also after other parts
/// have been added.
const OUTSIDE: i32 = 1 << 29;

impl Grid {
    /// Read access by words of 4^3 voxels.
    #[inline]
    pub fn words(&self) -> WordReader<'_> {
        let bricks = self.brick_dims.as_ivec3();
        let stride = BRICK_WORDS as i32 * IVec3::new(1, bricks.x, bricks.x * bricks.y);
        WordReader { words: bytemuck::cast_slice(&self.bricks), dims: bricks * 2, stride }
    }
}

impl WordReader<'_> {
    /// The word at `place`, the sum of three parts of [`WordReader::parts`]; 0 outside of the grid.
    #[inline(always)]
    pub fn word(&self, place: usize) -> u64 {
        self.words.get(place).copied().unwrap_or(0)
    }

    /// The parts of places along `axis` of the words with coordinate `lower` on it, and of those with
    /// `lower + 1`. `lower` must be at least -1 and less than the size of the grid in words.
    #[inline(always)]
    pub fn parts<S: Simd>(&self, simd: S, axis: usize, lower: i32x16<S>) -> (i32x16<S>, i32x16<S>) {
        let outside = i32x16::splat(simd, OUTSIDE);
        let (stride, step) = (self.stride[axis], STEP[axis]);
        let upper = lower + 1;
        (
            lower.simd_lt(0).select(outside, part(lower, stride, step)),
            upper.simd_ge(self.dims[axis]).select(outside, part(upper, stride, step)),
        )
    }

    /// The eight words of the cube whose lower corner is the word at `corner`, x fastest; 0 outside of
    /// the grid.
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

/// The parts of words along an axis. A function and not a closure: what is not inlined loses the
/// instructions that the dispatch chose.
#[inline(always)]
fn part<S: Simd>(word: i32x16<S>, stride: i32, step: i32) -> i32x16<S> {
    (word >> 1) * stride + (word & 1) * step
}
