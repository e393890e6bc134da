//! Labels the pieces of a grid: the face-connected components of its voxels, or of its empty places. Empty pieces that
//! do not reach the grid's border are its cavities.
//!
//! Takes a [`Grid`]; gives each voxel the number of its piece, and each piece its size and bounding box. Every word of
//! 4^3 voxels is split into its own components by bit shifts; those of neighbouring words are joined in a disjoint-set
//! forest (union-find; Galler and Fischer 1964) by all threads at once. Changes nothing and knows no document.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::{IVec3, UVec3};
use rayon::prelude::*;
use thiserror::Error;

use crate::progress::Progress;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::brick::{BRICK_EDGE_VX, BRICK_WORDS, WORD_EDGE_VX, local_index, word_bounds};
use crate::sculpture::{Brick, Grid};

/// Layers of bricks between two reports of progress.
const BATCH_LAYERS: usize = 8;
/// The voxels of a word with the lowest x, y and z.
const LOWEST: [u64; 3] = [0x1111_1111_1111_1111, 0x000F_000F_000F_000F, 0x0000_0000_0000_FFFF];
/// Distance from a voxel of a word to the next along each axis, in bits; likewise from a word of a brick, in words.
const BIT_STEPS: [u32; 3] = [1, 4, 16];
const WORD_STEPS: [usize; 3] = [1, 2, 4];

/// The voxels to label.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PiecesOf {
    /// The voxels that exist.
    Solid,
    /// The empty places inside the grid's box.
    Empty,
}

/// The reason why the pieces could not be found.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum PiecesError {
    /// [`Progress::is_cancelled`] returned true.
    #[error("the work was cancelled")]
    Cancelled,
    /// So many pieces need more memory than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

/// A connected component.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Piece {
    /// Number of voxels, at least 1.
    pub voxels: u32,
    low: [u16; 3],
    high: [u16; 3],
}

impl Piece {
    /// Returns the bounding box in voxels: its lowest voxel and one past its highest.
    pub fn bounds(&self) -> (UVec3, UVec3) {
        (self.low.map(u32::from).into(), self.high.map(u32::from).into())
    }
}

/// The pieces of a part of a grid.
#[derive(Debug)]
pub struct Pieces<'a> {
    grid: &'a Grid,
    part: PiecesOf,
    /// The number of the first node of each word of each brick; the eight words of a full brick share one.
    first: Vec<[u32; BRICK_WORDS]>,
    /// The piece of each node.
    piece_of: Vec<u32>,
    pieces: Vec<Piece>,
}

/// Finds the pieces of a part of a grid, within `budget_bytes` beyond the grid itself.
pub fn pieces<'a>(
    grid: &'a Grid,
    part: PiecesOf,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Pieces<'a>, PiecesError> {
    progress.begin("finding the pieces");
    let found = Pieces::find(grid, part, budget_bytes, progress);
    progress.end();
    found
}

impl<'a> Pieces<'a> {
    fn find(
        grid: &'a Grid,
        part: PiecesOf,
        budget_bytes: u64,
        progress: &dyn Progress,
    ) -> Result<Pieces<'a>, PiecesError> {
        let mut needed = (grid.brick_count() * size_of::<[u32; BRICK_WORDS]>()) as u64;
        let fits = |needed: u64| {
            let what = "finding the pieces needs";
            let checked = OverBudget::check(what, needed, MemoryBudget::Grids, budget_bytes);
            checked.map_err(|over| over.advise("remove noise with another threshold"))
        };
        fits(needed)?;
        let (first, nodes) = number_nodes(grid, part);
        needed += u64::from(nodes) * size_of::<u32>() as u64;
        fits(needed)?;
        let mut pieces = Pieces { grid, part, first, piece_of: Vec::new(), pieces: Vec::new() };

