//! Walks a grid by the nodes of its tree, for algorithms whose time shall follow the surface and not the box.
//!
//! A [`NodeView`] shows a node: which of its 8^3 children are full, empty or mixed, and the mixed ones. [`for_each_part`]
//! visits a box of bricks as uniform cubes, as large as the tree has them, and mixed bricks; [`uniform_in`] tells whether
//! a box is uniform. Reads only; allocates nothing.

use glam::{IVec3, UVec3};

use super::node::{NODE_EDGE, NODE_EDGE_LOG2, Slot, TreeNode};
use super::{Grid, row_of};
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick, local_coords};
use crate::sculpture::region::BrickBox;

/// A node of a grid's tree, which is mixed; or the root, which may be uniform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeView<'a> {
    grid: &'a Grid,
    node: &'a TreeNode,
    low: UVec3,
    /// 1 for a leaf.
    level: u32,
}

impl<'a> NodeView<'a> {
    /// Returns the root of a grid, which is no leaf.
    pub fn root(grid: &'a Grid) -> NodeView<'a> {
        NodeView { grid, node: &grid.root, low: UVec3::ZERO, level: grid.levels }
    }

    /// Returns whether the children are bricks.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.level == 1
    }

    /// Returns the lowest brick.
    #[inline(always)]
    pub fn low(self) -> UVec3 {
        self.low
    }

    /// Returns the logarithm of the edge of a child in bricks: 0 for those of a leaf.
    #[inline(always)]
    pub fn child_log2(self) -> u32 {
        NODE_EDGE_LOG2 * (self.level - 1)
    }

    /// Returns the lowest brick of a child.
    #[inline(always)]
    pub fn child_low(self, index: u32) -> UVec3 {
        self.low + (UVec3::from(local_coords(index)) << self.child_log2())
    }

    /// Returns the bricks of a child that lie within the grid.
    #[inline(always)]
    pub fn child_bricks(self, index: u32) -> BrickBox {
        let min = self.child_low(index);
        BrickBox { min, max: (min + (1 << self.child_log2())).min(self.grid.extent.bricks) }
    }

    /// Returns the voxels of a child that lie within the grid: the lowest, and one past the highest.
    #[inline(always)]
    pub fn child_voxel_bounds(self, index: u32) -> (UVec3, UVec3) {
        let min = self.child_low(index);
        let end = (min + (1 << self.child_log2())) * BRICK_EDGE_VX;
        (min * BRICK_EDGE_VX, end.min(self.grid.extent.dims))
    }

    /// Returns the number of voxels of a child that lie within the grid.
    #[inline]
    pub fn child_voxels(self, index: u32) -> u64 {
        self.grid.extent.voxels(self.child_low(index), self.child_log2())
    }

    /// Returns whether the node ends within the grid on all axes, or at its border.
    #[inline(always)]
    pub fn is_whole(self) -> bool {
        let end = (self.low + (NODE_EDGE << self.child_log2())) * BRICK_EDGE_VX;
        end.cmple(self.grid.extent.dims).all()
    }

    /// Returns which children are mixed: a bit each, in the order of the voxels of a brick, as in all masks.
    #[inline(always)]
    pub fn mixed(self) -> &'a Brick {
        &self.node.mixed
    }

    /// Returns which children are full, as far as they lie within the grid.
    #[inline(always)]
    pub fn full(self) -> &'a Brick {
        &self.node.full
    }

    /// Returns which children within the grid are empty.
    #[inline(always)]
    pub fn empty(self) -> Brick {
        let inside = self.grid.extent.children(self.low, self.child_log2());
        inside.and_not(&self.node.occupied())
    }

    /// Returns the place of a mixed child among the mixed ones.
    #[inline(always)]
    pub fn rank(self, index: u32) -> usize {
        self.node.rank(Slot::at(index))
    }

    /// Returns a mixed child that is a node, by its index; `None` for all others.
    #[inline(always)]
    pub fn node(self, index: u32) -> Option<NodeView<'a>> {
        let slot = Slot::at(index);
        let is_mixed = slot.is_in(&self.node.mixed);
        let node = self.node.nodes().get(self.node.rank(slot)).filter(|_| is_mixed)?;
        Some(NodeView { grid: self.grid, node, low: self.child_low(index), level: self.level - 1 })
    }

    /// Returns the mixed children that are nodes, in their order.
    pub fn nodes(self) -> impl Iterator<Item = NodeView<'a>> {
        let mixed = if self.is_leaf() { Brick::EMPTY } else { self.node.mixed };
        indices(mixed).filter_map(move |index| self.node(index))
    }

    /// Returns the mixed bricks of a leaf, in their order; none for other nodes.
    #[inline(always)]
    pub fn bricks(self) -> &'a [Brick] {
        self.node.bricks()
    }
}

