//! Changes a grid's tree: leaves are lent out, edited apart from the tree on any thread, and put back; whole cubes are
//! filled or emptied at once.
//!
//! Takes the choice of an edit for each cube that may change; returns the leaves that it opens and the bricks that it
//! changes at once. Keeps the tree canonical and its counts of voxels right. Knows no tool and no record.

use std::sync::Arc;

use glam::UVec3;

use super::extent::Extent;
use super::leaf_edit::{LeafEdit, kinds};
use super::node::{Child, NODE_EDGE, NODE_EDGE_LOG2, Slot, TreeNode};
use super::{Grid, LeafKey};
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::region::{BrickBox, VoxelBox};

/// A cube of the tree: a child of one of its nodes, but no brick.
#[derive(Clone, Copy, Debug)]
pub(in crate::sculpture) struct Cube {
    /// Its lowest brick.
    pub low: UVec3,
    /// The logarithm of its edge in bricks: 3 for a leaf.
    pub log2: u32,
    pub is_empty: bool,
    pub is_full: bool,
}

impl Cube {
    /// Returns its voxels, those beyond the border of the grid included.
    pub fn voxels(self) -> VoxelBox {
        let min = (self.low * BRICK_EDGE_VX).as_ivec3();
        VoxelBox { min, max: min + (BRICK_EDGE_VX << self.log2) as i32 }
    }
}

/// The change that an edit makes to a cube.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::sculpture) enum CubeEdit {
    /// Nothing in it changes.
    Skip,
    /// All its voxels exist from now on.
    Fill,
    /// None of its voxels exists from now on.
    Clear,
    /// Parts of it may change.
    Open,
}

/// A leaf that is lent out, apart from the tree.
#[derive(Debug)]
pub(in crate::sculpture) struct LentLeaf {
    /// The leaf's coordinates: those of its lowest brick, divided by 8.
    pub leaf: UVec3,
    node: Arc<TreeNode>,
    /// Whether the leaf was full; `None` if it was mixed.
    was_full: Option<bool>,
    voxels_before: u64,
}

/// The bits that a leaf had, shared with the tree for as long as they stay the same.
#[derive(Clone, Debug)]
pub(in crate::sculpture) struct OldLeaf(Child);

impl OldLeaf {
    pub const EMPTY: OldLeaf = OldLeaf(Child::Empty);

    /// Returns the leaf as a child of a node.
    pub(super) fn into_child(self) -> Child {
        self.0
    }

    /// Returns whether all its bricks are empty, or all full.
    pub fn is_uniform(&self) -> bool {
        !matches!(self.0, Child::Mixed(_))
    }

    /// Returns how many of the given bricks are neither empty nor full.
    pub fn mixed(&self, bricks: &Brick) -> usize {
        match &self.0 {
            Child::Empty | Child::Full => 0,
            Child::Mixed(leaf) => usize::from(bricks.and(&leaf.mixed).count()),
        }
    }

    /// Returns the given bricks by kind: empty, full (within the grid) and mixed, and passes the mixed ones to `keep` in
    /// the order of their masks.
    #[inline(always)]
    pub fn kinds(&self, bricks: Brick, mut keep: impl FnMut(&Brick)) -> [Brick; 3] {
        match &self.0 {
            Child::Empty => [bricks, Brick::EMPTY, Brick::EMPTY],
            Child::Full => [Brick::EMPTY, bricks, Brick::EMPTY],
            Child::Mixed(leaf) => kinds(leaf, bricks, &mut keep),
        }
    }
}

/// A leaf some of whose bricks have changed.
#[derive(Debug)]
pub(in crate::sculpture) struct ChangedLeaf {
    pub leaf: LeafKey,
    pub bricks: Brick,
    /// The bits before, unless they were not asked for.
    pub before: Option<OldLeaf>,
}

impl LentLeaf {
    /// Returns the bits of the leaf.
    pub fn bits(&self) -> OldLeaf {
        OldLeaf(match self.was_full {
            Some(false) => Child::Empty,
            Some(true) => Child::Full,
            None => Child::Mixed(self.node.clone()),
        })
    }

