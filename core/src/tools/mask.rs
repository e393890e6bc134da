//! Grows, shrinks and smooths masks, and selects parts of the surface by their shape.
//!
//! From grids to lists of voxels. Changes nothing; knows no document.

use glam::{IVec3, UVec2, UVec3, Vec3};
use rayon::prelude::*;

use super::flood::{self, Slices};
use super::tiles::{self, TileRule};
use crate::sculpture::Grid;
use crate::sculpture::bit_block::BitBlock;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::grid::{LEAF_EDGE_LOG2, bricks_beside_empty, indices, surface_leaves};
use crate::sculpture::region::{ListedBricks, Region, VoxelBox};
use crate::tools::brush::kernel::filter;

/// Greatest distance by which a mask grows or shrinks in one step, in voxels.
pub const MAX_GROWTH_VX: u32 = 64;
/// Greatest radius in which cavities are detected around a voxel, and by which a patch is thickened, in voxels.
pub const MAX_REACH_VX: u32 = 4;

/// Number of the 26 neighbours that a voxel needs to be added, in alternate rounds: the cubes and octahedra that result
/// keep growing masks round.
const ROUNDS: [u32; 2] = [1, 4];
/// By how much the filled share of the cube around a cavity voxel exceeds that around a voxel of a plane.
const CAVITY_SHARE: f32 = 0.06;

/// Returns the voxels that `mask` gains when it grows by `by` voxels.
pub fn grown(mask: &Grid, by: u32) -> ListedBricks {
    let tiles = tiles::tiles(mask, &rule(by, Some(true)));
    let [added] = tiles::in_tiles(mask, &tiles, |tile| {
        let VoxelBox { min, max } = tiles::widened(tile, by);
        let bits = BitBlock::of_grid(mask, min, max);
        let mut may = filled(&bits);
        may.keep_box(min, max);
        let mut added = spread(bits.clone(), &may, by).zip(&bits, |all, old| all & !old);
        added.keep_box(tile.min, tile.max);
        [added.bricks(mask.brick_dims())]
    });
    added
}

/// Returns the voxels that `mask` loses when it shrinks by `by` voxels. It does not shrink at the grid's border.
pub fn shrunk(mask: &Grid, by: u32) -> ListedBricks {
    let tiles = tiles::tiles(mask, &rule(by, Some(false)));
    let inside = VoxelBox::of_grid(mask);
    let [removed] = tiles::in_tiles(mask, &tiles, |tile| {
        let around = tiles::widened(tile, by);
        let VoxelBox { min, max } = around;
        let mut bits = BitBlock::of_grid(mask, min - 1, max + 1);
        let mut may = filled(&bits);
        may.keep_box(inside.min, inside.max);
        bits = bits.zip(&may, |bits, inside| bits | !inside);
        may.keep_box(min, max);
        let start = bits.clone();
        // In the reverse order of growing.
        for round in (0..by).rev() {
            let removed = filter::erosion(&bits, &may, 27 - ROUNDS[round as usize % 2]);
            bits = bits.zip(&removed, |bits, removed| bits & !removed);
        }
        let mut removed = start.zip(&bits, |old, left| old & !left);
        removed.keep_box(tile.min, tile.max);
        [removed.bricks(mask.brick_dims())]
    });
    removed
}

/// Returns the voxels that `mask` gains and loses when its outline is smoothed by a majority filter over the cube of
/// `radius_vx` around each voxel. Beyond the grid the mask is continued from the border, so that the border is no
/// outline.
pub fn evened(mask: &Grid, radius_vx: u32) -> (ListedBricks, ListedBricks) {
    let tiles = tiles::tiles(mask, &rule(radius_vx, None));
    let inside = VoxelBox::of_grid(mask);
    let [added, removed] = tiles::in_tiles(mask, &tiles, |tile| {
        let VoxelBox { min, max } = tiles::widened(tile, radius_vx);
        let mut bits = BitBlock::of_grid(mask, min, max);
        bits.extend_border(inside.min, inside.max);
        let mut may = filled(&bits);
        may.keep_box(tile.min, tile.max);
        let (added, removed) = filter::majority(&bits, &may, radius_vx, 1.0);
        [added, removed].map(|block| block.bricks(mask.brick_dims()))
    });
    (added, removed)
}

