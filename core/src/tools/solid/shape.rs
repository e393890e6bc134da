//! A solid of given proportions in tool space: its inside test, that of the volume that it sweeps, and its support.
//!
//! Between two points the value of the tests ([`super::sweep`]) changes by at most the [`SolidShape::slack`] of their
//! offset, so that the value at the centre of a box can decide the whole box. All tests are exact up to rounding,
//! except for the sweep of a torus ([`super::kind::torus::FINEST`]).
//!
//! From a kind and half extents to a [`SolidShape`]; each kind computes its own ([`super::kind`]). Knows no voxels and no
//! pose.

use glam::DVec3;

use super::kind::Solid;
use super::kind::torus::{FINEST, MOST_STEPS};
use super::parts::MinkowskiParts;
use super::simd_real::SimdReal;

/// A solid with the proportions that it has at given half extents.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SolidShape {
    solid: Solid,
    parts: MinkowskiParts,
}

impl SolidShape {
    /// Creates the shape of `solid` with half extents `half`, in any unit.
    pub fn new(solid: Solid, half: DVec3) -> SolidShape {
        SolidShape { solid, parts: (solid.spec().parts)(half) }
    }

    /// Returns the kind.
    pub fn solid(&self) -> Solid {
        self.solid
    }

    /// Returns the half extents of the rounding ellipsoid; 1 where there is no core.
    pub fn round(&self) -> DVec3 {
        self.parts.round
    }

    /// Returns whether a point of tool space lies inside.
    #[inline(always)]
    pub fn contains(&self, p: DVec3) -> bool {
        self.holds(p.to_array())
    }

    /// Returns whether one point or eight lie inside, given as coordinates in tool space.
    #[inline(always)]
    pub(super) fn holds<N: SimdReal>(&self, p: [N; 3]) -> N::Mask {
        self.solid.holds(&self.parts, p)
    }

    /// Returns the maximum of `direction . p` over the solid.
    pub fn support(&self, direction: DVec3) -> f64 {
        self.solid.support(&self.parts, direction)
    }

    /// Returns a point of the solid that lies furthest along `direction`.
    pub(super) fn furthest(&self, direction: DVec3) -> DVec3 {
        self.solid.furthest(&self.parts, direction)
    }

    /// Returns the margin by which the sweep may miss points because its steps are finite: 0 for convex solids, whose
    /// sweeps are exact.
    pub(super) fn finest(&self, displacement: DVec3) -> f64 {
        match self.solid.spec().is_convex {
            true => 0.0,
            false => FINEST.max(self.slack(displacement.abs()) / MOST_STEPS),
        }
    }

    /// Returns the greatest change of the value over `offset` (at least 0 on each axis), for any signs of its
    /// components.
    pub(super) fn slack(&self, offset: DVec3) -> f64 {
        self.solid.slack(&self.parts, offset)
    }

    /// Returns whether the solid, moved straight by `displacement`, passes over `p`. Points with a value up to `margin`
    /// instead of 0 count as inside, which makes the solid larger or smaller.
    pub(super) fn passes(&self, p: DVec3, displacement: DVec3, margin: f64) -> bool {
        // NaN or infinite coordinates lie in no solid.
        p.is_finite()
            && displacement.is_finite()
            && self.passes_over(p.to_array(), displacement, margin)
    }

