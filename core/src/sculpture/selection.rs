//! The selection: a marker box, and a stack of boxes added and subtracted in order. All tools can be limited to it.
//!
//! Boxes are in voxels and may reach beyond the grid. Changes no voxel; [`super::edit_scope`] intersects a tool's
//! region with the selection where edits are applied.

use fearless_simd::Simd;
use glam::{IVec3, UVec3};

use super::brick::Brick;
use super::canvas_frame::CanvasFrame;
use super::orientation::Orientation;
use super::region::{BoxCoverage, BoxRow, Region, RowReach, VoxelBox};
use crate::refusal::InvalidValue;

/// Largest coordinate of a marker, in voxels from the grid's corner.
pub const MARKER_LIMIT_VX: i32 = 1 << 20;
/// Most boxes on the stack.
pub const MAX_BOXES: usize = 256;

/// A box on the stack.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SelectedBox {
    /// The voxels of the box; it may reach beyond the grid.
    pub bounds: VoxelBox,
    /// Whether the box adds its voxels to those of the boxes below it, or subtracts them.
    pub adds: bool,
}

/// The boxes of the stack, the lowest first.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct BoxStack(Vec<SelectedBox>);

/// Marker and stack.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Selection {
    marker: VoxelBox,
    stack: BoxStack,
    /// Whether tools are limited to the selection, if anything is selected.
    limits: bool,
}

impl Selection {
    /// Returns the selection for a grid of `dims` voxels: a marker of half its size in its middle, and an empty stack.
    pub fn new(dims: UVec3) -> Selection {
        let size = (dims / 2).max(UVec3::ONE).as_ivec3();
        let min = (dims.as_ivec3() - size) / 2;
        Selection {
            marker: VoxelBox { min, max: min + size },
            stack: BoxStack::default(),
            limits: false,
        }
    }

    /// Returns the selection for a sculpture in a frame: the marker in the middle of the home box.
    pub fn of(frame: &CanvasFrame) -> Selection {
        Selection::new(frame.home).shifted(-frame.origin)
    }

    /// Returns the boxes moved by a number of voxels, as far as they stay within reach.
    pub fn shifted(&self, by: IVec3) -> Selection {
        let limit = IVec3::splat(MARKER_LIMIT_VX);
        let moved = |bounds: VoxelBox| {
            let moved = bounds.shifted(by);
            let low = moved.min.clamp(-limit, limit - 1);
            VoxelBox { min: low, max: moved.max.clamp(low + 1, limit) }
        };
        let boxes = self.stack.0.iter();
        let stack = boxes.map(|b| SelectedBox { bounds: moved(b.bounds), adds: b.adds }).collect();
        Selection { marker: moved(self.marker), stack: BoxStack(stack), limits: self.limits }
    }

    /// Returns the marker's box.
    pub fn marker(&self) -> VoxelBox {
        self.marker
    }

    /// Checks whether `marker` is a valid marker. The error says why it is not.
    pub(crate) fn check_marker(marker: VoxelBox) -> Result<(), InvalidValue> {
        let VoxelBox { min, max } = marker;
        let (far, given) = (IVec3::splat(MARKER_LIMIT_VX), format_args!("{min} to {max}"));
        let is_near = min.cmpge(-far).all() && max.cmple(far).all();
        InvalidValue::check(is_near, "marker", "is too far from the grid", given)?;
        let rule = "must be at least one voxel long on every axis";
        InvalidValue::check(!marker.is_empty(), "marker", rule, given)
    }

    /// Replaces the marker. Returns an error if `marker` is not a valid one.
    pub(crate) fn set_marker(&mut self, marker: VoxelBox) -> Result<(), InvalidValue> {
        Self::check_marker(marker)?;
        self.marker = marker;
        Ok(())
    }

    /// Returns the boxes of the stack, the lowest first.
    pub fn boxes(&self) -> &[SelectedBox] {
        &self.stack.0
    }

    /// Returns the stack, as a region of voxels.
    pub fn stack(&self) -> &BoxStack {
        &self.stack
    }

