//! Numbers the components of a grid by the nodes of its tree, and joins those that touch.
//!
//! The uniform children of a node of the tree are split into components word by word, as the voxels of a mixed brick are:
//! so cubes of any size that are empty or full count as single places, and nothing is done for what lies within them.
//! Neighbours on the faces of two cubes are found by going down in both at once.

use glam::UVec3;
use rayon::prelude::*;

use super::PiecesOf;
use super::forest::{BIT_STEPS, Forest, LOWEST, WORD_STEPS, count_nodes, for_each_node, node_of};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_WORDS, local_coords, local_index};
use crate::sculpture::grid::{NodeView, indices};
use crate::sculpture::{Brick, Grid};

/// Tasks between two reports of progress.
const BATCH_TASKS: usize = 1 << 10;

/// A node of the tree with its components.
#[derive(Clone, Copy, Debug)]
pub(super) struct LabelledNode<'a> {
    pub view: NodeView<'a>,
    /// Its children that are uniform and of the part.
    pub uniform: Brick,
    /// The number of the first component among the uniform children of each word, from `base` on.
    first: [u32; BRICK_WORDS],
    /// The number of the first component of the node's own: of its uniform children, or of the bricks of a leaf.
    base: u32,
    /// The place of the first mixed child in the list of nodes, or of bricks.
    children: usize,
}

/// The components of a part of a grid.
#[derive(Debug)]
pub(super) struct Labels<'a> {
    grid: &'a Grid,
    part: PiecesOf,
    /// The root first.
    pub nodes: Vec<LabelledNode<'a>>,
    /// The number of the first component of each word of each mixed brick, from the base of its leaf on.
    bricks: Vec<[u32; BRICK_WORDS]>,
    /// The number of components.
    pub count: u32,
}

/// One side of a face.
#[derive(Clone, Copy)]
enum Side {
    /// A uniform cube, and its component.
    Uniform(u32),
    /// A node, by its place in the list.
    Node(usize),
    /// The voxels of a brick, and the first component of each word.
    Brick(Brick, [u32; BRICK_WORDS]),
}

impl<'a> Labels<'a> {
    /// Lists the nodes and bricks of the tree. [`Labels::number`] numbers their components.
    pub fn new(grid: &'a Grid, part: PiecesOf) -> Labels<'a> {
        let labelled = |view: NodeView<'a>| {
            let uniform = match part {
                PiecesOf::Solid => *view.full(),
                PiecesOf::Empty => view.empty(),
            };
            LabelledNode { view, uniform, first: [0; BRICK_WORDS], base: 0, children: 0 }
        };
        let (mut nodes, mut bricks, mut at) = (vec![labelled(NodeView::root(grid))], 0, 0);
        while at < nodes.len() {
            let view = nodes[at].view;
            if view.is_leaf() {
                nodes[at].children = bricks;
                bricks += view.bricks().len();
            } else {
                nodes[at].children = nodes.len();
                nodes.extend(view.nodes().map(labelled));
            }
            at += 1;
        }
        Labels { grid, part, nodes, bricks: vec![[0; BRICK_WORDS]; bricks], count: 0 }
    }