    /// Tests one point or eight in the same way, none of them NaN, given as coordinates in tool space.
    #[inline(always)]
    pub(super) fn passes_over<N: SimdReal>(
        &self,
        p: [N; 3],
        displacement: DVec3,
        margin: f64,
    ) -> N::Mask {
        self.solid.passes(&self.parts, p, displacement, margin)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn half() -> impl Strategy<Value = DVec3> {
        let edge = || prop_oneof![4 => 0.3f64..60.0, 1 => Just(8.0), 1 => 1e-3f64..1e4];
        prop_oneof![(edge(), edge(), edge()).prop_map(DVec3::from), edge().prop_map(DVec3::splat),]
    }

    proptest! {
        /// No point reaches further than the support, and some reach it.
        #[test]
        fn the_support_is_as_far_as_points_reach(
            solid in prop::sample::select(&Solid::ALL),
            half in half(),
            direction in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let shape = SolidShape::new(solid, half);
            let direction = DVec3::from(direction);
            let most = shape.support(direction);
            // Points of a fine grid on a ball around the centre, moved to the surface by bisection.
            let mut furthest = f64::NEG_INFINITY;
            for i in 0..60 {
                for j in 0..120 {
                    let (up, turn) = ((f64::from(i) + 0.5) * 0.0523599, f64::from(j) * 0.0523599);
                    let outward = DVec3::new(up.sin() * turn.cos(), up.cos(), up.sin() * turn.sin());
                    // For a torus: around the centre line of the tube, however thin it is.
                    let (middle, outward) = match solid {
                        Solid::Torus => {
                            let ring = 1.0 - shape.round().x;
                            (DVec3::new(turn.cos(), 0.0, turn.sin()) * ring, outward * shape.round())
                        }
                        _ => (DVec3::ZERO, outward),
                    };
                    let (mut low, mut high) = (0.0, 2.0);
                    for _ in 0..24 {
                        let at = 0.5 * (low + high);
                        if shape.contains(middle + outward * at) { low = at } else { high = at }
                    }
                    furthest = furthest.max(direction.dot(middle + outward * low));
                }
            }
            let point = shape.furthest(direction);
            prop_assert!((direction.dot(point) - most).abs() <= 1e-9, "{} reaches {}", point, most);
            prop_assert!(shape.passes(point, DVec3::ZERO, 1e-9), "{} is outside", point);
            prop_assert!(furthest <= most + 1e-9, "{} beyond {}", furthest, most);
            prop_assert!(furthest >= most - 0.1 * direction.length(), "{} of {}", furthest, most);
        }
    }

    fn half_of_sweep() -> impl Strategy<Value = DVec3> {
        let edge = || prop_oneof![4 => 0.3f64..60.0, 1 => Just(8.0)];
        prop_oneof![(edge(), edge(), edge()).prop_map(DVec3::from), edge().prop_map(DVec3::splat)]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        let axis =
            || prop_oneof![4 => -2.0f64..2.0, 1 => prop::sample::select(vec![-1.0, 0.0, 1.0])];
        (axis(), axis(), axis()).prop_map(DVec3::from)
    }

    fn displacement() -> impl Strategy<Value = DVec3> {
        let axis = || prop_oneof![3 => -4.0f64..4.0, 1 => Just(0.0), 1 => -1e-6f64..1e-6];
        (axis(), axis(), axis()).prop_map(DVec3::from)
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
            half in half_of_sweep(),
            p in point(),
            displacement in displacement(),
        ) {
            let shape = SolidShape::new(solid, half);
            let passes = shape.passes(p, displacement, 0.0);
            let fine = 1e-9 + shape.finest(displacement);
            let between = shape.slack(displacement.abs()) / 4000.0;
            let mut nearly = false;
            for i in 0..=2000 {
                let at = p - displacement * (f64::from(i) / 2000.0);
                if shape.contains(at) {
                    prop_assert!(passes || shape.passes(p, displacement, fine), "contained at {}", i);
                }
                nearly |= shape.passes(at, DVec3::ZERO, between + 1e-9);
            }
            prop_assert!(nearly || !passes);
        }

        /// Without a displacement the sweep equals the inside test. A margin covers as much as the slack says.
        #[test]
        fn a_margin_covers_the_slack(
            solid in solid(),
            half in half_of_sweep(),
            p in point(),
            offset in prop::array::uniform3(-0.3f64..0.3),
            displacement in displacement(),
        ) {
            let shape = SolidShape::new(solid, half);
            let offset = DVec3::from(offset);
            if shape.passes(p, DVec3::ZERO, 1e-12) == shape.passes(p, DVec3::ZERO, -1e-12) {
                prop_assert_eq!(shape.passes(p, DVec3::ZERO, 0.0), shape.contains(p));
            }
            let slack = shape.slack(offset.abs()) * (1.0 + 1e-9) + 1e-9;
            let fine = shape.finest(displacement);
            if shape.passes(p, displacement, 0.0) {
                prop_assert!(shape.passes(p + offset, displacement, slack + fine));
            }
            if shape.passes(p, displacement, -slack - fine) {
                prop_assert!(shape.passes(p + offset, displacement, 0.0));
            }
        }
    }

    #[test]
    fn a_point_without_finite_coordinates_is_in_no_solid() {
        for solid in Solid::ALL {
            let shape = SolidShape::new(solid, DVec3::splat(8.0));
            for bad in [f64::NAN, f64::INFINITY] {
                assert!(!shape.passes(DVec3::splat(bad), DVec3::X, 0.0), "{solid:?}");
            }
            assert!(!shape.passes(DVec3::ZERO, DVec3::ZERO, -2.0), "{solid:?} of nothing");
        }
    }
}
