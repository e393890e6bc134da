//! Builds the whole tree of a grid from its bricks, on all threads: for loaders and generators.
//!
//! Takes functions that give bricks by coordinates or by runs in linear order, and cubes that are uniform; never holds
//! more than the runs in work beside the finished leaves.

use std::sync::Arc;

use glam::UVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::extent::Extent;
use super::node::{Child, NODE_EDGE_LOG2, Slot, TreeNode};
use super::{unflatten, valid_mask};
use crate::sculpture::brick::{BRICK_VOXELS, Brick, local_coords};
use crate::sculpture::region::BrickBox;

/// Returns the tree of the bricks that `f` returns for their coordinates, cut to the valid bits.
pub(super) fn tree_of_bricks(
    extent: Extent,
    levels: u32,
    f: &(dyn Fn(UVec3) -> Brick + Sync),
) -> Arc<TreeNode> {
    tree_of_cubes(extent, levels, &|_| None, f)
}

/// Returns the tree of the bricks that `f` adds to runs of `run` bricks in linear order, and the values that it returns.
/// `f` gets the linear index of a run's first brick and the run. Returns one of its errors if there is one.
pub(super) fn tree_of_runs<T: Send, E: Send>(
    extent: Extent,
    levels: u32,
    run: usize,
    f: impl Fn(usize, &mut BrickRun) -> Result<T, E> + Sync,
) -> Result<(Arc<TreeNode>, Vec<T>), E> {
    let count = extent.bricks.element_product() as usize;
    let firsts: Vec<usize> = (0..count).step_by(run.max(1)).collect();
    let written: Result<Vec<(T, BrickRun)>, E> = firsts
        .into_par_iter()
        .map(|first| {
            let mut bricks = BrickRun::new(extent, first, run.min(count - first));
            let value = f(first, &mut bricks)?;
            Ok((value, bricks))
        })
        .collect();
    let (values, runs): (Vec<T>, Vec<BrickRun>) = written?.into_iter().unzip();
    // Mostly a power of two, which spares two divisions a brick.
    let log2 = run.is_power_of_two().then(|| run.trailing_zeros());
    let root = tree_of_leaves_and_cubes(extent, levels, &|_| None, &|leaf| {
        leaf_of(&extent, leaf, |b, _| {
            let index = (b.x + extent.bricks.x * (b.y + extent.bricks.y * b.z)) as usize;
            let (at, within) = match log2 {
                Some(log2) => (index >> log2, index & (run - 1)),
                None => (index / run, index % run),
            };
            runs[at].brick(within)
        })
    });
    Ok((root, values))
}

/// Returns the tree of the cubes that `whole` says to be full (`true`) or empty, and of the bricks that `f` returns in
/// all others, cut to the valid bits. `whole` gets the bricks of a cube that lie within the grid.
pub(super) fn tree_of_cubes(
    extent: Extent,
    levels: u32,
    whole: &(dyn Fn(BrickBox) -> Option<bool> + Sync),
    f: &(dyn Fn(UVec3) -> Brick + Sync),
) -> Arc<TreeNode> {
    tree_of_leaves_and_cubes(extent, levels, whole, &|leaf| {
        leaf_of(&extent, leaf, |b, valid| Value::of(f(b).and(valid)))
    })
}

/// Performs [`tree_of_cubes`] with the leaves that `leaf` returns for their coordinates.
pub(super) fn tree_of_leaves_and_cubes(
    extent: Extent,
    levels: u32,
    whole: &(dyn Fn(BrickBox) -> Option<bool> + Sync),
    leaf: &(dyn Fn(UVec3) -> Child + Sync),
) -> Arc<TreeNode> {
    Arc::new(node_of_cubes(&extent, UVec3::ZERO, levels, whole, leaf))
}

