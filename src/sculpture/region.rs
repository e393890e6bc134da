//! Owns what an edit may ask of a set of voxels: a box around it and, for each row of bricks
//! along x, which bricks it touches, which it covers wholly, and the voxels of the others.
//!
//! A row is the unit because solids are convex: what decides the 64 rows of voxels in a row of
//! bricks is worked out once, and the bricks in the middle are then known without a look at
//! them. Knows no tool.

use std::ops::Range;

use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, Brick};
use super::grid::Grid;

/// A half-open box of voxels, `min` inclusive and `max` exclusive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VoxelBox {
    pub min: IVec3,
    pub max: IVec3,
}

impl VoxelBox {
    pub fn of_grid(grid: &Grid) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: grid.dims().as_ivec3() }
    }

    pub fn intersect(self, other: VoxelBox) -> VoxelBox {
        VoxelBox { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    pub fn is_empty(self) -> bool {
        !self.min.cmplt(self.max).all()
    }
}

/// A half-open box of bricks of one grid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrickBox {
    pub min: UVec3,
    pub max: UVec3,
}

impl BrickBox {
    /// The bricks of `grid` that the bounds of `region` reach, if there are any.
    pub fn around(region: &impl Region, grid: &Grid) -> Option<BrickBox> {
        let bounds = region.bounds_vx().intersect(VoxelBox::of_grid(grid));
        (!bounds.is_empty()).then(|| BrickBox {
            min: bounds.min.as_uvec3() / BRICK_EDGE_VX,
            max: (bounds.max.as_uvec3() + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX,
        })
    }

    pub fn brick_count(self) -> u64 {
        (self.max - self.min).as_u64vec3().element_product()
    }
}

/// A set of voxels that can be asked row of bricks by row of bricks.
pub trait Region: Sync {
    /// What is worked out once for a row of bricks along x.
    type Row<'a>: BrickRow
    where
        Self: 'a;

    /// A box outside of which the region covers nothing (it may reach beyond the grid).
    fn bounds_vx(&self) -> VoxelBox;

    /// The row of bricks whose lower edge runs along x at voxel coordinates `y_vx`, `z_vx`.
    fn row(&self, y_vx: u32, z_vx: u32) -> Self::Row<'_>;
}

/// A region cut by one row of bricks. Bricks are named by their brick coordinate along x, and
/// may lie beyond the grid's border; so may the voxels of a mask.
pub trait BrickRow {
    /// Bricks outside of this range are not covered at all.
    fn touched(&self) -> Range<u32>;

    /// Bricks in this range are covered wholly. Empty, or within [`BrickRow::touched`].
    fn whole(&self) -> Range<u32>;

    /// The voxels covered of a touched brick.
    fn mask(&self, brick_x: u32) -> Brick;
}

/// A region of all voxels.
pub struct Everywhere;

/// A row of bricks that is covered wholly.
pub struct WholeRow;

impl Region for Everywhere {
    type Row<'a> = WholeRow;

    fn bounds_vx(&self) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: IVec3::MAX }
    }

    fn row(&self, _: u32, _: u32) -> WholeRow {
        WholeRow
    }
}

impl BrickRow for WholeRow {
    fn touched(&self) -> Range<u32> {
        0..u32::MAX
    }

    fn whole(&self) -> Range<u32> {
        0..u32::MAX
    }

    fn mask(&self, _: u32) -> Brick {
        Brick::FULL
    }
}
