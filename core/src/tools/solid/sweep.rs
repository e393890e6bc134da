//! The inside test of swept solids: whether a solid that moves straight, without turning, passes over a point.
//!
//! Every solid is the set of points where a value `f` is at most 0. The value is that of the inside test: of an
//! ellipsoid |p| - 1, of a solid with faces the largest excess over a face. The swept volume is the set of points where
//! the least of `f(p - t way)` for t from 0 to 1 is at most 0. Between two points `f` changes by at most
//! [`Shape::slack`] of their distance, so that the value at the middle of a box can decide the whole box.
//!
//! Pure geometry in tool space, exact up to rounding, but for the torus ([`FINEST`]).

use glam::DVec3;

use super::shape::{Shape, Solid};
use super::simd_real::SimdReal;

/// The displacement of a torus is sampled in steps in which its value changes by at least this: a thousandth of the
/// tube's radius.
const FINEST: f64 = 1e-3;
/// Most steps along the displacement while it is in the box around the torus.
const MOST_STEPS: f64 = 16384.0;
/// Times from 0 to 1 that differ by less than this may be equal.
const NO_TIME: f64 = 1e-15;

impl Shape {
    /// The most by which the value changes over `offset` (at least 0 on each axis), in any direction with such parts.
    pub(super) fn slack(&self, offset: DVec3) -> f64 {
        let around = offset.x.hypot(offset.z);
        match self.solid() {
            Solid::Cuboid => offset.max_element(),
            Solid::Pyramid => offset.y.max(offset.x.max(offset.z) + 0.5 * offset.y),
            Solid::Cylinder => offset.y.max(around),
            Solid::Cone => offset.y.max(around + 0.5 * offset.y),
            Solid::Torus => (around / self.round().x).hypot(offset.y / self.round().y),
            Solid::Ellipsoid | Solid::Capsule | Solid::RoundedCuboid => {
                (offset / self.round()).length()
            }
        }
    }

    /// Whether the solid, moved straight from its place by `way`, passes over `p`. Points with a value up to `margin`
    /// instead of 0 count as inside, which makes the solid larger or smaller.
    pub(super) fn passes(&self, p: DVec3, way: DVec3, margin: f64) -> bool {
        // NaN or infinite coordinates lie in no solid.
        p.is_finite() && way.is_finite() && self.passes_over(p.to_array(), way, margin)
    }

    /// The same for one point or eight, none of them NaN, as coordinates in tool space.
    #[inline(always)]
    pub(super) fn passes_over<N: SimdReal>(&self, p: [N; 3], way: DVec3, margin: f64) -> N::Mask {
        let [x, y, z] = p;
        let most = 1.0 + margin;
        // Half the base of a solid with an apex: its limit where heights have no significant digits left.
        let widest = 1.0 + 1.5 * margin;
        match self.solid() {
            Solid::Cuboid => {
                let mut times = Times::all(x);
                for (at, way) in [(x, way.x), (y, way.y), (z, way.z)] {
                    times.keep_within(at, way, most);
                }
                times.are_some()
            }
            Solid::Pyramid => {
                let mut times = Times::all(x);
                times.keep_within(y, way.y, most);
                let (height, rise) = (y * 0.5 - (0.5 + margin), -0.5 * way.y);
                for (side, along) in [(x, way.x), (z, way.z)] {
                    times.keep_within(side, along, widest);
                    times.keep(height + side, rise - along);
                    times.keep(height - side, rise + along);
                }
                times.are_some()
            }
            Solid::Cylinder => {
                let mut times = Times::all(x);
                times.keep_within(y, way.y, most);
                let across = Across::new(x, z, way);
                let squared = across.squared(times.clamp(across.foot));
                times.are_some()
                    & squared.at_most(x.all(most.max(0.0) * most))
                    & x.all(0.0).at_most(x.all(most))
            }
            Solid::Cone => {
                let mut times = Times::all(x);
                times.keep_within(y, way.y, most);
                // The radius at the height of the point: at the start, and how it grows with time.
                let (radius, grows) = (y * -0.5 + (0.5 + margin), 0.5 * way.y);
                let across = Across::new(x, z, way);
                let deepest = times.clamp(across.deepest_in_cone(grows));
                let radius = (radius + deepest * grows).min(x.all(widest));
                let within = across.squared(deepest).at_most(radius * radius);
                times.are_some() & within & x.all(0.0).at_most(radius)
            }
            Solid::Torus => self.torus_passes(p, way, margin),
            Solid::Ellipsoid | Solid::Capsule | Solid::RoundedCuboid => {
                let t = self.nearest_of_sum(p, way);
                let [x, y, z] = self.beyond_core(behind(p, way, t));
                let squared = x * x + y * y + z * z;
                squared.at_most(t.all(most.max(0.0) * most)) & t.all(0.0).at_most(t.all(most))
            }
        }
    }