    /// Begins an edit of the leaf. It changes with [`LeafEdit::finish`].
    #[inline(always)]
    pub fn edit<'a>(&'a mut self, grid: LeafPlace, scratch: &'a mut [Brick; 512]) -> LeafEdit<'a> {
        LeafEdit::new(grid.extent, self.leaf, &mut self.node, scratch)
    }
}

/// The place of leaves: all that an edit needs to know of the grid while its tree is lent out.
#[derive(Clone, Copy, Debug)]
pub(in crate::sculpture) struct LeafPlace {
    extent: Extent,
}

impl LeafPlace {
    /// Returns whether the border of the grid cuts no brick of a cube.
    pub fn holds_whole_bricks(&self, cube: Cube) -> bool {
        let dims = self.extent.dims;
        let end = (cube.low + (1 << cube.log2)) * BRICK_EDGE_VX;
        end.min(dims).map(|end| end % BRICK_EDGE_VX) == UVec3::ZERO
    }
}

/// The leaves that an edit opens, and those that it has changed at once.
#[derive(Debug, Default)]
pub(in crate::sculpture) struct Lent {
    pub leaves: Vec<LentLeaf>,
    pub changed: Vec<ChangedLeaf>,
    pub voxels_added: u64,
    pub voxels_removed: u64,
}

impl Grid {
    /// Returns what [`LentLeaf::edit`] needs to know of the grid.
    pub(in crate::sculpture) fn leaf_place(&self) -> LeafPlace {
        LeafPlace { extent: self.extent }
    }

    /// Lets `choose` decide about the cubes that hold bricks of `bounds`, the large ones first, and performs its
    /// decisions. The leaves that it opens must be put back ([`Grid::put_back`]) before the grid is read again.
    pub(in crate::sculpture) fn lend(
        &mut self,
        bounds: BrickBox,
        choose: &mut dyn FnMut(Cube) -> CubeEdit,
    ) -> Lent {
        let mut lender = Lender { extent: self.extent, bounds, choose, lent: Lent::default() };
        lender.visit(&mut self.root, UVec3::ZERO, self.levels);
        lender.lent
    }

    /// Lends out one leaf.
    pub(in crate::sculpture) fn lend_leaf(&mut self, leaf: UVec3) -> LentLeaf {
        lend_leaf(&mut self.root, self.levels, leaf, &self.extent)
    }

    /// Replaces bricks of a leaf. `kinds`: the bricks, and those of them that shall be full and mixed, with the bits of
    /// the mixed ones in `bits`. Returns the kinds before: empty, full and mixed, and adds the bits of those that were
    /// mixed to `earlier`.
    pub(in crate::sculpture) fn replace_in(
        &mut self,
        leaf: LeafKey,
        kinds: [Brick; 3],
        bits: &[Brick],
        scratch: &mut [Brick; 512],
        earlier: &mut Vec<Brick>,
    ) -> [Brick; 3] {
        let mut lent = self.lend_leaf(leaf.coords());
        let mut edit = lent.edit(self.leaf_place(), scratch);
        let before = edit.replace_all(kinds, bits, earlier);
        edit.finish();
        self.put_back([lent]);
        before
    }

    /// Returns the bits of a leaf.
    pub(in crate::sculpture) fn leaf_bits(&self, leaf: LeafKey) -> OldLeaf {
        let low = leaf.coords() << NODE_EDGE_LOG2;
        let (mut node, mut level) = (&self.root, self.levels);
        loop {
            let slot = slot_in(low, level);
            if !slot.is_in(&node.mixed) {
                let is_full = slot.is_in(&node.full);
                return OldLeaf(if is_full { Child::Full } else { Child::Empty });
            }
            node = &node.nodes()[node.rank(slot)];
            level -= 1;
            if level == 1 {
                return OldLeaf(Child::Mixed(node.clone()));
            }
        }
    }

    /// Puts leaves back that were lent out, edited or not.
    pub(in crate::sculpture) fn put_back(&mut self, leaves: impl IntoIterator<Item = LentLeaf>) {
        for LentLeaf { leaf, node, voxels_before, .. } in leaves {
            let change = node.voxels as i64 - voxels_before as i64;
            put(&mut self.root, self.levels, leaf, node, change, &self.extent);
        }
    }
}