/// Returns the node of `level` (2 or more) from brick `low` on.
fn node_of_cubes(
    extent: &Extent,
    low: UVec3,
    level: u32,
    whole: &(dyn Fn(BrickBox) -> Option<bool> + Sync),
    leaf: &(dyn Fn(UVec3) -> Child + Sync),
) -> TreeNode {
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    let inside = extent.children(low, log2);
    let mut places = Vec::with_capacity(usize::from(inside.count()));
    inside.for_each(|index| places.push(index));
    let child = |&index: &u32| {
        let low = low + (UVec3::from(local_coords(index)) << log2);
        let max = (low + (1 << log2)).min(extent.bricks);
        match whole(BrickBox { min: low, max }) {
            Some(false) => Child::Empty,
            Some(true) => Child::Full,
            None if level == 2 => leaf(low >> NODE_EDGE_LOG2),
            None => {
                let node = node_of_cubes(extent, low, level - 1, whole, leaf);
                closed(node, extent, low, log2)
            }
        }
    };
    let children: Vec<Child> = places.par_iter().map(child).collect();
    let mut children = children.into_iter();
    node_with(extent, low, level, &mut |_| children.next().unwrap_or(Child::Empty))
}

/// A brick, without bits where it has none or all.
pub(super) enum Value {
    Empty,
    Full,
    Mixed(Brick),
}

impl Value {
    #[inline]
    pub fn of(brick: Brick) -> Value {
        match () {
            () if brick.is_empty() => Value::Empty,
            () if brick.is_full() => Value::Full,
            () => Value::Mixed(brick),
        }
    }
}

/// Returns a leaf of the bricks that `f` returns for their coordinates and valid bits.
pub(super) fn leaf_of(extent: &Extent, leaf: UVec3, f: impl Fn(UVec3, &Brick) -> Value) -> Child {
    let low = leaf << NODE_EDGE_LOG2;
    let (inside, is_whole) = (extent.children(low, 0), extent.holds_brick(low + 7));
    let (mut mixed, mut full, mut bricks, mut voxels) = (Brick::EMPTY, Brick::EMPTY, Vec::new(), 0);
    inside.for_each(|index| {
        let (slot, b) = (Slot::at(index), low + UVec3::from(local_coords(index)));
        let valid = if is_whole { Brick::FULL } else { valid_mask(extent.dims, b) };
        match f(b, &valid) {
            Value::Empty => {}
            Value::Full => {
                slot.put(&mut full, true);
                voxels += if is_whole { u64::from(BRICK_VOXELS) } else { u64::from(valid.count()) };
            }
            Value::Mixed(brick) => {
                voxels += u64::from(brick.count());
                if !is_whole && brick == valid {
                    slot.put(&mut full, true);
                } else {
                    slot.put(&mut mixed, true);
                    bricks.push(brick);
                }
            }
        }
    });
    if full == inside {
        Child::Full
    } else if voxels == 0 {
        Child::Empty
    } else {
        bricks.shrink_to_fit();
        Child::Mixed(Arc::new(TreeNode::leaf(mixed, full, bricks, voxels)))
    }
}

/// Returns the node of `level` (2 or more) from brick `low` on, of leaves.
pub(super) fn node_of(
    extent: &Extent,
    low: UVec3,
    level: u32,
    leaf: &mut dyn FnMut(UVec3) -> Child,
) -> TreeNode {
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    node_with(extent, low, level, &mut |low| match level {
        2 => leaf(low >> NODE_EDGE_LOG2),
        _ => closed(node_of(extent, low, level - 1, leaf), extent, low, log2),
    })
}

/// Returns a node, whose cube is of `1 << log2` bricks an edge from brick `low` on, as a child.
fn closed(node: TreeNode, extent: &Extent, low: UVec3, log2: u32) -> Child {
    let is_full = node.full == extent.children(low, log2 - NODE_EDGE_LOG2);
    match () {
        () if node.occupied() == Brick::EMPTY => Child::Empty,
        () if is_full => Child::Full,
        () => Child::Mixed(Arc::new(node)),
    }
}