/// Returns the choice of tiles for a change of a mask that depends on voxels up to `reach_vx` away. `idle`: the value of
/// cubes that the change leaves alone.
fn rule(reach_vx: u32, idle: Option<bool>) -> TileRule {
    // The further the reach, the more of a small tile is computed for its neighbours.
    let across = match reach_vx {
        0..=8 => UVec2::new(4, 2),
        9..=24 => UVec2::splat(4),
        _ => UVec2::splat(8),
    };
    let most_leaves = UVec3::new(8, across.x, across.y);
    TileRule { reach_vx, idle, border_is_surface: false, most_leaves }
}

/// Returns all voxels within about `by` voxels of those listed.
pub(crate) fn thickened(voxels: &ListedBricks, brick_dims: UVec3, by: u32) -> ListedBricks {
    let bounds = voxels.bounds_vx();
    if by == 0 || bounds.is_empty() {
        return voxels.clone();
    }
    let reach = IVec3::splat(by as i32);
    let mut bits = BitBlock::empty(bounds.min - reach, bounds.max + reach);
    voxels.bricks().iter().for_each(|(b, brick)| bits.put_brick(b.as_ivec3(), brick));
    let may = filled(&bits);
    ListedBricks::new(spread(bits, &may, by).bricks(brick_dims))
}

/// Returns the surface voxels with more filled voxels around them than on a plane, within `reach_vx` voxels: furrows,
/// corners and holes.
pub fn cavities(grid: &Grid, reach_vx: u32) -> ListedBricks {
    let edge = (2 * reach_vx + 1) as f32;
    let plane = (reach_vx as f32 + 1.0) / edge;
    let least = ((plane + CAVITY_SHARE) * edge.powi(3)) as u32;
    let of_brick = |b: UVec3| {
        let surface = flood::surface_of(grid, b);
        let window = (surface != [0; 8]).then(|| Window::around(grid, b))?;
        let is_cavity = |local: UVec3| window.moment(local, reach_vx).0 > least;
        Some((b, chosen(&surface, is_cavity))).filter(|(_, brick)| !brick.is_empty())
    };
    let leaves = surface_leaves(grid).into_par_iter();
    let of_leaf = |leaf: UVec3| {
        let low = leaf << LEAF_EDGE_LOG2;
        let near = indices(bricks_beside_empty(grid, leaf));
        near.filter_map(move |index| of_brick(low + UVec3::from(local_coords(index))))
    };
    let mut bricks: Vec<(UVec3, Brick)> = leaves.flat_map_iter(of_leaf).collect();
    bricks.par_sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
    ListedBricks::new(bricks)
}

/// Returns the surface voxels that are face-connected to `start` through voxels whose normals deviate by at most
/// `angle_deg` from its normal. Returns nothing if `start` is not on the surface.
pub(crate) fn flat_patch(grid: &Grid, start: UVec3, angle_deg: f32) -> ListedBricks {
    let size = grid.voxel_size();
    let normal = |window: &Window, local: UVec3| {
        // Points away from the solid; a covector, so that elongated voxels do not turn it.
        let (_, moment) = window.moment(local, MAX_REACH_VX);
        (-moment.as_vec3() / size).normalize_or_zero()
    };
    let brick = start / BRICK_EDGE_VX;
    let wanted = normal(&Window::around(grid, brick), start % BRICK_EDGE_VX);
    let least = angle_deg.to_radians().cos() - 1e-6;
    let may = |b: UVec3| -> Slices {
        let surface = flood::surface_of(grid, b);
        if surface == [0; 8] {
            return surface;
        }
        let window = Window::around(grid, b);
        chosen(&surface, |local| normal(&window, local).dot(wanted) >= least).to_rows()
    };
    flood::patch_by(grid, start, &may)
}