/// Takes a leaf out of a tree of `level` levels.
fn lend_leaf(node: &mut Arc<TreeNode>, level: u32, leaf: UVec3, extent: &Extent) -> LentLeaf {
    let low = leaf << NODE_EDGE_LOG2;
    let slot = slot_in(low, level);
    let node = Arc::make_mut(node);
    match level {
        2 => take_leaf(node, slot, leaf, extent),
        _ => lend_leaf(open(node, slot, low, level, extent), level - 1, leaf, extent),
    }
}

/// Stands in the tree for a leaf that is lent out.
static BLANK_LEAF: std::sync::LazyLock<Arc<TreeNode>> =
    std::sync::LazyLock::new(|| Arc::new(TreeNode::uniform(Brick::EMPTY, 0)));

/// A visit to all cubes that an edit may change.
struct Lender<'a> {
    extent: Extent,
    bounds: BrickBox,
    choose: &'a mut dyn FnMut(Cube) -> CubeEdit,
    lent: Lent,
}

impl Lender<'_> {
    /// Visits the children of a node of `level` (2 or more) whose lowest brick is `low`.
    fn visit(&mut self, node: &mut Arc<TreeNode>, low: UVec3, level: u32) {
        let log2 = NODE_EDGE_LOG2 * (level - 1);
        let within = |b: UVec3| (b.saturating_sub(low) >> log2).min(UVec3::splat(NODE_EDGE - 1));
        let (first, last) = (within(self.bounds.min), within(self.bounds.max - 1));
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let child = UVec3::new(x, y, z);
                    self.visit_child(node, low + (child << log2), level, Slot::of(child));
                }
            }
        }
    }

    fn visit_child(&mut self, parent: &mut Arc<TreeNode>, low: UVec3, level: u32, slot: Slot) {
        let log2 = NODE_EDGE_LOG2 * (level - 1);
        let is_full = slot.is_in(&parent.full);
        let is_empty = !is_full && !slot.is_in(&parent.mixed);
        match (self.choose)(Cube { low, log2, is_empty, is_full }) {
            CubeEdit::Skip => {}
            CubeEdit::Fill if is_full => {}
            CubeEdit::Clear if is_empty => {}
            CubeEdit::Fill => self.set(parent, low, level, slot, Child::Full),
            CubeEdit::Clear => self.set(parent, low, level, slot, Child::Empty),
            CubeEdit::Open if level == 2 => {
                let parent = Arc::make_mut(parent);
                let leaf = low >> NODE_EDGE_LOG2;
                self.lent.leaves.push(take_leaf(parent, slot, leaf, &self.extent));
            }
            CubeEdit::Open => {
                let parent = Arc::make_mut(parent);
                let child = open(parent, slot, low, level, &self.extent);
                let before = child.voxels;
                self.visit(child, low, level - 1);
                let after = child.voxels;
                close(parent, slot, low, level, &self.extent);
                parent.voxels = parent.voxels + after - before;
            }
        }
    }

    /// Replaces a whole cube.
    fn set(&mut self, parent: &mut Arc<TreeNode>, low: UVec3, level: u32, slot: Slot, new: Child) {
        let all = self.extent.voxels(low, NODE_EDGE_LOG2 * (level - 1));
        let fills = matches!(new, Child::Full);
        let parent = Arc::make_mut(parent);
        let old = parent.replace(slot, new);
        let before = match &old {
            Child::Empty => 0,
            Child::Full => all,
            Child::Mixed(node) => node.voxels,
        };
        let (added, removed) = if fills { (all - before, 0) } else { (0, before) };
        self.lent.voxels_added += added;
        self.lent.voxels_removed += removed;
        parent.voxels = parent.voxels + added - removed;
        list_changed(&old, fills, low, level - 1, &self.extent, &mut self.lent.changed);
    }
}

