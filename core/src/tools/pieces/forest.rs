//! Components of words of 4^3 places, and a disjoint-set forest that joins them (union-find; Galler and Fischer 1964),
//! on all threads at once.
//!
//! A place is a voxel of a brick, or a child of a node of a grid's tree: both lie in the same order. Knows no grid.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

/// The places of a word with the lowest x, y and z.
pub const LOWEST: [u64; 3] = [0x1111_1111_1111_1111, 0x000F_000F_000F_000F, 0x0000_0000_0000_FFFF];
/// Distance from a place of a word to the next along each axis, in bits; likewise from a word to the next, in words.
pub const BIT_STEPS: [u32; 3] = [1, 4, 16];
pub const WORD_STEPS: [usize; 3] = [1, 2, 4];

/// Calls `f` with each component of a word and its node, counted from `first`.
#[inline(always)]
pub fn for_each_node(first: u32, word: u64, mut f: impl FnMut(u32, u64)) {
    let (mut node, mut rest) = (first, word);
    if word == u64::MAX {
        return f(node, word);
    }
    while rest != 0 {
        let own = flood(rest & rest.wrapping_neg(), rest);
        f(node, own);
        node += 1;
        rest &= !own;
    }
}

/// Returns the number of components of a word.
#[inline(always)]
pub fn count_nodes(word: u64) -> u32 {
    let mut count = 0;
    for_each_node(0, word, |_, _| count += 1);
    count
}

/// Returns the node of the component that holds the place of a bit, which must be set.
#[inline(always)]
pub fn node_of(first: u32, word: u64, bit: u32) -> u32 {
    let mut found = first;
    for_each_node(first, word, |node, own| {
        if own >> bit & 1 != 0 {
            found = node;
        }
    });
    found
}

/// Returns the places of a word that can be reached from `seed` through those of `within`.
#[inline(always)]
fn flood(mut seed: u64, within: u64) -> u64 {
    loop {
        let before = seed;
        for axis in 0..3 {
            let step = BIT_STEPS[axis];
            // Bits that leave the word on one side must not re-enter on the other.
            let highest = LOWEST[axis] << (3 * step);
            seed |= ((seed & !highest) << step | (seed & !LOWEST[axis]) >> step) & within;
        }
        if seed == before {
            return seed;
        }
    }
}

/// A disjoint-set forest: each node has a parent of a lower number, or is a root.
pub struct Forest {
    parents: Vec<AtomicU32>,
}

impl Forest {
    pub fn new(nodes: u32) -> Forest {
        Forest { parents: (0..nodes).into_par_iter().map(AtomicU32::new).collect() }
    }

    /// Joins the nodes of two touching words: those at the upper x, y or z side of one and the lower side of the other.
    #[inline(always)]
    pub fn join_words(&self, axis: usize, below: (u32, u64), above: (u32, u64)) {
        let shift = 3 * BIT_STEPS[axis];
        let touching = |below: u64, above: u64| below >> shift & above & LOWEST[axis];
        if touching(below.1, above.1) == 0 {
            return;
        }
        for_each_node(below.0, below.1, |low, low_bits| {
            if touching(low_bits, above.1) != 0 {
                for_each_node(above.0, above.1, |high, high_bits| {
                    if touching(low_bits, high_bits) != 0 {
                        self.join(low, high);
                    }
                });
            }
        });
    }

    /// Returns the root of a node. Halves the path to it.
    #[inline(always)]
    fn root(&self, mut node: u32) -> u32 {
        loop {
            let parent = self.parents[node as usize].load(Relaxed);
            if parent == node {
                return node;
            }
            let above = self.parents[parent as usize].load(Relaxed);
            // Another thread may have stored a lower one; both are ancestors.
            if above != parent {
                self.parents[node as usize].fetch_min(above, Relaxed);
            }
            node = above;
        }
    }

    #[inline(always)]
    pub fn join(&self, a: u32, b: u32) {
        let (mut a, mut b) = (self.root(a), self.root(b));
        while a != b {
            let (low, high) = (a.min(b), a.max(b));
            let parent = &self.parents[high as usize];
            if parent.compare_exchange(high, low, Relaxed, Relaxed).is_ok() {
                return;
            }
            // Another thread has joined it elsewhere in the meantime.
            (a, b) = (low, self.root(high));
        }
    }

    /// Returns the number of each node's set, in the order of the roots, and the number of sets.
    pub fn into_numbers(self) -> (Vec<u32>, u32) {
        let mut numbers: Vec<u32> = self.parents.into_iter().map(AtomicU32::into_inner).collect();
        let mut count = 0;
        for node in 0..numbers.len() {
            let parent = numbers[node] as usize;
            if parent == node {
                numbers[node] = count;
                count += 1;
            } else {
                // Lower nodes already have their numbers.
                numbers[node] = numbers[parent];
            }
        }
        (numbers, count)
    }
}