/// Returns a block of the same position and size with all voxels set.
fn filled(block: &BitBlock) -> BitBlock {
    let mut all = block.zip(block, |_, _| u64::MAX);
    all.keep_box(block.origin(), block.origin() + block.size().as_ivec3());
    all
}

/// Returns a block grown by `by` voxels within those of `may`.
fn spread(mut bits: BitBlock, may: &BitBlock, by: u32) -> BitBlock {
    for round in 0..by {
        let added = filter::dilation(&bits, may, ROUNDS[round as usize % 2]);
        bits = bits.zip(&added, |bits, added| bits | added);
    }
    bits
}

/// Returns the voxels of a brick for which `is` holds.
fn chosen(voxels: &Slices, is: impl Fn(UVec3) -> bool) -> Brick {
    let mut chosen = Brick::EMPTY;
    Brick::from_rows(voxels).for_each(|local| {
        let [x, y, z] = local_coords(local);
        chosen.set(x, y, z, is(UVec3::new(x, y, z)));
    });
    chosen
}

/// Edge of a [`Window`], in voxels.
const WINDOW_EDGE: usize = (BRICK_EDGE_VX + 2 * MAX_REACH_VX) as usize;

/// The voxels of a brick and those around it: bit x of the rows `[z][y]`, counted from [`MAX_REACH_VX`] before the
/// brick.
struct Window {
    rows: [[u16; WINDOW_EDGE]; WINDOW_EDGE],
}

impl Window {
    fn around(grid: &Grid, b: UVec3) -> Window {
        let reach = MAX_REACH_VX as i32;
        let min = (b * BRICK_EDGE_VX).as_ivec3() - reach;
        let block = BitBlock::of_grid(grid, min, min + WINDOW_EDGE as i32);
        let from = min - block.origin();
        let row = |y: usize, z: usize| match block.row(from.y + y as i32, from.z + z as i32) {
            Some(row) => (row[0] >> from.x) as u16,
            None => 0,
        };
        Window { rows: std::array::from_fn(|z| std::array::from_fn(|y| row(y, z))) }
    }

    /// Returns the number of voxels in the cube that reaches `reach` voxels around a voxel of the brick, and the sum of
    /// their offsets from it.
    fn moment(&self, local: UVec3, reach: u32) -> (u32, IVec3) {
        let [x, y, z] = (local + MAX_REACH_VX).to_array();
        let (mut count, mut sum) = (0, IVec3::ZERO);
        for dz in 0..=2 * reach {
            for dy in 0..=2 * reach {
                let row = self.rows[(z + dz - reach) as usize][(y + dy - reach) as usize];
                let bits = u32::from(row) >> (x - reach) & ((1 << (2 * reach + 1)) - 1);
                if bits == 0 {
                    continue;
                }
                let ones = bits.count_ones();
                count += ones;
                let along: i32 = (1..=reach as i32)
                    .map(|d| {
                        let at = |d: i32| (bits >> (reach as i32 + d) & 1) as i32;
                        d * (at(d) - at(-d))
                    })
                    .sum();
                let across = |d: u32| (d as i32 - reach as i32) * ones as i32;
                sum += IVec3::new(along, across(dy), across(dz));
            }
        }
        (count, sum)
    }
}

/// Returns the outward unit normal in world space at a surface voxel; 0 where all sides are alike.
pub fn normal_at(grid: &Grid, v: UVec3) -> Vec3 {
    let (_, moment) =
        Window::around(grid, v / BRICK_EDGE_VX).moment(v % BRICK_EDGE_VX, MAX_REACH_VX);
    (-moment.as_vec3() / grid.voxel_size()).normalize_or_zero()
}

#[cfg(test)]
#[path = "mask_tests.rs"]
mod tests;
