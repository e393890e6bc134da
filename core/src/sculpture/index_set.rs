//! Sets of bricks by linear index, for tables with an entry per brick: a bit per brick, and a list of the words in use,
//! so that filling, iterating and clearing take time proportional to the set, not to the grid.
//!
//! Knows no grid beyond its number of bricks.

/// Bricks among the 64 whose linear indices begin at `64 * word`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct IndexMask {
    /// The lowest of the 64 linear indices, divided by 64.
    pub word: u32,
    /// A bit per brick, the lowest bit for the lowest index.
    pub mask: u64,
}

impl IndexMask {
    /// Returns the linear indices in ascending order.
    #[inline(always)]
    pub fn indices(self) -> Indices {
        Indices(self)
    }
}

/// The linear indices of a [`IndexMask`].
pub struct Indices(IndexMask);

impl Iterator for Indices {
    type Item = u32;

    #[inline(always)]
    fn next(&mut self) -> Option<u32> {
        let IndexMask { word, mask } = &mut self.0;
        if *mask == 0 {
            return None;
        }
        let index = *word * 64 + mask.trailing_zeros();
        *mask &= *mask - 1;
        Some(index)
    }
}

/// A set of linear brick indices.
#[derive(Debug, Default)]
pub struct IndexSet {
    words: Vec<u64>,
    /// The words that are not 0, each once, in the order of first insertion.
    used: Vec<u32>,
}

impl IndexSet {
    /// Returns an empty set over `brick_count` bricks.
    pub fn new(brick_count: usize) -> IndexSet {
        IndexSet { words: vec![0; brick_count.div_ceil(64)], used: Vec::new() }
    }

    /// Returns whether no brick is in the set.
    pub fn is_empty(&self) -> bool {
        self.used.is_empty()
    }

    /// Returns the number of bricks in the set.
    pub fn len(&self) -> usize {
        self.used.iter().map(|&word| self.words[word as usize].count_ones() as usize).sum()
    }

    /// Returns whether the brick of linear index `index` is in the set.
    #[inline]
    pub fn contains(&self, index: u32) -> bool {
        self.words[index as usize / 64] >> (index % 64) & 1 != 0
    }

    /// Returns the bricks of `word` that are in the set, as 64 bits.
    #[inline]
    pub fn mask(&self, word: u32) -> u64 {
        self.words[word as usize]
    }

    /// Adds the brick of linear index `index`.
    #[inline]
    pub fn insert(&mut self, index: u32) {
        self.insert_mask(IndexMask { word: index / 64, mask: 1 << (index % 64) });
    }

    /// Adds all bricks of `bricks`.
    #[inline]
    pub(crate) fn insert_mask(&mut self, bricks: IndexMask) {
        if bricks.mask == 0 {
            return;
        }
        let word = &mut self.words[bricks.word as usize];
        if *word == 0 {
            self.used.push(bricks.word);
        }
        *word |= bricks.mask;
    }

    /// Returns the words in use, in the order of first insertion.
    pub fn masks(&self) -> impl Iterator<Item = IndexMask> {
        self.used.iter().map(|&word| IndexMask { word, mask: self.words[word as usize] })
    }

    /// Appends the linear indices to `out` in ascending order.
    pub(crate) fn collect_into(&mut self, out: &mut Vec<u32>) {
        self.used.sort_unstable();
        for bricks in self.masks() {
            out.extend(bricks.indices());
        }
    }

    /// Removes all bricks; keeps the memory.
    pub fn clear(&mut self) {
        for &word in &self.used {
            self.words[word as usize] = 0;
        }
        self.used.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn behaves_as_a_set(indices in prop::collection::vec(0u32..1000, 0..300), again: bool) {
            let mut set = IndexSet::new(1000);
            if again {
                indices.iter().rev().for_each(|&i| set.insert(i ^ 1));
                set.clear();
                prop_assert!(set.is_empty());
            }
            for &i in &indices { set.insert(i); }
            let naive: BTreeSet<u32> = indices.into_iter().collect();
            let mut list = Vec::new();
            set.collect_into(&mut list);
            prop_assert_eq!(&list, &naive.iter().copied().collect::<Vec<_>>());
            for i in 0..1000 { prop_assert_eq!(set.contains(i), naive.contains(&i)); }
        }
    }
}
