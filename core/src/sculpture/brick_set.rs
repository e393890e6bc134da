//! Sets of bricks by their coordinates: a mask for each leaf of 8^3 bricks, so that memory and time follow the bricks in
//! the set, not the size of the grid.
//!
//! Knows no grid.

use glam::UVec3;
use rustc_hash::FxHashMap;

use super::brick::{Brick, local_coords, local_index};

/// Bits of a leaf's coordinate in a key.
const KEY_BITS: u32 = 10;

/// The coordinates of a leaf of 8^3 bricks, those of its bricks divided by 8. Keys are ordered by z, then y, then x.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct LeafKey(u32);

impl LeafKey {
    /// Returns the key of the leaf at these coordinates, each below 1024.
    #[inline(always)]
    pub fn of(leaf: UVec3) -> LeafKey {
        LeafKey(leaf.x | leaf.y << KEY_BITS | leaf.z << (2 * KEY_BITS))
    }

    /// Returns the coordinates.
    #[inline(always)]
    pub fn coords(self) -> UVec3 {
        let part = |axis: u32| self.0 >> (axis * KEY_BITS) & ((1 << KEY_BITS) - 1);
        UVec3::new(part(0), part(1), part(2))
    }
}

/// A set of bricks.
#[derive(Clone, Debug, Default)]
pub struct BrickSet {
    leaves: FxHashMap<LeafKey, Brick>,
}

impl BrickSet {
    /// Returns whether no brick is in the set.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Returns the number of bricks in the set.
    pub fn len(&self) -> usize {
        self.leaves.values().map(|mask| usize::from(mask.count())).sum()
    }

    /// Returns whether the brick at brick coordinates `b` is in the set.
    pub fn contains(&self, b: UVec3) -> bool {
        self.of_leaf(LeafKey::of(b >> 3)).get(b.x & 7, b.y & 7, b.z & 7)
    }

    /// Returns the bricks of a leaf that are in the set.
    #[inline]
    pub fn of_leaf(&self, leaf: LeafKey) -> Brick {
        self.leaves.get(&leaf).copied().unwrap_or_default()
    }

    /// Adds the brick at brick coordinates `b`.
    pub fn insert(&mut self, b: UVec3) {
        let index = local_index(b.x & 7, b.y & 7, b.z & 7);
        let mask = self.leaves.entry(LeafKey::of(b >> 3)).or_default();
        mask.words[(index >> 6) as usize] |= 1 << (index & 63);
    }

    /// Adds bricks of a leaf, a bit each in the order of the voxels of a brick. Returns those that were not in the set.
    #[inline]
    pub fn insert_in(&mut self, leaf: LeafKey, bricks: &Brick) -> Brick {
        if bricks.is_empty() {
            return Brick::EMPTY;
        }
        let mask = self.leaves.entry(leaf).or_default();
        let new = bricks.and_not(mask);
        *mask = mask.or(bricks);
        new
    }

    /// Returns the leaves with bricks in the set, and which these are, in the order of the keys.
    pub fn leaves(&self) -> Vec<(LeafKey, Brick)> {
        let mut leaves: Vec<_> = self.leaves.iter().map(|(leaf, mask)| (*leaf, *mask)).collect();
        leaves.sort_unstable_by_key(|(leaf, _)| *leaf);
        leaves
    }

    /// Removes all bricks; keeps the memory.
    pub fn clear(&mut self) {
        self.leaves.clear();
    }
}

/// Calls `f` with the coordinates of bricks of a leaf.
pub fn for_each_in(leaf: LeafKey, bricks: &Brick, mut f: impl FnMut(UVec3)) {
    let low = leaf.coords() << 3;
    bricks.for_each(|index| f(low + UVec3::from(local_coords(index))));
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn behaves_as_a_set(bricks in prop::collection::vec(prop::array::uniform3(0u32..8192), 0..60), again: bool) {
            let mut set = BrickSet::default();
            if again {
                bricks.iter().for_each(|b| set.insert(UVec3::from(*b) ^ 1));
                set.clear();
                prop_assert!(set.is_empty());
            }
            let mut naive = BTreeSet::new();
            for b in bricks {
                prop_assert_eq!(set.contains(UVec3::from(b)), naive.contains(&b));
                set.insert(UVec3::from(b));
                naive.insert(b);
            }
            prop_assert_eq!(set.len(), naive.len());
            let mut listed = BTreeSet::new();
            let leaves = set.leaves();
            prop_assert!(leaves.is_sorted_by(|a, b| a.0 < b.0));
            for (leaf, mask) in &leaves {
                prop_assert_eq!(LeafKey::of(leaf.coords()), *leaf);
                for_each_in(*leaf, mask, |b| { listed.insert(b.to_array()); });
            }
            prop_assert_eq!(listed, naive);
            let mut copy = BrickSet::default();
            for (leaf, mask) in leaves {
                prop_assert_eq!(copy.insert_in(leaf, &mask), mask);
                prop_assert_eq!(copy.insert_in(leaf, &mask), Brick::EMPTY);
                prop_assert_eq!(copy.of_leaf(leaf), mask);
            }
        }
    }
}
