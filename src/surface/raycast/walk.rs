//! Owns the walk of one ray through a grid by the largest empty blocks that it meets.
//!
//! Takes a grid and a [`Ray`], gives the first existing voxel. It visits a subset of the voxels
//! of the plain traversal (Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray
//! Tracing", 1987) and skips only empty ones, since both order crossings alike.

use super::ray::{Crossing, Ray};
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use glam::{IVec3, UVec3};

/// Blocks of 4^3 bricks, bricks, 4^3 words, voxels: the logarithms of their edges.
const BLOCK: u32 = 5;
const BRICK: u32 = 3;
const WORD: u32 = 2;
const VOXEL: u32 = 0;

/// Where a ray is: in which voxel, and by which crossing it came there.
pub(super) struct Walk<'a> {
    grid: &'a Grid,
    ray: Ray,
    dims: IVec3,
    cell: IVec3,
    event: Crossing,
}

impl<'a> Walk<'a> {
    /// Brings the ray to the first voxel of the grid that it meets.
    pub fn enter(grid: &'a Grid, ray: Ray) -> Option<Walk<'a>> {
        let dims = grid.dims().as_ivec3();
        let mut event = Crossing::START;
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
        let cell = IVec3::from(std::array::from_fn(|axis| {
            let first = ray.cell_after(axis, ray.near_plane(axis, 0, dims[axis]));
            let last = dims[axis] - 1 - first;
            if event.axis == axis { first } else { ray.cell_at(axis, event, first, last) }
        }));
        Some(Walk { grid, ray, dims, cell, event })
    }

    /// Walks to the first existing voxel, if there is one.
    pub fn first_voxel(mut self) -> Option<(UVec3, Crossing)> {
        loop {
            let cell = self.cell.as_uvec3();
            let brick = cell / BRICK_EDGE_VX;
            let (block, bit) = self.grid.occupancy_place(brick);
            let occupied = self.grid.occupancy()[block];
            let level = if occupied == 0 {
                BLOCK
            } else if occupied >> bit & 1 == 0 {
                BRICK
            } else {
                let local = local_index(cell.x & 7, cell.y & 7, cell.z & 7);
                let bits = &self.grid.bricks()[self.grid.brick_index(brick)];
                let word = bits.words[(local >> 6) as usize];
                if word == 0 {
                    WORD
                } else if word >> (local & 63) & 1 == 0 {
                    VOXEL
                } else {
                    return Some((cell, self.event));
                }
            };
            if !self.leave(level) {
                return None;
            }
        }
    }

    /// Moves to the first voxel after the aligned block of `1 << level` voxels an edge that
    /// holds the present one. False if that is outside of the grid.
    #[inline(always)]
    fn leave(&mut self, level: u32) -> bool {
        let ray = &self.ray;
        let size = 1 << level;
        let low = self.cell & -size;
        let crossing = |axis| ray.crossing(axis, ray.far_plane(axis, low[axis], size));
        let mut event = crossing(0);
        for axis in 1..3 {
            let other = crossing(axis);
            if other.before(event) {
                event = other;
            }
        }
        for axis in 0..3 {
            let far = ray.far_plane(axis, low[axis], size);
            let next = ray.cell_after(axis, far);
            if axis == event.axis {
                self.cell[axis] = next;
            } else if level > 0 {
                let last = next - ray.step[axis];
                self.cell[axis] = ray.cell_at(axis, event, self.cell[axis], last);
            }
        }
        self.event = event;
        (0..self.dims[event.axis]).contains(&self.cell[event.axis])
    }
}
