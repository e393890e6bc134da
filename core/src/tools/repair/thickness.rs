//! Finds and thickens thin walls: those places that no ball of the wanted diameter within the solid comes near.
//!
//! A solid is opened by a ball ([`DigitalBall`]), which leaves the part that such a ball can reach within it (morphological
//! opening: J. Serra, Image Analysis and Mathematical Morphology, 1982). The remainder is thin unless it lies within a
//! tolerance of that part, counted in steps to any of the 26 neighbours inside the solid. The tolerance is large enough
//! that the edges and corners of a cuboid, which a ball does not fill, and the stair steps of curved and sloping
//! surfaces are never thin. So an axis-aligned wall is thin exactly if it has fewer voxels than the ball; a sloping one
//! may be off by up to two voxels. Edges sharper than a right angle are thin along the edge.
//!
//! From a grid to blocks of bits; changes nothing. Knows no document.

use glam::{IVec3, UVec3, Vec3};

use super::ball::DigitalBall;
use crate::progress::Progress;
use crate::sculpture::Grid;
use crate::sculpture::bit_block::BitBlock;

/// Rounds of thickening: walls at a border of the grid grow to one side only, and by less.
const ROUNDS: u32 = 8;
/// Number of blocks as large as the sculpture's box that are in memory at the same time, for measuring and for
/// thickening.
const BLOCKS_TO_MEASURE: u64 = 4;
const BLOCKS_TO_THICKEN: u64 = 8;

/// The minimum thickness of walls.
#[derive(Clone, PartialEq, Debug)]
pub struct Thickness {
    ball: DigitalBall,
    /// Number of steps around the part that the ball reaches within which nothing is thin.
    tolerance: u32,
}

impl Thickness {
    /// Creates it from `thickness` and the edges of voxels in the same unit. Returns `None` where [`DigitalBall::new`] does.
    pub fn new(thickness: f32, voxel: Vec3) -> Option<Thickness> {
        let ball = DigitalBall::new(thickness, voxel)?;
        let edge = ball.extent_vx().into_iter().max().unwrap_or(1);
        // A corner of a cube is (1 - 1/sqrt(3)) radii from the ball on each axis, an edge less. One more voxel allows
        // for the ball's own steps and its position, which is a whole number.
        let tolerance = (0.5 * (1.0 - 3f32.sqrt().recip()) * edge as f32).ceil() as u32 + 1;
        Some(Thickness { ball, tolerance })
    }

    /// Returns the bytes that [`Thickness::thin`] takes.
    pub(crate) fn bytes_to_measure(grid: &Grid) -> u64 {
        block_bytes(grid, 0) * BLOCKS_TO_MEASURE
    }

    /// Returns the bytes that [`Thickness::thicken`] takes.
    pub(crate) fn bytes_to_thicken(&self, grid: &Grid) -> u64 {
        let reach = self.ball.extent_vx().into_iter().max().unwrap_or(1);
        block_bytes(grid, reach) * BLOCKS_TO_THICKEN
    }

    /// Returns the voxels of `grid` whose wall is too thin. `None` if cancelled.
    pub fn thin(&self, grid: &Grid, progress: &dyn Progress) -> Option<BitBlock> {
        let (min, max) = grid.opaque_bounds().unwrap_or_default();
        let solid = BitBlock::of_grid(grid, min.as_ivec3(), max.as_ivec3());
        progress.begin("measuring walls");
        let thin = self.thin_of(&solid, progress);
        progress.end();
        thin
    }

    fn thin_of(&self, solid: &BitBlock, progress: &dyn Progress) -> Option<BitBlock> {
        if self.ball.extent_vx() == [1; 3] {
            return Some(solid.emptied());
        }
        let mut reached = self.ball.dilate(&self.ball.erode(solid, progress)?, progress)?;
        for _ in 0..self.tolerance {
            if progress.is_cancelled() {
                return None;
            }
            reached = widened(&reached, solid);
        }
        Some(solid.zip(&reached, |solid, reached| solid & !reached))
    }

    /// Returns the voxels to add so that no wall of `grid` is too thin, as far as there is room. None is added below
    /// the lowest voxel, which stands on the bed, or beyond the grid. `None` if cancelled.
    ///
    /// Balls are placed on the medial surface of thin walls (the skeleton of C. Lantuéjoul, 1980), so that these grow
    /// to both sides and become as thick as wanted or one voxel thicker. Further balls are placed on all that is still
    /// thin.
    pub fn thicken(&self, grid: &Grid, progress: &dyn Progress) -> Option<BitBlock> {
        let (min, max) = grid.opaque_bounds().unwrap_or_default();
        let reach = IVec3::from(self.ball.extent_vx().map(|edge| edge as i32));
        let lowest = IVec3::new(0, min.y as i32, 0);
        let from = (min.as_ivec3() - reach).max(lowest);
        let to = (max.as_ivec3() + reach).min(grid.dims().as_ivec3());
        let before = BitBlock::of_grid(grid, from, to);
        let mut solid = before.clone();
        progress.begin("thickening walls");
        for round in 0..ROUNDS {
            let thin = self.thin_of(&solid, progress)?;
            let places = match round {
                0 => {
                    let skeleton = self.skeleton(&solid);
                    thin.zip(&skeleton, |thin, skeleton| thin & skeleton)
                }
                _ => {
                    let inside = self.moved_inside(&thin, from, to);
                    thin.zip(&inside, |thin, inside| thin | inside)
                }
            };
            if places.count() == 0 {
                break;
            }
            let mut thicker = self.ball.dilate(&places, progress)?;
            thicker.keep_box(from, to);
            let grown = solid.zip(&thicker, |solid, thicker| solid | thicker);
            if grown == solid {
                break;
            }
            solid = grown;
        }
        progress.end();
        Some(solid.zip(&before, |after, before| after & !before))
    }

