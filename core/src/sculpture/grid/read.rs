//! Reads a grid: single bricks by coordinates or linear index, the non-empty ones, rows along x, occupancy by blocks of
//! 4^3 bricks, and bounding boxes.
//!
//! Reveals nothing about how bricks are stored. Reads only; allocates nothing.

use glam::{IVec3, UVec3};

use super::extent::Extent;
use super::node::{NODE_EDGE, NODE_EDGE_LOG2, Slot, TreeNode};
use super::parts::{NodeView, indices};
use super::{BRICK_EDGE_VX, Cube, Grid, row_of, visit};
use crate::sculpture::brick::{Brick, BrickKind, local_coords};
use crate::sculpture::brick_set::LeafKey;
use crate::sculpture::region::BrickBox;

/// The part of a tree that holds a brick.
#[derive(Clone, Copy)]
enum Found<'a> {
    /// A cube whose bricks are all empty (`false`) or full.
    Uniform(bool),
    Leaf(&'a TreeNode),
}

/// Neither of these is ever changed; bricks of uniform cubes refer to them.
static EMPTY: Brick = Brick::EMPTY;
static FULL: Brick = Brick::FULL;

impl Grid {
    /// Returns the number of bricks, empty ones included: the length of a table with an entry per brick.
    #[inline]
    pub fn brick_count(&self) -> usize {
        self.extent.bricks.element_product() as usize
    }

