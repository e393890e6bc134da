//! Owns the telling of a hand's movement from a leap of its tracking: no hand goes faster than
//! [`LIMIT_M_S`], and after a leap it is believed again once it has been calm for [`CALM_S`].
//!
//! Takes places and the time between them; gives whether they belong to one way. In metres and
//! seconds.

use glam::Vec3;

/// Faster than any hand that works, in metres a second.
const LIMIT_M_S: f32 = 6.0;
/// What a pose may be off by besides, in metres.
const SLACK_M: f32 = 0.03;
/// How long a hand must go no faster than the limit until it is believed again, in seconds.
const CALM_S: f64 = 0.1;

/// Whether a hand comes from one place to the other within `dt_s`.
pub(super) fn is_way(from: Vec3, to: Vec3, dt_s: f64) -> bool {
    from.distance(to) <= LIMIT_M_S * dt_s as f32 + SLACK_M
}

/// Follows one hand.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Pace {
    at: Option<Vec3>,
    /// Until when it is not believed, on the clock of the hands.
    doubted_until_s: f64,
}

impl Pace {
    /// Follows the hand, if it is known, to where it is now. True if it has leapt.
    pub fn step(&mut self, to: Option<Vec3>, now_s: f64, dt_s: f64) -> bool {
        let from = std::mem::replace(&mut self.at, to);
        let leapt = from.zip(to).is_some_and(|(from, to)| !is_way(from, to, dt_s));
        if leapt {
            self.doubted_until_s = now_s + CALM_S;
        }
        leapt
    }

    /// Whether its places are to be believed.
    pub fn is_calm(&self, now_s: f64) -> bool {
        now_s >= self.doubted_until_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leap_is_doubted_until_the_hand_is_calm() {
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
}
