//! Labels the pieces of a grid: the face-connected components of its voxels, or of its empty places. Empty pieces that
//! do not reach the grid's border are its cavities.
//!
//! Takes a [`Grid`]; gives each voxel the number of its piece, and each piece its size and bounding box. Every word of
//! 4^3 voxels is split into its own components by bit shifts, and so is every word of 4^3 uniform children of a node of
//! the grid's tree ([`labels`]); those that touch are joined in a disjoint-set forest ([`forest`]). Time and memory
//! follow the surface, not the size of the grid. Changes nothing and knows no document.

use glam::{IVec3, UVec3};
use rayon::prelude::*;
use thiserror::Error;

use self::forest::{Forest, for_each_node};
use self::labels::{LabelledNode, Labels};
use crate::progress::Progress;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::brick::{BRICK_EDGE_VX, WORD_EDGE_VX, local_coords, word_bounds};
use crate::sculpture::grid::indices;
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Brick, Grid};

mod forest;
mod labels;

/// Fewer pieces than this are measured on all threads, each with a list of its own.
const FEW_PIECES: u32 = 1 << 12;

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
    pub voxels: u64,
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
    labels: Labels<'a>,
    /// The piece of each component.
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
        let fits = |needed: u64| {
            let what = "finding the pieces needs";
            let checked = OverBudget::check(what, needed, MemoryBudget::Grids, budget_bytes);
            checked.map_err(|over| over.advise("remove noise with another threshold"))
        };
        let mut labels = Labels::new(grid, part);
        let mut needed = labels.bytes();
        fits(needed)?;
        labels.number();
        needed += u64::from(labels.count) * size_of::<u32>() as u64;
        fits(needed)?;
        let forest = Forest::new(labels.count);
        if !labels.join(&forest, progress) {
            return Err(PiecesError::Cancelled);
        }
        let (piece_of, count) = forest.into_numbers();
        needed += u64::from(count) * size_of::<Piece>() as u64;
        fits(needed)?;
        let mut pieces = Pieces { grid, labels, piece_of, pieces: Vec::new() };
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
        let component = self.labels.at(inside.then(|| voxel.as_uvec3())?)?;
        Some(self.piece_of[component as usize])
    }

    /// Returns the voxels of the pieces that pass `is_chosen`.
    pub fn voxels_of(&self, is_chosen: &(dyn Fn(u32) -> bool + Sync)) -> ListedBricks {
        let is_chosen = |component: u32| is_chosen(self.piece_of[component as usize]);
        let nodes = self.labels.nodes.par_iter();
        let mut bricks: Vec<(UVec3, Brick)> =
            nodes.flat_map_iter(|node| self.chosen_in(node, &is_chosen)).collect();
        bricks.par_sort_unstable_by_key(|(b, _)| (b.z, b.y, b.x));
        ListedBricks::new(bricks)
    }

    /// Returns the voxels of a node's own children that are of chosen components.
    fn chosen_in(
        &self,
        node: &LabelledNode,
        is_chosen: &dyn Fn(u32) -> bool,
    ) -> Vec<(UVec3, Brick)> {
        let (view, mut bricks) = (node.view, Vec::new());
        node.for_each_uniform(|component, word, own| {
            if is_chosen(component) {
                let mut children = Brick::EMPTY;
                children.words[word as usize & 7] = own;
                children.for_each(|index| {
                    let cube = view.child_bricks(index);
                    let size = cube.max - cube.min;
                    let inside = (0..size.element_product()).map(|i| {
                        let at = UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y));
                        cube.min + at
                    });
                    bricks.extend(inside.map(|b| (b, self.grid.valid_mask(b))));
                });
            }
        });
        for (rank, index) in mixed_bricks(node) {
            let mut chosen = self.labels.bits(node, index, &view.bricks()[rank]);
            let first = self.labels.first_of_brick(node, rank);
            for (bits, first) in chosen.words.iter_mut().zip(first) {
                let all = std::mem::take(bits);
                for_each_node(first, all, |component, own| {
                    if is_chosen(component) {
                        *bits |= own;
                    }
                });
            }
            if !chosen.is_empty() {
                bricks.push((view.child_low(index), chosen));
            }
        }
        bricks
    }

    /// Computes the sizes and bounding boxes, and numbers the pieces in the order of their first bricks.
    fn measure(&mut self, count: u32) {
        let none = || vec![MeasuredPiece::NONE; count as usize];
        let add = |mut pieces: Vec<MeasuredPiece>, node: &LabelledNode| {
            self.measure_node(node, &mut pieces);
            pieces
        };
        let nodes = &self.labels.nodes;
        let mut measured: Vec<MeasuredPiece> = match count < FEW_PIECES {
            true => {
                let join = |mut a: Vec<MeasuredPiece>, b: Vec<MeasuredPiece>| {
                    a.iter_mut().zip(b).for_each(|(a, b)| a.join(&b));
                    a
                };
                let portion = nodes.len().div_ceil(rayon::current_num_threads()).max(64);
                let parts = nodes.par_chunks(portion).map(|nodes| nodes.iter().fold(none(), add));
                parts.reduce(none, join)
            }
            false => nodes.iter().fold(none(), add),
        };
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_unstable_by_key(|number| measured[*number as usize].first);
        let mut numbers = vec![0; count as usize];
        (0u32..).zip(&order).for_each(|(new, old)| numbers[*old as usize] = new);
        self.piece_of.par_iter_mut().for_each(|piece| *piece = numbers[*piece as usize]);
        measured.sort_unstable_by_key(|piece| piece.first);
        self.pieces = measured.into_iter().map(|measured| measured.piece).collect();
    }

    /// Adds the components of a node's own children to their pieces.
    fn measure_node(&self, node: &LabelledNode, pieces: &mut [MeasuredPiece]) {
        let (view, is_whole) = (node.view, node.view.is_whole());
        let dims = self.grid.dims();
        let edge = BRICK_EDGE_VX << view.child_log2();
        let low_vx = view.low() * BRICK_EDGE_VX;
        let place = |brick: UVec3| self.grid.brick_index(brick) as u64 * 512;
        node.for_each_uniform(|component, word, own| {
            let (low, high) = word_bounds(own);
            let corner = UVec3::from(local_coords(word << 6));
            let (low, high) = (low_vx + (corner + low) * edge, low_vx + (corner + high) * edge);
            let voxels = match is_whole {
                true => u64::from(own.count_ones()) * u64::from(edge).pow(3),
                false => {
                    let mut children = Brick::EMPTY;
                    children.words[word as usize & 7] = own;
                    indices(children).map(|index| view.child_voxels(index)).sum()
                }
            };
            let first = view.child_low(word << 6 | own.trailing_zeros());
            let piece = &mut pieces[self.piece_of[component as usize] as usize];
            piece.add(voxels, low, high.min(dims), place(first));
        });
        for (rank, index) in mixed_bricks(node) {
            let b = view.child_low(index);
            let bits = self.labels.bits(node, index, &view.bricks()[rank]);
            let first = self.labels.first_of_brick(node, rank);
            for (word, (&all, first)) in (0u32..).zip(bits.words.iter().zip(first)) {
                let corner = b * BRICK_EDGE_VX + UVec3::from(local_coords(word << 6));
                for_each_node(first, all, |component, own| {
                    let (low, high) = match own {
                        u64::MAX => (UVec3::ZERO, UVec3::splat(WORD_EDGE_VX)),
                        _ => word_bounds(own),
                    };
                    let first = place(b) + u64::from(word << 6 | own.trailing_zeros());
                    let piece = &mut pieces[self.piece_of[component as usize] as usize];
                    piece.add(own.count_ones().into(), corner + low, corner + high, first);
                });
            }
        }
    }
}