    /// The time from 0 to 1 when the sum of a box and an ellipsoid is nearest to a point. The square of the distance is
    /// convex in time, and quadratic between the times when the point passes a face of the box.
    #[inline(always)]
    fn nearest_of_sum<N: SimdReal>(&self, p: [N; 3], way: DVec3) -> N {
        let core = self.core();
        let zero = p[0].all(0.0);
        let (mut from, mut to) = (zero, p[0].all(1.0));
        let (mut slope_from, mut slope_to) =
            (self.slope_of_sum(p, way, from), self.slope_of_sum(p, way, to));
        let (first, last) = (zero.at_most(slope_from), slope_to.at_most(zero));
        for axis in 0..3 {
            // Without a core the two halves are one parabola.
            let inverse = way[axis].recip();
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
                let slope = self.slope_of_sum(p, way, t);
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
        // Gives a time even where slopes are NaN.
        zero.where_true(first, p[0].all(1.0).where_true(last, t.max(zero)))
    }

    /// Half the slope of the square of the distance at a time.
    #[inline(always)]
    fn slope_of_sum<N: SimdReal>(&self, p: [N; 3], way: DVec3, t: N) -> N {
        let (core, round) = (self.core(), self.round());
        let at = behind(p, way, t);
        let mut slope = t.all(0.0);
        for axis in 0..3 {
            // The part outside the core, with its sign.
            let nearest = at[axis].max(t.all(-core[axis])).min(t.all(core[axis]));
            slope = slope - (at[axis] - nearest) * (way[axis] / (round[axis] * round[axis]));
        }
        slope
    }

    /// Marches along the displacement while it is in the box around the solid, each step as long as the value lets the
    /// point be outside.
    #[inline(always)]
    fn torus_passes<N: SimdReal>(&self, p: [N; 3], way: DVec3, margin: f64) -> N::Mask {
        let zero = p[0].all(0.0);
        let mut times = Times::all(zero);
        let box_half = 1.0 + margin.max(0.0);
        for (at, way) in [(p[0], way.x), (p[1], way.y), (p[2], way.z)] {
            times.keep_within(at, way, box_half);
        }
        let Times { from, to } = times;
        let inverse = self.slack(way.abs()).max(f64::MIN_POSITIVE).recip();
        let least = ((to - from) * MOST_STEPS.recip()).max(zero.all(FINEST * inverse + NO_TIME));
        let mut t = from;
        let mut value = self.torus_value(behind(p, way, t), margin);
        let mut inside = value.at_most(zero) & times.are_some();
        while !N::is_all(inside | to.at_most(t)) {
            t = (t + (value * inverse).max(least)).min(to);
            value = self.torus_value(behind(p, way, t), margin);
            inside = inside | (value.at_most(zero) & times.are_some());
        }
        inside
    }

    #[inline(always)]
    fn torus_value<N: SimdReal>(&self, [x, y, z]: [N; 3], margin: f64) -> N {
        let out = ((x * x + z * z).sqrt() - self.core().x) / self.round().x;
        let up = y / self.round().y;
        (out * out + up * up).sqrt() - (1.0 + margin)
    }
}

/// Where a point is, seen from a solid that has moved along `way` for a time.
#[inline(always)]
fn behind<N: SimdReal>([x, y, z]: [N; 3], way: DVec3, t: N) -> [N; 3] {
    [x - t * way.x, y - t * way.y, z - t * way.z]
}

/// The motion of a point across the y axis.
struct Across<N> {
    at: [N; 2],
    way: [f64; 2],
    /// Square of the length of the displacement, and its reciprocal; 0 if there is none.
    squared_way: f64,
    inverse: f64,
    /// The time when it is nearest to the axis; not limited to 0 to 1.
    foot: N,
}

impl<N: SimdReal> Across<N> {
    #[inline(always)]
    fn new(x: N, z: N, way: DVec3) -> Across<N> {
        let squared_way = way.x * way.x + way.z * way.z;
        let inverse =
            Some(squared_way.recip()).filter(|inverse| inverse.is_finite()).unwrap_or(0.0);
        let foot = (x * way.x + z * way.z) * inverse;
        Across { at: [x, z], way: [way.x, way.z], squared_way, inverse, foot }
    }

    /// Square of the distance from the axis at a time.
    #[inline(always)]
    fn squared(&self, t: N) -> N {
        let [x, z] = [self.at[0] - t * self.way[0], self.at[1] - t * self.way[1]];
        x * x + z * z
    }

    /// The time when the point is furthest inside a circle around the axis that grows by `grows`: the least of
    /// hypot(aside, length u) - grows u, which is convex, with u from the foot.
    #[inline(always)]
    fn deepest_in_cone(&self, grows: f64) -> N {
        let steep = self.squared_way - grows * grows;
        if steep <= 0.0 || self.inverse == 0.0 {
            return self.foot.all(f64::INFINITY.copysign(grows));
        }
        let aside = self.squared(self.foot).sqrt();
        self.foot + aside * (grows / (self.squared_way * steep).sqrt())
    }
}

/// The times from 0 to 1 at which linear conditions hold.
#[derive(Clone, Copy)]
struct Times<N> {
    from: N,
    to: N,
}

impl<N: SimdReal> Times<N> {
    /// All, of as many points as `like` has.
    #[inline(always)]
    fn all(like: N) -> Times<N> {
        Times { from: like.all(0.0), to: like.all(1.0) }
    }