/// Returns the children in a mask, in ascending order.
#[inline]
pub(crate) fn indices(mask: Brick) -> impl Iterator<Item = u32> {
    (0u32..).zip(mask.words).flat_map(|(word, bits)| {
        let mut rest = bits;
        std::iter::from_fn(move || {
            let bit = (rest != 0).then(|| rest.trailing_zeros())?;
            rest &= rest - 1;
            Some(word << 6 | bit)
        })
    })
}

/// Returns the children from `first` to `last` (inclusive, each below 8), as a mask.
#[inline]
pub(crate) fn box_mask(first: UVec3, last: UVec3) -> Brick {
    // The lowest bit of each of the four places along an axis.
    let along = |first: u32, last: u32, half: u32, step: u32| {
        (4 * half..4 * half + 4)
            .filter(|at| (first..=last).contains(at))
            .fold(0u64, |bits, at| bits | 1 << (step * (at & 3)))
    };
    let halves =
        |axis: usize, step: u32| [0, 1].map(|half| along(first[axis], last[axis], half, step));
    let (x, y, z) = (halves(0, 1), halves(1, 4), halves(2, 16));
    Brick { words: std::array::from_fn(|word| x[word & 1] * y[word >> 1 & 1] * z[word >> 2 & 1]) }
}

/// A part of a grid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum GridPart<'a> {
    /// A cube of the tree whose bricks are all empty or all full, as far as they lie within the visited box: possibly a
    /// single brick.
    Uniform { bricks: BrickBox, is_full: bool },
    /// The coordinates and bits of a brick that is neither.
    Mixed(UVec3, &'a Brick),
}

/// Calls `f` with the parts of a grid within a box of bricks, each once: the children of a node in the order of the
/// voxels of a brick, those of a mixed child in its place.
pub(crate) fn for_each_part<'a>(grid: &'a Grid, within: BrickBox, f: &mut dyn FnMut(GridPart<'a>)) {
    let max = within.max.min(grid.extent.bricks);
    let within = BrickBox { max, ..within };
    if within.min.cmplt(max).all() {
        visit(NodeView::root(grid), within, f);
    }
}

fn visit<'a>(view: NodeView<'a>, within: BrickBox, f: &mut dyn FnMut(GridPart<'a>)) {
    let wanted = children_in(view, within);
    for index in indices(wanted) {
        let slot = Slot::at(index);
        if !slot.is_in(view.mixed()) {
            let BrickBox { min, max } = view.child_bricks(index);
            let bricks = BrickBox { min: min.max(within.min), max: max.min(within.max) };
            f(GridPart::Uniform { bricks, is_full: slot.is_in(view.full()) });
        } else if view.is_leaf() {
            f(GridPart::Mixed(view.child_low(index), &view.bricks()[view.rank(index)]));
        } else if let Some(child) = view.node(index) {
            visit(child, within, f);
        }
    }
}

/// Returns the children that hold bricks of a box, which must reach into the node.
#[inline]
fn children_in(view: NodeView, within: BrickBox) -> Brick {
    let log2 = view.child_log2();
    let place = |b: UVec3| (b.saturating_sub(view.low) >> log2).min(UVec3::splat(NODE_EDGE - 1));
    box_mask(place(within.min), place(within.max - 1))
}

/// Returns whether all bricks of a box, cut to the grid, are empty (`false`) or full. `None` if neither is so. An empty
/// box is neither.
pub(crate) fn uniform_in(grid: &Grid, within: BrickBox) -> Option<bool> {
    let within = BrickBox { max: within.max.min(grid.extent.bricks), ..within };
    let mut known = None;
    let is_uniform =
        within.min.cmplt(within.max).all() && agrees(NodeView::root(grid), within, &mut known);
    known.filter(|_| is_uniform)
}

/// Returns whether the bricks of a box below a node are all alike, and like those that are `known`.
fn agrees(view: NodeView, within: BrickBox, known: &mut Option<bool>) -> bool {
    let wanted = children_in(view, within);
    let mixed = wanted.and(view.mixed());
    if view.is_leaf() && !mixed.is_empty() {
        return false;
    }
    let full = wanted.and(view.full());
    let empty = wanted.and_not(view.full()).and_not(view.mixed());
    for (mask, is_full) in [(full, true), (empty, false)] {
        if !mask.is_empty() && *known.get_or_insert(is_full) != is_full {
            return false;
        }
    }
    indices(mixed).all(|index| view.node(index).is_some_and(|child| agrees(child, within, known)))
}

