//! The bricks whose levels are out of date, by leaf: memory follows their number, and rays look them up.
//!
//! Knows no grid and no levels.

use std::collections::BTreeSet;

use glam::UVec3;

use crate::sculpture::brick::Brick;
use crate::sculpture::brick_set::{BrickSet, LeafKey, for_each_in};
use crate::shade::per_leaf::PerLeaf;

/// See the module text.
#[derive(Debug)]
pub(super) struct StaleBricks {
    bricks: PerLeaf<Brick>,
    /// The numbers of the leaves that have some.
    leaves: BTreeSet<u32>,
}

impl StaleBricks {
    /// Returns none of a sculpture of so many bricks.
    pub fn none_of(brick_dims: UVec3) -> StaleBricks {
        StaleBricks { bricks: PerLeaf::new(brick_dims, &[Brick::EMPTY]), leaves: BTreeSet::new() }
    }

    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Returns the number of bricks.
    pub fn len(&self) -> usize {
        let of = |number: &u32| self.bricks.get(*number).map_or(0, |bricks| bricks.count().into());
        self.leaves.iter().map(of).sum()
    }

    /// Returns whether the brick at `b` is out of date.
    #[inline(always)]
    pub fn contains(&self, b: UVec3) -> bool {
        let bricks = self.bricks.get(self.bricks.number(b >> 3));
        bricks.is_some_and(|bricks| bricks.get(b.x & 7, b.y & 7, b.z & 7))
    }

    /// Adds bricks of a leaf.
    pub fn insert_in(&mut self, leaf: UVec3, bricks: &Brick) {
        if bricks.is_empty() {
            return;
        }
        let number = self.bricks.number(leaf);
        let stale = self.bricks.own(number);
        *stale = stale.or(bricks);
        self.leaves.insert(number);
    }

    /// Takes the bricks of the next leaves until there are at least `count`.
    pub fn take_first(&mut self, count: usize) -> Vec<UVec3> {
        let mut taken = Vec::new();
        while taken.len() < count
            && let Some(number) = self.leaves.pop_first()
        {
            let leaf = self.bricks.leaf(number);
            for_each_in(LeafKey::of(leaf), self.bricks.own(number), |b| taken.push(b));
            self.bricks.set_common(number, 0);
        }
        taken
    }

    /// Takes those of `wanted` that are out of date.
    pub fn take(&mut self, wanted: &BrickSet) -> Vec<UVec3> {
        let mut taken = Vec::new();
        for (leaf, wanted) in wanted.leaves() {
            let number = self.bricks.number(leaf.coords());
            if !self.leaves.contains(&number) {
                continue;
            }
            let stale = self.bricks.own(number);
            for_each_in(leaf, &stale.and(&wanted), |b| taken.push(b));
            *stale = stale.and_not(&wanted);
            if stale.is_empty() {
                self.leaves.remove(&number);
                self.bricks.set_common(number, 0);
            }
        }
        taken
    }

    /// Returns the memory in use, in bytes.
    pub fn heap_bytes(&self) -> usize {
        self.bricks.heap_bytes() + 2 * self.leaves.len() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::scenes::Random;

    #[test]
    fn bricks_are_taken_once() {
        let dims = UVec3::new(19, 8, 30);
        let (mut stale, mut naive) = (StaleBricks::none_of(dims), BTreeSet::new());
        let mut random = Random(4);
        for round in 0..300 {
            let mut some = BrickSet::default();
            for _ in 0..random.next_u64() % 30 {
                some.insert(random.voxel(dims).as_uvec3());
            }
            let listed = |set: &BrickSet| {
                let mut all = Vec::new();
                for (leaf, bricks) in set.leaves() {
                    for_each_in(leaf, &bricks, |b| all.push(b.to_array()));
                }
                all
            };
            match round % 3 {
                0 => {
                    for (leaf, bricks) in some.leaves() {
                        stale.insert_in(leaf.coords(), &bricks);
                    }
                    naive.extend(listed(&some));
                }
                1 => {
                    let taken: BTreeSet<_> =
                        stale.take(&some).iter().map(|b| b.to_array()).collect();
                    let wanted: BTreeSet<_> = listed(&some).into_iter().collect();
                    assert!(taken == naive.intersection(&wanted).copied().collect(), "{round}");
                    naive.retain(|b| !wanted.contains(b));
                }
                _ => {
                    let before = naive.len();
                    let taken = stale.take_first(7);
                    assert!(taken.len() >= before.min(7), "{round}");
                    assert!(taken.iter().all(|b| naive.remove(&b.to_array())), "{round}");
                }
            }
            assert_eq!((stale.len(), stale.is_empty()), (naive.len(), naive.is_empty()));
            let b = random.voxel(dims).as_uvec3();
            assert_eq!(stale.contains(b), naive.contains(&b.to_array()));
        }
    }
}
