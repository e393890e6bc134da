//! Prediction from the last report to the display time of a frame: constant velocity, clamped. Takes a placement, its
//! velocity and a time difference; gives a placement.

use glam::DQuat;

use crate::pose::{Placement, Velocity};

/// Limits of prediction.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PredictionOptions {
    /// Longest time, in seconds; beyond it the placement stays.
    pub max_ahead_s: f64,
    /// Longest distance, metres.
    pub max_distance_m: f64,
    /// Largest rotation, radians.
    pub max_turn_rad: f64,
}

impl Default for PredictionOptions {
    fn default() -> Self {
        Self { max_ahead_s: 0.1, max_distance_m: 0.15, max_turn_rad: 0.7 }
    }
}

/// Returns the placement `ahead_s` later (or earlier, if negative) at constant velocity. Time, distance and rotation
/// are each clamped to the options, keeping their direction.
pub fn predict(
    placement: Placement,
    velocity: Velocity,
    ahead_s: f64,
    options: &PredictionOptions,
) -> Placement {
    let dt_s = ahead_s.clamp(-options.max_ahead_s, options.max_ahead_s);
    let displacement = (velocity.linear_m_s * dt_s).clamp_length_max(options.max_distance_m);
    let turn = (velocity.angular_rad_s * dt_s).clamp_length_max(options.max_turn_rad);
    Placement {
        position_m: placement.position_m + displacement,
        orientation: (DQuat::from_scaled_axis(turn) * placement.orientation).normalize(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    fn vec3(limit: f64) -> impl Strategy<Value = DVec3> {
        [-limit..limit, -limit..limit, -limit..limit].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn exact_for_constant_velocity(
            p in vec3(2.0), r in vec3(1.5), v in vec3(1.0), w in vec3(1.0), dt in -0.08..0.08f64,
        ) {
            let start = Placement { position_m: p, orientation: DQuat::from_scaled_axis(r) };
            let velocity = Velocity { linear_m_s: v, angular_rad_s: w };
            let options = PredictionOptions { max_distance_m: 10.0, max_turn_rad: 3.0, ..Default::default() };
            let there = predict(start, velocity, dt, &options);
            prop_assert!(there.position_m.distance(p + v * dt) < 1e-12);
            let expected = DQuat::from_scaled_axis(w * dt) * start.orientation;
            prop_assert!(there.orientation.dot(expected).abs() > 1.0 - 1e-12);
            let back = predict(there, velocity, -dt, &options);
            prop_assert!(back.position_m.distance(p) < 1e-12 && back.angle_to(start) < 1e-7);
        }

        #[test]
        fn never_beyond_the_clamps(
            v in vec3(900.0), w in vec3(900.0), dt in -1.0e6..1.0e6f64,
        ) {
            let options = PredictionOptions::default();
            let there = predict(Placement::IDENTITY, Velocity { linear_m_s: v, angular_rad_s: w }, dt, &options);
            prop_assert!(there.position_m.length() <= options.max_distance_m + 1e-9);
            prop_assert!(there.angle_to(Placement::IDENTITY) <= options.max_turn_rad + 1e-9);
        }
    }

    #[test]
    fn stands_still_after_the_longest_time() {
        let v = Velocity { linear_m_s: DVec3::X, angular_rad_s: DVec3::Y };
        let o = PredictionOptions::default();
        assert_eq!(
            predict(Placement::IDENTITY, v, 0.1, &o),
            predict(Placement::IDENTITY, v, 9.0, &o)
        );
    }
}
