//! The nodes of the tree of colours: cubes of 8^3 children, shared between sculptures and copied when one of them
//! changes.
//!
//! Children of a leaf (level 1) are bricks, those of a node of level `n` cubes of `8^(n-1)` bricks an edge. A mask tells
//! which are painted, a bit per child in the order of a brick's voxels; only these take memory, in that order without
//! gaps. A child is a node or a page: the page of a brick, or one colour for all bricks of a cube. Nodes are canonical:
//! one whose bricks within the extent have the same single colour is that colour, and one without painted bricks is
//! none. Knows no grid and no coordinates beyond the extent.

use std::sync::Arc;

use glam::UVec3;

use super::page::{PackedColour, Page, SHARED_BYTES};
use crate::sculpture::brick::{Brick, local_coords};
use crate::sculpture::grid::{Extent, NODE_EDGE_LOG2, Slot};

/// A cube of the tree: a brick (level 0), a leaf, or a larger node.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct ColourCube {
    /// Its lowest brick, a multiple of its edge.
    pub low: UVec3,
    /// The logarithm to base 8 of its volume in bricks.
    pub level: u32,
}

impl ColourCube {
    /// Returns the cube of a level that holds a brick.
    pub fn around(b: UVec3, level: u32) -> ColourCube {
        let log2 = NODE_EDGE_LOG2 * level;
        ColourCube { low: b >> log2 << log2, level }
    }

    /// Returns the logarithm of the edge in bricks.
    pub fn log2(self) -> u32 {
        NODE_EDGE_LOG2 * self.level
    }

    /// Returns the cube of the child at `slot`; the cube must be no brick.
    #[inline(always)]
    pub(super) fn child(self, slot: Slot) -> ColourCube {
        self.child_at(slot.index() as u32)
    }

    /// Returns the cube of the child of an index in 0..512; the cube must be no brick.
    #[inline(always)]
    pub(crate) fn child_at(self, index: u32) -> ColourCube {
        let level = self.level - 1;
        let at = UVec3::from(local_coords(index));
        ColourCube { low: self.low + (at << (NODE_EDGE_LOG2 * level)), level }
    }

    /// Returns the slot of the child that holds a brick.
    #[inline(always)]
    pub(super) fn slot_of(self, b: UVec3) -> Slot {
        Slot::of(b >> (NODE_EDGE_LOG2 * (self.level - 1)))
    }

    /// Returns the children that lie at least partly within an extent.
    #[inline(always)]
    pub(super) fn children(self, extent: &Extent) -> Brick {
        extent.children(self.low, NODE_EDGE_LOG2 * (self.level - 1))
    }

    /// Returns the number of its bricks within an extent.
    pub(super) fn bricks(self, extent: &Extent) -> u64 {
        let edge = UVec3::splat(1 << self.log2());
        extent.bricks.saturating_sub(self.low).min(edge).as_u64vec3().element_product()
    }
}

/// A painted child of a node.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum PaintedChild {
    /// The page of a brick, or of all bricks of a cube: then of one colour.
    Page(Page),
    Node(Arc<ColourNode>),
}

/// Children of a node.
pub(super) const CHILDREN: usize = 512;
/// The bytes of a child in the list of its node.
pub(super) const CHILD_BYTES: usize = size_of::<PaintedChild>();
/// The bytes of a node without its children.
pub(super) const NODE_BYTES: usize = size_of::<ColourNode>() + SHARED_BYTES;

impl PaintedChild {
    /// Returns the painted bricks of a child that is this cube.
    pub(super) fn pages(&self, cube: ColourCube, extent: &Extent) -> u64 {
        match self {
            PaintedChild::Page(_) => cube.bricks(extent),
            PaintedChild::Node(node) => node.pages,
        }
    }

    /// Returns the state of a cube, in a sculpture of `dims` voxels, from its painted children, in the order of their
    /// mask. Nodes among them must be of the next lower level, and pages of other cubes than bricks have one colour.
    /// `None` if no child is painted, or if one of them lies beyond the border.
    pub fn of_children(
        painted: Brick,
        children: Vec<PaintedChild>,
        cube: ColourCube,
        dims: UVec3,
    ) -> Option<PaintedChild> {
        let extent = Extent::new(dims);
        if !painted.and_not(&cube.children(&extent)).is_empty() {
            return None;
        }
        let node = ColourNode::new(painted, children, cube, &extent);
        ColourNode::closed(Arc::new(node), cube, &extent)
    }

    /// Returns the heap bytes, shared or not.
    pub fn heap_bytes(&self) -> usize {
        match self {
            PaintedChild::Page(page) => page.heap_bytes(),
            PaintedChild::Node(node) => node.bytes as usize,
        }
    }
}

