//! The colours of a sculpture in another box: the pages of its bricks moved by whole leaves.
//!
//! Takes colours, a size and a distance in leaves; returns new colours that share what stays as it is. A brick at a border
//! keeps its page as a whole; a brick beyond the border has none. Cubes of one colour cost nothing, however large they are.

use std::sync::Arc;

use glam::{IVec3, UVec3};

use super::Material;
use super::node::{ColourCube, ColourNode, PaintedChild};
use super::page::Page;
use super::read::uniform_in;
use crate::sculpture::brick::Brick;
use crate::sculpture::grid::{Extent, Slot, source_of};
use crate::sculpture::region::BrickBox;

/// Returns the colours for a grid of `dims` voxels, with the pages of other ones moved by `shift` leaves.
pub(in crate::sculpture) fn reframed(material: &Material, dims: UVec3, shift: IVec3) -> Material {
    let mut moved = Material::new(material.depth, material.base, dims);
    let whole = moved.whole();
    move_into(&mut moved, whole, material, shift);
    moved
}

/// Gives the cube `target` of `moved` the pages that lie there once those of `material` have moved by `shift` leaves.
fn move_into(moved: &mut Material, target: ColourCube, material: &Material, shift: IVec3) {
    let (from, to) = (material.extent, moved.extent);
    let max = (target.low + (1 << target.log2())).min(to.bricks);
    let bricks = BrickBox { min: target.low, max };
    let Some((source, is_covered)) = source_of(bricks, shift, &from) else { return };
    match uniform_in(material, source) {
        Some(None) => {}
        Some(Some(colour)) if is_covered => {
            moved.replace(target, Some(PaintedChild::Page(Page::of_packed(colour))));
        }
        _ if target.level > 1 => target
            .children(&to)
            .for_each(|index| move_into(moved, target.child_at(index), material, shift)),
        _ => {
            let source = ColourCube { low: source.min, level: 1 };
            let Some(child) = material.find(source) else { return };
            let is_whole = |cube: ColourCube, extent: &Extent| cube.children(extent) == Brick::FULL;
            let child = match is_whole(source, &from) && is_whole(target, &to) {
                true => Some(child.clone()),
                false => cut(child.clone(), (source, &from), (target, &to)),
            };
            moved.replace(target, child);
        }
    }
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
