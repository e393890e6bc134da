//! Shows a grid as an octree: aligned cubes of `2^level` voxels an edge down to bricks, each with the node that holds it.
//!
//! Nothing is looked up from the root: a cube finds its children in the masks of its node. Reads only; allocates nothing.

use glam::IVec3;

use super::Grid;
use super::node::{NODE_EDGE_LOG2, Slot, TreeNode};
use crate::sculpture::brick::{BRICK_EDGE_VX, Brick};

/// The level of a brick.
pub(crate) const BRICK_LEVEL: u32 = BRICK_EDGE_VX.ilog2();
/// The least level of the cube around a grid: above that of a leaf, which has a node of its own.
const LEAST_ROOT: u32 = BRICK_LEVEL + NODE_EDGE_LOG2 + 1;

/// An aligned cube of a grid, larger than a brick or full.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OctreeCube<'a> {
    /// The smallest node that spans more than the cube or is it; `None` if the cube is full.
    node: Option<&'a TreeNode>,
    /// The level of the node's children.
    child_level: u32,
    /// The lowest voxel.
    pub low: IVec3,
    pub level: u32,
}

/// A brick that is not empty.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OctreeBrick<'a> {
    /// As far as it lies within the grid.
    Full,
    Mixed(&'a Brick),
}

impl<'a> OctreeCube<'a> {
    /// Returns the smallest cube at the origin that holds all of a grid and is larger than a leaf.
    pub fn around(grid: &'a Grid) -> OctreeCube<'a> {
        let level = grid.dims().max_element().next_power_of_two().ilog2().max(LEAST_ROOT);
        let child_level = BRICK_LEVEL + NODE_EDGE_LOG2 * (grid.levels - 1);
        OctreeCube { node: Some(&grid.root), child_level, low: IVec3::ZERO, level }
    }

    /// Returns whether all voxels of the cube exist, as far as they lie within the grid.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.node.is_none()
    }

    /// Returns the children that are not empty: a bit each, in the order of their corners (x is bit 0).
    #[inline(always)]
    pub fn occupied_children(&self) -> u32 {
        let Some(node) = self.node else { return 0xFF };
        let Slot { word, bit } = self.slot();
        let occupied = |word: usize| node.mixed.words[word] | node.full.words[word];
        match self.level - self.child_level {
            1 => {
                let eight = (occupied(word) >> bit) as u32;
                eight & 3 | (eight >> 4 & 3) << 2 | (eight >> 16 & 3) << 4 | (eight >> 20 & 3) << 6
            }
            2 => {
                // Eighths of 2^3 children.
                const EIGHTH: u64 = 0x0033_0033;
                let four = occupied(word);
                (0..8).fold(0, |mask, child| {
                    let shift = (child & 1) * 2 + (child >> 1 & 1) * 8 + (child >> 2) * 32;
                    mask | u32::from(four >> shift & EIGHTH != 0) << child
                })
            }
            _ => (0..8).fold(0, |mask, word| mask | u32::from(occupied(word) != 0) << word),
        }
    }

    /// Returns the lowest voxel of a child.
    #[inline(always)]
    pub fn child_low(&self, child: usize) -> IVec3 {
        let child = child as i32;
        self.low + (IVec3::new(child & 1, child >> 1 & 1, child >> 2) << (self.level - 1))
    }

    /// Returns a child that is larger than a brick and not empty.
    #[inline(always)]
    pub fn child(&self, child: usize) -> OctreeCube<'a> {
        let mut cube = OctreeCube { low: self.child_low(child), level: self.level - 1, ..*self };
        if let Some(node) = self.node
            && cube.level == self.child_level
        {
            let slot = cube.slot();
            cube.node = match slot.is_in(&node.full) {
                true => None,
                false => node.nodes().get(node.rank(slot)).map(|node| &**node),
            };
            cube.child_level -= NODE_EDGE_LOG2;
        }
        cube
    }

    /// Returns a child that is a brick and not empty.
    #[inline(always)]
    pub fn brick(&self, child: usize) -> OctreeBrick<'a> {
        let Some(node) = self.node else { return OctreeBrick::Full };
        let slot = Slot::of(self.child_low(child).as_uvec3() / BRICK_EDGE_VX);
        match slot.is_in(&node.full) {
            true => OctreeBrick::Full,
            false => OctreeBrick::Mixed(&node.bricks()[node.rank(slot)]),
        }
    }

    /// Returns where the cube, or its lowest part, lies among the children of its node.
    #[inline(always)]
    fn slot(&self) -> Slot {
        Slot::of(self.low.as_uvec3() >> self.child_level)
    }
}
