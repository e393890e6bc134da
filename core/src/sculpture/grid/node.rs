//! The nodes of a grid's tree: cubes of 8^3 children, shared between grids and copied when one of them changes.
//!
//! A leaf (level 1) has bricks as children and spans 64^3 voxels; a node of level `n` spans `8^(n+1)` voxels an edge. A
//! child is empty, full or mixed. Masks tell which, a bit per child in the order of a brick's voxels
//! ([`local_index`]), and only mixed children take memory, in that order without gaps: a mixed brick its 64 bytes, a
//! mixed node a reference. This is the layout of sparse voxel trees with packed children (Laine and Karras, "Efficient
//! Sparse Voxel Octrees", 2010), eight on an edge.
//!
//! "Full" means full within the extent of the grid, so that a full grid is one node whatever its size. Nodes are
//! canonical: a child that is empty or full is never stored as mixed. Knows no grid, no coordinates beyond the node's
//! own.

use std::sync::Arc;

use crate::sculpture::brick::{Brick, local_index};
use glam::UVec3;

/// Children along one edge of a node, and the logarithm of that.
pub(super) const NODE_EDGE: u32 = 8;
pub(in crate::sculpture) const NODE_EDGE_LOG2: u32 = 3;

/// The most bytes that a new leaf takes besides its bricks, with the nodes above it that have to be made.
pub(in crate::sculpture) const LEAF_BYTES: u64 =
    (3 * (size_of::<TreeNode>() + align_of::<TreeNode>() + size_of::<Arc<TreeNode>>())) as u64;

/// A child among the 512 of a node: a word of the masks, and the bit in it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::sculpture) struct Slot {
    pub word: usize,
    pub bit: u32,
}

impl Slot {
    /// Returns the slot of the child at these coordinates, of which only the lowest three bits count.
    #[inline(always)]
    pub fn of(child: UVec3) -> Slot {
        let index = local_index(child.x & 7, child.y & 7, child.z & 7);
        Slot::at(index)
    }

    /// Returns the slot of an index in 0..512.
    #[inline(always)]
    pub fn at(index: u32) -> Slot {
        Slot { word: (index >> 6) as usize & 7, bit: index & 63 }
    }

    #[inline(always)]
    pub fn index(self) -> usize {
        self.word << 6 | self.bit as usize
    }

    #[inline(always)]
    pub fn is_in(self, mask: &Brick) -> bool {
        mask.words[self.word] >> self.bit & 1 != 0
    }

    #[inline(always)]
    pub fn put(self, mask: &mut Brick, value: bool) {
        let bit = 1 << self.bit;
        let word = &mut mask.words[self.word];
        *word = if value { *word | bit } else { *word & !bit };
    }
}

/// The bricks of a leaf that an edit has replaced by mixed ones.
pub(super) struct NewBricks<'a> {
    /// Their bits, by index in the leaf.
    pub bricks: &'a [Brick; 512],
    /// Which they are: some of those that are mixed from now on.
    pub which: Brick,
}

/// A node of 8^3 children.
#[derive(Clone, Debug)]
pub(super) struct TreeNode {
    /// Which children are mixed, and which are full.
    pub mixed: Brick,
    pub full: Brick,
    /// The number of mixed children before each word of the masks.
    before: [u16; 8],
    /// The mixed children in the order of the masks: bricks in a leaf, nodes in all others.
    nodes: Vec<Arc<TreeNode>>,
    bricks: Vec<Brick>,
    /// The number of existing voxels.
    pub voxels: u64,
}

/// A child of a node, or what is put in its place.
#[derive(Clone, Debug)]
pub(super) enum Child {
    Empty,
    Full,
    Mixed(Arc<TreeNode>),
}

impl TreeNode {
    /// Returns a node without mixed children.
    pub fn uniform(full: Brick, voxels: u64) -> TreeNode {
        TreeNode::leaf(Brick::EMPTY, full, Vec::new(), voxels)
    }

