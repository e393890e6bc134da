//! The extent of a grid: which voxels, bricks and nodes lie within its size.
//!
//! Takes coordinates, returns masks and counts. Knows no bits.

use glam::UVec3;

use crate::sculpture::brick::{BRICK_EDGE_VX, Brick};

/// The size of a grid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::sculpture) struct Extent {
    /// In voxels.
    pub dims: UVec3,
    /// In bricks, the last ones possibly cut.
    pub bricks: UVec3,
}

impl Extent {
    pub fn new(dims: UVec3) -> Extent {
        Extent { dims, bricks: (dims + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX }
    }

    /// Returns whether all voxels of the brick at `b` lie within.
    #[inline(always)]
    pub fn holds_brick(&self, b: UVec3) -> bool {
        ((b + 1) * BRICK_EDGE_VX).cmple(self.dims).all()
    }

    /// Returns the children that lie at least partly within, of a node whose lowest brick is `low` and whose children
    /// are `1 << log2` bricks an edge.
    #[inline(always)]
    pub fn children(&self, low: UVec3, log2: u32) -> Brick {
        let room = self.bricks.saturating_sub(low);
        if room.min_element() >= 8 << log2 {
            return Brick::FULL;
        }
        let edge = 1u32 << log2;
        Brick::below(((room + (edge - 1)) >> log2).to_array())
    }

    /// Returns the number of voxels within, of a cube of `1 << log2` bricks an edge from brick `low` on.
    #[inline]
    pub fn voxels(&self, low: UVec3, log2: u32) -> u64 {
        let edge = BRICK_EDGE_VX << log2;
        let inside = self.dims.saturating_sub(low * BRICK_EDGE_VX).min(UVec3::splat(edge));
        u64::from(inside.x) * u64::from(inside.y) * u64::from(inside.z)
    }
}
