//! Regions: sets of voxels as edits query them. A region has a bounding box. For each row of bricks along x, it tells
//! which bricks it touches, which it covers entirely, and which voxels of the others.
//!
//! The unit is a row because solids are convex: the values that decide the 64 rows of voxels in a row of bricks are
//! computed once, and the bricks in the middle are then known without examining them. Knows no tool.

use std::ops::Range;

use fearless_simd::Simd;
use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, Brick};
use super::grid::Grid;

/// A half-open box of voxels, `min` inclusive and `max` exclusive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VoxelBox {
    /// Lowest voxel.
    pub min: IVec3,
    /// One past the highest voxel.
    pub max: IVec3,
}

impl VoxelBox {
    /// Returns all voxels of `grid`.
    pub fn of_grid(grid: &Grid) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: grid.dims().as_ivec3() }
    }

    /// Returns the voxels in both; empty if there are none.
    pub fn intersect(self, other: VoxelBox) -> VoxelBox {
        VoxelBox { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Returns whether the box holds no voxel.
    pub fn is_empty(self) -> bool {
        !self.min.cmplt(self.max).all()
    }

    /// Returns the size in voxels; 0 on an axis where `max` is below `min`.
    pub fn size(self) -> UVec3 {
        self.max.saturating_sub(self.min).max(IVec3::ZERO).as_uvec3()
    }

    /// Returns whether the voxel `v` is in the box.
    pub fn contains(self, v: IVec3) -> bool {
        v.cmpge(self.min).all() && v.cmplt(self.max).all()
    }
}

/// The part of a row's bricks that a box covers on y and z, in voxels of the brick: 0 to 8.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct BoxRow {
    low: [u32; 2],
    high: [u32; 2],
}

impl Region for VoxelBox {
    type Row = BoxRow;

    fn bounds_vx(&self) -> VoxelBox {
        *self
    }

    fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut BoxRow) -> RowReach {
        let edge = BRICK_EDGE_VX as i32;
        let local = |v: i32, origin: u32| v.saturating_sub(origin as i32).clamp(0, edge) as u32;
        row.low = [local(self.min.y, y_vx), local(self.min.z, z_vx)];
        row.high = [local(self.max.y, y_vx), local(self.max.z, z_vx)];
        let (from, to) = (self.min.x.max(0) as u32, self.max.x.max(0) as u32);
        if from >= to || row.low[0] >= row.high[0] || row.low[1] >= row.high[1] {
            return RowReach::NONE;
        }
        let touched = from / BRICK_EDGE_VX..to.div_ceil(BRICK_EDGE_VX);
        let whole = from.div_ceil(BRICK_EDGE_VX)..to / BRICK_EDGE_VX;
        let across = row.low == [0; 2] && row.high == [BRICK_EDGE_VX; 2];
        let whole = if across && !whole.is_empty() { whole } else { 0..0 };
        RowReach { touched, whole }
    }

    fn mask<S: Simd>(&self, _: S, row: &BoxRow, _: &RowReach, brick_x: u32) -> Brick {
        let origin = (brick_x * BRICK_EDGE_VX) as i32;
        let edge = BRICK_EDGE_VX as i32;
        let low = self.min.x.saturating_sub(origin).clamp(0, edge) as u32;
        let high = self.max.x.saturating_sub(origin).clamp(0, edge) as u32;
        let all = BRICK_EDGE_VX;
        Brick::below([high, row.high[0], row.high[1]])
            .and_not(&Brick::below([low, all, all]))
            .and_not(&Brick::below([all, row.low[0], all]))
            .and_not(&Brick::below([all, all, row.low[1]]))
    }
}

/// A half-open box of bricks of one grid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrickBox {
    /// Lowest brick coordinates.
    pub min: UVec3,
    /// One past the highest brick coordinates.
    pub max: UVec3,
}

impl BrickBox {
    /// Returns the bricks of `grid` within the bounds of `region`, if there are any.
    pub fn around(region: &impl Region, grid: &Grid) -> Option<BrickBox> {
        let bounds = region.bounds_vx().intersect(VoxelBox::of_grid(grid));
        (!bounds.is_empty()).then(|| BrickBox {
            min: bounds.min.as_uvec3() / BRICK_EDGE_VX,
            max: (bounds.max.as_uvec3() + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX,
        })
    }

    /// Returns the number of bricks in the box.
    pub fn brick_count(self) -> u64 {
        (self.max - self.min).as_u64vec3().element_product()
    }
}

/// How a region covers the bricks of a row. Bricks are named by their brick coordinate along x; they may lie beyond the
/// grid's border.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RowReach {
    /// Bricks outside of this range are not covered at all.
    pub touched: Range<u32>,
    /// Bricks in this range are covered entirely. Empty, or within `touched`.
    pub whole: Range<u32>,
}

