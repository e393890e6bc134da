//! A dense block of existence bits cut out of a grid: rows of 64-bit words along x, for neighbourhood filters that
//! process 64 voxels at once.
//!
//! Input is a box of voxel coordinates, which may reach beyond the grid (nothing exists there); output is brick masks.
//! Knows no tool.

use std::ops::Range;

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::brick::{BRICK_EDGE_VX, Brick};
use super::grid::{Grid, GridPart, for_each_part};
use super::region::BrickBox;

/// Existence bits of a box whose lower x is a multiple of eight.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BitBlock {
    /// Voxel coordinates of the first bit; multiples of 8.
    origin: IVec3,
    /// Size in voxels; multiples of 8.
    size: UVec3,
    words_per_row: usize,
    /// Rows along x, then y, then z; bit 0 of a row's first word is the lowest x.
    words: Vec<u64>,
}

impl BitBlock {
    /// Returns an empty block of the voxels from `min` (inclusive) to `max` (exclusive), rounded outwards to brick
    /// borders.
    pub fn empty(min: IVec3, max: IVec3) -> BitBlock {
        let edge = IVec3::splat(BRICK_EDGE_VX as i32);
        let origin = min.div_euclid(edge) * edge;
        let end = (max - 1).div_euclid(edge) * edge + edge;
        let size = (end - origin).max(IVec3::ZERO).as_uvec3();
        let words_per_row = size.x.div_ceil(64) as usize;
        let words = vec![0; words_per_row * (size.y * size.z) as usize];
        BitBlock { origin, size, words_per_row, words }
    }

    /// Returns the voxels of `grid` from `min` (inclusive) to `max` (exclusive), rounded outwards to brick borders.
    pub fn of_grid(grid: &Grid, min: IVec3, max: IVec3) -> BitBlock {
        let mut block = BitBlock::empty(min, max);
        let edge = BRICK_EDGE_VX as i32;
        let first = (block.origin / edge).max(IVec3::ZERO).as_uvec3();
        let end = (block.origin + block.size.as_ivec3()) / edge;
        let within = BrickBox { min: first, max: end.max(IVec3::ZERO).as_uvec3() };
        for_each_part(grid, within, &mut |part| match part {
            GridPart::Uniform { is_full: false, .. } => {}
            GridPart::Uniform { bricks, .. } => {
                let end = (bricks.max * BRICK_EDGE_VX).min(grid.dims()).as_ivec3();
                block.fill_box((bricks.min * BRICK_EDGE_VX).as_ivec3(), end);
            }
            GridPart::Mixed(b, brick) => block.put_brick(b.as_ivec3(), brick),
        });
        block
    }

    /// Sets the voxels of a box, which must lie within the block and not be empty.
    fn fill_box(&mut self, min: IVec3, max: IVec3) {
        let (low, end) = ((min - self.origin).as_uvec3(), (max - self.origin).as_uvec3());
        let words = (low.x / 64) as usize..end.x.div_ceil(64) as usize;
        let (first, last) = (u64::MAX << (low.x % 64), u64::MAX >> ((64 - end.x % 64) % 64));
        for z in low.z..end.z {
            for y in low.y..end.y {
                let start = (y + z * self.size.y) as usize * self.words_per_row;
                let row = &mut self.words[start + words.start..start + words.end];
                let last_word = row.len() - 1;
                for (i, bits) in row.iter_mut().enumerate() {
                    let low = if i == 0 { first } else { u64::MAX };
                    *bits |= low & if i == last_word { last } else { u64::MAX };
                }
            }
        }
    }

    /// Returns a block of the same place and size whose rows `f` computes. `f` gets the y and z of each row, counted
    /// from the block's origin, and the row to fill.
    pub fn map_rows(&self, mut f: impl FnMut(i32, i32, &mut [u64])) -> BitBlock {
        let mut out = BitBlock { words: vec![0; self.words.len()], ..*self };
        let (rows_y, width) = (self.size.y as usize, self.words_per_row.max(1));
        for (i, row) in out.words.chunks_mut(width).enumerate() {
            f((i % rows_y) as i32, (i / rows_y) as i32, row);
        }
        out
    }