    /// Returns a leaf of bricks by their kinds, with the mixed ones in the order of their slots.
    pub fn leaf(mixed: Brick, full: Brick, bricks: Vec<Brick>, voxels: u64) -> TreeNode {
        debug_assert_eq!(bricks.len(), usize::from(mixed.count()));
        let before = counts_before(&mixed);
        TreeNode { mixed, full, before, nodes: Vec::new(), bricks, voxels }
    }

    /// Returns a node of nodes, with the mixed ones in the order of their slots.
    pub fn inner(mixed: Brick, full: Brick, nodes: Vec<Arc<TreeNode>>, voxels: u64) -> TreeNode {
        debug_assert_eq!(nodes.len(), usize::from(mixed.count()));
        let before = counts_before(&mixed);
        TreeNode { mixed, full, before, nodes, bricks: Vec::new(), voxels }
    }

    /// Returns the place of a mixed child among the packed ones, or that of the next.
    #[inline(always)]
    pub fn rank(&self, slot: Slot) -> usize {
        let below = self.mixed.words[slot.word] & ((1 << slot.bit) - 1);
        usize::from(self.before[slot.word]) + below.count_ones() as usize
    }

    /// Returns the children that are not empty.
    #[inline(always)]
    pub fn occupied(&self) -> Brick {
        self.mixed.or(&self.full)
    }

    /// Returns the nodes that are mixed children; none for a leaf.
    #[inline(always)]
    pub fn nodes(&self) -> &[Arc<TreeNode>] {
        &self.nodes
    }

    /// Returns the mixed bricks of a leaf; none for other nodes.
    #[inline(always)]
    pub fn bricks(&self) -> &[Brick] {
        &self.bricks
    }

    /// Returns the mixed bricks of a leaf after a change: those of `mixed`, new or kept.
    pub fn bricks_with(&self, mixed: &Brick, new: &NewBricks) -> Vec<Brick> {
        let mut bricks = Vec::with_capacity(capacity_for(usize::from(mixed.count())));
        let mut old = &*self.bricks;
        for (word, (was, now)) in self.mixed.words.into_iter().zip(mixed.words).enumerate() {
            let is_new = new.which.words[word];
            if was == now && is_new == 0 {
                let (kept, rest) = old.split_at(was.count_ones() as usize);
                bricks.extend_from_slice(kept);
                old = rest;
                continue;
            }
            let mut rest = was | now;
            while rest != 0 {
                let bit = rest.trailing_zeros();
                rest &= rest - 1;
                let kept = match was >> bit & 1 != 0 {
                    true => old.split_off_first(),
                    false => None,
                };
                if is_new >> bit & 1 != 0 {
                    bricks.push(new.bricks[word << 6 | bit as usize]);
                } else if now >> bit & 1 != 0
                    && let Some(kept) = kept
                {
                    bricks.push(*kept);
                }
            }
        }
        bricks
    }

    /// Makes `mixed` the mixed bricks of a leaf, new or kept, in place. Full bricks and the count of voxels are left to
    /// the caller.
    pub fn replace_bricks(&mut self, mixed: Brick, new: &NewBricks) {
        let kept = self.mixed.and(&mixed);
        let (kept_count, count) = (usize::from(kept.count()), usize::from(mixed.count()));
        if kept != self.mixed {
            self.keep_bricks(&kept);
        }
        if self.bricks.capacity() < count {
            self.bricks.reserve_exact(capacity_for(count) - kept_count);
        }
        self.bricks.resize(count, Brick::EMPTY);
        // From the last one on, so that none is overwritten before it has moved up.
        let (mut from, mut to) = (kept_count, count);
        for word in (0..8).rev() {
            let (now, was, is_new) = (mixed.words[word], kept.words[word], new.which.words[word]);
            if now == was && is_new == 0 {
                let moved = now.count_ones() as usize;
                (from, to) = (from - moved, to - moved);
                if from != to {
                    self.bricks.copy_within(from..from + moved, to);
                }
                continue;
            }
            let mut rest = now;
            while rest != 0 {
                let bit = 63 - rest.leading_zeros();
                rest ^= 1 << bit;
                to -= 1;
                from -= usize::from(was >> bit & 1 != 0);
                self.bricks[to] = match is_new >> bit & 1 != 0 {
                    true => new.bricks[word << 6 | bit as usize],
                    false => self.bricks[from],
                };
            }
        }
        self.mixed = mixed;
        self.before = counts_before(&mixed);
        if self.bricks.capacity() > capacity_for(count) + MAX_SPARE {
            self.bricks.shrink_to(capacity_for(count));
        }
    }