    /// Returns the bytes in use.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.nodes) + size_of_val(&*self.bricks)) as u64
    }

    /// Numbers all components.
    pub fn number(&mut self) {
        let (grid, part) = (self.grid, self.part);
        let (mut rest, mut of_leaves) = (&mut *self.bricks, Vec::new());
        for node in &mut self.nodes {
            let (own, others) = std::mem::take(&mut rest).split_at_mut(node.view.bricks().len());
            rest = others;
            of_leaves.push((node, own));
        }
        let number = |(node, bricks): (&mut LabelledNode, &mut [[u32; BRICK_WORDS]])| {
            let mut count = 0;
            let mut add = |words: &[u64; BRICK_WORDS], first: &mut [u32; BRICK_WORDS]| {
                for (first, word) in first.iter_mut().zip(words) {
                    (*first, count) = (count, count + count_nodes(*word));
                }
            };
            add(&node.uniform.words, &mut node.first);
            let LabelledNode { view, .. } = *node;
            for (index, first) in indices(*view.mixed()).zip(bricks) {
                let brick = &view.bricks()[view.rank(index)];
                add(&part_of(grid, part, view, index, brick).words, first);
            }
            count
        };
        let counts: Vec<u32> = of_leaves.into_par_iter().map(number).collect();
        for (node, count) in self.nodes.iter_mut().zip(counts) {
            (node.base, self.count) = (self.count, self.count + count);
        }
    }

    /// Joins all components that touch. Returns false if cancelled.
    pub fn join(&self, forest: &Forest, progress: &dyn Progress) -> bool {
        // The mixed children of inner nodes are tasks of their own, since there may be few such nodes.
        let inner = |at: usize| {
            let node = &self.nodes[at];
            let mixed = if node.view.is_leaf() { Brick::EMPTY } else { *node.view.mixed() };
            indices(mixed).map(move |child| (at, Some(child)))
        };
        let tasks: Vec<(usize, Option<u32>)> =
            (0..self.nodes.len()).flat_map(|at| inner(at).chain([(at, None)])).collect();
        for (batch, portion) in tasks.chunks(BATCH_TASKS).enumerate() {
            if progress.is_cancelled() {
                return false;
            }
            progress.advance((batch * BATCH_TASKS) as f32 / tasks.len() as f32);
            portion.par_iter().for_each(|&(at, child)| match child {
                Some(child) => self.join_child(at, child, forest),
                None => self.join_within(at, forest),
            });
        }
        !progress.is_cancelled()
    }

    /// Joins the uniform children of a node with each other, and all pairs of bricks of a leaf.
    fn join_within(&self, at: usize, forest: &Forest) {
        let node = &self.nodes[at];
        self.join_own_words(node.first.map(|first| node.base + first), &node.uniform, forest);
        if node.view.is_leaf() {
            for child in indices(*node.view.mixed()) {
                if let Some(Side::Brick(bits, first)) = self.child(at, child) {
                    self.join_own_words(first, &bits, forest);
                }
                self.join_child(at, child, forest);
            }
        }
    }

    /// Joins the words of a brick, or of a mask of children, with those beside them.
    fn join_own_words(&self, first: [u32; BRICK_WORDS], bits: &Brick, forest: &Forest) {
        for (axis, step) in WORD_STEPS.into_iter().enumerate() {
            for word in (0..BRICK_WORDS).filter(|word| word & step != 0) {
                let below = word - step;
                let (below, above) =
                    ((first[below], bits.words[below]), (first[word], bits.words[word]));
                forest.join_words(axis, below, above);
            }
        }
    }

    /// Joins a mixed child of a node with its neighbours in the node: those above it, and the uniform ones below it.
    fn join_child(&self, at: usize, child: u32, forest: &Forest) {
        let Some(own) = self.child(at, child) else { return };
        for axis in 0..3 {
            if let Some(above) = above(child, axis).and_then(|other| self.child(at, other)) {
                self.join_faces(axis, own, above, forest);
            }
            if let Some(below @ Side::Uniform(_)) =
                below(child, axis).and_then(|other| self.child(at, other))
            {
                self.join_faces(axis, below, own, forest);
            }
        }
    }

    /// Joins what touches at the face between two cubes of one size, of which one lies below the other on an axis.
    fn join_faces(&self, axis: usize, low: Side, high: Side, forest: &Forest) {
        if let (Side::Uniform(low), Side::Uniform(high)) = (low, high) {
            return forest.join(low, high);
        }
        let ((low_bits, low_first), (high_bits, high_first)) = (self.words(low), self.words(high));
        let shift = 3 * BIT_STEPS[axis];
        for lower in (0..BRICK_WORDS).filter(|word| word & WORD_STEPS[axis] == 0) {
            // The word of the low side that touches this word of the high side.
            let upper = lower + WORD_STEPS[axis];
            let (below, above) = (low_bits.words[upper], high_bits.words[lower]);
            forest.join_words(axis, (low_first[upper], below), (high_first[lower], above));
            let low_mixed = self.mixed(low, upper) >> shift & LOWEST[axis];
            let high_mixed = self.mixed(high, lower) & LOWEST[axis];
            let mut pairs = low_mixed & (high_mixed | above) | high_mixed & (below >> shift);
            while pairs != 0 {
                let bit = pairs.trailing_zeros();
                pairs &= pairs - 1;
                let low = self.part(low, upper, bit + shift);
                if let Some((low, high)) = low.zip(self.part(high, lower, bit)) {
                    self.join_faces(axis, low, high, forest);
                }
            }
        }
    }

    /// Returns the places of a cube that are of the part, and the first component of each word.
    #[inline(always)]
    fn words(&self, side: Side) -> (Brick, [u32; BRICK_WORDS]) {
        match side {
            Side::Brick(bits, first) => (bits, first),
            Side::Uniform(component) => (Brick::FULL, [component; BRICK_WORDS]),
            Side::Node(at) => {
                let node = &self.nodes[at];
                (node.uniform, node.first.map(|first| node.base + first))
            }
        }
    }

    /// Returns the mixed children of a word.
    #[inline(always)]
    fn mixed(&self, side: Side, word: usize) -> u64 {
        match side {
            Side::Node(at) => self.nodes[at].view.mixed().words[word],
            Side::Brick(..) | Side::Uniform(_) => 0,
        }
    }

    /// Returns the part of a cube at a child.
    #[inline(always)]
    fn part(&self, side: Side, word: usize, bit: u32) -> Option<Side> {
        match side {
            Side::Node(at) => self.child(at, (word as u32) << 6 | bit),
            uniform => Some(uniform),
        }
    }

    /// Returns a child of a node; `None` if it is uniform and not of the part.
    #[inline]
    fn child(&self, at: usize, child: u32) -> Option<Side> {
        let node = &self.nodes[at];
        let (word, bit) = ((child >> 6) as usize & 7, child & 63);
        if node.view.mixed().words[word] >> bit & 1 == 0 {
            let bits = node.uniform.words[word];
            let component = || node_of(node.base + node.first[word], bits, bit);
            return (bits >> bit & 1 != 0).then(|| Side::Uniform(component()));
        }
        let rank = node.view.rank(child);
        if !node.view.is_leaf() {
            return Some(Side::Node(node.children + rank));
        }
        let bits = self.bits(node, child, &node.view.bricks()[rank]);
        Some(Side::Brick(bits, self.first_of_brick(node, rank)))
    }

    /// Returns the voxels of the part in a mixed brick of a leaf.
    #[inline(always)]
    pub fn bits(&self, leaf: &LabelledNode, child: u32, brick: &Brick) -> Brick {
        part_of(self.grid, self.part, leaf.view, child, brick)
    }

    /// Returns the first component of each word of a mixed brick, by its rank in its leaf.
    #[inline(always)]
    pub fn first_of_brick(&self, leaf: &LabelledNode, rank: usize) -> [u32; BRICK_WORDS] {
        self.bricks[leaf.children + rank].map(|first| leaf.base + first)
    }

    /// Returns the component of a voxel of the grid; `None` in the other part.
    pub fn at(&self, v: UVec3) -> Option<u32> {
        let (b, mut at) = (v / BRICK_EDGE_VX, 0);
        loop {
            let place = b >> self.nodes[at].view.child_log2() & 7;
            match self.child(at, local_index(place.x, place.y, place.z))? {
                Side::Node(child) => at = child,
                Side::Uniform(component) => return Some(component),
                Side::Brick(bits, first) => {
                    let local = local_index(v.x & 7, v.y & 7, v.z & 7);
                    let (word, bit) = ((local >> 6) as usize & 7, local & 63);
                    let bits = bits.words[word];
                    return (bits >> bit & 1 != 0).then(|| node_of(first[word], bits, bit));
                }
            }
        }
    }
}