/// A node of 8^3 children.
#[derive(Clone, Debug)]
pub(crate) struct ColourNode {
    /// Which children are painted, at least in part.
    pub painted: Brick,
    /// The number of painted children before each word of the mask.
    before: [u16; 8],
    /// The painted children, in the order of the mask.
    children: Vec<PaintedChild>,
    /// The number of painted bricks.
    pages: u64,
    /// The heap bytes of the node and all below it, shared or not. Leaves out the room to spare of lists, so that equal
    /// sculptures have equal sizes.
    bytes: u64,
}

impl ColourNode {
    /// Returns the node of a cube from its painted children, in the order of the mask.
    pub(super) fn new(
        painted: Brick,
        children: Vec<PaintedChild>,
        cube: ColourCube,
        extent: &Extent,
    ) -> ColourNode {
        debug_assert_eq!(children.len(), usize::from(painted.count()));
        let before = [0; 8];
        let mut node = ColourNode { painted, before, children, pages: 0, bytes: 0 };
        node.recount(cube, extent);
        node
    }

    /// Returns the node of a cube as it would be with children of its own.
    pub(super) fn opened(
        child: Option<PaintedChild>,
        cube: ColourCube,
        extent: &Extent,
    ) -> Arc<ColourNode> {
        match child {
            Some(PaintedChild::Node(node)) => node,
            None => Arc::new(ColourNode::new(Brick::EMPTY, Vec::new(), cube, extent)),
            Some(page @ PaintedChild::Page(_)) => {
                let inside = cube.children(extent);
                let children = vec![page; usize::from(inside.count())];
                Arc::new(ColourNode::new(inside, children, cube, extent))
            }
        }
    }

    /// Returns the node as a child: none, one colour, or itself.
    pub(super) fn closed(
        node: Arc<ColourNode>,
        cube: ColourCube,
        extent: &Extent,
    ) -> Option<PaintedChild> {
        let first = node.children.first()?;
        if let PaintedChild::Page(page) = first
            && page.packed().is_some()
            && node.children.iter().rev().all(|child| child == first)
            && node.painted == cube.children(extent)
        {
            return Some(first.clone());
        }
        Some(PaintedChild::Node(node))
    }

    /// Returns the place of a child among the painted ones, or that of the next.
    #[inline(always)]
    fn rank(&self, slot: Slot) -> usize {
        let below = self.painted.words[slot.word] & ((1 << slot.bit) - 1);
        usize::from(self.before[slot.word]) + below.count_ones() as usize
    }

    /// Returns the child at `slot`, if it is painted.
    #[inline(always)]
    pub(super) fn child(&self, slot: Slot) -> Option<&PaintedChild> {
        if slot.is_in(&self.painted) { self.children.get(self.rank(slot)) } else { None }
    }

    /// Returns the child at `slot` for changes, if it is painted. The counts are left to the caller.
    #[inline(always)]
    pub(super) fn child_mut(&mut self, slot: Slot) -> Option<&mut PaintedChild> {
        let at = self.rank(slot);
        if slot.is_in(&self.painted) { self.children.get_mut(at) } else { None }
    }

    /// Returns the painted children, in the order of the mask.
    pub fn painted_children(&self) -> &[PaintedChild] {
        &self.children
    }

    /// Replaces the child at `slot`. The counts are left to the caller.
    pub(super) fn put(&mut self, slot: Slot, child: Option<PaintedChild>) {
        let at = self.rank(slot);
        let is_painted = child.is_some();
        match (slot.is_in(&self.painted), child) {
            (true, Some(child)) => self.children[at] = child,
            (true, None) => drop(self.children.remove(at)),
            (false, Some(child)) => {
                if self.children.len() == self.children.capacity() {
                    self.children.reserve_exact(8);
                }
                self.children.insert(at, child);
            }
            (false, None) => {}
        }
        slot.put(&mut self.painted, is_painted);
    }

    /// Replaces children, named by slot in rising order, of a cube.
    pub(super) fn put_all(
        &mut self,
        new: Vec<(Slot, Option<PaintedChild>)>,
        cube: ColourCube,
        extent: &Extent,
    ) {
        let mut painted = self.painted;
        for (slot, child) in &new {
            slot.put(&mut painted, child.is_some());
        }
        if painted == self.painted {
            for (slot, child) in new {
                if let (Some(here), Some(child)) = (self.child_mut(slot), child) {
                    *here = child;
                }
            }
        } else {
            let mut children = Vec::with_capacity(usize::from(painted.count()));
            let mut old = std::mem::take(&mut self.children).into_iter();
            let mut new = new.into_iter().peekable();
            let was = self.painted;
            was.or(&painted).for_each(|index| {
                let slot = Slot::at(index);
                let kept = if slot.is_in(&was) { old.next() } else { None };
                match new.next_if(|(at, _)| *at == slot) {
                    Some((_, child)) => children.extend(child),
                    None => children.extend(kept),
                }
            });
            (self.painted, self.children) = (painted, children);
        }
        self.recount(cube, extent);
    }

