//! The voxels that tools may change: those within the selection, if tools are limited to it, and outside the mask.
//!
//! [`ScopedRegion`] cuts a tool's region down to them; all code that edits contents passes it. Changes nothing.

use std::ops::Range;

use fearless_simd::Simd;
use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, Brick, BrickKind};
use super::grid::{Grid, uniform_in};
use super::region::{BoxCoverage, BoxRow, BrickBox, Region, RowReach, VoxelBox};
use super::selection::BoxStack;

/// The voxels that tools may change.
#[derive(Clone, Copy, Debug, Default)]
pub struct EditScope<'a> {
    /// The selection, if tools are limited to it.
    pub stack: Option<&'a BoxStack>,
    /// The protected voxels: a grid of the same size as the sculpture's.
    pub mask: Option<&'a Grid>,
}

impl EditScope<'_> {
    /// Returns whether tools may work everywhere.
    pub(crate) fn is_everywhere(&self) -> bool {
        self.stack.is_none() && self.mask.is_none()
    }

    /// Returns whether a voxel may be changed.
    pub fn allows(&self, v: IVec3) -> bool {
        self.stack.is_none_or(|stack| stack.contains(v))
            && !self.mask.is_some_and(|mask| mask.get(v))
    }
}

/// The part of a tool's region that the tool may change.
pub struct ScopedRegion<'a, R> {
    /// The region that the tool covers.
    pub region: &'a R,
    /// The voxels that it may change.
    pub scope: EditScope<'a>,
}

/// The rows of the region and of the stack, and their position.
pub struct PermittedRow<R: Region> {
    region: R::Row,
    reach: RowReach,
    stack: Vec<(RowReach, BoxRow)>,
    /// Brick coordinates across the row.
    y: u32,
    z: u32,
}

impl<R: Region> Default for PermittedRow<R> {
    fn default() -> Self {
        let region = R::Row::default();
        PermittedRow { region, reach: RowReach::NONE, stack: Vec::new(), y: 0, z: 0 }
    }
}

impl<R: Region> Region for ScopedRegion<'_, R> {
    type Row = PermittedRow<R>;

    fn bounds_vx(&self) -> VoxelBox {
        let bounds = self.region.bounds_vx();
        self.scope.stack.map_or(bounds, |stack| bounds.intersect(stack.bounds_vx()))
    }

    fn cut_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32, row: &mut Self::Row) -> RowReach {
        (row.y, row.z) = (y_vx / BRICK_EDGE_VX, z_vx / BRICK_EDGE_VX);
        let mut reach = RowReach { touched: 0..u32::MAX, whole: 0..u32::MAX };
        if let Some(stack) = self.scope.stack {
            reach = stack.cut_row(simd, y_vx, z_vx, &mut row.stack);
            if reach.touched.is_empty() {
                return RowReach::NONE;
            }
        }
        row.reach = self.region.cut_row(simd, y_vx, z_vx, &mut row.region);
        reach.touched = both(&row.reach.touched, &reach.touched);
        reach.whole = both(&row.reach.whole, &reach.whole);
        if let Some(mask) = self.scope.mask {
            reach.whole = longest_free_run(mask, reach.whole, row.y, row.z);
        }
        reach
    }

    fn mask<S: Simd>(&self, simd: S, row: &Self::Row, reach: &RowReach, brick_x: u32) -> Brick {
        let mut allowed = match self.scope.stack {
            Some(stack) => stack.mask(simd, &row.stack, reach, brick_x),
            None => Brick::FULL,
        };
        if let Some(mask) = self.scope.mask {
            let b = UVec3::new(brick_x, row.y, row.z);
            // Callers cut off the part beyond the border.
            if b.cmplt(mask.brick_dims()).all() {
                allowed = allowed.and_not(mask.brick(b));
            }
        }
        if row.reach.whole.contains(&brick_x) {
            return allowed;
        }
        allowed.and(&self.region.mask(simd, &row.region, &row.reach, brick_x))
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        let mut coverage = self.region.coverage(bounds);
        if let Some(stack) = self.scope.stack {
            coverage = coverage.and(stack.coverage(bounds));
        }
        match self.scope.mask {
            Some(mask) if coverage != BoxCoverage::None => {
                coverage.and(coverage_of_mask(mask, bounds).inverse())
            }
            _ => coverage,
        }
    }
}

/// Returns how a mask covers the voxels of `bounds` that lie within the grid, as the kinds of its bricks tell.
fn coverage_of_mask(mask: &Grid, bounds: VoxelBox) -> BoxCoverage {
    let Some(bricks) = BrickBox::around(&bounds, mask) else {
        return BoxCoverage::None;
    };
    match uniform_in(mask, bricks) {
        Some(false) => BoxCoverage::None,
        Some(true) => BoxCoverage::All,
        None => BoxCoverage::Part,
    }
}

fn both(a: &Range<u32>, b: &Range<u32>) -> Range<u32> {
    let both = a.start.max(b.start)..a.end.min(b.end);
    if both.is_empty() { 0..0 } else { both }
}

/// Returns the longest part of a run of bricks in which the mask has no voxel.
fn longest_free_run(mask: &Grid, run: Range<u32>, y: u32, z: u32) -> Range<u32> {
    let (mut longest, mut now) = (0..0, run.start..run.start);
    for x in run.start..run.end.min(mask.brick_dims().x) {
        let index = mask.brick_index(UVec3::new(x, y, z));
        now = match mask.brick_kind(index) {
            BrickKind::Empty => now.start..x + 1,
            _ => x + 1..x + 1,
        };
        if now.len() > longest.len() {
            longest = now.clone();
        }
    }
    longest
}
