//! Blends from one guide to another (a tracker, another tracker, the rest position if there is none) without a jump.
//! Takes times and placements, gives placements; does not know the reason of a change.
//!
//! At a change, the difference between the shown placement and the new guide's is kept and decays to zero, while the
//! new guide's motion passes undelayed (inertialisation: D. Bollo, "High Performance Animation in Gears of War 4",
//! 2018, with a smoothstep in place of the quintic).

use glam::{DQuat, DVec3};

use crate::pose::{Placement, rotation_vector};

/// Durations of fades.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FadeOptions {
    /// Time for which the last placement is held after a loss, in seconds.
    pub hold_s: f64,
    /// Duration of the move to the rest position after that, seconds.
    pub leave_s: f64,
    /// Duration of the move to a live tracker, seconds.
    pub return_s: f64,
}

impl Default for FadeOptions {
    fn default() -> Self {
        Self { hold_s: 0.5, leave_s: 1.5, return_s: 0.5 }
    }
}

/// The remaining difference to the current guide.
#[derive(Clone, Copy, Debug)]
pub struct Fade {
    offset_m: DVec3,
    offset_turn: DVec3,
    start_s: f64,
    length_s: f64,
}

impl Fade {
    /// No difference: the guide is followed exactly.
    pub const DONE: Self =
        Self { offset_m: DVec3::ZERO, offset_turn: DVec3::ZERO, start_s: 0.0, length_s: 0.0 };

    /// Returns a fade over `length_s` from `shown`, at or before `start_s`, to a guide that is at `guide` then.
    pub fn start(shown: Placement, guide: Placement, start_s: f64, length_s: f64) -> Self {
        Self {
            offset_m: shown.position_m - guide.position_m,
            offset_turn: rotation_vector(shown.orientation * guide.orientation.inverse()),
            start_s,
            length_s,
        }
    }

    /// Returns the progress at `time_s`: 0 to 1, with zero slope at both ends.
    pub fn share(&self, time_s: f64) -> f64 {
        if self.length_s <= 0.0 {
            return 1.0;
        }
        let x = ((time_s - self.start_s) / self.length_s).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }

    /// Returns the placement to show at `time_s`, when the guide is at `guide`.
    pub fn place(&self, guide: Placement, time_s: f64) -> Placement {
        let left = 1.0 - self.share(time_s);
        if left == 0.0 {
            return guide;
        }
        let turn = DQuat::from_scaled_axis(self.offset_turn * left);
        Placement {
            position_m: guide.position_m + self.offset_m * left,
            orientation: (turn * guide.orientation).normalize(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn placement() -> impl Strategy<Value = Placement> {
        ([-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64], [-1.7..1.7f64, -1.7..1.7f64, -1.7..1.7f64])
            .prop_map(|(p, r)| Placement {
                position_m: DVec3::from_array(p),
                orientation: DQuat::from_scaled_axis(DVec3::from_array(r)),
            })
    }

    proptest! {
        #[test]
        fn begins_where_it_was_and_ends_at_the_guide(a in placement(), b in placement(), start in -9.0..9.0f64, length in 0.01..3.0f64) {
            let fade = Fade::start(a, b, start, length);
            let first = fade.place(b, start);
            prop_assert!(first.position_m.distance(a.position_m) < 1e-12 && first.angle_to(a) < 1e-7);
            prop_assert_eq!(fade.place(b, start + length * 1.001), b);
            prop_assert!(fade.place(b, start - 1.0).angle_to(a) < 1e-7);
        }

        #[test]
        fn never_faster_than_its_steepest_slope(a in placement(), b in placement(), length in 0.1..3.0f64) {
            let fade = Fade::start(a, b, 0.0, length);
            let dt = length / 97.0;
            let steepest = 1.5 * dt / length + 1e-9;
            for i in 0..100 {
                let t = f64::from(i) * dt;
                let (p, q) = (fade.place(b, t), fade.place(b, t + dt));
                prop_assert!(p.position_m.distance(q.position_m) <= a.position_m.distance(b.position_m) * steepest + 1e-9);
                prop_assert!(p.angle_to(q) <= a.angle_to(b) * steepest + 1e-7);
            }
        }

        #[test]
        fn opposite_orientations_do_not_flip(yaw in -0.1..0.1f64) {
            // A guide that oscillates around half a turn: a slerp would switch sides.
            let shown = Placement::IDENTITY;
            let guide = |t: f64| Placement {
                position_m: DVec3::ZERO,
                orientation: DQuat::from_rotation_y(std::f64::consts::PI + yaw + 0.2 * (7.0 * t).sin()),
            };
            let fade = Fade::start(shown, guide(0.0), 0.0, 1.0);
            for i in 0..1000 {
                let (t, u) = (f64::from(i) * 0.001, f64::from(i + 1) * 0.001);
                prop_assert!(fade.place(guide(t), t).angle_to(fade.place(guide(u), u)) < 0.008);
            }
        }
    }
}
