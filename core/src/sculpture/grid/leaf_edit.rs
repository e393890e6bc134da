//! An edit of the bricks of one leaf, each at most once.
//!
//! Reads bricks from the leaf, takes new ones, and writes the leaf at the end: in place where the leaf is not shared,
//! else as a new one. Bricks that become empty or full take no memory. Knows no tool and no record.

use std::sync::Arc;

use glam::UVec3;

use super::extent::Extent;
use super::node::{NODE_EDGE_LOG2, NewBricks, Slot, TreeNode};
use crate::sculpture::brick::{BRICK_VOXELS, Brick, local_coords};

/// An edit of a leaf in progress.
pub(in crate::sculpture) struct LeafEdit<'a> {
    extent: Extent,
    /// Whether no brick is cut by the border of the grid.
    is_whole: bool,
    low: UVec3,
    leaf: &'a mut Arc<TreeNode>,
    /// The kinds of the bricks as they shall be.
    mixed: Brick,
    full: Brick,
    /// The new mixed bricks, and which they are.
    new: &'a mut [Brick; 512],
    is_new: Brick,
    changed: Brick,
    voxels: u64,
}

impl<'a> LeafEdit<'a> {
    #[inline(always)]
    pub(super) fn new(
        extent: Extent,
        leaf: UVec3,
        node: &'a mut Arc<TreeNode>,
        scratch: &'a mut [Brick; 512],
    ) -> LeafEdit<'a> {
        let low = leaf << NODE_EDGE_LOG2;
        LeafEdit {
            extent,
            is_whole: extent.holds_brick(low + 7),
            low,
            mixed: node.mixed,
            full: node.full,
            voxels: node.voxels,
            leaf: node,
            new: scratch,
            is_new: Brick::EMPTY,
            changed: Brick::EMPTY,
        }
    }

    /// Returns the leaf's lowest brick.
    #[inline(always)]
    pub fn low(&self) -> UVec3 {
        self.low
    }

    /// Returns the bits that the brick at `b` may hold.
    #[inline(always)]
    pub fn valid_mask(&self, b: UVec3) -> Brick {
        if self.is_whole { Brick::FULL } else { super::valid_mask(self.extent.dims, b) }
    }

    /// Returns the bricks of a row that are not empty, and those that are full: a bit per brick along x.
    #[inline(always)]
    pub fn row(&self, y: u32, z: u32) -> (u32, u32) {
        let full = row_of(&self.full, y, z);
        (row_of(&self.mixed, y, z) | full, full)
    }

    /// Returns the brick at `b`, which has not been replaced, and its count of voxels.
    #[inline(always)]
    pub fn brick(&self, b: UVec3) -> (Brick, u16) {
        let slot = Slot::of(b);
        if slot.is_in(&self.leaf.mixed) {
            let brick = self.leaf.bricks()[self.leaf.rank(slot)];
            (brick, brick.count())
        } else if slot.is_in(&self.leaf.full) {
            let valid = self.valid_mask(b);
            let count = if self.is_whole { BRICK_VOXELS as u16 } else { valid.count() };
            (valid, count)
        } else {
            (Brick::EMPTY, 0)
        }
    }

    /// Replaces the brick at `b`, of `before` voxels, by a different one of `count` voxels, all of them valid.
    #[inline(always)]
    pub fn replace(&mut self, b: UVec3, before: u16, brick: &Brick, count: u16) {
        debug_assert_eq!(count, brick.count());
        let slot = Slot::of(b);
        let most = match self.is_whole || self.extent.holds_brick(b) {
            true => BRICK_VOXELS as u16,
            false => self.valid_mask(b).count(),
        };
        let (is_full, is_mixed) = (count == most, count != 0 && count != most);
        slot.put(&mut self.full, is_full);
        slot.put(&mut self.mixed, is_mixed);
        if is_mixed {
            self.new[slot.index() & 511] = *brick;
            slot.put(&mut self.is_new, true);
        }
        slot.put(&mut self.changed, true);
        self.voxels = self.voxels + u64::from(count) - u64::from(before);
    }

    /// Empties bricks of a row: a bit per brick along x, of bricks that are not empty. Returns the number of voxels
    /// removed.
    #[inline(always)]
    pub fn clear_in_row(&mut self, y: u32, z: u32, bricks: u32) -> u64 {
        if bricks == 0 {
            return 0;
        }
        let full = row_of(&self.full, y, z) & bricks;
        let mut voxels = u64::from(full.count_ones()) * u64::from(BRICK_VOXELS);
        let mut rest = if self.is_whole { bricks & !full } else { bricks };
        if !self.is_whole {
            voxels = 0;
        }
        while rest != 0 {
            let x = rest.trailing_zeros();
            rest &= rest - 1;
            voxels += u64::from(self.brick(UVec3::new(self.low.x + x, y, z)).1);
        }
        let (word, shift) = row_place(y, z);
        for (word, bricks) in [(word, bricks & 0xF), (word + 1, bricks >> 4)] {
            let bits = u64::from(bricks) << shift;
            self.mixed.words[word & 7] &= !bits;
            self.full.words[word & 7] &= !bits;
            self.changed.words[word & 7] |= bits;
        }
        self.voxels -= voxels;
        voxels
    }

    /// Replaces bricks. `kinds`: the bricks, and those of them that shall be full and mixed, with the bits of the mixed
    /// ones in `bits`. Returns the kinds before: empty, full and mixed, and adds the bits of those that were mixed to
    /// `earlier`.
    #[inline(always)]
    pub fn replace_all(
        &mut self,
        [bricks, full, mixed]: [Brick; 3],
        bits: &[Brick],
        earlier: &mut Vec<Brick>,
    ) -> [Brick; 3] {
        let first = earlier.len();
        let before = kinds(self.leaf, bricks, &mut |brick| earlier.push(*brick));
        let count = |bricks: &[Brick]| -> u64 { bricks.iter().map(|b| u64::from(b.count())).sum() };
        let voxels = |full: &Brick, mixed: &[Brick]| self.voxels_of(full) + count(mixed);
        self.voxels = self.voxels + voxels(&full, bits) - voxels(&before[1], &earlier[first..]);
        self.full = self.full.and_not(&bricks).or(&full);
        self.mixed = self.mixed.and_not(&bricks).or(&mixed);
        self.is_new = mixed;
        let mut bits = bits.iter();
        mixed.for_each(|index| {
            self.new[index as usize & 511] = bits.next().copied().unwrap_or_default();
        });
        self.changed = bricks;
        before
    }

    /// Returns the number of voxels of full bricks.
    #[inline(always)]
    fn voxels_of(&self, full: &Brick) -> u64 {
        if self.is_whole {
            return u64::from(full.count()) * u64::from(BRICK_VOXELS);
        }
        let mut voxels = 0;
        full.for_each(|index| {
            let b = self.low + UVec3::from(local_coords(index));
            voxels += u64::from(self.valid_mask(b).count());
        });
        voxels
    }

    /// Writes the leaf. Returns the bricks that were replaced.
    #[inline(always)]
    pub fn finish(self) -> Brick {
        if self.changed == Brick::EMPTY {
            return self.changed;
        }
        let new = NewBricks { bricks: self.new, which: self.is_new };
        if let Some(leaf) = Arc::get_mut(self.leaf) {
            leaf.replace_bricks(self.mixed, &new);
            leaf.full = self.full;
            leaf.voxels = self.voxels;
        } else {
            let bricks = self.leaf.bricks_with(&self.mixed, &new);
            *self.leaf = Arc::new(TreeNode::leaf(self.mixed, self.full, bricks, self.voxels));
        }
        self.changed
    }
}

