//! The two parts of a solid that is a Minkowski sum, and the tests that such solids share.
//!
//! The file of such a solid re-exports the tests that hold for it. Pure geometry in tool space. Knows no kinds of solids.

use glam::DVec3;

use super::simd_real::SimdReal;
use super::sweep::behind;

/// A solid as a Minkowski sum: a core (a circle, a segment, a box that reaches 1), shrunk by 1 - `round`, and an
/// ellipsoid of half extents `round`. Outside tool space the ellipsoid is a ball where the solid is as wide as deep.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MinkowskiParts {
    /// Extent of the core along each axis.
    pub core: DVec3,
    /// Half extents of the ellipsoid.
    pub round: DVec3,
}

impl MinkowskiParts {
    /// Returns the parts of a solid that is no sum, for all half extents: no core, and an ellipsoid that fills the box.
    pub(super) fn without_core(_: DVec3) -> MinkowskiParts {
        MinkowskiParts { core: DVec3::ZERO, round: DVec3::ONE }
    }

    /// Returns the offset of a point beyond the core, without sign, in units of the ellipsoid.
    #[inline(always)]
    pub(crate) fn beyond_core<N: SimdReal>(&self, p: [N; 3]) -> [N; 3] {
        let MinkowskiParts { core, round } = *self;
        let [x, y, z] = p;
        let zero = x.all(0.0);
        [
            (x.abs() - core.x).max(zero) / round.x,
            (y.abs() - core.y).max(zero) / round.y,
            (z.abs() - core.z).max(zero) / round.z,
        ]
    }

    /// Returns the point of the ellipsoid that lies furthest along a direction.
    pub(super) fn furthest_of_round(&self, direction: DVec3) -> DVec3 {
        self.round * (self.round * direction).normalize_or_zero()
    }

    /// Returns the time from 0 to 1 when the sum of a box and an ellipsoid is nearest to a point. The squared distance
    /// is convex in time, and quadratic between the times when the point passes a face of the box.
    #[inline(always)]
    fn nearest_of_sum<N: SimdReal>(&self, p: [N; 3], displacement: DVec3) -> N {
        let core = self.core;
        let zero = p[0].all(0.0);
        let (mut from, mut to) = (zero, p[0].all(1.0));
        let (mut slope_from, mut slope_to) =
            (self.slope_of_sum(p, displacement, from), self.slope_of_sum(p, displacement, to));
        let (first, last) = (zero.at_most(slope_from), slope_to.at_most(zero));
        for axis in 0..3 {
            // Without a core, the two halves are one parabola.
            let inverse = displacement[axis].recip();
            if core[axis] == 0.0 || !inverse.is_finite() {
                continue;
            }
            for face in [-core[axis], core[axis]] {
                let t = (p[axis] - face) * inverse;
                let between = from.below(t) & t.below(to);
                if N::is_none(between) {
                    continue;
                }
                let t = t.where_true(between, zero);
                let slope = self.slope_of_sum(p, displacement, t);
                let (before, after) = (between & slope.below(zero), between & zero.at_most(slope));
                (from, slope_from) =
                    (t.where_true(before, from), slope.where_true(before, slope_from));
                (to, slope_to) = (t.where_true(after, to), slope.where_true(after, slope_to));
            }
        }
        let change = slope_from - slope_to;
        // At one of the ends, or where the slope is 0.
        let level = change.at_most(zero) & zero.at_most(change);
        let t = from + (to - from) * (slope_from / p[0].all(1.0).where_true(level, change));
        // Yields a time even where slopes are NaN.
        zero.where_true(first, p[0].all(1.0).where_true(last, t.max(zero)))
    }

    /// Returns half the derivative of the squared distance at a time.
    #[inline(always)]
    fn slope_of_sum<N: SimdReal>(&self, p: [N; 3], displacement: DVec3, t: N) -> N {
        let (core, round) = (self.core, self.round);
        let at = behind(p, displacement, t);
        let mut slope = t.all(0.0);
        for axis in 0..3 {
            // The component outside the core, with its sign.
            let nearest = at[axis].max(t.all(-core[axis])).min(t.all(core[axis]));
            slope =
                slope - (at[axis] - nearest) * (displacement[axis] / (round[axis] * round[axis]));
        }
        slope
    }
}

/// Returns whether a sum whose core is a box or a segment passes over one point or eight when it moves by
/// `displacement`. Points with a value up to `margin` instead of 0 count as inside.
#[inline(always)]
pub fn passes<N: SimdReal>(
    parts: &MinkowskiParts,
    p: [N; 3],
    displacement: DVec3,
    margin: f64,
) -> N::Mask {
    let most = 1.0 + margin;
    let t = parts.nearest_of_sum(p, displacement);
    let [x, y, z] = parts.beyond_core(behind(p, displacement, t));
    let squared = x * x + y * y + z * z;
    squared.at_most(t.all(most.max(0.0) * most)) & t.all(0.0).at_most(t.all(most))
}

/// Returns the greatest change of the value of such a sum over `offset` (at least 0 on each axis).
pub fn slack(parts: &MinkowskiParts, offset: DVec3) -> f64 {
    (offset / parts.round).length()
}

/// Returns the maximum of `direction . p` over such a sum.
pub fn support(parts: &MinkowskiParts, direction: DVec3) -> f64 {
    (parts.core * direction).abs().element_sum() + (parts.round * direction).length()
}

/// Returns a point of such a sum that lies furthest along a direction.
pub fn furthest(parts: &MinkowskiParts, direction: DVec3) -> DVec3 {
    parts.core.copysign(direction) + parts.furthest_of_round(direction)
}