    /// Puts the marker's box on the stack. Returns false if the stack is full.
    pub fn push(&mut self, adds: bool) -> bool {
        let room = self.stack.0.len() < MAX_BOXES;
        if room {
            self.stack.0.push(SelectedBox { bounds: self.marker, adds });
        }
        room
    }

    /// Removes the uppermost box. Returns false if there is none.
    pub(crate) fn drop_last(&mut self) -> bool {
        self.stack.0.pop().is_some()
    }

    /// Removes all boxes.
    pub fn clear(&mut self) {
        self.stack.0.clear();
    }

    /// Returns the boxes about the same voxels after a grid of `dims` voxels was reoriented.
    pub fn oriented(&self, orientation: Orientation, dims: UVec3) -> Selection {
        let turned = |bounds: VoxelBox| {
            let ends = [bounds.min, bounds.max - 1].map(|v| orientation.destination(v, dims));
            let (min, max) = (ends[0].min(ends[1]), ends[0].max(ends[1]) + 1);
            // A box at the limit could lie beyond it now, by less than the grid's size.
            let limit = IVec3::splat(MARKER_LIMIT_VX);
            let back = (limit - max).min(IVec3::ZERO) + (-limit - min).max(IVec3::ZERO);
            let (min, max) = (min + back, max + back);
            VoxelBox { min: min.max(-limit), max: max.min(limit) }
        };
        let boxes = self.stack.0.iter();
        let stack = boxes.map(|b| SelectedBox { bounds: turned(b.bounds), adds: b.adds }).collect();
        Selection { marker: turned(self.marker), stack: BoxStack(stack), limits: self.limits }
    }

    /// Returns whether tools are limited to the selection, if anything is selected.
    pub fn limits(&self) -> bool {
        self.limits
    }

    /// Limits tools to the selection, or not.
    pub(crate) fn set_limits(&mut self, limits: bool) {
        self.limits = limits;
    }

    /// Returns the boxes that tools are limited to; `None` while they work everywhere.
    pub fn limit(&self) -> Option<&BoxStack> {
        (self.limits && !self.stack.0.is_empty()).then_some(&self.stack)
    }
}

impl BoxStack {
    /// Returns whether there is no box on the stack.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns whether a voxel is selected: the uppermost box that contains it decides.
    pub fn contains(&self, v: IVec3) -> bool {
        self.0.iter().rev().find(|b| b.bounds.contains(v)).is_some_and(|b| b.adds)
    }
}

impl Region for BoxStack {
    /// For each box, the part of the row that it covers.
    type Row = Vec<(RowReach, BoxRow)>;

    fn bounds_vx(&self) -> VoxelBox {
        let adding = self.0.iter().filter(|b| b.adds).map(|b| b.bounds);
        let around =
            |a: VoxelBox, b: VoxelBox| VoxelBox { min: a.min.min(b.min), max: a.max.max(b.max) };
        adding.reduce(around).unwrap_or(VoxelBox { min: IVec3::ZERO, max: IVec3::ZERO })
    }

    fn cut_row<S: Simd>(&self, simd: S, y_vx: u32, z_vx: u32, row: &mut Self::Row) -> RowReach {
        row.clear();
        let mut all = RowReach::NONE;
        for selected in &self.0 {
            let mut cut = BoxRow::default();
            let reach = selected.bounds.cut_row(simd, y_vx, z_vx, &mut cut);
            if !reach.touched.is_empty() {
                match selected.adds {
                    true => all = joined(&all, &reach),
                    false => all.whole = longest_without(&all.whole, &reach.touched),
                }
            }
            row.push((reach, cut));
        }
        all
    }

    fn mask<S: Simd>(&self, simd: S, row: &Self::Row, _: &RowReach, brick_x: u32) -> Brick {
        self.0.iter().zip(row).fold(Brick::EMPTY, |mask, (selected, (reach, cut))| {
            if !reach.touched.contains(&brick_x) {
                return mask;
            }
            let covered = selected.bounds.mask(simd, cut, reach, brick_x);
            if selected.adds { mask.or(&covered) } else { mask.and_not(&covered) }
        })
    }

