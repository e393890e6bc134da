//! The motion of a point relative to a solid that is translated along a straight line: the basis of the tests of swept
//! solids.
//!
//! Every solid is the set of points where a value `f` is at most 0. The value is that of the inside test: |p| - 1 for
//! an ellipsoid, the largest excess over a face for a solid with faces. The swept volume is the set of points where the
//! minimum of `f(p - t displacement)` over t from 0 to 1 is at most 0.
//!
//! Pure geometry in tool space. Knows no solid.

use glam::DVec3;

use super::simd_real::SimdReal;

/// Returns half the base of a solid with an apex, enlarged by `margin`: the limit for heights that have no significant
/// digits left.
#[inline(always)]
pub(crate) fn widest_base(margin: f64) -> f64 {
    1.0 + 1.5 * margin
}

/// Returns the position of a point relative to a solid that has moved along `displacement` until time `t`.
#[inline(always)]
pub fn behind<N: SimdReal>([x, y, z]: [N; 3], displacement: DVec3, t: N) -> [N; 3] {
    [x - t * displacement.x, y - t * displacement.y, z - t * displacement.z]
}

/// Returns the point of the unit circle about the y axis that lies furthest along `direction`; the origin if all lie
/// equally far.
pub fn along_circle(direction: DVec3) -> DVec3 {
    direction.with_y(0.0).normalize_or_zero()
}

/// The motion of a point perpendicular to the y axis.
pub struct PerpendicularMotion<N> {
    at: [N; 2],
    displacement: [f64; 2],
    /// Square of the length of the displacement, and its reciprocal; 0 if there is none.
    squared_length: f64,
    inverse: f64,
    /// The time when the point is nearest to the axis; not limited to 0 to 1.
    pub foot: N,
}

impl<N: SimdReal> PerpendicularMotion<N> {
    #[inline(always)]
    pub fn new(x: N, z: N, displacement: DVec3) -> PerpendicularMotion<N> {
        let squared_length = displacement.x * displacement.x + displacement.z * displacement.z;
        let inverse =
            Some(squared_length.recip()).filter(|inverse| inverse.is_finite()).unwrap_or(0.0);
        let foot = (x * displacement.x + z * displacement.z) * inverse;
        PerpendicularMotion {
            at: [x, z],
            displacement: [displacement.x, displacement.z],
            squared_length,
            inverse,
            foot,
        }
    }

    /// Returns the squared distance from the axis at a time.
    #[inline(always)]
    pub fn squared(&self, t: N) -> N {
        let [x, z] = [self.at[0] - t * self.displacement[0], self.at[1] - t * self.displacement[1]];
        x * x + z * z
    }

    /// Returns the time when the point is deepest inside a circle around the axis whose radius grows by `grows`. It
    /// minimises hypot(aside, length u) - grows u, which is convex, with u counted from the foot.
    #[inline(always)]
    pub(crate) fn deepest_in_cone(&self, grows: f64) -> N {
        let steep = self.squared_length - grows * grows;
        if steep <= 0.0 || self.inverse == 0.0 {
            return self.foot.all(f64::INFINITY.copysign(grows));
        }
        let aside = self.squared(self.foot).sqrt();
        self.foot + aside * (grows / (self.squared_length * steep).sqrt())
    }
}

/// The interval of times within 0 to 1 at which linear conditions hold.
#[derive(Clone, Copy)]
pub struct Times<N> {
    pub from: N,
    pub to: N,
}

impl<N: SimdReal> Times<N> {
    /// Returns the whole interval, for as many points as `like` has.
    #[inline(always)]
    pub fn all(like: N) -> Times<N> {
        Times { from: like.all(0.0), to: like.all(1.0) }
    }

    /// Keeps the times at which a coordinate moving from `at` by `-along` lies within `-most` to `most`.
    #[inline(always)]
    pub(crate) fn keep_within(&mut self, at: N, along: f64, most: f64) {
        self.keep(at - most, -along);
        self.keep(at * -1.0 - most, along);
    }

    /// Keeps the times at which `start + change t` is at most 0.
    #[inline(always)]
    pub fn keep(&mut self, start: N, change: f64) {
        let inverse = change.recip();
        let turn = start * -inverse;
        match () {
            // No change, or too small a change to divide by.
            _ if !inverse.is_finite() => {
                let held = start.at_most(start.all(0.0));
                self.to = self.to.where_true(held, start.all(f64::NEG_INFINITY));
            }
            _ if change > 0.0 => self.to = self.to.min(turn),
            () => self.from = self.from.max(turn),
        }
    }

    #[inline(always)]
    pub(crate) fn are_some(self) -> N::Mask {
        self.from.at_most(self.to)
    }

    /// Returns the time of the interval nearest to `t`.
    #[inline(always)]
    pub fn clamp(self, t: N) -> N {
        t.max(self.from).min(self.to)
    }
}