    /// Returns a block of the same place and size without voxels.
    pub fn emptied(&self) -> BitBlock {
        BitBlock { words: vec![0; self.words.len()], ..*self }
    }

    /// Returns the rows in chunks of `layers` layers along z, for several threads.
    pub(crate) fn layers_mut(&mut self, layers: usize) -> rayon::slice::ChunksMut<'_, u64> {
        let layer = self.words_per_row * self.size.y as usize;
        self.words.par_chunks_mut((layer * layers).max(1))
    }

    /// Performs [`BitBlock::map_rows`] on all threads.
    pub(crate) fn map_rows_in_parallel(&self, f: impl Fn(i32, i32, &mut [u64]) + Sync) -> BitBlock {
        let mut out = self.emptied();
        let (rows, width) = (self.size.y as usize, self.words_per_row.max(1));
        out.layers_mut(1).enumerate().for_each(|(z, words)| {
            let rows = words.chunks_mut(width).take(rows);
            rows.enumerate().for_each(|(y, row)| f(y as i32, z as i32, row));
        });
        out
    }

    /// Returns the voxel coordinates of the block's lower corner, multiples of 8.
    pub fn origin(&self) -> IVec3 {
        self.origin
    }

    /// Returns the size in voxels, multiples of 8.
    pub fn size(&self) -> UVec3 {
        self.size
    }

    /// Returns the row at (y, z), counted from the origin; `None` outside the block.
    #[inline]
    pub fn row(&self, y: i32, z: i32) -> Option<&[u64]> {
        let inside = y >= 0 && z >= 0 && (y as u32) < self.size.y && (z as u32) < self.size.z;
        inside.then(|| {
            let start = (y as usize + z as usize * self.size.y as usize) * self.words_per_row;
            &self.words[start..start + self.words_per_row]
        })
    }

    /// Returns whether the voxel `v` (grid coordinates) is set; false outside the block.
    pub fn get(&self, v: IVec3) -> bool {
        let local = v - self.origin;
        local.x >= 0
            && (local.x as u32) < self.size.x
            && self
                .row(local.y, local.z)
                .is_some_and(|row| row[local.x as usize / 64] >> (local.x % 64) & 1 != 0)
    }

    /// Sets the voxels of one row from `x0` to `x1` (inclusive, grid coordinates). Ignores voxels outside the block.
    pub(crate) fn set_span(&mut self, x0: i32, x1: i32, y: i32, z: i32) {
        let (y, z) = (y - self.origin.y, z - self.origin.z);
        if y < 0 || z < 0 || y as u32 >= self.size.y || z as u32 >= self.size.z {
            return;
        }
        let first = (x0 - self.origin.x).max(0);
        let last = (x1 - self.origin.x).min(self.size.x as i32 - 1);
        if first > last {
            return;
        }
        let start = (y as usize + z as usize * self.size.y as usize) * self.words_per_row;
        for word in first / 64..=last / 64 {
            let low = (first - word * 64).max(0) as u32;
            let high = (last - word * 64).min(63) as u32;
            self.words[start + word as usize] |= (u64::MAX >> (63 - high)) & (u64::MAX << low);
        }
    }

    /// Clears the voxels outside the box from `min` (inclusive) to `max` (exclusive).
    pub(crate) fn keep_box(&mut self, min: IVec3, max: IVec3) {
        let (min, max) = (min - self.origin, max - self.origin);
        let size = self.size.as_ivec3();
        let (rows, width) = (size.y, self.words_per_row);
        let inside = |at: i32, axis: usize| at >= min[axis] && at < max[axis];
        let mut row = vec![0u64; width];
        (0..size.x).filter(|x| inside(*x, 0)).for_each(|x| row[x as usize / 64] |= 1 << (x % 64));
        for (i, words) in (0..).zip(self.words.chunks_mut(width.max(1))) {
            match inside(i % rows, 1) && inside(i / rows, 2) {
                true => words.iter_mut().zip(&row).for_each(|(bits, keep)| *bits &= keep),
                false => words.fill(0),
            }
        }
    }

    /// Gives each voxel outside the box from `min` (inclusive) to `max` (exclusive) the value of the nearest voxel
    /// inside.
    pub(crate) fn extend_border(&mut self, min: IVec3, max: IVec3) {
        let (low, high) = (min - self.origin, max - 1 - self.origin);
        let size = self.size.as_ivec3();
        // The part of the box that lies within the block.
        let (low, high) = (low.max(IVec3::ZERO), high.min(size - 1));
        if self.words.is_empty() || low.cmpgt(high).any() {
            return;
        }
        let width = self.words_per_row;
        let place = |y: i32, z: i32| (y + z * size.y) as usize * width;
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                let get = |x: i32| self.words[place(y, z) + x as usize / 64] >> (x % 64) & 1 != 0;
                let (first, last) = (get(low.x), get(high.x));
                let row = &mut self.words[place(y, z)..][..width];
                let mut set = |xs: Range<i32>, value: bool| {
                    xs.for_each(|x| {
                        let (word, bit) = (&mut row[x as usize / 64], 1 << (x % 64));
                        if value { *word |= bit } else { *word &= !bit }
                    });
                };
                set(0..low.x, first);
                set(high.x + 1..size.x, last);
            }
        }
        for z in 0..size.z {
            for y in 0..size.y {
                let (from_y, from_z) = (y.clamp(low.y, high.y), z.clamp(low.z, high.z));
                if (from_y, from_z) != (y, z) {
                    let from = place(from_y, from_z);
                    self.words.copy_within(from..from + width, place(y, z));
                }
            }
        }
    }

    /// Sets the voxels whose centres are at most `sqrt(squared_vx)` from that of a voxel of `seeds`, a block of the
    /// same place and size.
    pub(crate) fn add_balls(&mut self, seeds: &BitBlock, squared_vx: u32) {
        let reach = squared_vx.isqrt() as i32;
        self.add_spans(seeds, reach, |dy, dz| {
            let rest = squared_vx.checked_sub((dy * dy + dz * dz) as u32)?;
            Some(rest.isqrt())
        });
    }

    /// Sets the voxels of the cubes that extend `reach_vx` voxels on every side of those of `seeds`, a block of the
    /// same place and size.
    pub(crate) fn add_cubes(&mut self, seeds: &BitBlock, reach_vx: u32) {
        self.add_spans(seeds, reach_vx as i32, |_, _| Some(reach_vx));
    }

    /// Sets, in the rows up to `reach` away, the voxels within `span` of a seed along x. `span` gets the distance of
    /// the row on y and z.
    fn add_spans(
        &mut self,
        seeds: &BitBlock,
        reach: i32,
        span: impl Fn(i32, i32) -> Option<u32> + Sync,
    ) {
        debug_assert!(self.origin == seeds.origin && self.size == seeds.size);
        let (rows, width) = (self.size.y as i32, self.words_per_row.max(1));
        // Each row that has seeds, with the range of its words that hold them.
        let filled = |y: i32, z: i32| -> Option<(&[u64], Range<usize>)> {
            let row = seeds.row(y, z)?;
            let first = row.iter().position(|word| *word != 0)?;
            let last = row.iter().rposition(|word| *word != 0)?;
            Some((row, first..last + 1))
        };
        self.layers_mut(1).enumerate().for_each(|(z, out)| {
            // The seeds of a row, widened by the last span.
            let (mut wide, mut scratch) = (vec![0; width], vec![0; width]);
            for dz in -reach..=reach {
                for y in 0..rows {
                    let Some((row, range)) = filled(y, z as i32 + dz) else { continue };
                    let mut known = None;
                    for dy in -reach..=reach {
                        let Some(by) = span(dy, dz).filter(|_| (0..rows).contains(&(y + dy)))
                        else {
                            continue;
                        };
                        if known != Some(by) {
                            widen(row, &range, by as usize, &mut wide, &mut scratch);
                            known = Some(by);
                        }
                        let words = (by as usize).div_ceil(64);
                        let (first, end) =
                            (range.start.saturating_sub(words), (range.end + words).min(width));
                        let start = (y + dy) as usize * width;
                        let out = &mut out[start + first..start + end];
                        out.iter_mut().zip(&wide[first..end]).for_each(|(out, wide)| *out |= wide);
                    }
                }
            }
        });
    }

    /// Combines two blocks of the same place and size word by word.
    pub fn zip(&self, other: &BitBlock, f: impl Fn(u64, u64) -> u64) -> BitBlock {
        debug_assert!(self.origin == other.origin && self.size == other.size);
        let words = self.words.iter().zip(&other.words).map(|(&a, &b)| f(a, b)).collect();
        BitBlock { words, ..*self }
    }

    /// Returns the number of set voxels.
    pub fn count(&self) -> u64 {
        self.words.iter().map(|w| u64::from(w.count_ones())).sum()
    }

    /// Returns the non-empty bricks of the block that lie in a grid of `brick_dims` bricks: coordinates and masks, x
    /// fastest, then y, then z.
    pub fn bricks(&self, brick_dims: UVec3) -> Vec<(UVec3, Brick)> {
        let edge = BRICK_EDGE_VX as i32;
        let first = (self.origin / edge).max(IVec3::ZERO);
        let end = ((self.origin + self.size.as_ivec3()) / edge).min(brick_dims.as_ivec3());
        let (mut bricks, mut any) = (Vec::new(), vec![0u64; self.words_per_row]);
        for (z, y) in (first.z..end.z).flat_map(|z| (first.y..end.y).map(move |y| (z, y))) {
            // All rows of the row of bricks together: where they have no voxel, no brick has one.
            any.fill(0);
            let low = IVec3::new(0, y, z) * edge - self.origin;
            for (z, y) in (0..edge).flat_map(|z| (0..edge).map(move |y| (z, y))) {
                let row = self.row(low.y + y, low.z + z).unwrap_or_default();
                any.iter_mut().zip(row).for_each(|(any, bits)| *any |= bits);
            }
            for x in first.x..end.x {
                let at = (x * edge - self.origin.x) as usize;
                if any[at / 64] >> (at % 64) & 0xFF != 0 {
                    let b = IVec3::new(x, y, z).as_uvec3();
                    bricks.push((b, self.brick(b)));
                }
            }
        }
        bricks
    }

    /// Returns the brick at brick coordinates `b`, which must lie within the block.
    fn brick(&self, b: UVec3) -> Brick {
        let local = (b * BRICK_EDGE_VX).as_ivec3() - self.origin;
        let (word, shift) = (local.x as usize / 64, local.x as u32 % 64);
        let mut rows = [0u64; 8];
        for (z, slice) in rows.iter_mut().enumerate() {
            for y in 0..8 {
                if let Some(row) = self.row(local.y + y, local.z + z as i32) {
                    *slice |= (row[word] >> shift & 0xFF) << (8 * y);
                }
            }
        }
        Brick::from_rows(&rows)
    }

    /// Adds the voxels of a brick, which must lie within the block.
    pub(crate) fn put_brick(&mut self, b: IVec3, brick: &Brick) {
        let local = b * BRICK_EDGE_VX as i32 - self.origin;
        let (word, shift) = (local.x as usize / 64, local.x as u32 % 64);
        for (z, slice) in brick.to_rows().into_iter().enumerate() {
            for y in 0..8usize {
                let row = local.y as usize + y + (local.z as usize + z) * self.size.y as usize;
                self.words[row * self.words_per_row + word] |= (slice >> (8 * y) & 0xFF) << shift;
            }
        }
    }
}