/// Returns the mixed bricks of a leaf: rank and index; none for other nodes.
fn mixed_bricks<'a>(node: &LabelledNode<'a>) -> impl Iterator<Item = (usize, u32)> + use<'a> {
    let mixed = if node.view.is_leaf() { *node.view.mixed() } else { Brick::EMPTY };
    indices(mixed).enumerate()
}

/// A piece, and the place of its first voxel: by brick, then word, then bit.
#[derive(Clone, Copy)]
struct MeasuredPiece {
    piece: Piece,
    first: u64,
}

impl MeasuredPiece {
    const NONE: MeasuredPiece = MeasuredPiece {
        piece: Piece { voxels: 0, low: [u16::MAX; 3], high: [0; 3] },
        first: u64::MAX,
    };

    #[inline(always)]
    fn add(&mut self, voxels: u64, low: UVec3, high: UVec3, first: u64) {
        self.piece.add(voxels, low, high);
        self.first = self.first.min(first);
    }

    fn join(&mut self, other: &MeasuredPiece) {
        let (low, high) = other.piece.bounds();
        self.add(other.piece.voxels, low, high, other.first);
    }
}

impl Piece {
    #[inline(always)]
    fn add(&mut self, voxels: u64, low: UVec3, high: UVec3) {
        self.voxels += voxels;
        for axis in 0..3 {
            // An axis has fewer than 2^16 voxels.
            self.low[axis] = self.low[axis].min(low[axis] as u16);
            self.high[axis] = self.high[axis].max(high[axis] as u16);
        }
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
    let removed = found.voxels_of(&|piece| piece != largest);
    for (b, mask) in removed.bricks() {
        grid.put_brick(*b, &grid.brick(*b).and_not(mask));
    }
    Ok(())
}

/// Fills all cavities: empty pieces that do not reach the grid's border.
pub fn fill_holes(
    grid: &mut Grid,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<(), PiecesError> {
    let found = pieces(grid, PiecesOf::Empty, budget_bytes, progress)?;
    let holes = found.voxels_of(&|piece| !found.reaches_border(piece));
    for (b, mask) in holes.bricks() {
        grid.put_brick(*b, &grid.brick(*b).or(mask));
    }
    Ok(())
}