/// Returns the leaves that may hold bricks beside others that are not full: mixed ones, and those at the faces of larger
/// full cubes. Returns their coordinates, those of their lowest bricks divided by 8, in the order of a visit.
pub(crate) fn surface_leaves(grid: &Grid) -> Vec<UVec3> {
    let mut leaves = Vec::new();
    add_surface_leaves(NodeView::root(grid), &mut leaves);
    leaves
}

fn add_surface_leaves(view: NodeView, leaves: &mut Vec<UVec3>) {
    for index in indices(view.mixed().or(view.full())) {
        match view.node(index) {
            Some(leaf) if leaf.is_leaf() => leaves.push(leaf.low >> NODE_EDGE_LOG2),
            Some(child) => add_surface_leaves(child, leaves),
            None => {
                let BrickBox { min, max } = view.child_bricks(index);
                let (low, end) = (min >> NODE_EDGE_LOG2, (max + (NODE_EDGE - 1)) >> NODE_EDGE_LOG2);
                for (z, y) in (low.z..end.z).flat_map(|z| (low.y..end.y).map(move |y| (z, y))) {
                    let is_face = z == low.z || z == end.z - 1 || y == low.y || y == end.y - 1;
                    let step = if is_face { 1 } else { (end.x - 1 - low.x).max(1) };
                    let along_x = (low.x..end.x).step_by(step as usize);
                    leaves.extend(along_x.map(|x| UVec3::new(x, y, z)));
                }
            }
        }
    }
}

/// Returns the bricks of a leaf that are not empty and may have a voxel with an empty one among its 26 neighbours, or at
/// the border of the grid.
pub(crate) fn bricks_beside_empty(grid: &Grid, leaf: UVec3) -> Brick {
    let own = kinds_of(grid, leaf.as_ivec3());
    // The full bricks of the leaves around, and one more brick on each side: bit x + 1 of the rows [z + 1][y + 1].
    let full: [Brick; 27] = std::array::from_fn(|i| {
        let step = IVec3::new(i as i32 % 3, i as i32 / 3 % 3, i as i32 / 9) - 1;
        kinds_of(grid, leaf.as_ivec3() + step).1
    });
    let mut rows = [[0u16; 10]; 10];
    for (z, layer) in rows.iter_mut().enumerate() {
        for (y, row) in layer.iter_mut().enumerate() {
            // The leaf around on an axis, and the place in it.
            let place = |at: usize| (at.div_ceil(8), ((at + 7) % 8) as u32);
            let ((leaf_y, y), (leaf_z, z)) = (place(y), place(z));
            let part = |leaf_x: usize| row_of(&full[leaf_x + 3 * leaf_y + 9 * leaf_z], y, z) as u16;
            *row = part(0) >> 7 | part(1) << 1 | (part(2) & 1) << 9;
        }
    }
    let inside_rows = rows.map(|layer| layer.map(|row| row & row << 1 & row >> 1));
    let mut slices = [0u64; 8];
    for (z, slice) in slices.iter_mut().enumerate() {
        for y in 0..8 {
            let around = inside_rows[z..z + 3].iter().flat_map(|layer| &layer[y..y + 3]);
            let inside = around.fold(u16::MAX, |all, row| all & row);
            *slice |= u64::from(inside >> 1 & 0xFF) << (8 * y);
        }
    }
    own.0.or(&own.1).and_not(&Brick::from_rows(&slices))
}

/// Returns the mixed and the full bricks of a leaf; none beyond the grid.
fn kinds_of(grid: &Grid, leaf: IVec3) -> (Brick, Brick) {
    let low = leaf << NODE_EDGE_LOG2 as i32;
    if low.cmplt(IVec3::ZERO).any() || low.cmpge(grid.extent.bricks.as_ivec3()).any() {
        return (Brick::EMPTY, Brick::EMPTY);
    }
    let b = low.as_uvec3();
    let mut view = NodeView::root(grid);
    loop {
        if view.is_leaf() {
            return (*view.mixed(), *view.full());
        }
        let slot = Slot::of(b >> view.child_log2());
        match view.node(slot.index() as u32) {
            Some(child) => view = child,
            None if slot.is_in(view.full()) => {
                return (Brick::EMPTY, grid.extent.children(b, 0));
            }
            None => return (Brick::EMPTY, Brick::EMPTY),
        }
    }
}

#[cfg(test)]
#[path = "parts_tests.rs"]
mod tests;