    /// Returns the leaf that holds brick `b`, or the kind of the uniform cube that does.
    #[inline(always)]
    fn leaf(&self, b: UVec3) -> Found<'_> {
        let mut node = &*self.root;
        let mut log2 = NODE_EDGE_LOG2 * (self.levels - 1);
        loop {
            let slot = Slot::of(b >> log2);
            if !slot.is_in(&node.mixed) {
                return Found::Uniform(slot.is_in(&node.full));
            }
            node = &node.nodes()[node.rank(slot)];
            log2 -= NODE_EDGE_LOG2;
            if log2 == 0 {
                return Found::Leaf(node);
            }
        }
    }

    /// Returns the brick at brick coordinates `b`, which must be inside.
    #[inline(always)]
    pub fn brick(&self, b: UVec3) -> &Brick {
        match self.leaf(b) {
            Found::Uniform(is_full) => self.uniform_brick(is_full, b),
            Found::Leaf(leaf) => self.brick_of(leaf, b),
        }
    }

    #[inline(always)]
    fn brick_of<'a>(&'a self, leaf: &'a TreeNode, b: UVec3) -> &'a Brick {
        let slot = Slot::of(b);
        match slot.is_in(&leaf.mixed) {
            true => &leaf.bricks()[leaf.rank(slot)],
            false => self.uniform_brick(slot.is_in(&leaf.full), b),
        }
    }

    #[inline(always)]
    pub(super) fn uniform_brick(&self, is_full: bool, b: UVec3) -> &Brick {
        match (is_full, &self.cut) {
            (false, _) => &EMPTY,
            (true, None) => &FULL,
            (true, Some(cut)) => {
                let is_last = b.cmpeq(self.extent.bricks - 1).bitmask();
                &cut[is_last as usize & 7]
            }
        }
    }

    /// Lets `opens` decide for each cube that holds bricks of `bounds` whether to look into it, and returns the
    /// coordinates of the leaves for which it was true.
    pub(in crate::sculpture) fn visit(
        &self,
        bounds: BrickBox,
        opens: &mut dyn FnMut(Cube) -> bool,
    ) -> Vec<UVec3> {
        visit::leaves_in(&self.root, self.levels, bounds, opens)
    }

    /// Returns whether the border of the grid cuts no brick of a cube.
    pub(in crate::sculpture) fn holds_whole_bricks(&self, cube: Cube) -> bool {
        self.leaf_place().holds_whole_bricks(cube)
    }

    /// Returns the bricks from a linear index on ([`Grid::brick_index`]), in linear order, with their coordinates.
    pub fn bricks_from(&self, index: usize) -> impl Iterator<Item = (UVec3, &Brick)> {
        let next = match index < self.brick_count() {
            true => self.brick_coords(index),
            // The brick beyond the last one: none is left.
            false => UVec3::new(0, 0, self.extent.bricks.z),
        };
        let mut bricks = LinearBricks { grid: self, next, mixed: 0, full: 0, bricks: [].iter() };
        if next.x & 3 != 0 {
            bricks.enter();
        }
        bricks
    }

    /// Returns the brick of a linear brick index ([`Grid::brick_index`]).
    #[inline(always)]
    pub fn brick_at(&self, index: usize) -> &Brick {
        self.brick(self.brick_coords(index))
    }

    /// Returns whether the brick of a linear brick index is empty, full or neither, without reading the bits.
    #[inline(always)]
    pub fn brick_kind(&self, index: usize) -> BrickKind {
        self.kind(self.brick_coords(index))
    }

    /// Returns whether the brick at `b`, which must be inside, is empty, full or neither, without reading the bits.
    #[inline(always)]
    pub fn kind(&self, b: UVec3) -> BrickKind {
        let is_full = match self.leaf(b) {
            Found::Uniform(is_full) => is_full,
            Found::Leaf(leaf) => {
                let slot = Slot::of(b);
                if slot.is_in(&leaf.mixed) {
                    return BrickKind::Mixed;
                }
                slot.is_in(&leaf.full)
            }
        };
        match is_full {
            false => BrickKind::Empty,
            true if self.cut.is_none() || self.extent.holds_brick(b) => BrickKind::Full,
            true => BrickKind::Mixed,
        }
    }

    /// Returns the bricks of a leaf that may have a surface voxel: those that are neither empty nor full among full
    /// neighbours.
    pub(crate) fn bricks_near_surface(&self, leaf: LeafKey) -> Brick {
        let low = leaf.coords() << NODE_EDGE_LOG2;
        let (mixed, full) = match self.leaf(low) {
            Found::Uniform(false) => return Brick::EMPTY,
            Found::Uniform(true) => (Brick::EMPTY, Brick::FULL),
            Found::Leaf(leaf) => (leaf.mixed, leaf.full),
        };
        let inside = Brick::below((self.extent.bricks - low).to_array());
        let (mixed, full) = (mixed.and(&inside), full.and(&inside));
        let size = self.extent.bricks.as_ivec3();
        let axes = [IVec3::X, IVec3::Y, IVec3::Z];
        let is_uniform = |b: IVec3| {
            let is_inside = b.cmpge(IVec3::ZERO).all() && b.cmplt(size).all();
            is_inside && matches!(self.leaf(b.as_uvec3()), Found::Uniform(true))
        };
        let edge = NODE_EDGE as i32;
        let around = |axis: IVec3| [low.as_ivec3() - axis * edge, low.as_ivec3() + axis * edge];
        if full.is_full() && axes.iter().all(|axis| around(*axis).into_iter().all(is_uniform)) {
            return Brick::EMPTY;
        }
        let is_full = |b: IVec3| {
            let at = b - low.as_ivec3();
            if at.cmpge(IVec3::ZERO).all() && at.cmplt(IVec3::splat(edge)).all() {
                let [x, y, z] = at.as_uvec3().to_array();
                return full.get(x, y, z);
            }
            let is_inside = b.cmpge(IVec3::ZERO).all() && b.cmplt(size).all();
            is_inside && self.kind(b.as_uvec3()) == BrickKind::Full
        };
        let mut near = mixed;
        full.for_each(|index| {
            let at = UVec3::from(local_coords(index));
            let b = (low + at).as_ivec3();
            if axes.iter().any(|&axis| !is_full(b - axis) || !is_full(b + axis)) {
                near.set(at.x, at.y, at.z, true);
            }
        });
        near
    }

    /// Returns the non-empty bricks with their brick coordinates, x fastest, then y, then z.
    pub fn nonempty_bricks(&self) -> impl Iterator<Item = (UVec3, &Brick)> {
        let UVec3 { y: height, z: depth, .. } = self.extent.bricks;
        (0..depth).flat_map(move |z| {
            (0..height).flat_map(move |y| {
                self.nonempty_in_row(y, z).map(move |(x, brick)| (UVec3::new(x, y, z), brick))
            })
        })
    }

    /// Returns the non-empty bricks of the row along x at brick coordinates (y, z), each with its x, in ascending
    /// order.
    #[inline]
    pub fn nonempty_in_row(&self, y: u32, z: u32) -> impl Iterator<Item = (u32, &Brick)> {
        (0..self.extent.bricks.x).step_by(8).flat_map(move |x| {
            let found = self.leaf(UVec3::new(x, y, z));
            let occupied = match found {
                Found::Uniform(false) => 0,
                Found::Uniform(true) => u8::MAX >> 8u32.saturating_sub(self.extent.bricks.x - x),
                Found::Leaf(leaf) => row_of(&leaf.occupied(), y, z) as u8,
            };
            let set = (0..8).filter(move |i| occupied >> i & 1 != 0);
            set.map(move |i| {
                let b = UVec3::new(x + i, y, z);
                let brick = match found {
                    Found::Uniform(is_full) => self.uniform_brick(is_full, b),
                    Found::Leaf(leaf) => self.brick_of(leaf, b),
                };
                (b.x, brick)
            })
        })
    }

    /// Copies as many bricks along x as `target` has room for, starting at brick coordinates `first`: 64 bytes each. The
    /// row must be long enough.
    pub fn copy_row(&self, first: UVec3, target: &mut [u8]) {
        let mut x = first.x;
        let mut rest = target;
        while !rest.is_empty() {
            let found = self.leaf(first.with_x(x));
            let in_leaf = ((8 - x % 8) as usize * size_of::<Brick>()).min(rest.len());
            let (bricks, after) = rest.split_at_mut(in_leaf);
            for bytes in bricks.chunks_exact_mut(size_of::<Brick>()) {
                let b = first.with_x(x);
                let brick = match found {
                    Found::Uniform(is_full) => self.uniform_brick(is_full, b),
                    Found::Leaf(leaf) => self.brick_of(leaf, b),
                };
                bytes.copy_from_slice(bytemuck::bytes_of(brick));
                x += 1;
            }
            rest = after;
        }
    }

    /// Returns the size of the grid in blocks of 4^3 bricks, the unit of occupancy words.
    #[inline]
    pub fn occupancy_dims(&self) -> UVec3 {
        super::occupancy_dims(self.extent.bricks)
    }

    /// Returns the occupancy of the block of 4^3 bricks at block coordinates `block`, which must be inside: a bit per
    /// brick, set if it is not empty, ordered as the voxels of a brick's word.
    #[inline(always)]
    pub fn occupancy_word(&self, block: UVec3) -> u64 {
        let b = block * 4;
        let word = Slot::of(b).word;
        match self.leaf(b) {
            Found::Uniform(false) => 0,
            Found::Uniform(true) => self.extent.children(b & !7, 0).words[word],
            Found::Leaf(leaf) => leaf.mixed.words[word] | leaf.full.words[word],
        }
    }

    /// Returns the occupancy word of the block around the brick at `b`, and the brick's bit in it.
    #[inline(always)]
    pub(crate) fn occupancy_around(&self, b: UVec3) -> (u64, u32) {
        (self.occupancy_word(b / 4), Slot::of(b).bit)
    }

    /// Returns the bounding box of the non-empty bricks, in voxels and cut to the grid: its lowest voxel and one past
    /// its highest. `None` if the grid is empty.
    pub fn bounds_vx(&self) -> Option<(UVec3, UVec3)> {
        let mut bounds = BrickBounds { extent: self.extent, low: UVec3::MAX, high: UVec3::ZERO };
        bounds.add(&self.root, UVec3::ZERO, self.levels);
        let edge = BRICK_EDGE_VX;
        let BrickBounds { low, high, .. } = bounds;
        (low.x != u32::MAX).then(|| (low * edge, (high * edge).min(self.extent.dims)))
    }

    /// Returns the smallest box of voxels that holds every existing one, `min` inclusive and `max` exclusive. `None` if
    /// the grid is empty.
    pub fn opaque_bounds(&self) -> Option<(UVec3, UVec3)> {
        let (mut min, mut max) = (UVec3::MAX, UVec3::ZERO);
        add_voxels(NodeView::root(self), &mut min, &mut max);
        (self.opaque_count() > 0).then_some((min, max))
    }
}