/// Returns the node of `level` (2 or more) from brick `low` on, of the children that `child` returns for their lowest
/// bricks, in ascending order.
fn node_with(
    extent: &Extent,
    low: UVec3,
    level: u32,
    child: &mut dyn FnMut(UVec3) -> Child,
) -> TreeNode {
    let log2 = NODE_EDGE_LOG2 * (level - 1);
    let (mut mixed, mut full, mut nodes, mut voxels) = (Brick::EMPTY, Brick::EMPTY, Vec::new(), 0);
    extent.children(low, log2).for_each(|index| {
        let (slot, low) = (Slot::at(index), low + (UVec3::from(local_coords(index)) << log2));
        match child(low) {
            Child::Empty => {}
            Child::Full => {
                slot.put(&mut full, true);
                voxels += extent.voxels(low, log2);
            }
            Child::Mixed(node) => {
                slot.put(&mut mixed, true);
                voxels += node.voxels;
                nodes.push(node);
            }
        }
    });
    nodes.shrink_to_fit();
    TreeNode::inner(mixed, full, nodes, voxels)
}

/// Returns the tree of the cubes that `whole` says to be full (`true`) or empty, and of the leaves in runs of `run` that
/// `f` fills, and the values that it returns. `f` gets the number of a run and the bricks of its leaves, one leaf after
/// the other. Leaves that are neither are empty. Returns one of its errors if there is one.
pub(super) fn tree_of_leaf_runs<T: Send, E: Send>(
    extent: Extent,
    levels: u32,
    whole: &(dyn Fn(BrickBox) -> Option<bool> + Sync),
    (leaves, run): (&[UVec3], usize),
    f: impl Fn(usize, &mut BrickRun) -> Result<T, E> + Sync,
) -> Result<(Arc<TreeNode>, Vec<T>), E> {
    let written: Result<Vec<(T, BrickRun)>, E> = leaves
        .par_chunks(run.max(1))
        .enumerate()
        .map(|(number, leaves)| {
            let mut bricks = BrickRun::of_leaves(extent, leaves);
            let value = f(number, &mut bricks)?;
            Ok((value, bricks))
        })
        .collect();
    let (values, runs): (Vec<T>, Vec<BrickRun>) = written?.into_iter().unzip();
    // The run of each leaf, and its first brick there.
    let mut places = FxHashMap::default();
    for (number, leaves) in leaves.chunks(run.max(1)).enumerate() {
        let mut first = 0;
        for leaf in leaves {
            places.insert(*leaf, (number, first));
            first += leaf_bricks(&extent, *leaf).brick_count() as usize;
        }
    }
    let brick = |b: UVec3| {
        let leaf = b >> NODE_EDGE_LOG2;
        let Some((number, first)) = places.get(&leaf) else { return Brick::EMPTY };
        let bricks = leaf_bricks(&extent, leaf);
        let (at, size) = (b - bricks.min, bricks.max - bricks.min);
        let within = (at.x + size.x * (at.y + size.y * at.z)) as usize;
        match runs[*number].brick(first + within) {
            Value::Empty => Brick::EMPTY,
            Value::Full => Brick::FULL,
            Value::Mixed(brick) => brick,
        }
    };
    let root = tree_of_cubes(extent, levels, whole, &brick);
    Ok((root, values))
}

/// Returns the bricks of a leaf that lie within the grid.
fn leaf_bricks(extent: &Extent, leaf: UVec3) -> BrickBox {
    let min = leaf << NODE_EDGE_LOG2;
    BrickBox { min, max: (min + (1 << NODE_EDGE_LOG2)).min(extent.bricks) }
}

/// A run of bricks, as a loader adds them: in linear order, or those of some leaves, one after the other. Only the mixed
/// ones take memory.
#[derive(Debug)]
pub(crate) struct BrickRun {
    extent: Extent,
    /// The box of bricks whose rows are added, and the boxes that follow.
    within: BrickBox,
    following: std::vec::IntoIter<UVec3>,
    /// The coordinates of the next brick, and how many may follow.
    next: UVec3,
    left: usize,
    /// By 64 bricks: which are full, which are mixed, and the number of mixed ones before them.
    words: Vec<(u64, u64, u32)>,
    mixed: Vec<Brick>,
    len: usize,
}

