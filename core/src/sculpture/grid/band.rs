//! Parallel write access to a grid: bands of four slabs of bricks along z, each lent to one task. One occupancy word
//! spans four slabs, so that bands share nothing. Loaders use runs of bricks in linear order.

use std::ops::Range;

use glam::UVec3;
use rayon::prelude::*;

use super::{Grid, unflatten, valid_mask};
use crate::sculpture::brick::{BRICK_VOXELS, Brick};

/// Slabs of bricks in a band.
pub const BAND_SLABS: u32 = 4;

/// The bricks of one band with their counts and occupancy.
pub(in crate::sculpture) struct GridBand<'a> {
    /// Linear index of the band's first brick.
    first: u32,
    dims: UVec3,
    brick_dims: UVec3,
    occupancy_width: u32,
    bricks: &'a mut [Brick],
    counts: &'a mut [u16],
    occupancy: &'a mut [u64],
    opaque_change: i64,
}

impl GridBand<'_> {
    /// Returns the linear index, in the grid, of the brick at brick coordinates `b`.
    #[inline]
    pub fn brick_index(&self, b: UVec3) -> u32 {
        b.x + self.brick_dims.x * (b.y + self.brick_dims.y * b.z)
    }

    /// Returns the slabs of the band that lie in `slabs`.
    pub(crate) fn slabs_of(&self, slabs: Range<u32>) -> Range<u32> {
        let first = self.first / (self.brick_dims.x * self.brick_dims.y);
        slabs.start.max(first)..slabs.end.min(first + BAND_SLABS)
    }

    #[inline]
    pub fn brick(&self, index: u32) -> &Brick {
        &self.bricks[(index - self.first) as usize]
    }

    #[inline]
    pub fn count(&self, index: u32) -> u16 {
        self.counts[(index - self.first) as usize]
    }

    /// Returns the counts of `len` bricks from `index` on.
    #[inline]
    pub fn counts(&self, index: u32, len: u32) -> &[u16] {
        let at = (index - self.first) as usize;
        &self.counts[at..at + len as usize]
    }

    /// Performs [`Grid::valid_mask`].
    #[inline]
    pub fn valid_mask(&self, b: UVec3) -> Brick {
        valid_mask(self.dims, b)
    }

    /// Replaces the brick at brick coordinates `b` and linear index `index` by one of `count` voxels, all of them
    /// within [`GridBand::valid_mask`].
    #[inline(always)]
    pub fn set(&mut self, b: UVec3, index: u32, brick: &Brick, count: u16) {
        debug_assert_eq!(count, brick.count());
        debug_assert_eq!(index, self.brick_index(b));
        let at = (index - self.first) as usize;
        let before = std::mem::replace(&mut self.counts[at], count);
        self.opaque_change += i64::from(count) - i64::from(before);
        self.bricks[at] = *brick;
        if (before == 0) != (count == 0) {
            let word = b.x / 4 + self.occupancy_width * (b.y / 4);
            let bit = (b.x & 3) | (b.y & 3) << 2 | (b.z & 3) << 4;
            self.occupancy[word as usize] ^= 1 << bit;
        }
    }

    /// Fills `len` empty bricks along x, starting at `b`, or empties as many full ones.
    #[inline(always)]
    pub(crate) fn flip_run(&mut self, b: UVec3, index: u32, len: u32, full: bool) {
        let at = (index - self.first) as usize;
        let range = at..at + len as usize;
        let voxels = i64::from(len) * i64::from(BRICK_VOXELS);
        self.opaque_change += if full { voxels } else { -voxels };
        self.bricks[range.clone()].fill(if full { Brick::FULL } else { Brick::EMPTY });
        self.counts[range].fill(if full { BRICK_VOXELS as u16 } else { 0 });
        let row = self.occupancy_width * (b.y / 4);
        let shift = (b.y & 3) << 2 | (b.z & 3) << 4;
        let (first, end) = (b.x, b.x + len);
        for word in first / 4..end.div_ceil(4) {
            let from = first.max(word * 4) & 3;
            let to = end.min(word * 4 + 4) - word * 4;
            let bits = (1u64 << to) - (1 << from);
            self.occupancy[(row + word) as usize] ^= bits << shift;
        }
    }
}

