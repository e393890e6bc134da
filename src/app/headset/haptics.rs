//! Haptic feedback of the tool hand: maps voxels changed per frame to the strength of a vibration.
//!
//! Takes times and voxel counts; knows no controllers.

use crate::input::pad::rumble::{Rumble, RumbleCurve};
use crate::screen::headset::HeadsetOptions;

/// The state of the vibration between two frames.
pub struct HapticFeedback {
    enabled: bool,
    curve: RumbleCurve,
    rumble: Rumble,
    /// The time of the last step, in seconds of the headset's clock.
    last_s: Option<f64>,
    /// Voxels that tools had changed in total at the last step.
    last_voxels: u64,
}

impl HapticFeedback {
    pub fn new(settings: &HeadsetOptions) -> HapticFeedback {
        HapticFeedback {
            enabled: settings.haptics,
            curve: settings.haptics_curve(),
            rumble: Rumble::default(),
            last_s: None,
            last_voxels: 0,
        }
    }

    /// Returns the strength, 0 to 1, to set at `now_s`; `None` where the hand neither vibrates nor did. `total_voxels`:
    /// changed by tools so far; `working`: the hand uses its tool.
    pub fn step(&mut self, now_s: f64, total_voxels: u64, working: bool) -> Option<f32> {
        let dt_s = self.last_s.replace(now_s).map_or(0.0, |last| (now_s - last).clamp(0.0, 1.0));
        let last_voxels = std::mem::replace(&mut self.last_voxels, total_voxels);
        let changed = total_voxels.saturating_sub(last_voxels);
        let felt = (self.enabled && working).then_some(changed);
        let was_shaking = self.rumble.is_shaking();
        let strength = self.rumble.step(felt, dt_s as f32, &self.curve);
        (was_shaking || strength > 0.0).then_some(strength)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_working_hand_vibrates_and_is_stopped_once() {
        let mut haptics = HapticFeedback::new(&HeadsetOptions::default());
        assert_eq!(haptics.step(0.0, 0, false), None);
        let strength = haptics.step(0.02, 2000, true).unwrap();
        assert!(strength > 0.0, "{strength}");
        let after: Vec<_> = (2..200).map(|i| haptics.step(0.02 * i as f64, 2000, false)).collect();
        let stops = after.iter().filter(|strength| **strength == Some(0.0)).count();
        assert_eq!((stops, after[197]), (1, None), "{after:?}");
    }

    #[test]
    fn edits_that_are_not_of_the_hand_are_not_felt() {
        let mut haptics = HapticFeedback::new(&HeadsetOptions::default());
        haptics.step(0.0, 0, false);
        assert_eq!(haptics.step(0.02, 5000, false), None, "an edit with the mouse");
        assert_eq!(haptics.step(0.04, 5000, true), None, "nothing since");
        let off = HeadsetOptions { haptics: false, ..HeadsetOptions::default() };
        let mut off = HapticFeedback::new(&off);
        off.step(0.0, 0, false);
        assert_eq!(off.step(0.02, 5000, true), None, "switched off");
    }
}