/// Extends a box to the voxels below a node.
fn add_voxels(view: NodeView, min: &mut UVec3, max: &mut UVec3) {
    for index in indices(view.mixed().or(view.full())) {
        let (low, high) = view.child_voxel_bounds(index);
        // Only a cube that extends beyond the box so far needs a closer look.
        if low.cmpge(*min).all() && high.cmple(*max).all() {
            continue;
        }
        let slot = Slot::at(index);
        if slot.is_in(view.full()) {
            (*min, *max) = (min.min(low), max.max(high));
        } else if let Some(child) = view.node(index) {
            add_voxels(child, min, max);
        } else if let Some(brick) = view.bricks().get(view.rank(index)) {
            brick.for_each(|local| {
                let v = low + UVec3::from(local_coords(local));
                (*min, *max) = (min.min(v), max.max(v + 1));
            });
        }
    }
}

/// Bricks in linear order.
struct LinearBricks<'a> {
    grid: &'a Grid,
    next: UVec3,
    /// Which of the next bricks, up to a multiple of four along x, are mixed and full: a bit each, the lowest for the
    /// next.
    mixed: u64,
    full: u64,
    /// The mixed ones, and those behind them.
    bricks: std::slice::Iter<'a, Brick>,
}

impl LinearBricks<'_> {
    /// Looks up the next bricks, up to a multiple of four along x: they lie beside each other in the masks of a leaf.
    fn enter(&mut self) {
        let grid = self.grid;
        match grid.leaf(self.next) {
            Found::Uniform(is_full) => {
                (self.mixed, self.full) = (0, if is_full { 0xF } else { 0 });
            }
            Found::Leaf(leaf) => {
                let slot = Slot::of(self.next);
                self.mixed = leaf.mixed.words[slot.word] >> slot.bit & 0xF;
                self.full = leaf.full.words[slot.word] >> slot.bit & 0xF;
                self.bricks = leaf.bricks()[leaf.rank(slot)..].iter();
            }
        }
    }
}

