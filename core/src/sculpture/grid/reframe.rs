//! A grid in another box: its leaves moved as wholes, those at a border cut or filled up.
//!
//! Takes a grid, a size and a distance in leaves; returns a new grid that shares all leaves that stay as they are. Empty
//! and full parts cost nothing, however large they are.

use glam::{IVec3, UVec3};

use super::build::{Value, leaf_of, tree_of_leaves_and_cubes};
use super::extent::Extent;
use super::node::{Child, NODE_EDGE_LOG2};
use super::parts::uniform_in;
use super::{Grid, LeafKey};
use crate::sculpture::brick::Brick;
use crate::sculpture::region::BrickBox;

/// Returns a grid of `dims` voxels with the voxels of another one, moved by `shift` leaves. `dims` must have been checked.
pub(in crate::sculpture) fn reframed(grid: &Grid, dims: UVec3, shift: IVec3) -> Grid {
    let mut moved = Grid::empty(dims, grid.voxel_size);
    let (from, to) = (grid.extent, moved.extent);
    let whole = |bricks: BrickBox| match source_of(bricks, shift, &from) {
        None => Some(false),
        Some((source, is_covered)) => {
            uniform_in(grid, source).filter(|is_full| !is_full || is_covered)
        }
    };
    moved.root = tree_of_leaves_and_cubes(to, moved.levels, &whole, &|leaf| {
        // Beyond the old box, all is empty.
        let source = (leaf.as_ivec3() - shift).as_uvec3();
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

/// Returns where the bricks of a box lay in an extent before they moved by `shift` leaves, and whether all their voxels lay
/// there. `None` if none did.
pub(in crate::sculpture) fn source_of(
    bricks: BrickBox,
    shift: IVec3,
    from: &Extent,
) -> Option<(BrickBox, bool)> {
    let by = shift << NODE_EDGE_LOG2;
    let (min, max) = (bricks.min.as_ivec3() - by, bricks.max.as_ivec3() - by);
    let (low, high) = (min.max(IVec3::ZERO), max.min(from.bricks.as_ivec3()));
    if low.cmpge(high).any() {
        return None;
    }
    let source = BrickBox { min: low.as_uvec3(), max: high.as_uvec3() };
    Some((source, (low, high) == (min, max) && from.holds_brick(source.max - 1)))
}

/// Returns whether all voxels of a leaf lie within an extent.
fn is_whole(extent: &Extent, leaf: UVec3) -> bool {
    extent.holds_brick((leaf << NODE_EDGE_LOG2) + 7)
}
