//! The colours of a sculpture in another box: the pages of its bricks moved by whole leaves.
//!
//! Takes colours, a size and a distance in leaves; returns new colours that share what stays as it is. A brick at a border
//! keeps its page as a whole; a brick beyond the border has none.

use std::sync::Arc;

use glam::{IVec3, UVec3};

use super::Material;
use super::node::{ColourCube, ColourNode, PaintedChild};
use crate::sculpture::brick::Brick;
use crate::sculpture::grid::{Extent, NODE_EDGE_LOG2, Slot};

/// Returns the colours for a grid of `dims` voxels, with the pages of other ones moved by `shift` leaves.
pub(in crate::sculpture) fn reframed(material: &Material, dims: UVec3, shift: IVec3) -> Material {
    let mut moved = Material::new(material.depth, material.base, dims);
    let (from, to) = (material.extent, moved.extent);
    let leaves = |extent: &Extent| ((extent.bricks + 7) >> NODE_EDGE_LOG2).as_ivec3();
    let (low, high) = (shift.max(IVec3::ZERO), (leaves(&from) + shift).min(leaves(&to)));
    if material.root.is_none() || low.cmpge(high).any() {
        return moved;
    }
    let cube = |leaf: IVec3| ColourCube { low: leaf.as_uvec3() << NODE_EDGE_LOG2, level: 1 };
    for z in low.z..high.z {
        for y in low.y..high.y {
            for x in low.x..high.x {
                let leaf = IVec3::new(x, y, z);
                let (source, target) = (cube(leaf - shift), cube(leaf));
                let Some(child) = material.find(source) else { continue };
                let is_whole =
                    |cube: ColourCube, extent: &Extent| cube.children(extent) == Brick::FULL;
                let child = match is_whole(source, &from) && is_whole(target, &to) {
                    true => Some(child.clone()),
                    false => cut(child.clone(), (source, &from), (target, &to)),
                };
                moved.replace(target, child);
            }
        }
    }
    moved
}

/// Returns a leaf of one extent as a leaf of another, without the bricks beyond its border.
fn cut(
    child: PaintedChild,
    (source, from): (ColourCube, &Extent),
    (target, to): (ColourCube, &Extent),
) -> Option<PaintedChild> {
    let node = ColourNode::opened(Some(child), source, from);
    let painted = node.painted.and(&target.children(to));
    let mut children = Vec::with_capacity(usize::from(painted.count()));
    painted.for_each(|index| children.extend(node.child(Slot::at(index)).cloned()));
    ColourNode::closed(Arc::new(ColourNode::new(painted, children, target, to)), target, to)
}