    /// Removes all mixed bricks of a leaf but those of `kept`.
    fn keep_bricks(&mut self, kept: &Brick) {
        let (mut from, mut to) = (0, 0);
        for (was, now) in self.mixed.words.into_iter().zip(kept.words) {
            if was == now {
                let moved = was.count_ones() as usize;
                if from != to {
                    self.bricks.copy_within(from..from + moved, to);
                }
                (from, to) = (from + moved, to + moved);
                continue;
            }
            let mut rest = was;
            while rest != 0 {
                if now & rest & rest.wrapping_neg() != 0 {
                    self.bricks[to] = self.bricks[from];
                    to += 1;
                }
                from += 1;
                rest &= rest - 1;
            }
        }
        self.bricks.truncate(to);
    }

    /// Returns the mixed node at `slot`; `None` if there is none.
    #[inline(always)]
    pub fn node_mut(&mut self, slot: Slot) -> Option<&mut Arc<TreeNode>> {
        let at = self.rank(slot);
        self.nodes.get_mut(at).filter(|_| slot.is_in(&self.mixed))
    }

    /// Returns the mixed node at `slot`. If there is none, puts that of `make` there.
    #[inline(always)]
    pub fn node_or_insert_with(
        &mut self,
        slot: Slot,
        make: impl FnOnce() -> Arc<TreeNode>,
    ) -> &mut Arc<TreeNode> {
        if !slot.is_in(&self.mixed) {
            self.replace(slot, Child::Mixed(make()));
        }
        let at = self.rank(slot);
        &mut self.nodes[at]
    }

    /// Replaces a child of a node of nodes, and returns the old one. The count of voxels is left to the caller.
    pub fn replace(&mut self, slot: Slot, new: Child) -> Child {
        let at = self.rank(slot);
        let (was_mixed, was_full) = (slot.is_in(&self.mixed), slot.is_in(&self.full));
        let nodes = &mut self.nodes;
        slot.put(&mut self.full, matches!(new, Child::Full));
        match (was_mixed, new) {
            (true, Child::Mixed(node)) => Child::Mixed(std::mem::replace(&mut nodes[at], node)),
            (true, Child::Empty | Child::Full) => {
                let old = nodes[at].clone();
                take_out(nodes, at);
                slot.put(&mut self.mixed, false);
                self.before = counts_before(&self.mixed);
                Child::Mixed(old)
            }
            (false, new) => {
                if let Child::Mixed(node) = new {
                    put_in(nodes, at, node);
                    slot.put(&mut self.mixed, true);
                    self.before = counts_before(&self.mixed);
                }
                if was_full { Child::Full } else { Child::Empty }
            }
        }
    }

    /// Replaces a brick of a leaf; `valid` are the bits that it may hold. The count of voxels is left to the caller.
    pub fn put_brick(&mut self, slot: Slot, brick: &Brick, valid: &Brick) {
        let at = self.rank(slot);
        let was_mixed = slot.is_in(&self.mixed);
        let is_full = brick == valid;
        let is_mixed = !is_full && !brick.is_empty();
        let bricks = &mut self.bricks;
        match (was_mixed, is_mixed) {
            (true, true) => bricks[at] = *brick,
            (true, false) => take_out(bricks, at),
            (false, true) => put_in(bricks, at, *brick),
            (false, false) => {}
        }
        slot.put(&mut self.full, is_full);
        slot.put(&mut self.mixed, is_mixed);
        self.before = counts_before(&self.mixed);
    }