        let forest = Forest::new(nodes);
        let layers = grid.brick_dims().z as usize;
        for start in (0..layers).step_by(BATCH_LAYERS) {
            if progress.is_cancelled() {
                return Err(PiecesError::Cancelled);
            }
            progress.advance(start as f32 / layers as f32);
            let end = (start + BATCH_LAYERS).min(layers);
            (start..end).into_par_iter().for_each(|z| pieces.join_layer(z as u32, &forest));
        }
        let (piece_of, count) = forest.into_numbers();
        needed += u64::from(count) * size_of::<Piece>() as u64;
        fits(needed)?;
        pieces.piece_of = piece_of;
        pieces.measure(count);
        Ok(pieces)
    }

    /// Returns all pieces, numbered from 0 in the order of their first bricks.
    pub fn list(&self) -> &[Piece] {
        &self.pieces
    }

    /// Returns the number of the piece with the most voxels; the first of equals.
    pub fn largest(&self) -> Option<u32> {
        let most = self.pieces.iter().map(|piece| piece.voxels).max()?;
        self.pieces.iter().position(|piece| piece.voxels == most).map(|place| place as u32)
    }

    /// Returns whether a piece touches the border of the grid. An empty one that does not is a cavity.
    pub(crate) fn reaches_border(&self, piece: u32) -> bool {
        let (low, high) = self.pieces[piece as usize].bounds();
        low.min_element() == 0 || high.cmpeq(self.grid.dims()).any()
    }

    /// Returns the number of the piece at a voxel; `None` outside the grid or in the other part.
    pub fn at(&self, voxel: IVec3) -> Option<u32> {
        let inside = self.grid.contains(voxel);
        let v = inside.then(|| voxel.as_uvec3())?;
        let brick = self.grid.brick_index(v / BRICK_EDGE_VX);
        let local = local_index(v.x & 7, v.y & 7, v.z & 7);
        let (word, bit) = ((local >> 6) as usize, 1 << (local & 63));
        let mut found = None;
        self.for_each_of_word(brick, word, self.bits(brick).words[word], |piece, bits| {
            if bits & bit != 0 {
                found = Some(piece);
            }
        });
        found
    }

    /// Returns the voxels of a brick (by linear index) whose pieces pass `is_chosen`.
    pub fn chosen(&self, brick: usize, is_chosen: &impl Fn(u32) -> bool) -> Brick {
        let mut chosen = self.bits(brick);
        for (word, bits) in chosen.words.iter_mut().enumerate() {
            let all = std::mem::take(bits);
            self.for_each_of_word(brick, word, all, |piece, own| {
                if is_chosen(piece) {
                    *bits |= own;
                }
            });
        }
        chosen
    }

    #[inline(always)]
    fn for_each_of_word(&self, brick: usize, word: usize, bits: u64, mut f: impl FnMut(u32, u64)) {
        for_each_node(self.first[brick][word], bits, |node, own| {
            f(self.piece_of[node as usize], own);
        });
    }

    #[inline(always)]
    fn bits(&self, brick: usize) -> Brick {
        bits_of(self.grid, self.part, brick)
    }

    /// Joins the nodes of each word of a layer of bricks with those of the preceding words on each axis.
    fn join_layer(&self, z: u32, forest: &Forest) {
        let UVec3 { x: width, y: height, .. } = self.grid.brick_dims();
        let strides = [1, width as usize, (width * height) as usize];
        let begin = self.grid.brick_index(UVec3::new(0, 0, z));
        for brick in begin..begin + strides[2] {
            let bits = self.bits(brick);
            if bits.is_empty() {
                continue;
            }
            let b = self.grid.brick_coords(brick).to_array();
            for axis in 0..3 {
                if !bits.is_full() {
                    for (word, &above) in bits.words.iter().enumerate() {
                        if word & WORD_STEPS[axis] != 0 {
                            let below = word - WORD_STEPS[axis];
                            let below = (self.first[brick][below], bits.words[below]);
                            forest.join_words(axis, below, (self.first[brick][word], above));
                        }
                    }
                }
                if b[axis] == 0 {
                    continue;
                }
                let other = brick - strides[axis];
                let below_bits = self.bits(other);
                if bits.is_full() && below_bits.is_full() {
                    forest.join(self.first[brick][0], self.first[other][0]);
                    continue;
                }
                for word in (0..BRICK_WORDS).filter(|word| word & WORD_STEPS[axis] == 0) {
                    let below = word + WORD_STEPS[axis];
                    let below = (self.first[other][below], below_bits.words[below]);
                    forest.join_words(axis, below, (self.first[brick][word], bits.words[word]));
                }
            }
        }
    }

    /// Computes the sizes and bounding boxes.
    fn measure(&mut self, count: u32) {
        let none = Piece { voxels: 0, low: [u16::MAX; 3], high: [0; 3] };
        let mut pieces = vec![none; count as usize];
        for brick in 0..self.first.len() {
            let corner = self.grid.brick_coords(brick) * BRICK_EDGE_VX;
            let bits = self.bits(brick);
            if bits.is_full() {
                let piece = &mut pieces[self.piece_of[self.first[brick][0] as usize] as usize];
                piece.add(bits.count().into(), corner, corner + BRICK_EDGE_VX);
                continue;
            }
            for (word, &all) in bits.words.iter().enumerate() {
                let place = UVec3::new(word as u32 & 1, word as u32 >> 1 & 1, word as u32 >> 2);
                let corner = corner + place * WORD_EDGE_VX;
                self.for_each_of_word(brick, word, all, |piece, own| {
                    let (low, high) = word_bounds(own);
                    let piece = &mut pieces[piece as usize];
                    piece.add(own.count_ones(), corner + low, corner + high);
                });
            }
        }
        self.pieces = pieces;
    }
}