impl LabelledNode<'_> {
    /// Calls `f` with each component of the uniform children: its number, the word, and the children.
    #[inline(always)]
    pub fn for_each_uniform(&self, mut f: impl FnMut(u32, u32, u64)) {
        for (word, (bits, first)) in (0u32..).zip(self.uniform.words.iter().zip(self.first)) {
            for_each_node(self.base + first, *bits, |component, own| f(component, word, own));
        }
    }
}

/// Returns the voxels of the part in a mixed brick.
#[inline(always)]
fn part_of(grid: &Grid, part: PiecesOf, leaf: NodeView, child: u32, brick: &Brick) -> Brick {
    match part {
        PiecesOf::Solid => *brick,
        PiecesOf::Empty if leaf.is_whole() => Brick::FULL.and_not(brick),
        PiecesOf::Empty => grid.valid_mask(leaf.child_low(child)).and_not(brick),
    }
}

/// Returns the neighbour of a child above it on an axis, if it is in the same node.
#[inline(always)]
fn above(child: u32, axis: usize) -> Option<u32> {
    let mut at = local_coords(child);
    at[axis] += 1;
    (at[axis] < 8).then(|| local_index(at[0], at[1], at[2]))
}

/// Returns the neighbour of a child below it on an axis, if it is in the same node.
#[inline(always)]
fn below(child: u32, axis: usize) -> Option<u32> {
    let mut at = local_coords(child);
    at[axis] = at[axis].checked_sub(1)?;
    Some(local_index(at[0], at[1], at[2]))
}