/// Returns the kinds of bricks of a leaf: empty, full and mixed, and passes the mixed ones to `keep`.
#[inline(always)]
pub(super) fn kinds(leaf: &TreeNode, which: Brick, keep: &mut impl FnMut(&Brick)) -> [Brick; 3] {
    let (full, mixed) = (which.and(&leaf.full), which.and(&leaf.mixed));
    let bricks = leaf.bricks();
    let mut first = 0;
    for (all, wanted) in leaf.mixed.words.iter().zip(mixed.words) {
        let mut rest = wanted;
        while rest != 0 {
            let bit = rest.trailing_zeros();
            rest &= rest - 1;
            keep(&bricks[first + (all & ((1 << bit) - 1)).count_ones() as usize]);
        }
        first += all.count_ones() as usize;
    }
    [which.and_not(&leaf.occupied()), full, mixed]
}

/// Returns a row of a mask: a bit per child along x.
#[inline(always)]
pub(super) fn row_of(mask: &Brick, y: u32, z: u32) -> u32 {
    let (word, shift) = row_place(y, z);
    let piece = |word: usize| (mask.words[word & 7] >> shift & 0xF) as u32;
    piece(word) | piece(word + 1) << 4
}

/// Returns the place of a row in a mask: the word of its lower four children, and their lowest bit. The other four have
/// the same place in the next word.
#[inline(always)]
fn row_place(y: u32, z: u32) -> (usize, u32) {
    (((y >> 2 & 1) << 1 | (z >> 2 & 1) << 2) as usize, (y & 3) << 2 | (z & 3) << 4)
}