/// The valid bits of bricks by linear index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrickPlaces {
    dims: UVec3,
    brick_dims: UVec3,
}

impl BrickPlaces {
    /// Performs [`Grid::valid_mask`].
    #[inline]
    pub fn valid_mask(&self, index: usize) -> Brick {
        valid_mask(self.dims, unflatten(index as u32, self.brick_dims))
    }
}

impl Grid {
    /// Lets `f` write all bricks, in runs of `run` in linear order, on all threads. `f` gets the linear index of a
    /// run's first brick and the run, and must leave only valid bits. Returns the values of `f` in order, or one of its
    /// errors.
    pub(crate) fn try_fill_runs<T: Send, E: Send>(
        &mut self,
        run: usize,
        f: impl Fn(usize, &mut [Brick], &BrickPlaces) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let places = BrickPlaces { dims: self.dims, brick_dims: self.brick_dims };
        let result = self
            .bricks
            .par_chunks_mut(run)
            .zip(self.counts.par_chunks_mut(run))
            .enumerate()
            .map(|(i, (bricks, counts))| {
                let result = f(i * run, bricks, &places);
                for (count, brick) in counts.iter_mut().zip(bricks) {
                    *count = brick.count();
                }
                result
            })
            .collect();
        self.recount();
        result
    }

    /// Returns the number of bands.
    pub(in crate::sculpture) fn band_count(&self) -> usize {
        self.brick_dims.z.div_ceil(BAND_SLABS) as usize
    }

    /// Returns the number of bricks in a band, which is the distance between the first bricks of successive bands.
    pub(in crate::sculpture) fn bricks_per_band(&self) -> usize {
        (self.brick_dims.x * self.brick_dims.y * BAND_SLABS) as usize
    }

    /// Returns the bands that hold the bricks of `slabs`.
    pub(in crate::sculpture) fn bands_of(&self, slabs: Range<u32>) -> Range<usize> {
        (slabs.start / BAND_SLABS) as usize..slabs.end.div_ceil(BAND_SLABS) as usize
    }

    /// Calls `f` for each band that holds bricks of `slabs`, with its entry of `states` (one per band of the grid); on
    /// all threads if `parallel`.
    pub(in crate::sculpture) fn edit_bands<S: Send>(
        &mut self,
        slabs: Range<u32>,
        parallel: bool,
        states: &mut [S],
        f: &(dyn Fn(&mut GridBand, &mut S) + Sync),
    ) {
        let Range { start, end } = self.bands_of(slabs);
        let (dims, brick_dims) = (self.dims, self.brick_dims);
        let occupancy_width = self.occupancy_dims.x;
        let per_band = self.bricks_per_band();
        let words_per_band = (occupancy_width * self.occupancy_dims.y) as usize;
        let range = start * per_band..(end * per_band).min(self.bricks.len());

        let bricks = &mut self.bricks[range.clone()];
        let counts = &mut self.counts[range];
        let occupancy = &mut self.occupancy[start * words_per_band..end * words_per_band];
        let states = &mut states[start..end];
        let work = |band: usize, bricks, counts, occupancy, state: &mut S| {
            let mut band = GridBand {
                first: ((start + band) * per_band) as u32,
                dims,
                brick_dims,
                occupancy_width,
                bricks,
                counts,
                occupancy,
                opaque_change: 0,
            };
            f(&mut band, state);
            band.opaque_change
        };
        let change: i64 = if parallel {
            bricks
                .par_chunks_mut(per_band)
                .zip(counts.par_chunks_mut(per_band))
                .zip(occupancy.par_chunks_mut(words_per_band))
                .zip(states)
                .enumerate()
                .map(|(i, (((bricks, counts), words), state))| {
                    work(i, bricks, counts, words, state)
                })
                .sum()
        } else {
            bricks
                .chunks_mut(per_band)
                .zip(counts.chunks_mut(per_band))
                .zip(occupancy.chunks_mut(words_per_band))
                .zip(states)
                .enumerate()
                .map(|(i, (((bricks, counts), words), state))| {
                    work(i, bricks, counts, words, state)
                })
                .sum()
        };
        self.opaque = self.opaque.wrapping_add_signed(change);
    }
}