impl Piece {
    #[inline(always)]
    fn add(&mut self, voxels: u32, low: UVec3, high: UVec3) {
        self.voxels += voxels;
        for axis in 0..3 {
            // An axis has at most 4096 voxels.
            self.low[axis] = self.low[axis].min(low[axis] as u16);
            self.high[axis] = self.high[axis].max(high[axis] as u16);
        }
    }
}

#[inline(always)]
fn bits_of(grid: &Grid, part: PiecesOf, brick: usize) -> Brick {
    let bits = grid.brick_at(brick);
    match part {
        PiecesOf::Solid => *bits,
        PiecesOf::Empty => grid.valid_mask(grid.brick_coords(brick)).and_not(bits),
    }
}

/// Returns the first node of each word and the number of nodes.
fn number_nodes(grid: &Grid, part: PiecesOf) -> (Vec<[u32; BRICK_WORDS]>, u32) {
    let mut first = vec![[0; BRICK_WORDS]; grid.brick_count()];
    first.par_iter_mut().enumerate().with_min_len(1 << 10).for_each(|(brick, counts)| {
        let bits = bits_of(grid, part, brick);
        if bits.is_full() {
            counts[0] = 1;
            return;
        }
        for (count, &word) in counts.iter_mut().zip(&bits.words) {
            for_each_node(0, word, |_, _| *count += 1);
        }
    });
    let mut nodes = 0;
    for (brick, first) in first.iter_mut().enumerate() {
        let full = bits_of(grid, part, brick).is_full();
        let begin = nodes;
        for first in first {
            let count = std::mem::replace(first, if full { begin } else { nodes });
            nodes += count;
        }
    }
    (first, nodes)
}

/// Calls `f` with each piece of a word and its node, counted from `first`.
#[inline(always)]
fn for_each_node(first: u32, word: u64, mut f: impl FnMut(u32, u64)) {
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

/// Returns the voxels of a word that can be reached from `seed` through those of `within`.
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
struct Forest {
    parents: Vec<AtomicU32>,
}

impl Forest {
    fn new(nodes: u32) -> Forest {
        Forest { parents: (0..nodes).into_par_iter().map(AtomicU32::new).collect() }
    }

    /// Joins the nodes of two touching words: those at the upper x, y or z side of one and the lower side of the other.
    #[inline(always)]
    fn join_words(&self, axis: usize, below: (u32, u64), above: (u32, u64)) {
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
    fn join(&self, a: u32, b: u32) {
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
    fn into_numbers(self) -> (Vec<u32>, u32) {
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

/// Removes all but the largest piece. An empty grid stays empty.
pub(crate) fn keep_largest(
    grid: &mut Grid,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<(), PiecesError> {
    let found = pieces(grid, PiecesOf::Solid, budget_bytes, progress)?;
    let Some(largest) = found.largest().filter(|_| found.list().len() > 1) else { return Ok(()) };
    let kept = changed(&found, &|brick| found.chosen(brick, &|piece| piece == largest));
    kept.into_iter().for_each(|(index, brick)| grid.set_brick(index, brick));
    Ok(())
}

/// Fills all cavities: empty pieces that do not reach the grid's border.
pub fn fill_holes(
    grid: &mut Grid,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<(), PiecesError> {
    let found = pieces(grid, PiecesOf::Empty, budget_bytes, progress)?;
    let is_hole = |piece| !found.reaches_border(piece);
    let filled =
        changed(&found, &|brick| found.grid.brick_at(brick).or(&found.chosen(brick, &is_hole)));
    filled.into_iter().for_each(|(index, brick)| grid.set_brick(index, brick));
    Ok(())
}

/// Returns the bricks that `of` gives where they differ from those of the grid.
fn changed(pieces: &Pieces<'_>, of: &(dyn Fn(usize) -> Brick + Sync)) -> Vec<(usize, Brick)> {
    let grid = pieces.grid;
    let bricks = (0..grid.brick_count()).into_par_iter().with_min_len(1 << 10);
    bricks.map(|i| (i, of(i))).filter(|(i, brick)| brick != grid.brick_at(*i)).collect()
}