/// Lists the bricks of a cube of `level` that were not full before it was filled, or not empty before it was emptied.
fn list_changed(
    old: &Child,
    fills: bool,
    low: UVec3,
    level: u32,
    extent: &Extent,
    changed: &mut Vec<ChangedLeaf>,
) {
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    let inside = extent.children(low, log2);
    let (stays, node) = match old {
        Child::Empty => (if fills { Brick::EMPTY } else { inside }, None),
        Child::Full => (if fills { inside } else { Brick::EMPTY }, None),
        Child::Mixed(node) => {
            (if fills { node.full } else { inside.and_not(&node.occupied()) }, Some(node))
        }
    };
    let differs = inside.and_not(&stays);
    if level == 1 {
        changed.push(ChangedLeaf {
            leaf: LeafKey::of(low >> NODE_EDGE_LOG2),
            bricks: differs,
            before: Some(OldLeaf(old.clone())),
        });
        return;
    }
    differs.for_each(|index| {
        let slot = Slot::at(index);
        let low = low + (UVec3::from(local_coords(index)) << log2);
        let child = match node {
            Some(node) if slot.is_in(&node.mixed) => {
                Child::Mixed(node.nodes()[node.rank(slot)].clone())
            }
            Some(node) if slot.is_in(&node.full) => Child::Full,
            Some(_) => Child::Empty,
            None => old.clone(),
        };
        list_changed(&child, fills, low, level - 1, extent, changed);
    });
}

/// Returns the slot, in a node of `level`, of the child that holds brick `b`.
#[inline(always)]
pub(super) fn slot_in(b: UVec3, level: u32) -> Slot {
    Slot::of(b >> (NODE_EDGE_LOG2 * (level - 1)))
}

/// Takes the leaf at `slot` out of a node of level 2, which is the node's own.
fn take_leaf(parent: &mut TreeNode, slot: Slot, leaf: UVec3, extent: &Extent) -> LentLeaf {
    let is_full = slot.is_in(&parent.full);
    let (node, was_full) = match parent.node_mut(slot) {
        Some(child) => (std::mem::replace(child, BLANK_LEAF.clone()), None),
        None => {
            let low = leaf << NODE_EDGE_LOG2;
            (Arc::new(uniform_node(is_full, low, 1, extent)), Some(is_full))
        }
    };
    LentLeaf { leaf, voxels_before: node.voxels, was_full, node }
}

/// Returns an empty or full node of `level`.
fn uniform_node(is_full: bool, low: UVec3, level: u32, extent: &Extent) -> TreeNode {
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    match is_full {
        true => {
            let voxels = extent.voxels(low, log2 + NODE_EDGE_LOG2);
            TreeNode::uniform(extent.children(low, log2), voxels)
        }
        false => TreeNode::uniform(Brick::EMPTY, 0),
    }
}

/// Returns the child at `slot` for changes; makes it a node if it is empty or full. `low`: a brick of the child, `level`:
/// that of the parent, which is no leaf.
pub(super) fn open<'a>(
    parent: &'a mut TreeNode,
    slot: Slot,
    low: UVec3,
    level: u32,
    extent: &Extent,
) -> &'a mut Arc<TreeNode> {
    let is_full = slot.is_in(&parent.full);
    parent.node_or_insert_with(slot, || {
        let log2 = NODE_EDGE_LOG2 * (level - 1);
        Arc::new(uniform_node(is_full, low >> log2 << log2, level - 1, extent))
    })
}

/// Makes the child at `slot` empty or full if its node is. `low`: a brick of the child, `level`: that of the parent.
pub(super) fn close(parent: &mut TreeNode, slot: Slot, low: UVec3, level: u32, extent: &Extent) {
    let Some(child) = parent.node_mut(slot) else { return };
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    let inside = || extent.children(low >> log2 << log2, log2 - NODE_EDGE_LOG2);
    if child.mixed != Brick::EMPTY {
        return;
    }
    let new = match () {
        () if child.full == Brick::EMPTY => Child::Empty,
        () if child.full == inside() => Child::Full,
        () => return,
    };
    parent.replace(slot, new);
}

/// Puts a leaf back into a tree of `level` levels.
fn put(
    node: &mut Arc<TreeNode>,
    level: u32,
    leaf: UVec3,
    new: Arc<TreeNode>,
    change: i64,
    extent: &Extent,
) {
    let low = leaf << NODE_EDGE_LOG2;
    let node = Arc::make_mut(node);
    let slot = slot_in(low, level);
    if level == 2 {
        node.replace(slot, Child::Mixed(new));
    } else {
        put(open(node, slot, low, level, extent), level - 1, leaf, new, change, extent);
    }
    close(node, slot, low, level, extent);
    node.voxels = node.voxels.wrapping_add_signed(change);
}