    /// Keeps those at which a coordinate that goes from `at` by `-way` is within `-most` to `most`.
    #[inline(always)]
    fn keep_within(&mut self, at: N, way: f64, most: f64) {
        self.keep(at - most, -way);
        self.keep(at * -1.0 - most, way);
    }

    /// Keeps those at which `start + change t` is at most 0.
    #[inline(always)]
    fn keep(&mut self, start: N, change: f64) {
        let inverse = change.recip();
        let turn = start * -inverse;
        match () {
            // No change, or one too small to divide by.
            _ if !inverse.is_finite() => {
                let held = start.at_most(start.all(0.0));
                self.to = self.to.where_true(held, start.all(f64::NEG_INFINITY));
            }
            _ if change > 0.0 => self.to = self.to.min(turn),
            () => self.from = self.from.max(turn),
        }
    }

    #[inline(always)]
    fn are_some(self) -> N::Mask {
        self.from.at_most(self.to)
    }

    /// The one nearest to `t`.
    #[inline(always)]
    fn clamp(self, t: N) -> N {
        t.max(self.from).min(self.to)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn half() -> impl Strategy<Value = DVec3> {
        let edge = || prop_oneof![4 => 0.3f64..60.0, 1 => Just(8.0)];
        prop_oneof![(edge(), edge(), edge()).prop_map(DVec3::from), edge().prop_map(DVec3::splat)]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        let axis =
            || prop_oneof![4 => -2.0f64..2.0, 1 => prop::sample::select(vec![-1.0, 0.0, 1.0])];
        (axis(), axis(), axis()).prop_map(DVec3::from)
    }

    fn way() -> impl Strategy<Value = DVec3> {
        let axis = || prop_oneof![3 => -4.0f64..4.0, 1 => Just(0.0), 1 => -1e-6f64..1e-6];
        (axis(), axis(), axis()).prop_map(DVec3::from)
    }

    /// The margin by which the sweep of a torus may miss points, because its steps are finite; 0 for other solids.
    fn finest(shape: &Shape, way: DVec3) -> f64 {
        match shape.solid() {
            Solid::Torus => FINEST.max(shape.slack(way.abs()) / MOST_STEPS),
            _ => 0.0,
        }
    }

    fn solid() -> impl Strategy<Value = Solid> {
        prop::sample::select(&Solid::ALL[..])
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

        /// A solid passes over a point if it contains it at one of many times, and does not if a slightly larger one
        /// contains it at none.
        #[test]
        fn a_solid_passes_over_what_it_contains_at_some_time(
            solid in solid(),
            half in half(),
            p in point(),
            way in way(),
        ) {
            let shape = Shape::new(solid, half);
            let passes = shape.passes(p, way, 0.0);
            let fine = 1e-9 + finest(&shape, way);
            let between = shape.slack(way.abs()) / 4000.0;
            let mut nearly = false;
            for i in 0..=2000 {
                let at = p - way * (f64::from(i) / 2000.0);
                if shape.contains(at) {
                    prop_assert!(passes || shape.passes(p, way, fine), "contained at {}", i);
                }
                nearly |= shape.passes(at, DVec3::ZERO, between + 1e-9);
            }
            prop_assert!(nearly || !passes);
        }

        /// Without a displacement the sweep is the inside test. A margin covers as much as the slack says.
        #[test]
        fn a_margin_covers_the_slack(
            solid in solid(),
            half in half(),
            p in point(),
            offset in prop::array::uniform3(-0.3f64..0.3),
            way in way(),
        ) {
            let shape = Shape::new(solid, half);
            let offset = DVec3::from(offset);
            if shape.passes(p, DVec3::ZERO, 1e-12) == shape.passes(p, DVec3::ZERO, -1e-12) {
                prop_assert_eq!(shape.passes(p, DVec3::ZERO, 0.0), shape.contains(p));
            }
            let slack = shape.slack(offset.abs()) * (1.0 + 1e-9) + 1e-9;
            let fine = finest(&shape, way);
            if shape.passes(p, way, 0.0) {
                prop_assert!(shape.passes(p + offset, way, slack + fine));
            }
            if shape.passes(p, way, -slack - fine) {
                prop_assert!(shape.passes(p + offset, way, 0.0));
            }
        }
    }

    #[test]
    fn what_is_no_number_is_in_nothing() {
        for solid in Solid::ALL {
            let shape = Shape::new(solid, DVec3::splat(8.0));
            for bad in [f64::NAN, f64::INFINITY] {
                assert!(!shape.passes(DVec3::splat(bad), DVec3::X, 0.0), "{solid:?}");
            }
            assert!(!shape.passes(DVec3::ZERO, DVec3::ZERO, -2.0), "{solid:?} of nothing");
        }
    }
}