    /// Returns the heap bytes of the node and all below it, shared or not. Leaves out the little room to spare that lists
    /// may have, so that equal grids have equal sizes.
    pub fn heap_bytes(&self) -> u64 {
        // The counters of the reference, rounded up to the alignment of a node.
        let own = size_of::<TreeNode>() + align_of::<TreeNode>();
        let lists =
            self.nodes.len() * size_of::<Arc<TreeNode>>() + self.bricks.len() * size_of::<Brick>();
        (own + lists) as u64 + self.nodes.iter().map(|node| node.heap_bytes()).sum::<u64>()
    }
}

impl PartialEq for TreeNode {
    fn eq(&self, other: &TreeNode) -> bool {
        let same_node = |(a, b): (&Arc<TreeNode>, &Arc<TreeNode>)| Arc::ptr_eq(a, b) || a == b;
        self.mixed == other.mixed
            && self.full == other.full
            && self.bricks() == other.bricks()
            && self.nodes().len() == other.nodes().len()
            && self.nodes().iter().zip(other.nodes()).all(same_node)
    }
}

/// Elements for which a list of children may have room to spare.
const MAX_SPARE: usize = 16;

/// Returns the room that a list of so many bricks gets. Few different sizes let the allocator reuse what others freed.
#[inline(always)]
fn capacity_for(bricks: usize) -> usize {
    bricks.next_multiple_of(MAX_SPARE)
}

/// Inserts into a list of children, whose memory hardly grows by more than needed: large ones would waste much.
fn put_in<T>(list: &mut Vec<T>, at: usize, value: T) {
    if list.len() == list.capacity() {
        list.reserve_exact(MAX_SPARE);
    }
    list.insert(at, value);
}

/// Removes from a list of children.
fn take_out<T>(list: &mut Vec<T>, at: usize) {
    list.remove(at);
    if list.capacity() - list.len() > 2 * MAX_SPARE {
        list.shrink_to(list.len() + MAX_SPARE);
    }
}

/// Returns the number of set bits before each word.
#[inline(always)]
fn counts_before(mask: &Brick) -> [u16; 8] {
    let (mut before, mut sum) = ([0; 8], 0);
    for (before, word) in before.iter_mut().zip(mask.words) {
        *before = sum;
        sum += word.count_ones() as u16;
    }
    before
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::sculpture::brick::local_coords;
    use crate::sculpture::grid::extent::Extent;
    use crate::sculpture::grid::valid_mask;

    /// Checks that a node and all below it are canonical, packed and counted.
    pub fn check(node: &TreeNode, low: UVec3, level: u32, extent: &Extent) {
        let log2 = NODE_EDGE_LOG2 * (level - 1);
        assert_eq!(node.before, counts_before(&node.mixed));
        assert_eq!(node.mixed.and(&node.full), Brick::EMPTY);
        assert_eq!(node.occupied().and_not(&extent.children(low, log2)), Brick::EMPTY, "outside");
        let packed = node.nodes().len() + node.bricks().len();
        assert_eq!(packed, usize::from(node.mixed.count()));
        let mut voxels = 0;
        node.occupied().for_each(|index| {
            let (slot, low) = (Slot::at(index), low + (UVec3::from(local_coords(index)) << log2));
            if slot.is_in(&node.full) {
                voxels += extent.voxels(low, log2);
            } else if level == 1 {
                let (brick, valid) = (node.bricks()[node.rank(slot)], valid_mask(extent.dims, low));
                assert!(!brick.is_empty() && brick != valid, "{brick:?} at {low} is not mixed");
                assert_eq!(brick.and_not(&valid), Brick::EMPTY);
                voxels += u64::from(brick.count());
            } else {
                let child = &node.nodes()[node.rank(slot)];
                let inside = extent.children(low, log2 - NODE_EDGE_LOG2);
                assert!(
                    child.occupied() != Brick::EMPTY && child.full != inside,
                    "not mixed: {low}"
                );
                check(child, low, level - 1, extent);
                voxels += child.voxels;
            }
        });
        assert_eq!(node.voxels, voxels, "at {low} of level {level}");
    }
}