    /// Returns the positions nearest to `places` at which the ball lies within the box from `min` (inclusive) to `max`
    /// (exclusive). A ball cut off at a border would leave the voxels on which it was placed thin.
    fn moved_inside(&self, places: &BitBlock, min: IVec3, max: IVec3) -> BitBlock {
        let edges = IVec3::from(self.ball.extent_vx().map(|edge| edge as i32));
        let first = min + (edges - 1) / 2;
        let last = (max - 1 - edges / 2).max(first);
        let (origin, size) = (places.origin(), places.size().as_ivec3());
        let mut moved = places.emptied();
        for (z, y) in (0..size.z).flat_map(|z| (0..size.y).map(move |y| (z, y))) {
            for (i, word) in (0..).zip(places.row(y, z).unwrap_or_default()) {
                let mut bits = *word;
                while bits != 0 {
                    let x = 64 * i + bits.trailing_zeros() as i32;
                    let to = (origin + IVec3::new(x, y, z)).clamp(first, last);
                    moved.set_span(to.x, to.x, to.y, to.z);
                    bits &= bits - 1;
                }
            }
        }
        moved
    }

    /// Returns the medial surface of walls up to the ball's thickness.
    fn skeleton(&self, solid: &BitBlock) -> BitBlock {
        let mut rest = solid.clone();
        let mut middles = solid.emptied();
        let levels = self.ball.extent_vx().into_iter().max().unwrap_or(1).div_ceil(2);
        for _ in 0..=levels {
            let inner = crossed::<true>(&rest);
            let opened = crossed::<false>(&inner);
            let middle = rest.zip(&opened, |rest, opened| rest & !opened);
            middles = middles.zip(&middle, |all, middle| all | middle);
            rest = inner;
        }
        middles
    }
}

/// Returns the bytes of a block of the sculpture's box extended by `reach` voxels, rounded to bricks.
fn block_bytes(grid: &Grid, reach: u32) -> u64 {
    let (min, max) = grid.opaque_bounds().unwrap_or_default();
    let (low, high) = (min.saturating_sub(UVec3::splat(reach)), (max + reach).min(grid.dims()));
    (high.saturating_sub(low) + 16).as_u64vec3().element_product() / 8
}

/// Returns the voxels of `within` that are in `block` or have one of their 26 neighbours in it.
fn widened(block: &BitBlock, within: &BitBlock) -> BitBlock {
    within.map_rows_in_parallel(|y, z, out| {
        let Some(limit) = within.row(y, z).filter(|row| row.iter().any(|word| *word != 0)) else {
            return;
        };
        for row in neighbours(block, y, z, &NINE) {
            out.iter_mut().zip(row).for_each(|(bits, other)| *bits |= other);
        }
        let mut before = 0;
        for i in 0..out.len() {
            let (here, next) = (out[i], out.get(i + 1).copied().unwrap_or(0));
            out[i] = (here | here << 1 | here >> 1 | before >> 63 | next << 63) & limit[i];
            before = here;
        }
    })
}

/// Erodes (`ALL`) or dilates by a voxel and its six neighbours.
fn crossed<const ALL: bool>(block: &BitBlock) -> BitBlock {
    block.map_rows_in_parallel(|y, z, out| {
        let Some(row) = block.row(y, z) else { return };
        for (i, bits) in out.iter_mut().enumerate() {
            let here = row[i];
            let before = if i > 0 { row[i - 1] } else { 0 };
            let next = row.get(i + 1).copied().unwrap_or(0);
            let (low, high) = (here << 1 | before >> 63, here >> 1 | next << 63);
            *bits = if ALL { here & low & high } else { here | low | high };
        }
        for (dy, dz) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            match block.row(y + dy, z + dz) {
                Some(other) if ALL => out.iter_mut().zip(other).for_each(|(a, b)| *a &= b),
                Some(other) => out.iter_mut().zip(other).for_each(|(a, b)| *a |= b),
                None if ALL => out.fill(0),
                None => {}
            }
        }
    })
}

const NINE: [(i32, i32); 9] =
    [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (-1, 1), (1, -1), (1, 1)];

fn neighbours<'a>(
    block: &'a BitBlock,
    y: i32,
    z: i32,
    offsets: &'a [(i32, i32)],
) -> impl Iterator<Item = &'a [u64]> {
    offsets.iter().filter_map(move |(dy, dz)| block.row(y + dy, z + dz))
}

#[cfg(test)]
#[path = "thickness_tests.rs"]
mod tests;
