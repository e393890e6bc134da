//! Reads the pages of a sculpture one after the other: remembers where the last one was.
//!
//! Takes brick coordinates, gives views of pages.

use glam::UVec3;

use super::node::{ColourCube, PaintedChild};
use super::{Material, PackedColour, PageView};
use crate::sculpture::colour::Rgb;
use crate::sculpture::grid::{NODE_EDGE_LOG2, Slot, box_mask, indices};
use crate::sculpture::region::BrickBox;

/// Returns the state of a box of bricks, cut to the extent, whose pages have all one colour or are all absent:
/// `Some(None)` if none is painted. `None` if they differ.
pub(crate) fn uniform_in(material: &Material, bricks: BrickBox) -> Option<Option<PackedColour>> {
    let max = bricks.max.min(material.extent.bricks);
    let mut known = None;
    let root = (material.root.as_ref(), material.whole());
    let is_uniform =
        bricks.min.cmplt(max).all() && agrees(root, BrickBox { max, ..bricks }, &mut known);
    known.filter(|_| is_uniform)
}

/// Returns whether the bricks of a box within a cube are all alike, and like those that are `known`.
fn agrees(
    (child, at): (Option<&PaintedChild>, ColourCube),
    within: BrickBox,
    known: &mut Option<Option<PackedColour>>,
) -> bool {
    let node = match child {
        None => return known.get_or_insert(None).is_none(),
        Some(PaintedChild::Page(page)) => {
            let colour = page.packed();
            return colour.is_some() && *known.get_or_insert(colour) == colour;
        }
        Some(PaintedChild::Node(node)) => node,
    };
    let log2 = at.log2() - NODE_EDGE_LOG2;
    let place = |b: UVec3| (b.saturating_sub(at.low) >> log2).min(UVec3::splat(7));
    let wanted = box_mask(place(within.min), place(within.max - 1));
    // An unpainted child is found without a look at the others.
    let unpainted = wanted.and_not(&node.painted);
    (unpainted.is_empty() || known.get_or_insert(None).is_none())
        && indices(wanted.and(&node.painted))
            .all(|index| agrees((node.child(Slot::at(index)), at.child_at(index)), within, known))
}

/// Reads pages, quickly where neighbours follow each other.
#[derive(Clone, Debug)]
pub struct PageReader<'a> {
    material: &'a Material,
    /// The coordinates of the last leaf, and its part of the tree.
    leaf: UVec3,
    found: Option<&'a PaintedChild>,
}

impl<'a> PageReader<'a> {
    pub(super) fn new(material: &'a Material) -> PageReader<'a> {
        PageReader { material, leaf: UVec3::MAX, found: None }
    }

    /// Returns the page of the brick at `b`, if it has been painted.
    #[inline(always)]
    pub fn page(&mut self, b: UVec3) -> Option<PageView<'a>> {
        if b >> 3 != self.leaf {
            self.leaf = b >> 3;
            self.found = self.material.find(ColourCube::around(b, 1));
        }
        let page = match self.found? {
            PaintedChild::Page(page) => page,
            PaintedChild::Node(leaf) => match leaf.child(Slot::of(b))? {
                PaintedChild::Page(page) => page,
                PaintedChild::Node(_) => return None,
            },
        };
        Some(PageView { page, depth: self.material.depth })
    }

    /// Returns the page of the brick at `b`, if it has been painted, and the end along x of the bricks that surely have
    /// the same.
    pub fn span(&self, b: UVec3) -> (Option<PageView<'a>>, u32) {
        let material = self.material;
        let (mut child, mut at) = (material.root.as_ref(), material.whole());
        while let Some(PaintedChild::Node(node)) = child {
            let slot = at.slot_of(b);
            (child, at) = (node.child(slot), at.child(slot));
        }
        let page = match child {
            Some(PaintedChild::Page(page)) => Some(PageView { page, depth: material.depth }),
            _ => None,
        };
        (page, at.low.x + (1 << at.log2()))
    }

    /// Returns the colour of voxel `local` (0..512) of the brick at `b`.
    #[inline(always)]
    pub fn rgb(&mut self, b: UVec3, local: u32) -> Rgb {
        self.page(b).map_or(self.material.base, |page| page.rgb(local))
    }
}