impl BrickRun {
    fn new(extent: Extent, first: usize, count: usize) -> BrickRun {
        let within = BrickBox { min: UVec3::ZERO, max: extent.bricks };
        let next = unflatten(first as u32, extent.bricks);
        let words = Vec::with_capacity(count.div_ceil(64));
        let following = Vec::new().into_iter();
        BrickRun { extent, within, following, next, left: count, words, mixed: Vec::new(), len: 0 }
    }

    fn of_leaves(extent: Extent, leaves: &[UVec3]) -> BrickRun {
        let bricks = |leaf: &UVec3| leaf_bricks(&extent, *leaf);
        let count = leaves.iter().map(|leaf| bricks(leaf).brick_count() as usize).sum();
        let (first, rest) = leaves.split_first().unwrap_or((&UVec3::ZERO, &[]));
        let (within, following) = (bricks(first), Vec::from(rest).into_iter());
        BrickRun { within, following, next: within.min, ..BrickRun::new(extent, 0, count) }
    }

    /// Returns how many bricks remain to be added.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Returns the coordinates of the next brick.
    #[inline]
    pub fn next(&self) -> UVec3 {
        self.next
    }

    /// Makes room for `mixed` bricks that are neither empty nor full.
    pub fn reserve(&mut self, mixed: usize) {
        self.mixed.reserve_exact(mixed);
    }

    /// Adds an empty brick.
    #[inline]
    pub fn add_empty(&mut self) {
        self.add(0, 0);
    }

    /// Adds a brick that is full as far as it lies within the grid.
    #[inline]
    pub fn add_full(&mut self) {
        self.add(1, 0);
    }

    /// Adds a brick. Returns false if it has voxels beyond the border of the grid; then it is not added.
    #[inline]
    pub fn add_brick(&mut self, brick: &Brick) -> bool {
        if !self.extent.holds_brick(self.next) {
            let valid = valid_mask(self.extent.dims, self.next);
            if *brick != brick.and(&valid) {
                return false;
            }
        }
        match () {
            () if brick.is_empty() => self.add_empty(),
            () if brick.is_full() => self.add_full(),
            () => {
                self.add(0, 1);
                self.mixed.push(*brick);
            }
        }
        true
    }

    /// Adds a brick that is full or mixed, or neither.
    #[inline]
    fn add(&mut self, full: u64, mixed: u64) {
        let bit = self.len % 64;
        if bit == 0 {
            self.words.push((0, 0, self.mixed.len() as u32));
        }
        if let Some(word) = self.words.last_mut() {
            word.0 |= full << bit;
            word.1 |= mixed << bit;
        }
        self.len += 1;
        self.left = self.left.saturating_sub(1);
        let BrickBox { min, max } = self.within;
        let next = &mut self.next;
        next.x += 1;
        if next.x == max.x {
            (next.x, next.y) = (min.x, next.y + 1);
        }
        if next.y == max.y {
            (next.y, next.z) = (min.y, next.z + 1);
        }
        if next.z == max.z
            && let Some(leaf) = self.following.next()
        {
            self.within = leaf_bricks(&self.extent, leaf);
            self.next = self.within.min;
        }
    }

    /// Returns a brick by its place in the run. Those that were not added are empty.
    fn brick(&self, index: usize) -> Value {
        let ((full, mixed, before), bit) =
            (self.words.get(index / 64).copied().unwrap_or_default(), index % 64);
        match (full >> bit & 1, mixed >> bit & 1) {
            (0, 0) => Value::Empty,
            (0, _) => {
                let rank = (mixed & ((1 << bit) - 1)).count_ones();
                Value::Mixed(self.mixed[(before + rank) as usize])
            }
            _ => Value::Full,
        }
    }
}
