//! Traces one ray through a grid, skipping the largest empty blocks along it.
//!
//! Takes a grid and a [`Ray`], returns the first existing voxel. Visits a subset of the voxels of the plain traversal
//! (Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987) and skips only empty ones, since both
//! order crossings alike.

use super::ray::{BoundaryCrossing, Ray};
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::{Brick, Grid};
use crate::surface::small_bricks::{SmallBricks, stand_in};
use glam::{IVec3, UVec3};

/// The logarithms of the edges of blocks of 4^3 bricks, bricks, words of 4^3 voxels, and voxels.
const BLOCK: u32 = 5;
const BRICK: u32 = 3;
const WORD: u32 = 2;
const VOXEL: u32 = 0;

/// The position of a ray: its current voxel, and the crossing by which it entered.
pub(in crate::surface) struct Walk<'a> {
    grid: &'a Grid,
    ray: Ray,
    dims: IVec3,
    cell: IVec3,
    event: BoundaryCrossing,
}

impl<'a> Walk<'a> {
    /// Starts in the first voxel of the grid on the ray. Returns `None` if the ray misses the grid.
    #[inline(always)]
    pub fn enter(grid: &'a Grid, ray: Ray) -> Option<Walk<'a>> {
        let dims = grid.dims().as_ivec3();
        let mut event = BoundaryCrossing::START;
        for axis in 0..3 {
            let crossing = ray.crossing(axis, ray.near_plane(axis, 0, dims[axis]));
            if event.before(crossing) {
                event = crossing;
            }
        }
        let missed = |axis| ray.crossing(axis, ray.far_plane(axis, 0, dims[axis])).before(event);
        if (0..3).any(missed) {
            return None;
        }
        // Loops instead of `array::from_fn`, which is not inlined.
        let mut cell = IVec3::ZERO;
        for axis in 0..3 {
            let first = ray.cell_after(axis, ray.near_plane(axis, 0, dims[axis]));
            let last = dims[axis] - 1 - first;
            let between = event.axis != axis;
            cell[axis] = if between { ray.cell_at(axis, event, first, last) } else { first };
        }
        Some(Walk { grid, ray, dims, cell, event })
    }

    /// Continues to the first existing voxel, if there is one. Bricks among the small ones are hit as a whole.
    #[inline(always)]
    pub(crate) fn first_voxel(mut self, small: &SmallBricks) -> Option<(UVec3, BoundaryCrossing)> {
        loop {
            let level = match self.empty_level() {
                Some(level) => level,
                None => {
                    let cell = self.cell.as_uvec3();
                    let brick = self.brick();
                    if small.contains(self.cell >> BRICK) {
                        let low = self.cell & -(BRICK_EDGE_VX as i32);
                        let voxel = low.as_uvec3() + stand_in(brick, low, self.ray.origin);
                        return Some((voxel, self.event));
                    }
                    let local = local_index(cell.x & 7, cell.y & 7, cell.z & 7);
                    let word = brick.words[(local >> 6) as usize];
                    if word >> (local & 63) & 1 != 0 {
                        return Some((cell, self.event));
                    }
                    if word == 0 { WORD } else { VOXEL }
                }
            };
            if !self.leave(level) {
                return None;
            }
        }
    }

    /// Continues to the first voxel in a non-empty brick, possibly the current one. Returns false if there is none.
    #[inline(always)]
    pub(crate) fn find_brick(&mut self) -> bool {
        while let Some(level) = self.empty_level() {
            if !self.leave(level) {
                return false;
            }
        }
        true
    }

    /// Moves to the first voxel after the current brick. Returns false if that is outside the grid.
    #[inline(always)]
    pub(crate) fn leave_brick(&mut self) -> bool {
        self.leave(BRICK)
    }

    /// Returns the last voxel of the current brick on the ray, which may lie beyond the grid's border.
    #[inline(always)]
    pub(crate) fn last_in_brick(&self) -> IVec3 {
        let (event, mut cell) = self.after(BRICK);
        cell[event.axis] -= self.ray.step[event.axis];
        cell
    }

    #[inline(always)]
    pub fn cell(&self) -> IVec3 {
        self.cell
    }

    #[inline(always)]
    pub fn brick(&self) -> &'a Brick {
        self.grid.brick(self.cell.as_uvec3() / BRICK_EDGE_VX)
    }

    /// Returns the level of the largest empty block, brick or larger, around the current voxel.
    #[inline(always)]
    fn empty_level(&self) -> Option<u32> {
        let brick = self.cell.as_uvec3() / BRICK_EDGE_VX;
        let (occupied, bit) = self.grid.occupancy_around(brick);
        if occupied == 0 { Some(BLOCK) } else { (occupied >> bit & 1 == 0).then_some(BRICK) }
    }

    /// Moves to the first voxel after the aligned block of `1 << level` voxels an edge that holds the current one.
    /// Returns false if that is outside the grid.
    #[inline(always)]
    fn leave(&mut self, level: u32) -> bool {
        (self.event, self.cell) = self.after(level);
        let axis = self.event.axis;
        (0..self.dims[axis]).contains(&self.cell[axis])
    }

    /// Returns the crossing that leaves the block of `level`, and the voxel that it leads to.
    #[inline(always)]
    fn after(&self, level: u32) -> (BoundaryCrossing, IVec3) {
        let ray = &self.ray;
        let size = 1 << level;
        let low = self.cell & -size;
        let mut far = [0; 3];
        for (axis, far) in far.iter_mut().enumerate() {
            *far = ray.far_plane(axis, low[axis], size);
        }
        let mut event = ray.crossing(0, far[0]);
        for axis in [1, 2] {
            let other = ray.crossing(axis, far[axis]);
            if other.before(event) {
                event = other;
            }
        }
        let mut cell = self.cell;
        for axis in 0..3 {
            let next = ray.cell_after(axis, far[axis]);
            if axis == event.axis {
                cell[axis] = next;
            } else if level != VOXEL {
                cell[axis] = ray.cell_at(axis, event, cell[axis], next - ray.step[axis]);
            }
        }
        (event, cell)
    }
}
