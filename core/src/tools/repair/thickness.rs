//! Finds and thickens thin walls: those places that no ball of the wanted diameter within the solid comes near.
//!
//! A solid is opened by a ball ([`DigitalBall`]), which leaves the part that such a ball can reach within it (morphological
//! opening: J. Serra, Image Analysis and Mathematical Morphology, 1982). The remainder is thin unless it lies within a
//! tolerance of that part, counted in steps to any of the 26 neighbours inside the solid. The tolerance is large enough
//! that the edges and corners of a cuboid, which a ball does not fill, and the stair steps of curved and sloping
//! surfaces are never thin. So an axis-aligned wall is thin exactly if it has fewer voxels than the ball; a sloping one
//! may be off by up to two voxels. Edges sharper than a right angle are thin along the edge.
//!
//! Walls are measured tile by tile, where the sculpture has a surface. From a grid to voxels; changes nothing. Knows no
//! document.

use glam::{IVec3, UVec3, Vec3};

use super::ball::DigitalBall;
use crate::progress::Progress;
use crate::sculpture::Grid;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::grid::LEAF_EDGE_LOG2;
use crate::sculpture::region::{ListedBricks, VoxelBox};
use crate::tools::tiles::{TileRule, tiles, widened as widened_box};

/// Rounds of thickening: walls at a border of the grid grow to one side only, and by less.
const ROUNDS: u32 = 8;
/// The most leaves of a tile along each axis, for measuring.
const MOST_LEAVES: u32 = 8;
/// Number of blocks as large as a tile, for measuring, or as the sculpture's box, for thickening, that are in memory at
/// the same time.
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
    pub(crate) fn bytes_to_measure(&self, grid: &Grid) -> u64 {
        let (min, max) = grid.opaque_bounds().unwrap_or_default();
        let most = (BRICK_EDGE_VX << LEAF_EDGE_LOG2) * MOST_LEAVES + 2 * self.reach_vx();
        let size = (max - min).min(UVec3::splat(most));
        (size + 16).as_u64vec3().element_product() / 8 * BLOCKS_TO_MEASURE
    }

    /// Returns the bytes that [`Thickness::thicken`] takes.
    pub(crate) fn bytes_to_thicken(&self, grid: &Grid) -> u64 {
        let reach = self.ball.extent_vx().into_iter().max().unwrap_or(1);
        block_bytes(grid, reach) * BLOCKS_TO_THICKEN
    }

    /// Returns the voxels of `grid` whose wall is too thin. `None` if cancelled.
    pub fn thin(&self, grid: &Grid, progress: &dyn Progress) -> Option<ListedBricks> {
        self.thin_by_tiles(grid, MOST_LEAVES, progress)
    }

    /// Performs [`Thickness::thin`] with tiles of at most so many leaves along each axis.
    fn thin_by_tiles(
        &self,
        grid: &Grid,
        most_leaves: u32,
        progress: &dyn Progress,
    ) -> Option<ListedBricks> {
        progress.begin("measuring walls");
        let rule = TileRule {
            reach_vx: self.reach_vx(),
            idle: Some(false),
            border_is_surface: true,
            most_leaves: UVec3::splat(most_leaves),
        };
        let (min, max) = grid.opaque_bounds().unwrap_or_default();
        let solid = VoxelBox { min: min.as_ivec3(), max: max.as_ivec3() };
        let tiles = tiles(grid, &rule);
        let mut bricks = Vec::new();
        for (at, tile) in tiles.iter().enumerate() {
            // All threads work at one tile.
            let around = widened_box(*tile, self.reach_vx()).intersect(solid);
            let block = BitBlock::of_grid(grid, around.min, around.max);
            let of_tile = TileProgress { progress, at, count: tiles.len() };
            let mut thin = self.thin_of(&block, &of_tile)?;
            thin.keep_box(tile.min, tile.max);
            bricks.append(&mut thin.bricks(grid.brick_dims()));
        }
        progress.end();
        bricks.sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
        Some(ListedBricks::new(bricks))
    }

    /// Returns how far away the voxels may be on which it depends whether a voxel is thin.
    fn reach_vx(&self) -> u32 {
        self.ball.extent_vx().into_iter().max().unwrap_or(1) + self.tolerance
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

/// The progress of one tile of several.
struct TileProgress<'a> {
    progress: &'a dyn Progress,
    at: usize,
    count: usize,
}

impl Progress for TileProgress<'_> {
    fn begin(&self, _: &str) {}

    fn advance(&self, done: f32) {
        self.progress.advance((self.at as f32 + done) / self.count as f32);
    }

    fn end(&self) {}

    fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
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