    /// Returns the counts.
    #[cfg(test)]
    pub(super) fn counts(&self) -> ([u16; 8], u64, u64) {
        (self.before, self.pages, self.bytes)
    }

    /// Counts the painted bricks and the bytes again, from the counts of the children.
    pub(super) fn recount(&mut self, cube: ColourCube, extent: &Extent) {
        let mut sum = 0;
        for (before, word) in self.before.iter_mut().zip(self.painted.words) {
            *before = sum;
            sum += word.count_ones() as u16;
        }
        let is_whole = (cube.low + (1 << cube.log2())).cmple(extent.bricks).all();
        let each = if is_whole { 1 << (3 * (cube.log2() - NODE_EDGE_LOG2)) } else { 0 };
        let (mut pages, mut bytes) = (0, NODE_BYTES + self.children.len() * CHILD_BYTES);
        for child in &self.children {
            bytes += child.heap_bytes();
            pages += match child {
                PaintedChild::Node(node) => node.pages,
                PaintedChild::Page(_) => each,
            };
        }
        if !is_whole {
            let mut children = self.children.iter();
            self.painted.for_each(|index| {
                if let Some(PaintedChild::Page(_)) = children.next() {
                    pages += cube.child(Slot::at(index)).bricks(extent);
                }
            });
        }
        (self.pages, self.bytes) = (pages, bytes as u64);
    }
}

impl PartialEq for ColourNode {
    fn eq(&self, other: &ColourNode) -> bool {
        let same = |(a, b): (&PaintedChild, &PaintedChild)| match (a, b) {
            (PaintedChild::Node(a), PaintedChild::Node(b)) => Arc::ptr_eq(a, b) || a == b,
            (a, b) => a == b,
        };
        self.painted == other.painted && self.children.iter().zip(&other.children).all(same)
    }
}

/// Replaces the part of `child`, which is the cube `at`, that is the cube `target`, and returns the old one.
pub(super) fn replace(
    child: &mut Option<PaintedChild>,
    at: ColourCube,
    target: ColourCube,
    new: Option<PaintedChild>,
    extent: &Extent,
) -> Option<PaintedChild> {
    if at.level == target.level {
        return std::mem::replace(child, new);
    }
    if matches!((&*child, &new), (None, None)) || is_page(child) && *child == new {
        return new;
    }
    let mut node = ColourNode::opened(child.take(), at, extent);
    let own = Arc::make_mut(&mut node);
    let slot = at.slot_of(target.low);
    // The child leaves the list for as long as it changes, so that it is not shared.
    let mut inner = own.child_mut(slot).map(|child| std::mem::replace(child, BLANK));
    let old = replace(&mut inner, at.child(slot), target, new, extent);
    own.put(slot, inner);
    own.recount(at, extent);
    *child = ColourNode::closed(node, at, extent);
    old
}

fn is_page(child: &Option<PaintedChild>) -> bool {
    matches!(child, Some(PaintedChild::Page(_)))
}

/// Stands in a list for a child that has been taken out.
pub(super) const BLANK: PaintedChild =
    PaintedChild::Page(Page(super::page::PageForm::Uniform(PackedColour(0))));

/// Calls `f` with the leaves, and their bricks, in which two states of a cube differ.
pub(super) fn differing(
    (a, b): (Option<&PaintedChild>, Option<&PaintedChild>),
    cube: ColourCube,
    extent: &Extent,
    f: &mut dyn FnMut(UVec3, &Brick),
) {
    match (a, b) {
        (None, None) => return,
        (Some(PaintedChild::Node(a)), Some(PaintedChild::Node(b))) if Arc::ptr_eq(a, b) => return,
        (Some(PaintedChild::Page(a)), Some(PaintedChild::Page(b))) if a == b => return,
        _ => {}
    }
    let within = |child: Option<&PaintedChild>| match child {
        Some(PaintedChild::Node(node)) => node.painted,
        Some(PaintedChild::Page(_)) => cube.children(extent),
        None => Brick::EMPTY,
    };
    let mut bricks = Brick::EMPTY;
    within(a).or(&within(b)).for_each(|index| {
        let slot = Slot::at(index);
        let (a, b) = (part(a, slot), part(b, slot));
        if cube.level > 1 {
            differing((a, b), cube.child(slot), extent, f);
        } else if a != b {
            slot.put(&mut bricks, true);
        }
    });
    if !bricks.is_empty() {
        f(cube.low >> NODE_EDGE_LOG2, &bricks);
    }
}

/// Returns the child at `slot` of a child.
#[inline(always)]
pub(super) fn part(child: Option<&PaintedChild>, slot: Slot) -> Option<&PaintedChild> {
    match child {
        Some(PaintedChild::Node(node)) => node.child(slot),
        page => page,
    }
}