    fn coverage(&self, bounds: VoxelBox) -> BoxCoverage {
        self.0.iter().fold(BoxCoverage::None, |below, selected| {
            let covered = selected.bounds.coverage(bounds);
            if selected.adds { below.or(covered) } else { below.and(covered.inverse()) }
        })
    }
}

/// Returns the union of two rows' coverage; `whole` may leave out some bricks.
fn joined(a: &RowReach, b: &RowReach) -> RowReach {
    let hull = |a: &std::ops::Range<u32>, b: &std::ops::Range<u32>| {
        if a.is_empty() { b.clone() } else { a.start.min(b.start)..a.end.max(b.end) }
    };
    let meet = a.whole.start <= b.whole.end && b.whole.start <= a.whole.end;
    let whole = match (a.whole.is_empty(), b.whole.is_empty()) {
        (_, true) => a.whole.clone(),
        (true, _) => b.whole.clone(),
        _ if meet => hull(&a.whole, &b.whole),
        _ if a.whole.len() >= b.whole.len() => a.whole.clone(),
        _ => b.whole.clone(),
    };
    RowReach { touched: hull(&a.touched, &b.touched), whole }
}

/// Returns the longest part of `range` beside `hole`.
fn longest_without(
    range: &std::ops::Range<u32>,
    hole: &std::ops::Range<u32>,
) -> std::ops::Range<u32> {
    let left = range.start..range.end.min(hole.start);
    let right = range.start.max(hole.end)..range.end;
    match (left.is_empty(), right.is_empty()) {
        (true, true) => 0..0,
        (false, true) => left,
        (true, false) => right,
        _ if left.len() >= right.len() => left,
        _ => right,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn every_voxel(dims: UVec3) -> impl Iterator<Item = IVec3> {
        let dims = dims.as_ivec3();
        (0..dims.z).flat_map(move |z| {
            (0..dims.y).flat_map(move |y| (0..dims.x).map(move |x| IVec3::new(x, y, z)))
        })
    }

    #[test]
    fn boxes_follow_the_axes_and_stay_within_reach() {
        let dims = UVec3::new(20, 30, 40);
        let far = MARKER_LIMIT_VX;
        for orientation in Orientation::all() {
            let mut selection = Selection::new(dims);
            selection.push(true);
            let marker = VoxelBox { min: IVec3::new(-3, 4, 5), max: IVec3::new(6, 9, 41) };
            selection.set_marker(marker).unwrap();
            selection.push(false);
            let turned = selection.oriented(orientation, dims);
            for v in every_voxel(dims) {
                let there = orientation.destination(v, dims);
                assert_eq!(turned.stack().contains(there), selection.stack().contains(v));
                assert_eq!(turned.marker().contains(there), marker.contains(v));
            }
            let turned_dims = orientation.size(dims);
            assert_eq!(turned.oriented(orientation.inverse(), turned_dims), selection);

            let all = VoxelBox { min: IVec3::splat(-far), max: IVec3::splat(far) };
            let corner = VoxelBox { min: IVec3::splat(-far), max: IVec3::splat(1 - far) };
            for extreme in [all, corner] {
                selection.set_marker(extreme).unwrap();
                let marker = selection.oriented(orientation, dims).marker();
                assert_eq!(Selection::check_marker(marker), Ok(()));
            }
        }
    }

    #[test]
    fn a_marker_must_be_near_and_not_empty() {
        let mut selection = Selection::new(UVec3::new(64, 1, 10));
        let first = VoxelBox { min: IVec3::new(16, 0, 2), max: IVec3::new(48, 1, 7) };
        assert_eq!(selection.marker(), first);
        let empty = VoxelBox { min: IVec3::ONE, max: IVec3::new(5, 1, 5) };
        assert!(selection.set_marker(empty).is_err());
        let far = VoxelBox { min: IVec3::ZERO, max: IVec3::new(i32::MAX, 1, 1) };
        assert!(selection.set_marker(far).is_err());
        assert_eq!(selection.marker(), first);
        selection.set_limits(true);
        assert!(selection.limit().is_none(), "nothing selected limits nothing");
        assert!(selection.push(true) && selection.limit().is_some());
        assert!(selection.drop_last() && !selection.drop_last());
    }
}
