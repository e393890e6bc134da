//! The arithmetic of a ray on the grid: the times and the order of its crossings of voxel boundaries. All casters use
//! it, so that they agree to the voxel.
//!
//! - The ray crosses the plane `k` (an integer) of an axis at `t = (k - origin) * (1 / direction)`,
//!   computed in `f32` from the integer each time and never accumulated.
//! - Crossings happen in the order of `t`; at equal `t`, x before y before z (through an edge or
//!   a corner the ray therefore passes a neighbour by a face, never straight across).
//! - Crossings at `t <= 0` are behind the ray. It starts in the voxel that it is in just after
//!   leaving its origin: with the origin on a boundary, the one it looks into.
//! - A component of the direction smaller than [`STANDSTILL`] counts as that small positive
//!   number: it crosses nothing within any grid, and no time is infinite or undefined.
//!
//! Knows no bricks and no bits.

use glam::{IVec3, Vec3};

/// Components of a direction below this magnitude are replaced by it.
pub const STANDSTILL: f32 = 1e-20;

/// A crossing of a voxel boundary: its time and axis (0..3); and the order of crossings.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct BoundaryCrossing {
    pub t: f32,
    pub axis: usize,
}

impl BoundaryCrossing {
    /// Comes after every crossing behind the ray and before all others.
    pub const START: BoundaryCrossing = BoundaryCrossing { t: 0.0, axis: 3 };

    #[inline(always)]
    pub fn before(self, other: BoundaryCrossing) -> bool {
        self.t < other.t || (self.t == other.t && self.axis < other.axis)
    }
}

/// A ray in grid coordinates (voxels).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub origin: Vec3,
    direction: Vec3,
    inverse: Vec3,
    /// 1 or -1 on each axis.
    pub step: IVec3,
}

impl Ray {
    /// Returns the ray; `None` if origin or direction are not finite or the direction has length 0.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Option<Ray> {
        let usable = origin.is_finite() && direction.is_finite() && direction != Vec3::ZERO;
        usable.then(|| Ray::new_unchecked(origin, direction))
    }

    #[inline(always)]
    fn new_unchecked(origin: Vec3, direction: Vec3) -> Ray {
        let direction = Vec3::select(
            direction.abs().cmplt(Vec3::splat(STANDSTILL)),
            Vec3::splat(STANDSTILL),
            direction,
        );
        let step = IVec3::select(direction.cmplt(Vec3::ZERO), IVec3::NEG_ONE, IVec3::ONE);
        Ray { origin, direction, inverse: 1.0 / direction, step }
    }

    /// Returns the crossing of `plane` of `axis`.
    #[inline(always)]
    pub fn crossing(&self, axis: usize, plane: i32) -> BoundaryCrossing {
        BoundaryCrossing { t: (plane as f32 - self.origin[axis]) * self.inverse[axis], axis }
    }

    #[inline(always)]
    pub fn forward(&self, axis: usize) -> bool {
        self.step[axis] > 0
    }

    /// Returns the plane through which the ray leaves the cells `low..low + size` of an axis.
    #[inline(always)]
    pub(crate) fn far_plane(&self, axis: usize, low: i32, size: i32) -> i32 {
        if self.forward(axis) { low + size } else { low }
    }

    /// Returns the plane through which the ray enters the cells `low..low + size` of an axis.
    #[inline(always)]
    pub(crate) fn near_plane(&self, axis: usize, low: i32, size: i32) -> i32 {
        if self.forward(axis) { low } else { low + size }
    }

    /// Returns the cell behind `plane`, as seen along the ray.
    #[inline(always)]
    pub(crate) fn cell_after(&self, axis: usize, plane: i32) -> i32 {
        if self.forward(axis) { plane } else { plane - 1 }
    }

    /// Returns the cell of `axis` in which the ray is just after `event`, known to lie from `first` to `last` (in the
    /// order in which the ray meets them). Estimated from the position, then corrected by the crossings themselves.
    #[inline(always)]
    pub(crate) fn cell_at(
        &self,
        axis: usize,
        event: BoundaryCrossing,
        first: i32,
        last: i32,
    ) -> i32 {
        let guess = (self.origin[axis] + self.direction[axis] * event.t).floor() as i32;
        let step = self.step[axis];
        let mut cell = guess.clamp(first.min(last), first.max(last));
        while cell != last && self.crossing(axis, self.far_plane(axis, cell, 1)).before(event) {
            cell += step;
        }
        while cell != first && !self.crossing(axis, self.near_plane(axis, cell, 1)).before(event) {
            cell -= step;
        }
        cell
    }
}
