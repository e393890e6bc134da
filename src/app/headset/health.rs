//! The health of a session: whether it shows pictures, and whether its runtime still answers.
//!
//! Takes the time since the last answer; knows no session.

use std::time::Duration;

/// A runtime that shows pictures hangs if it does not answer for this long.
const HANG: Duration = Duration::from_secs(1);

#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SessionHealth {
    /// Pictures are visible.
    showing: bool,
    /// The runtime has stopped answering.
    unresponsive: bool,
}

impl SessionHealth {
    pub fn is_showing(&self) -> bool {
        self.showing
    }

    /// Records a frame. Returns true if the runtime had stopped answering before.
    pub fn note_frame(&mut self, visible: bool) -> bool {
        self.showing = visible;
        std::mem::take(&mut self.unresponsive)
    }

    /// Detects a hanging runtime from the time since its last answer. Returns true once each time.
    pub fn check(&mut self, since_answer: Duration) -> bool {
        let hangs = self.showing && since_answer >= HANG;
        if hangs {
            *self = SessionHealth { showing: false, unresponsive: true };
        }
        hangs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_runtime_that_hangs_is_noted_once_and_comes_back() {
        let mut health = SessionHealth::default();
        assert!(!health.check(HANG * 10), "nothing is shown yet");
        assert!(!health.note_frame(true) && health.is_showing());
        assert!(!health.check(HANG / 2) && health.is_showing());
        assert!(health.check(HANG) && !health.is_showing());
        assert!(!health.check(HANG * 2), "it is known");
        assert!(health.note_frame(true) && health.is_showing());
        assert!(!health.note_frame(true));
    }

    #[test]
    fn a_headset_that_is_taken_off_may_be_silent() {
        let mut health = SessionHealth::default();
        health.note_frame(false);
        assert!(!health.check(HANG * 10));
    }
}
