//! Strength of rumble: maps the voxels changed per frame along a curve with a limit, and pauses after some time.

/// The curve of the strength.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RumbleCurve {
    /// Largest strength, 0 to 1.
    pub limit: f32,
    /// Voxels changed in one frame for the limit.
    pub full_voxels: f32,
    /// Longest rumble without a break, in seconds; a pause of half that time follows, against numb hands.
    pub longest_s: f32,
}

/// Seconds in which the strength fades to a third between two changes of a stroke.
const FADE_S: f32 = 0.08;
/// Strength below which motors do not turn.
const LEAST: f32 = 0.02;
/// How much faster hands recover than they tire.
const RECOVERY: f32 = 2.0;
/// Exponent of the curve, which makes even few voxels perceptible.
const EXPONENT: f32 = 0.5;

/// The state between frames.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Rumble {
    strength: f32,
    /// Seconds of rumble from which the hands have not recovered.
    tired_s: f32,
    pausing: bool,
}

impl Rumble {
    /// Returns the strength from now on, 0 to the limit. `bite`: voxels changed since the last call, `dt_s` ago; `None`
    /// while no tool is used, which stops at once.
    pub fn step(&mut self, bite: Option<u64>, dt_s: f32, curve: &RumbleCurve) -> f32 {
        let dt_s = dt_s.max(0.0);
        if self.strength > 0.0 {
            self.tired_s += dt_s;
        } else {
            self.tired_s = (self.tired_s - dt_s * RECOVERY).max(0.0);
        }
        if self.tired_s >= curve.longest_s {
            self.tired_s = curve.longest_s;
            self.pausing = true;
        }
        self.pausing &= self.tired_s > 0.0;
        self.strength = match bite {
            Some(voxels) if !self.pausing => {
                let share = (voxels as f32 / curve.full_voxels).min(1.0).powf(EXPONENT);
                (share * curve.limit).max(self.strength * (-dt_s / FADE_S).exp())
            }
            _ => 0.0,
        };
        if self.strength < LEAST {
            self.strength = 0.0;
        }
        self.strength
    }

    /// Returns whether it rumbles and must be updated.
    pub fn is_shaking(&self) -> bool {
        self.strength > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CURVE: RumbleCurve = RumbleCurve { limit: 0.8, full_voxels: 1000.0, longest_s: 2.0 };

    proptest! {
        #[test]
        fn it_never_exceeds_the_limit_nor_the_longest_time(
            bites in prop::collection::vec((prop::option::of(0u64..1 << 40), 0.001f32..0.3), 1..200),
        ) {
            let (mut rumble, mut stretch) = (Rumble::default(), 0.0f32);
            let mut before = 0.0;
            for (bite, dt_s) in bites {
                // The last strength has applied until now.
                stretch = if before > 0.0 { stretch + dt_s } else { 0.0 };
                prop_assert!(stretch <= CURVE.longest_s + 0.3 + 1e-3, "{}", stretch);
                before = rumble.step(bite, dt_s, &CURVE);
                prop_assert!((0.0..=CURVE.limit).contains(&before));
                if bite.is_none() {
                    prop_assert_eq!(before, 0.0);
                }
            }
        }

        #[test]
        fn more_voxels_are_never_felt_less(a in 0u64..3000, b in 0u64..3000) {
            let first = |voxels| Rumble::default().step(Some(voxels), 0.016, &CURVE);
            prop_assert!(first(a.min(b)) <= first(a.max(b)));
        }
    }

    #[test]
    fn it_begins_with_the_bite_fades_between_and_ends_with_the_stroke() {
        let mut rumble = Rumble::default();
        assert_eq!(rumble.step(Some(0), 0.016, &CURVE), 0.0);
        assert_eq!(rumble.step(Some(1_000_000), 0.016, &CURVE), CURVE.limit);
        let faded = rumble.step(Some(0), 0.05, &CURVE);
        assert!(faded > 0.0 && faded < CURVE.limit, "{faded}");
        assert_eq!(rumble.step(None, 0.001, &CURVE), 0.0);
        assert!(!rumble.is_shaking());
    }

    #[test]
    fn it_pauses_after_the_longest_time_and_comes_back() {
        let mut rumble = Rumble::default();
        let felt: Vec<bool> =
            (0..500).map(|_| rumble.step(Some(500), 0.01, &CURVE) > 0.0).collect();
        assert!(felt[..195].iter().all(|felt| *felt));
        assert!(felt[205..295].iter().all(|felt| !felt), "a pause of half as long");
        assert!(felt[305..495].iter().all(|felt| *felt));
    }
}
