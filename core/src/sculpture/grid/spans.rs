//! Reads the bricks of a grid in linear order as spans along x: a uniform cube gives one span for each row that crosses
//! it, whatever its length, and a mixed brick a span of its own.
//!
//! Reads only; allocates nothing.

use glam::UVec3;

use super::node::{NODE_EDGE, NODE_EDGE_LOG2, Slot};
use super::{Grid, row_of, unflatten};
use crate::sculpture::brick::Brick;

/// Bricks beside each other along x that have the same bits.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct BrickSpan<'a> {
    /// The coordinates of the first one.
    pub first: UVec3,
    /// Their number, at least 1.
    pub len: u32,
    /// The bits of each.
    pub brick: &'a Brick,
}

/// The spans of bricks that follow each other in linear order.
#[derive(Clone, Debug)]
pub(crate) struct BrickSpans<'a> {
    grid: &'a Grid,
    next: UVec3,
    left: usize,
}

impl<'a> BrickSpans<'a> {
    /// Returns the spans of `count` bricks, or as many as there are, from a linear index on ([`Grid::brick_index`]).
    pub fn new(grid: &'a Grid, first: usize, count: usize) -> BrickSpans<'a> {
        let left = count.min(grid.brick_count().saturating_sub(first));
        BrickSpans { grid, next: unflatten(first as u32, grid.extent.bricks), left }
    }
}

impl<'a> Iterator for BrickSpans<'a> {
    type Item = BrickSpan<'a>;

    fn next(&mut self) -> Option<BrickSpan<'a>> {
        if self.left == 0 {
            return None;
        }
        let (first, dims) = (self.next, self.grid.extent.bricks);
        let (brick, end) = span_at(self.grid, first);
        let len = (end.min(dims.x) - first.x).min(self.left as u32);
        self.left -= len as usize;
        self.next.x += len;
        if self.next.x == dims.x {
            (self.next.x, self.next.y) = (0, first.y + 1);
        }
        if self.next.y == dims.y {
            (self.next.y, self.next.z) = (0, first.z + 1);
        }
        Some(BrickSpan { first, len, brick })
    }
}

/// Returns a brick, and the end along x of those that surely have the same bits.
#[inline]
fn span_at(grid: &Grid, b: UVec3) -> (&Brick, u32) {
    let mut node = &*grid.root;
    let mut log2 = NODE_EDGE_LOG2 * (grid.levels - 1);
    let (is_full, end) = loop {
        let slot = Slot::of(b >> log2);
        if log2 == 0 {
            if slot.is_in(&node.mixed) {
                return (&node.bricks()[node.rank(slot)], b.x + 1);
            }
            let is_full = slot.is_in(&node.full);
            // The bricks of the row that are alike, from this one on: the next one that is not ends them.
            let (full, mixed) = (row_of(&node.full, b.y, b.z), row_of(&node.mixed, b.y, b.z));
            let others = if is_full { !full } else { full | mixed };
            let until = (others >> (b.x & (NODE_EDGE - 1))).trailing_zeros();
            break (is_full, (b.x + until).min((b.x | (NODE_EDGE - 1)) + 1));
        }
        if !slot.is_in(&node.mixed) {
            break (slot.is_in(&node.full), (b.x >> log2 << log2) + (1 << log2));
        }
        node = &node.nodes()[node.rank(slot)];
        log2 -= NODE_EDGE_LOG2;
    };
    // The border may cut the last brick along x.
    let last = grid.extent.bricks.x - 1;
    let end = if is_full && grid.cut.is_some() && b.x < last { end.min(last) } else { end };
    (grid.uniform_brick(is_full, b), end)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn spans_are_the_bricks_in_linear_order(
            dims in prop::array::uniform3(1u32..90),
            long in 0usize..4,
            fills in prop::collection::vec((any::<prop::sample::Index>(), 1usize..2000, 0u32..3), 0..12),
            run in (any::<prop::sample::Index>(), 0usize..3000),
        ) {
            let mut dims = UVec3::from(dims);
            if long < 3 {
                dims[long] *= 9;
            }
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            for (index, len, kind) in fills {
                let first = index.index(grid.brick_count());
                for index in first..grid.brick_count().min(first + len) {
                    let valid = grid.valid_mask(grid.brick_coords(index));
                    let odd = Brick { words: [0x1234_5678_9ABC_DEF0; 8] };
                    grid.set_brick(index, [Brick::EMPTY, valid, odd.and(&valid)][kind as usize]);
                }
            }
            let (first, count) = (run.0.index(grid.brick_count() + 1), run.1);
            let mut found = Vec::new();
            for span in BrickSpans::new(&grid, first, count) {
                prop_assert!(span.len == 1 || span.brick.is_empty() || *span.brick == *grid.brick(span.first));
                for x in 0..span.len {
                    found.push((span.first + UVec3::X * x, *span.brick));
                }
            }
            let all: Vec<_> = grid.bricks_from(first).take(count).map(|(b, brick)| (b, *brick)).collect();
            prop_assert_eq!(found, all);
        }
    }
}
