//! Replaces pages and whole cubes of the tree, and returns what was there before: for undo, and for writers of single
//! bricks. Adds many pages at once, as loaders make them.
//!
//! Keeps the tree canonical. Knows no record.

use std::sync::Arc;

use glam::UVec3;
use rayon::prelude::*;

use super::node::{BLANK, ColourCube, ColourNode, PaintedChild, differing, part, replace};
use super::{Material, Page};
use crate::sculpture::brick::{Brick, local_coords};
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::grid::Slot;

/// The pages of some bricks of a leaf, as they were.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct KeptLeaf {
    pub leaf: LeafKey,
    /// The bricks, and those of them that have a page.
    pub bricks: Brick,
    pub painted: Brick,
}

impl Material {
    /// Replaces the page of the brick at `b`, or its absence, and returns the old one.
    pub fn set_page(&mut self, b: UVec3, page: Option<Page>) -> Option<Page> {
        let brick = ColourCube { low: b, level: 0 };
        match self.replace(brick, page.map(PaintedChild::Page)) {
            Some(PaintedChild::Page(page)) => Some(page),
            _ => None,
        }
    }

    /// Gives all bricks of a cube one page, which must be uniform.
    pub(crate) fn set_cube(&mut self, cube: ColourCube, page: Page) {
        self.replace(cube, Some(PaintedChild::Page(page)));
    }

    /// Adds pages, each of another brick, or replaces those that these bricks have.
    pub fn set_pages(&mut self, mut pages: Vec<(UVec3, Page)>) {
        let place = |b: UVec3| (b.z >> 3, b.y >> 3, b.x >> 3, Slot::of(b).index());
        pages.par_sort_unstable_by_key(|(b, _)| place(*b));
        let extent = self.extent;
        let of_leaves = pages.chunk_by(|(a, _), (b, _)| *a >> 3 == *b >> 3);
        let lent: Vec<_> = of_leaves
            .map(|pages| (pages[0].0 >> 3, self.lend_leaf(pages[0].0 >> 3), pages))
            .collect();
        let written: Vec<_> = lent
            .into_par_iter()
            .map(|(leaf, child, pages)| {
                let cube = ColourCube { low: leaf << 3, level: 1 };
                let mut node = ColourNode::opened(child, cube, &extent);
                let new = pages
                    .iter()
                    .map(|(b, page)| (Slot::of(*b), Some(PaintedChild::Page(page.clone()))));
                Arc::make_mut(&mut node).put_all(new.collect(), cube, &extent);
                (cube, ColourNode::closed(node, cube, &extent))
            })
            .collect();
        for (cube, child) in written {
            self.replace(cube, child);
        }
    }

    /// Replaces a cube and returns the old one.
    pub(in crate::sculpture) fn replace(
        &mut self,
        cube: ColourCube,
        new: Option<PaintedChild>,
    ) -> Option<PaintedChild> {
        let (whole, extent) = (self.whole(), self.extent);
        replace(&mut self.root, whole, cube, new, &extent)
    }

    /// Takes a leaf out of the tree, so that it can be changed apart from it. It must be put back
    /// ([`Material::replace`]) before anything else is done.
    pub(super) fn lend_leaf(&mut self, leaf: UVec3) -> Option<PaintedChild> {
        let target = leaf << 3;
        let mut at = self.whole();
        let mut child = self.root.as_mut()?;
        loop {
            match child {
                PaintedChild::Page(page) => return Some(PaintedChild::Page(page.clone())),
                PaintedChild::Node(_) if at.level == 1 => {
                    return Some(std::mem::replace(child, BLANK));
                }
                PaintedChild::Node(node) => {
                    let slot = at.slot_of(target);
                    at = at.child(slot);
                    child = Arc::make_mut(node).child_mut(slot)?;
                }
            }
        }
    }

    /// Keeps the present pages of bricks of a leaf: adds them to `pages`.
    pub(in crate::sculpture) fn keep(
        &self,
        leaf: LeafKey,
        bricks: Brick,
        pages: &mut Vec<Page>,
    ) -> KeptLeaf {
        let found = self.find(ColourCube { low: leaf.coords() << 3, level: 1 });
        let mut painted = Brick::EMPTY;
        bricks.for_each(|index| {
            let slot = Slot::at(index);
            if let Some(PaintedChild::Page(page)) = part(found, slot) {
                slot.put(&mut painted, true);
                pages.push(page.clone());
            }
        });
        KeptLeaf { leaf, bricks, painted }
    }

    /// Calls `f` with the pages that bricks of a leaf have.
    pub(in crate::sculpture) fn for_each_page(
        &self,
        leaf: LeafKey,
        bricks: &Brick,
        f: &mut dyn FnMut(&Page),
    ) {
        let found = self.find(ColourCube { low: leaf.coords() << 3, level: 1 });
        bricks.for_each(|index| {
            if let Some(PaintedChild::Page(page)) = part(found, Slot::at(index)) {
                f(page);
            }
        });
    }

    /// Puts kept pages back, which `pages` returns in their order.
    pub(in crate::sculpture) fn put_kept(
        &mut self,
        kept: &KeptLeaf,
        pages: &mut impl Iterator<Item = Page>,
    ) {
        let cube = ColourCube { low: kept.leaf.coords() << 3, level: 1 };
        let child = self.lend_leaf(kept.leaf.coords());
        let mut node = ColourNode::opened(child, cube, &self.extent);
        let mut new = Vec::with_capacity(usize::from(kept.bricks.count()));
        kept.bricks.for_each(|index| {
            let slot = Slot::at(index);
            let page = if slot.is_in(&kept.painted) { pages.next() } else { None };
            new.push((slot, page.map(PaintedChild::Page)));
        });
        Arc::make_mut(&mut node).put_all(new, cube, &self.extent);
        let closed = ColourNode::closed(node, cube, &self.extent);
        self.replace(cube, closed);
    }

    /// Calls `f` with the leaves, and their bricks, whose pages differ from earlier ones of a cube.
    pub(in crate::sculpture) fn for_each_differing(
        &self,
        cube: ColourCube,
        before: Option<&PaintedChild>,
        f: &mut dyn FnMut(LeafKey, &Brick),
    ) {
        let found = self.find(cube);
        differing((before, found), cube, &self.extent, &mut |leaf, bricks| {
            f(LeafKey::of(leaf), bricks);
        });
    }
}

/// Returns the coordinates of a brick of a leaf.
pub(super) fn brick_of(leaf: UVec3, index: u32) -> UVec3 {
    (leaf << 3) + UVec3::from(local_coords(index))
}
