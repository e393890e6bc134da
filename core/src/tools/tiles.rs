//! Tiles for filters that look at a neighbourhood of each voxel: boxes of leaves that hold all places whose surroundings
//! are not uniform. What lies far from a surface belongs to no tile.
//!
//! From a grid to boxes of voxels. Changes nothing.

use glam::{IVec3, UVec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick};
use crate::sculpture::grid::{LEAF_EDGE_LOG2, uniform_in};
use crate::sculpture::region::{BrickBox, ListedBricks, VoxelBox};

/// A filter, as far as the choice of tiles depends on it.
#[derive(Clone, Copy, Debug)]
pub struct TileRule {
    /// How far a voxel's surroundings reach, in voxels.
    pub reach_vx: u32,
    /// Cubes that are all empty (`false`) or all full have nothing to be computed, whatever is around them.
    pub idle: Option<bool>,
    /// Whether the border of the grid counts as a surface of what is full.
    pub border_is_surface: bool,
    /// The most leaves of a tile along each axis.
    pub most_leaves: UVec3,
}

/// Returns the tiles of a grid, none of which overlap. They may reach beyond the border.
pub fn tiles(grid: &Grid, rule: &TileRule) -> Vec<VoxelBox> {
    let mut leaves = Vec::new();
    let dims = grid.brick_dims();
    let edge = dims.max_element();
    let log2 = (LEAF_EDGE_LOG2..).step_by(LEAF_EDGE_LOG2 as usize).find(|log2| edge <= 1 << log2);
    add_leaves(grid, rule, UVec3::ZERO, log2.unwrap_or(LEAF_EDGE_LOG2), &mut leaves);
    leaves.sort_unstable_by_key(|leaf| (leaf.z, leaf.y, leaf.x));
    let mut left: FxHashSet<UVec3> = leaves.iter().copied().collect();
    let edge = (BRICK_EDGE_VX << LEAF_EDGE_LOG2) as i32;
    let mut tiles = Vec::new();
    for leaf in leaves {
        if left.contains(&leaf) {
            let end = largest_box(leaf, rule.most_leaves, &left);
            leaves_of(leaf, end).for_each(|leaf| _ = left.remove(&leaf));
            tiles.push(VoxelBox { min: leaf.as_ivec3() * edge, max: end.as_ivec3() * edge });
        }
    }
    tiles
}

/// Adds the leaves of a cube that have something to be computed.
fn add_leaves(grid: &Grid, rule: &TileRule, low: UVec3, log2: u32, leaves: &mut Vec<UVec3>) {
    let dims = grid.brick_dims();
    let cube = BrickBox { min: low, max: (low + (1 << log2)).min(dims) };
    let reach = UVec3::splat(rule.reach_vx.div_ceil(BRICK_EDGE_VX));
    let (min, max) = (low.saturating_sub(reach), cube.max + reach);
    let leaves_grid = low.cmplt(reach).any() || max.cmpgt(dims).any();
    let is_idle = match uniform_in(grid, BrickBox { min, max }) {
        Some(true) if rule.border_is_surface => !leaves_grid,
        Some(_) => true,
        None => rule.idle.is_some() && uniform_in(grid, cube) == rule.idle,
    };
    if is_idle {
        return;
    }
    if log2 == LEAF_EDGE_LOG2 {
        leaves.push(low >> LEAF_EDGE_LOG2);
        return;
    }
    let child_log2 = log2 - LEAF_EDGE_LOG2;
    let end = (cube.max - low + ((1 << child_log2) - 1)) >> child_log2;
    for at in leaves_of(UVec3::ZERO, end) {
        add_leaves(grid, rule, low + (at << child_log2), child_log2, leaves);
    }
}

/// Returns the end of a box of leaves of the set, from `low` on.
fn largest_box(low: UVec3, most: UVec3, left: &FxHashSet<UVec3>) -> UVec3 {
    let mut end = low + 1;
    for axis in 0..3 {
        while end[axis] < low[axis] + most[axis] {
            let (mut first, mut last) = (low, end);
            first[axis] = end[axis];
            last[axis] += 1;
            if !leaves_of(first, last).all(|leaf| left.contains(&leaf)) {
                break;
            }
            end[axis] += 1;
        }
    }
    end
}

fn leaves_of(low: UVec3, end: UVec3) -> impl Iterator<Item = UVec3> {
    (low.z..end.z).flat_map(move |z| {
        (low.y..end.y).flat_map(move |y| (low.x..end.x).map(move |x| UVec3::new(x, y, z)))
    })
}

/// Returns the voxels that `f` returns for the tiles, on all threads. It may return those of its tile alone.
pub fn in_tiles<const N: usize>(
    grid: &Grid,
    tiles: &[VoxelBox],
    f: impl Fn(VoxelBox) -> [Vec<(UVec3, Brick)>; N] + Sync,
) -> [ListedBricks; N] {
    let inside = VoxelBox::of_grid(grid);
    let of_tile = |tile: &VoxelBox| f(tile.intersect(inside));
    let all: Vec<[Vec<(UVec3, Brick)>; N]> = tiles.par_iter().map(of_tile).collect();
    let mut lists: [Vec<(UVec3, Brick)>; N] = std::array::from_fn(|_| Vec::new());
    for found in all {
        lists.iter_mut().zip(found).for_each(|(list, mut found)| list.append(&mut found));
    }
    lists.map(|mut list| {
        list.par_sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
        ListedBricks::new(list)
    })
}

/// Returns a box, extended by a number of voxels on all sides.
pub fn widened(tile: VoxelBox, by: u32) -> VoxelBox {
    let by = IVec3::splat(by as i32);
    VoxelBox { min: tile.min - by, max: tile.max + by }
}