impl<'a> Iterator for LinearBricks<'a> {
    type Item = (UVec3, &'a Brick);

    #[inline]
    fn next(&mut self) -> Option<(UVec3, &'a Brick)> {
        let (b, dims) = (self.next, self.grid.extent.bricks);
        if b.z >= dims.z {
            return None;
        }
        if b.x & 3 == 0 {
            self.enter();
        }
        let brick = match (self.mixed & 1, self.full & 1) {
            (1, _) => self.bricks.next().unwrap_or(&EMPTY),
            (_, full) => self.grid.uniform_brick(full != 0, b),
        };
        (self.mixed, self.full) = (self.mixed >> 1, self.full >> 1);
        self.next.x += 1;
        if self.next.x == dims.x {
            (self.next.x, self.next.y) = (0, b.y + 1);
        }
        if self.next.y == dims.y {
            (self.next.y, self.next.z) = (0, b.z + 1);
        }
        Some((b, brick))
    }
}

/// The bounding box of the bricks met so far.
struct BrickBounds {
    extent: Extent,
    low: UVec3,
    high: UVec3,
}

impl BrickBounds {
    /// Adds the bricks below a node of `level` whose lowest brick is `low`.
    fn add(&mut self, node: &TreeNode, low: UVec3, level: u32) {
        let log2 = NODE_EDGE_LOG2 * (level - 1);
        node.occupied().for_each(|index| {
            let low = low + (UVec3::from(local_coords(index)) << log2);
            let high = (low + (1 << log2)).min(self.extent.bricks);
            // Most lie within the bounds known so far.
            if low.cmpge(self.low).all() && high.cmple(self.high).all() {
                return;
            }
            let slot = Slot::at(index);
            if level > 1 && slot.is_in(&node.mixed) {
                self.add(&node.nodes()[node.rank(slot)], low, level - 1);
            } else {
                self.low = self.low.min(low);
                self.high = self.high.max(high);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    proptest! {
        /// All ways of reading bricks agree with a list of them.
        #[test]
        fn readers_agree(
            dims in prop::array::uniform3(1u32..90),
            long in 0usize..4,
            writes in prop::collection::vec((any::<prop::sample::Index>(), any::<[u64; 8]>(), 0..4), 0..12),
            starts in prop::array::uniform3(any::<prop::sample::Index>()),
        ) {
            let mut dims = UVec3::from(dims);
            // Long enough for several nodes of leaves.
            if long < 3 {
                dims[long] *= 8;
            }
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            let mut naive = vec![Brick::EMPTY; grid.brick_count()];
            for (index, words, kind) in writes {
                let index = index.index(naive.len());
                let valid = grid.valid_mask(grid.brick_coords(index));
                // A whole leaf or node becomes full now and then.
                let end = if kind == 3 { naive.len().min(index + 900) } else { index + 1 };
                for (index, brick) in naive.iter_mut().enumerate().take(end).skip(index) {
                    let valid = grid.valid_mask(grid.brick_coords(index));
                    *brick = if kind >= 2 { valid } else { Brick::EMPTY };
                    grid.set_brick(index, *brick);
                }
                if kind == 1 {
                    naive[index] = Brick { words }.and(&valid);
                    grid.set_brick(index, naive[index]);
                }
            }
            crate::sculpture::grid::tests::check(&grid);
            let all = || naive.iter().enumerate().map(|(index, brick)| (grid.brick_coords(index), *brick));
            let expected: Vec<_> = all().filter(|(_, brick)| !brick.is_empty()).collect();
            let found: Vec<_> = grid.nonempty_bricks().map(|(b, brick)| (b, *brick)).collect();
            prop_assert_eq!(found, expected);
            for (index, (b, brick)) in all().enumerate() {
                prop_assert_eq!(*grid.brick(b), brick);
                prop_assert_eq!(*grid.brick_at(index), brick);
                let kind = match () {
                    () if brick.is_empty() => BrickKind::Empty,
                    () if brick.is_full() => BrickKind::Full,
                    () => BrickKind::Mixed,
                };
                prop_assert_eq!(grid.brick_kind(index), kind);
                let (word, bit) = grid.occupancy_around(b);
                prop_assert_eq!(word >> bit & 1 != 0, !brick.is_empty());
                prop_assert_eq!(word, grid.occupancy_word(b / 4));
            }
            for start in starts {
                let start = start.index(naive.len() + 1);
                let found: Vec<_> = grid.bricks_from(start).map(|(b, brick)| (b, *brick)).collect();
                prop_assert_eq!(found, all().skip(start).collect::<Vec<_>>());
            }
            // Rows, whole and from their second brick on.
            let UVec3 { x: width, y: height, z: depth } = grid.brick_dims();
            for first in [0, 1.min(width - 1)] {
                let mut bytes = vec![0; (width - first) as usize * size_of::<Brick>()];
                for (y, z) in (0..height).flat_map(|y| (0..depth).map(move |z| (y, z))) {
                    grid.copy_row(UVec3::new(first, y, z), &mut bytes);
                    for (x, words) in (first..).zip(bytes.chunks(size_of::<Brick>())) {
                        let index = grid.brick_index(UVec3::new(x, y, z));
                        prop_assert_eq!(words, bytemuck::bytes_of(&naive[index]));
                    }
                }
            }
            let bounds = all().filter(|(_, brick)| !brick.is_empty()).map(|(b, _)| (b, b + 1));
            let bounds = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
            prop_assert_eq!(grid.bounds_vx(), bounds.map(|(low, high)| (low * 8, (high * 8).min(dims))));
            prop_assert_eq!(grid.opaque_count(), naive.iter().map(|b| u64::from(b.count())).sum::<u64>());
        }
    }
}