impl RowReach {
    /// No brick of the row is covered.
    pub const NONE: RowReach = RowReach { touched: 0..0, whole: 0..0 };
}

/// A set of voxels that is queried by rows of bricks, with vector instructions chosen for the whole edit.
pub trait Region: Sync {
    /// Values computed once for a row of bricks along x; their memory is reused for the next row.
    type Row: Default;

    /// Returns a box outside which the region covers nothing (it may extend beyond the grid).
    fn bounds_vx(&self) -> VoxelBox;

    /// Intersects the region with the row of bricks whose lower edge runs along x at voxel coordinates `y_vx`, `z_vx`.
    fn cut_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32, row: &mut Self::Row) -> RowReach;

    /// Returns the covered voxels of a touched brick of the row passed to [`Region::cut_row`] last. May include voxels
    /// beyond the grid's border.
    fn mask<S: Simd>(&self, simd: S, row: &Self::Row, reach: &RowReach, brick_x: u32) -> Brick;
}

/// A region of all voxels.
pub struct Everywhere;

impl Region for Everywhere {
    type Row = ();

    fn bounds_vx(&self) -> VoxelBox {
        VoxelBox { min: IVec3::ZERO, max: IVec3::MAX }
    }

    fn cut_row<S: Simd>(&self, _: S, _: u32, _: u32, (): &mut ()) -> RowReach {
        RowReach { touched: 0..u32::MAX, whole: 0..u32::MAX }
    }

    fn mask<S: Simd>(&self, _: S, (): &(), _: &RowReach, _: u32) -> Brick {
        Brick::FULL
    }
}

/// A region of listed bricks, each with the voxels covered.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ListedBricks {
    /// Brick coordinates and masks, x fastest, then y, then z; each brick at most once.
    bricks: Vec<(UVec3, Brick)>,
}

impl ListedBricks {
    /// Takes bricks in the order x fastest, then y, then z, each at most once.
    pub fn new(bricks: Vec<(UVec3, Brick)>) -> ListedBricks {
        debug_assert!(bricks.is_sorted_by_key(|(b, _)| (b.z, b.y, b.x)));
        ListedBricks { bricks }
    }

    /// Returns the brick coordinates and masks, x fastest, then y, then z.
    pub fn bricks(&self) -> &[(UVec3, Brick)] {
        &self.bricks
    }

    /// Returns the voxels that are in any of `lists`.
    pub fn union(lists: impl IntoIterator<Item = ListedBricks>) -> ListedBricks {
        let mut bricks: Vec<(UVec3, Brick)> = lists.into_iter().flat_map(|l| l.bricks).collect();
        bricks.sort_by_key(|(b, _)| (b.z, b.y, b.x));
        bricks.dedup_by(|(next, mask), (b, all)| {
            *next == *b && {
                *all = all.or(mask);
                true
            }
        });
        ListedBricks { bricks }
    }
}

impl Region for ListedBricks {
    /// The position of the row's bricks in the list.
    type Row = Range<usize>;

    fn bounds_vx(&self) -> VoxelBox {
        let low = self.bricks.iter().map(|(b, _)| *b).reduce(UVec3::min);
        let high = self.bricks.iter().map(|(b, _)| *b).reduce(UVec3::max);
        let (low, high) = low.zip(high).map_or_else(Default::default, |(l, h)| (l, h + 1));
        VoxelBox { min: (low * BRICK_EDGE_VX).as_ivec3(), max: (high * BRICK_EDGE_VX).as_ivec3() }
    }

    fn cut_row<S: Simd>(&self, _: S, y_vx: u32, z_vx: u32, row: &mut Range<usize>) -> RowReach {
        let wanted = (z_vx / BRICK_EDGE_VX, y_vx / BRICK_EDGE_VX);
        let start = self.bricks.partition_point(|(b, _)| (b.z, b.y) < wanted);
        let end = self.bricks.partition_point(|(b, _)| (b.z, b.y) <= wanted);
        *row = start..end;
        match &self.bricks[start..end] {
            [] => RowReach::NONE,
            [(first, _), ..] => {
                let last = self.bricks[end - 1].0;
                RowReach { touched: first.x..last.x + 1, whole: 0..0 }
            }
        }
    }

    fn mask<S: Simd>(&self, _: S, row: &Range<usize>, _: &RowReach, brick_x: u32) -> Brick {
        let bricks = &self.bricks[row.clone()];
        let found = bricks.binary_search_by_key(&brick_x, |(b, _)| b.x);
        found.map_or(Brick::EMPTY, |at| bricks[at].1)
    }
}