/// Writes the bits of a row, widened by `by` on both sides, to `wide`. Only the words of `range` have bits.
fn widen(row: &[u64], range: &Range<usize>, by: usize, wide: &mut [u64], scratch: &mut [u64]) {
    let words = by.div_ceil(64);
    let end = (range.end + words).min(wide.len());
    let reached = range.start.saturating_sub(words)..end;
    wide[reached.clone()].fill(0);
    wide[range.clone()].copy_from_slice(&row[range.clone()]);
    // Doubles the width while possible, then adds the rest.
    let mut done = 0;
    while done < by {
        let step = (by - done).min(2 * done + 1);
        let (jump, shift) = (step / 64, step % 64);
        scratch[reached.clone()].copy_from_slice(&wide[reached.clone()]);
        for (out, at) in wide[reached.clone()].iter_mut().zip(reached.clone()) {
            let word = |at: Option<usize>| {
                at.filter(|at| reached.contains(at)).map_or(0, |at| scratch[at])
            };
            let up = |jump: usize| word(at.checked_sub(jump));
            let down = |jump: usize| word(Some(at + jump));
            *out |= match shift {
                0 => up(jump) | down(jump),
                _ => {
                    up(jump) << shift
                        | up(jump + 1) >> (64 - shift)
                        | down(jump) >> shift
                        | down(jump + 1) << (64 - shift)
                }
            };
        }
        done += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn grid_of(dims: UVec3, voxels: &[[i32; 3]]) -> Grid {
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        for &v in voxels {
            grid.set(IVec3::from(v), true);
        }
        grid
    }

    proptest! {
        #[test]
        fn a_block_shows_the_grid_and_gives_its_bricks_back(
            dims in prop::array::uniform3(1u32..90),
            voxels in prop::collection::vec(prop::array::uniform3(0i32..90), 0..80),
            min in prop::array::uniform3(-20i32..60),
            size in prop::array::uniform3(1i32..80),
        ) {
            let grid = grid_of(UVec3::from(dims), &voxels);
            let (min, max) = (IVec3::from(min), IVec3::from(min) + IVec3::from(size));
            let block = BitBlock::of_grid(&grid, min, max);
            for &v in &voxels {
                let v = IVec3::from(v);
                let inside = v.cmpge(min).all() && v.cmplt(max).all();
                if inside { prop_assert_eq!(block.get(v), grid.get(v)); }
            }
            for (b, mask) in block.bricks(grid.brick_dims()) {
                prop_assert_eq!(mask, *grid.brick(b));
            }
        }

        #[test]
        fn balls_and_cubes_are_what_they_say(
            v in prop::array::uniform3(10i32..60), radius in 0f32..9.0,
        ) {
            let v = IVec3::from(v);
            let (min, max) = (IVec3::splat(-3), IVec3::new(140, 66, 70));
            let (mut ball, mut cube) = (BitBlock::empty(min, max), BitBlock::empty(min, max));
            let (mut seeds, others) = (ball.emptied(), [IVec3::new(3, -2, 1), IVec3::new(70, 1, 0)]);
            let middles = [v, v + others[0], v + others[1]];
            middles.iter().for_each(|v| seeds.set_span(v.x, v.x, v.y, v.z));
            ball.add_balls(&seeds, (radius * radius) as u32);
            cube.add_cubes(&seeds, radius as u32);
            for z in min.z..max.z { for y in min.y..max.y { for x in min.x..max.x {
                let at = IVec3::new(x, y, z);
                let offsets = || middles.iter().map(|v| at - v);
                let near = |d: IVec3| d.length_squared() as f32 <= radius * radius;
                prop_assert_eq!(ball.get(at), offsets().any(near));
                prop_assert_eq!(cube.get(at), offsets().any(|d| d.abs().max_element() as f32 <= radius));
            } } }
        }
    }
}
