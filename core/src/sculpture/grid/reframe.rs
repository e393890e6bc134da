//! A grid in another box: its leaves moved as wholes, those at a border cut or filled up.
//!
//! Takes a grid, a size and a distance in leaves; returns a new grid that shares all leaves that stay as they are.

use glam::{IVec3, UVec3};

use super::build::{Value, leaf_of, tree_of_leaves};
use super::extent::Extent;
use super::node::{Child, NODE_EDGE_LOG2};
use super::{Grid, LeafKey};
use crate::sculpture::brick::Brick;

/// Returns a grid of `dims` voxels with the voxels of another one, moved by `shift` leaves. `dims` must have been checked.
pub(in crate::sculpture) fn reframed(grid: &Grid, dims: UVec3, shift: IVec3) -> Grid {
    let mut moved = Grid::empty(dims, grid.voxel_size);
    let (from, to) = (grid.extent, moved.extent);
    let sources = ((from.bricks + 7) >> NODE_EDGE_LOG2).as_ivec3();
    moved.root = tree_of_leaves(to, moved.levels, &|leaf| {
        let source = leaf.as_ivec3() - shift;
        if source.cmplt(IVec3::ZERO).any() || source.cmpge(sources).any() {
            return Child::Empty;
        }
        let source = source.as_uvec3();
        let child = grid.leaf_bits(LeafKey::of(source)).into_child();
        if matches!(child, Child::Empty) || is_whole(&from, source) && is_whole(&to, leaf) {
            return child;
        }
        let low = leaf << NODE_EDGE_LOG2;
        leaf_of(&to, leaf, |b, valid| {
            let at = b - low + (source << NODE_EDGE_LOG2);
            let is_inside = at.cmplt(from.bricks).all();
            let bits = if is_inside { *grid.brick(at) } else { Brick::EMPTY };
            Value::of(bits.and(valid))
        })
    });
    moved
}

/// Returns whether all voxels of a leaf lie within an extent.
fn is_whole(extent: &Extent, leaf: UVec3) -> bool {
    extent.holds_brick((leaf << NODE_EDGE_LOG2) + 7)
}
