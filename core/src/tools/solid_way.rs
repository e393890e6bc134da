//! Whether a solid that moves straight, without turning, passes over a point: the inside test of what it sweeps.
//!
//! Every solid is the set of points where a value `f` is at most 0. The value is that of the inside test: of an
//! ellipsoid |p| - 1, of a solid with faces the largest excess over a face. What a solid sweeps is where the least of
//! `f(p - t way)` for t from 0 to 1 is at most 0. `f` changes from a point to another by at most [`Shape::slack`] of
//! their distance, so that a value at the middle of a box decides all of it.
//!
//! Pure geometry in tool space, exact up to rounding, but for the torus ([`FINEST`]).

use glam::swizzles::Vec3Swizzles;
use glam::{DVec2, DVec3};

use super::solid::{Shape, Solid};

/// The way of a torus is looked at in steps in which its value changes by at least this: a thousandth of the tube's
/// radius.
const FINEST: f64 = 1e-3;
/// Nor in more steps than this.
const MOST_STEPS: f64 = 16384.0;

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

    /// Whether the solid, led from its place straight along `way`, passes over `p`; with a value up to `margin` instead
    /// of 0, which makes it larger or smaller.
    #[inline]
    pub(super) fn passes(&self, p: DVec3, way: DVec3, margin: f64) -> bool {
        let most = 1.0 + margin;
        // What is no number is in nothing.
        if !(p.is_finite() && way.is_finite()) {
            return false;
        }
        // Half the base of a solid with an apex.
        let widest = 1.0 + 1.5 * margin;
        match self.solid() {
            Solid::Cuboid => {
                let mut times = Times::ALL;
                for axis in 0..3 {
                    times.keep(p[axis] - most, -way[axis]);
                    times.keep(-p[axis] - most, way[axis]);
                }
                times.are_some()
            }
            Solid::Pyramid => {
                let mut times = Times::within_height(p, way, margin);
                let (height, rise) = (0.5 * p.y - 0.5 - margin, -0.5 * way.y);
                for (side, along) in [(p.x, way.x), (p.z, way.z)] {
                    // The base: for heights that have no digits left.
                    times.keep(side - widest, -along);
                    times.keep(-side - widest, along);
                    times.keep(height + side, rise - along);
                    times.keep(height - side, rise + along);
                }
                times.are_some()
            }
            Solid::Cylinder => {
                let times = Times::within_height(p, way, margin);
                let (p, way) = (p.xz(), way.xz());
                let nearest = times.clamp(p.dot(way) / way.length_squared());
                times.are_some()
                    && most >= 0.0
                    && (p - way * nearest).length_squared() <= most * most
            }
            Solid::Cone => {
                let times = Times::within_height(p, way, margin);
                // The radius at the height of the point: at the start, and how it grows with time.
                let (radius, grows) = (0.5 * (1.0 - p.y) + margin, 0.5 * way.y);
                let (p, way) = (p.xz(), way.xz());
                let nearest = times.clamp(furthest_into_cone(p, way, grows));
                let radius = (radius + grows * nearest).min(widest);
                times.are_some()
                    && radius >= 0.0
                    && (p - way * nearest).length_squared() <= radius * radius
            }
            Solid::Torus => self.torus_passes(p, way, margin),
            Solid::Ellipsoid | Solid::Capsule | Solid::RoundedCuboid => {
                let nearest = p - way * self.nearest_of_sum(p, way);
                let beyond = self.beyond_core(nearest);
                most >= 0.0 && nearest.is_finite() && beyond.length_squared() <= most * most
            }
        }
    }

    /// The part of a point that is beyond the core of a sum with an ellipsoid, in units of the ellipsoid.
    fn beyond_core(&self, p: DVec3) -> DVec3 {
        (p.abs() - self.core()).max(DVec3::ZERO) / self.round()
    }

    /// When a sum of a box and an ellipsoid is nearest to a point, from 0 to 1. The square of the distance is convex in
    /// time, and of second degree between the times when the point passes a face of the box.
    fn nearest_of_sum(&self, p: DVec3, way: DVec3) -> f64 {
        let (core, round) = (self.core(), self.round());
        let slope = |t: f64| {
            let at = p - way * t;
            let beyond = (at.abs() - core).max(DVec3::ZERO) * at.signum();
            -(beyond * way / (round * round)).element_sum()
        };
        let (mut from, mut to) = ((0.0, slope(0.0)), (1.0, slope(1.0)));
        if from.1 >= 0.0 {
            return 0.0;
        }
        if to.1 <= 0.0 {
            return 1.0;
        }
        for axis in 0..3 {
            for face in [-core[axis], core[axis]] {
                let t = (p[axis] - face) / way[axis];
                if t > from.0 && t < to.0 {
                    let there = (t, slope(t));
                    if there.1 < 0.0 { from = there } else { to = there }
                }
            }
        }
        from.0 + (to.0 - from.0) * (from.1 / (from.1 - to.1))
    }

    /// Follows the way as far as the value lets the point be outside.
    fn torus_passes(&self, p: DVec3, way: DVec3, margin: f64) -> bool {
        let change = self.slack(way.abs());
        let least = (FINEST / change).max(MOST_STEPS.recip());
        let mut t = 0.0;
        loop {
            let at = p - way * f64::min(t, 1.0);
            let out = (at.x.hypot(at.z) - self.core().x) / self.round().x;
            let value = out.hypot(at.y / self.round().y) - 1.0 - margin;
            if value <= 0.0 {
                return true;
            }
            // Also where it is no number.
            if t >= 1.0 || !value.is_finite() {
                return false;
            }
            t += (value / change).max(least);
        }
    }
}

/// When a point that moves by `-way` and is at `p` at first is furthest inside of a circle that grows by `grows`: any
/// time, not a number where it makes no difference.
fn furthest_into_cone(p: DVec2, way: DVec2, grows: f64) -> f64 {
    // The least of |p - t way| - grows t, which is convex: hypot(aside, length u) - grows u with u from the foot.
    let squared = way.length_squared();
    let foot = p.dot(way) / squared;
    let aside = (p - way * foot).length();
    match squared - grows * grows {
        steep if steep > 0.0 => foot + aside * grows / (squared * steep).sqrt(),
        _ => f64::INFINITY.copysign(grows),
    }
}

/// The times from 0 to 1 at which linear conditions hold.
#[derive(Clone, Copy)]
struct Times {
    from: f64,
    to: f64,
}

impl Times {
    const ALL: Times = Times { from: 0.0, to: 1.0 };

    /// Those with a height within -1 to 1 and a margin.
    fn within_height(p: DVec3, way: DVec3, margin: f64) -> Times {
        let mut times = Times::ALL;
        times.keep(p.y - 1.0 - margin, -way.y);
        times.keep(-p.y - 1.0 - margin, way.y);
        times
    }

    /// Keeps those at which `start + change t` is at most 0.
    #[inline]
    fn keep(&mut self, start: f64, change: f64) {
        let turn = -start / change;
        match () {
            _ if change > 0.0 => self.to = self.to.min(turn),
            _ if change < 0.0 => self.from = self.from.max(turn),
            _ if start <= 0.0 => {}
            () => self.to = f64::NEG_INFINITY,
        }
    }

    fn are_some(self) -> bool {
        self.from <= self.to
    }

    /// The one nearest to `t`, the first if that is no number.
    fn clamp(self, t: f64) -> f64 {
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

    /// What a torus may miss of its way.
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

        /// Without a way it is the inside test, and a margin takes as much as the slack says.
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
