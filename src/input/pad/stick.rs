//! Maps stick deflection to speed: a round dead zone around the centre, then a curve.

use glam::Vec2;

/// The response of sticks and triggers.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Response {
    /// Radius of the dead zone as a share of the travel, 0 to below 1: sticks do not return to
    /// their exact centre.
    pub dead_zone: f32,
    /// Exponent from travel outside of the dead zone to speed: 1 is linear, more gives finer control of slow movements.
    pub curve: f32,
}

impl Response {
    /// Returns the speed of a stick, of length 0 to 1, in the direction of its push. It starts at 0 at the edge of the
    /// dead zone, without a jump. A diagonal push is no faster than a straight one.
    pub fn speed(&self, stick: Vec2) -> Vec2 {
        let deflection = stick.length();
        if !deflection.is_finite() || deflection <= self.dead_zone {
            return Vec2::ZERO;
        }
        stick / deflection * self.shaped(deflection)
    }

    /// Returns the speed of a trigger, 0 to 1, from its travel 0 to 1.
    pub fn pull(&self, deflection: f32) -> f32 {
        if deflection > self.dead_zone { self.shaped(deflection) } else { 0.0 }
    }

    fn shaped(&self, deflection: f32) -> f32 {
        let behind = (deflection.min(1.0) - self.dead_zone) / (1.0 - self.dead_zone);
        behind.max(0.0).powf(self.curve)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn response() -> impl Strategy<Value = Response> {
        (0.0f32..0.9, 0.25f32..5.0).prop_map(|(dead_zone, curve)| Response { dead_zone, curve })
    }

    fn at(angle: f32, deflection: f32) -> Vec2 {
        Vec2::from_angle(angle) * deflection
    }

    proptest! {
        #[test]
        fn the_dead_zone_gives_exactly_nothing(
            response in response(), angle in -4.0f32..4.0, share in 0.0f32..0.999,
        ) {
            let deflection = response.dead_zone * share;
            prop_assert_eq!(response.speed(at(angle, deflection)), Vec2::ZERO);
            prop_assert_eq!(response.pull(deflection), 0.0);
        }

        #[test]
        fn farther_is_never_slower_and_full_is_full(
            response in response(), angle in -4.0f32..4.0, a in 0.0f32..1.5, b in 0.0f32..1.5,
        ) {
            let (less, more) = (a.min(b), a.max(b));
            let speed = |deflection| response.speed(at(angle, deflection)).length();
            prop_assert!(speed(less) <= speed(more) + 1e-5);
            prop_assert!(speed(more) <= 1.0 + 1e-5);
            prop_assert!((speed(1.2) - 1.0).abs() < 1e-5);
            prop_assert!(response.pull(less) <= response.pull(more));
        }

        #[test]
        fn speed_is_the_same_in_all_directions_and_along_the_push(
            response in response(), one in -4.0f32..4.0, other in -4.0f32..4.0, deflection in 0.0f32..1.0,
        ) {
            let (a, b) = (response.speed(at(one, deflection)), response.speed(at(other, deflection)));
            prop_assert!((a.length() - b.length()).abs() < 2e-3, "{} {}", a, b);
            prop_assert!(a.perp_dot(at(one, 1.0)).abs() < 1e-4 && a.dot(at(one, 1.0)) >= 0.0);
        }

        /// Checks that motion starts at 0, and a small step of the stick is a small step of speed.
        #[test]
        fn nothing_jumps(
            dead_zone in 0.0f32..0.9, curve in 1.0f32..5.0, angle in -4.0f32..4.0, deflection in 0.0f32..1.0,
        ) {
            let response = Response { dead_zone, curve };
            let step = 1e-3;
            let speed = |deflection| response.speed(at(angle, deflection)).length();
            // The slope is at most that at the end of the curve.
            let most = curve / (1.0 - dead_zone) * step;
            prop_assert!(speed(deflection + step) - speed(deflection) <= most * 1.01 + 1e-4);
            prop_assert!(speed(dead_zone + 1e-4) <= 1e-4 / (1.0 - dead_zone) + 1e-5);
        }
    }

    #[test]
    fn a_broken_stick_stands_still() {
        let response = Response { dead_zone: 0.1, curve: 2.0 };
        assert_eq!(response.speed(Vec2::NAN), Vec2::ZERO);
        assert_eq!(response.speed(Vec2::splat(f32::INFINITY)), Vec2::ZERO);
        assert_eq!(response.pull(f32::NAN), 0.0);
    }
}
