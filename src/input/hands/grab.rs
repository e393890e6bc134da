//! Carries the sculpture with the hands that hold it: one hand moves and rotates it rigidly, two hands rotate and scale
//! it with both points fixed to them.
//!
//! Takes poses of the gripping hands; returns the [`Similarity`] since the last call. Everything in metres of the room.

use glam::Quat;

use super::{HandSide, HandsState};
use crate::input::pace::is_plausible_step;
use crate::view::{RoomPose, Similarity};

/// Hands closer than this define no direction, in metres.
const LEAST_SPAN_M: f32 = 0.02;

/// Hands that grip, with their poses at the last call.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Grab {
    held: [Option<RoomPose>; 2],
}

impl Grab {
    /// Returns whether a hand holds the sculpture.
    pub fn is_holding(&self) -> bool {
        self.held.iter().any(Option::is_some)
    }

    /// Returns the movement of the sculpture since the last call, `dt_s` ago. `gripping`: the hands that hold it now,
    /// by [`HandSide::index`].
    pub fn step(
        &mut self,
        gripping: [bool; 2],
        state: &HandsState,
        dt_s: f64,
    ) -> Option<Similarity> {
        let now =
            HandSide::ALL.map(|side| state.hand(side).grip.filter(|_| gripping[side.index()]));
        let before = std::mem::replace(&mut self.held, now);
        // A hand counts from the call after its grip, so that nothing jumps to it or follows a jump of tracking.
        let pair = |i: usize| {
            let (from, to) = (before[i]?, now[i]?);
            is_plausible_step(from.position, to.position, dt_s).then_some((from, to))
        };
        let moved = match (pair(0), pair(1)) {
            (Some(left), Some(right)) => between(left, right),
            // The other hand has just gripped or released: this one carries on.
            (Some((from, to)), None) | (None, Some((from, to))) => Similarity::carrying(&from, &to),
            (None, None) => return None,
        };
        (moved.is_finite() && moved != Similarity::IDENTITY).then_some(moved)
    }
}

/// Returns the similarity of two hands: the change of their midpoint, direction and distance, and half of the twist of
/// each about the line between them.
fn between(left: (RoomPose, RoomPose), right: (RoomPose, RoomPose)) -> Similarity {
    let (old, new) = (right.0.position - left.0.position, right.1.position - left.1.position);
    let middle = (left.0.position + right.0.position) * 0.5;
    let to = (left.1.position + right.1.position) * 0.5;
    if old.length() < LEAST_SPAN_M || new.length() < LEAST_SPAN_M {
        return Similarity::about(middle, Quat::IDENTITY, 1.0, to);
    }
    let (from_axis, axis) = (old.normalize(), new.normalize());
    let swing = Quat::from_rotation_arc(from_axis, axis);
    let twist = |(from, to): (RoomPose, RoomPose)| {
        let turn = to.rotation * from.rotation.inverse() * swing.inverse();
        // The rotation about the axis: swing-twist decomposition.
        let along = turn.xyz().dot(axis);
        let angle = 2.0 * along.atan2(turn.w);
        // The same rotation by the smaller angle.
        (angle + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI
    };
    let twist = 0.5 * (twist(left) + twist(right));
    let rotation = (Quat::from_axis_angle(axis, twist) * swing).normalize();
    Similarity::about(middle, rotation, new.length() / old.length(), to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::hands::HandState;
    use glam::Vec3;
    use proptest::prelude::*;

    fn at(poses: [Option<RoomPose>; 2]) -> HandsState {
        HandsState {
            time_s: 0.0,
            hands: poses.map(|grip| HandState { grip, ..HandState::default() }),
        }
    }

    fn pose() -> impl Strategy<Value = RoomPose> {
        let unit = -1.0f32..1.0;
        ([unit.clone(), unit.clone(), unit.clone()], [unit.clone(), unit.clone(), unit]).prop_map(
            |(p, r)| RoomPose {
                position: Vec3::from(p) * 0.14,
                rotation: Quat::from_scaled_axis(Vec3::from(r)),
            },
        )
    }

    const BOTH: [bool; 2] = [true, true];
    /// Time between two calls, in seconds.
    const DT_S: f64 = 0.1;

    proptest! {
        #[test]
        fn points_held_by_one_hand_stay_in_it(a in pose(), b in pose(), own in pose()) {
            let mut grab = Grab::default();
            prop_assert_eq!(grab.step([true, false], &at([Some(a), None]), DT_S), None);
            let moved = grab.step([true, false], &at([Some(b), None]), DT_S)
                .unwrap_or(Similarity::IDENTITY);
            let point = a.at(own.position);
            prop_assert!(moved.apply(point).abs_diff_eq(b.at(own.position), 1e-4));
            prop_assert_eq!(moved.scale, 1.0);
        }

        /// Checks that two points under two hands stay under them.
        #[test]
        fn points_held_by_two_hands_stay_under_both(
            a in pose(), b in pose(), c in pose(), d in pose(),
        ) {
            prop_assume!(a.position.distance(b.position) > 0.1);
            prop_assume!(c.position.distance(d.position) > 0.1);
            let mut grab = Grab::default();
            grab.step(BOTH, &at([Some(a), Some(b)]), DT_S);
            let moved = grab.step(BOTH, &at([Some(c), Some(d)]), DT_S).unwrap_or(Similarity::IDENTITY);
            prop_assert!(moved.apply(a.position).abs_diff_eq(c.position, 1e-3));
            prop_assert!(moved.apply(b.position).abs_diff_eq(d.position, 1e-3));
        }

        /// Checks that hands moving as one body carry the sculpture rigidly, including its twist.
        #[test]
        fn two_hands_that_move_as_one_body_move_it_rigidly(a in pose(), b in pose(), motion in pose()) {
            prop_assume!(a.position.distance(b.position) > 0.1);
            let by = Similarity { rotation: motion.rotation, scale: 1.0, translation: motion.position };
            let carried = |p: RoomPose| RoomPose {
                position: by.apply(p.position),
                rotation: by.rotation * p.rotation,
            };
            let mut grab = Grab::default();
            grab.step(BOTH, &at([Some(a), Some(b)]), DT_S);
            let moved = grab.step(BOTH, &at([Some(carried(a)), Some(carried(b))]), DT_S)
                .unwrap_or(Similarity::IDENTITY);
            for p in [Vec3::ZERO, Vec3::X, Vec3::new(0.3, -0.4, 0.5)] {
                prop_assert!(moved.apply(p).abs_diff_eq(by.apply(p), 5e-3), "{} {}", moved.apply(p), by.apply(p));
            }
        }
    }

    #[test]
    fn releasing_and_losing_track_move_nothing() {
        let pose = |x| Some(RoomPose { position: Vec3::X * x, rotation: Quat::IDENTITY });
        let mut grab = Grab::default();
        assert_eq!(grab.step([false, true], &at([None, pose(0.0)]), DT_S), None);
        assert!(grab.is_holding());
        let moved = grab.step([false, true], &at([None, pose(0.1)]), DT_S).unwrap();
        assert!(moved.translation.abs_diff_eq(Vec3::X * 0.1, 1e-6));
        assert_eq!(grab.step([false, true], &at([None, None]), DT_S), None, "not tracked");
        assert_eq!(grab.step([false, true], &at([None, pose(0.3)]), DT_S), None, "found again");
        assert_eq!(grab.step([false, true], &at([None, pose(2.0)]), DT_S), None, "jumped");
        assert_eq!(grab.step([false, false], &at([None, pose(2.1)]), DT_S), None, "released");
        assert!(!grab.is_holding());
    }
}
