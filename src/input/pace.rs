//! Detects jumps of tracking: nothing held or worn by a person moves faster than [`LIMIT_M_S`].
//!
//! [`Pace`] follows a hand, which is trusted again once it has been below the limit for [`CALM_S`]; [`ViewPace`]
//! follows the tracked viewpoint of a window. Takes positions and times, in metres and seconds; knows no tools.

use glam::Vec3;

/// Faster than any hand at work, in metres per second.
const LIMIT_M_S: f32 = 6.0;
/// Tolerance for noise of a pose, in metres.
const SLACK_M: f32 = 0.03;
/// Time below the limit after which a hand is trusted again, in seconds.
const CALM_S: f64 = 0.1;
/// Longest counted pause between two poses, in seconds.
pub const LONGEST_STEP_S: f64 = 0.1;

/// Returns whether a hand or a head can move between the positions within `dt_s`. False for a position that is not
/// finite.
pub fn is_plausible_step(from: Vec3, to: Vec3, dt_s: f64) -> bool {
    from.distance(to) <= LIMIT_M_S * dt_s as f32 + SLACK_M
}

/// Follows one hand.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Pace {
    at: Option<Vec3>,
    /// End of the distrust, on the clock of the hands.
    doubted_until_s: f64,
}

impl Pace {
    /// Moves to the hand's present position, if it is tracked. Returns true if it has jumped.
    pub fn step(&mut self, to: Option<Vec3>, now_s: f64, dt_s: f64) -> bool {
        let from = std::mem::replace(&mut self.at, to);
        let jumped = from.zip(to).is_some_and(|(from, to)| !is_plausible_step(from, to, dt_s));
        if jumped {
            self.doubted_until_s = now_s + CALM_S;
        }
        jumped
    }

    /// Returns whether its positions can be trusted.
    pub fn is_calm(&self, now_s: f64) -> bool {
        now_s >= self.doubted_until_s
    }
}

/// The source of a tracked viewpoint.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TrackingSource {
    /// The camera, relative to the printed marker before it.
    Camera,
    /// The head, relative to the screen.
    Head,
}

/// Follows the tracked viewpoint of a window.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ViewPace {
    /// The last position that differed from the one before, and its time: poses come less often than updates.
    last: Option<(TrackingSource, Vec3, f64)>,
}

impl ViewPace {
    /// Moves to the present viewpoint, if it is tracked. Returns true if the change is not a movement: it has jumped,
    /// was lost or found, or its source has changed.
    pub fn step(&mut self, to: Option<(TrackingSource, Vec3)>, now_s: f64) -> bool {
        let Some((kind, to)) = to else { return self.last.take().is_some() };
        let Some((former, from, since_s)) = self.last else {
            self.last = Some((kind, to, now_s));
            return true;
        };
        if (former, from) == (kind, to) {
            return false;
        }
        self.last = Some((kind, to, now_s));
        let dt_s = (now_s - since_s).clamp(0.0, LONGEST_STEP_S);
        former != kind || !is_plausible_step(from, to, dt_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_that_jumped_is_not_trusted_until_it_is_slow() {
        let mut pace = Pace::default();
        let dt_s = 1.0 / 64.0;
        assert!(!pace.step(Some(Vec3::X), 1.0, dt_s), "it has only just been found");
        assert!(!pace.step(Some(Vec3::X * 1.09), 1.0 + dt_s, dt_s), "5.8 m/s");
        assert!(pace.is_calm(1.0 + dt_s));
        assert!(pace.step(Some(Vec3::X * 2.0), 1.1, dt_s));
        assert!(!pace.step(Some(Vec3::X * 2.0), 1.15, dt_s) && !pace.is_calm(1.15));
        // There and back.
        assert!(pace.step(Some(Vec3::X), 1.18, dt_s));
        assert!(!pace.is_calm(1.25));
        assert!(pace.is_calm(1.18 + CALM_S));
        assert!(!pace.step(None, 1.3, dt_s) && !pace.step(Some(Vec3::ZERO), 1.4, dt_s), "lost");
    }

    #[test]
    fn jumps_and_losses_of_a_viewpoint_are_not_movements() {
        let mut pace = ViewPace::default();
        let camera = |x: f32| Some((TrackingSource::Camera, Vec3::X * x));
        assert!(!pace.step(None, 0.0), "never tracked");
        assert!(pace.step(camera(0.0), 1.0), "found");
        assert!(!pace.step(camera(0.1), 1.033), "3 m/s");
        // Updates without a new pose do not shorten its time.
        assert!((1..8).all(|i| !pace.step(camera(0.1), 1.033 + 0.008 * f64::from(i))));
        assert!(!pace.step(camera(0.4), 1.1));
        assert!(pace.step(camera(0.9), 1.133), "15 m/s");
        assert!(pace.step(camera(3.0), 9.0), "a pause does not allow a jump");
        assert!(pace.step(camera(f32::NAN), 9.033) && pace.step(camera(3.0), 9.067));
        assert!(pace.step(Some((TrackingSource::Head, Vec3::X * 3.0)), 9.1), "another one");
        assert!(pace.step(None, 9.2) && !pace.step(None, 9.3), "lost");
    }
}
