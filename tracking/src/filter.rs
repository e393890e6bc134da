//! The one-euro filter for positions and orientations: strong smoothing at low speed, little lag at high speed.
//! Takes samples with their times, gives smoothed ones and the filtered velocity.
//!
//! G. Casiez, N. Roussel, D. Vogel: "1 Euro Filter: A Simple Speed-based Low-pass Filter for Noisy Input in
//! Interactive Systems", CHI 2012. Vectors use one cutoff from the length of the velocity, so that the result does
//! not depend on the choice of axes; orientations are interpolated by slerp instead of lerp. The speed is the
//! difference of raw samples and not, as in the paper's listing, of the raw and the last smoothed sample:
//! prediction uses it too, and the latter overestimates it by the lag.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::pose::{Placement, Velocity, rotation_vector};

/// Settings of one filter.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OneEuroOptions {
    /// Cutoff at rest, Hz: lower removes more jitter.
    pub min_cutoff_hz: f64,
    /// Growth of the cutoff with speed, Hz per (m/s or rad/s): higher removes more lag.
    pub beta: f64,
    /// Cutoff for the velocity, Hz.
    pub derivative_cutoff_hz: f64,
}

impl OneEuroOptions {
    pub const POSITION: Self = Self { min_cutoff_hz: 2.0, beta: 30.0, derivative_cutoff_hz: 4.0 };
    pub const ORIENTATION: Self =
        Self { min_cutoff_hz: 2.0, beta: 10.0, derivative_cutoff_hz: 4.0 };
}

/// Returns the weight of a new sample after `dt_s` for an exponential filter with that cutoff (equations 4 and 5).
fn weight(cutoff_hz: f64, dt_s: f64) -> f64 {
    let tau_s = 1.0 / (TAU * cutoff_hz.max(1.0e-6));
    1.0 / (1.0 + tau_s / dt_s)
}

/// A sample that comes later than this after its predecessor restarts the filter, seconds.
pub const RESTART_AFTER_S: f64 = 0.5;

/// One-euro filter for a placement, with separate settings for position and orientation.
#[derive(Clone, Debug)]
pub struct PlacementFilter {
    position: OneEuroOptions,
    orientation: OneEuroOptions,
    last: Option<Last>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    raw: Placement,
    smooth: Placement,
    velocity: Velocity,
    time_s: f64,
}

impl PlacementFilter {
    pub fn new(position: OneEuroOptions, orientation: OneEuroOptions) -> Self {
        Self { position, orientation, last: None }
    }

    pub fn reset(&mut self) {
        self.last = None;
    }

    /// Filters the sample of `time_s`. Returns the smoothed placement and velocity. A sample that is not newer than the
    /// last changes nothing. `measured` is the velocity reported by the tracker itself, used instead of the difference
    /// of samples.
    pub fn step(
        &mut self,
        raw: Placement,
        measured: Option<Velocity>,
        time_s: f64,
    ) -> (Placement, Velocity) {
        let last = match self.last {
            Some(last) if time_s - last.time_s <= RESTART_AFTER_S => last,
            _ => {
                let velocity = measured.unwrap_or_default();
                self.last = Some(Last { raw, smooth: raw, velocity, time_s });
                return (raw, velocity);
            }
        };
        let dt_s = time_s - last.time_s;
        if dt_s <= 0.0 {
            return (last.smooth, last.velocity);
        }
        let velocity = measured.unwrap_or_else(|| {
            let linear = (raw.position_m - last.raw.position_m) / dt_s;
            let turn = raw.orientation * last.raw.orientation.inverse();
            let angular = rotation_vector(turn) / dt_s;
            Velocity {
                linear_m_s: last
                    .velocity
                    .linear_m_s
                    .lerp(linear, weight(self.position.derivative_cutoff_hz, dt_s)),
                angular_rad_s: last
                    .velocity
                    .angular_rad_s
                    .lerp(angular, weight(self.orientation.derivative_cutoff_hz, dt_s)),
            }
        });
        let smooth = Placement {
            position_m: self.smooth_position(last.smooth.position_m, raw, velocity, dt_s),
            orientation: self.smooth_orientation(last.smooth.orientation, raw, velocity, dt_s),
        };
        self.last = Some(Last { raw, smooth, velocity, time_s });
        (smooth, velocity)
    }

    fn smooth_position(&self, from: DVec3, raw: Placement, v: Velocity, dt_s: f64) -> DVec3 {
        let cutoff_hz = self.position.min_cutoff_hz + self.position.beta * v.linear_m_s.length();
        from.lerp(raw.position_m, weight(cutoff_hz, dt_s))
    }

    fn smooth_orientation(&self, from: DQuat, raw: Placement, v: Velocity, dt_s: f64) -> DQuat {
        let options = &self.orientation;
        let cutoff_hz = options.min_cutoff_hz + options.beta * v.angular_rad_s.length();
        from.slerp(raw.orientation, weight(cutoff_hz, dt_s)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn filter() -> PlacementFilter {
        PlacementFilter::new(OneEuroOptions::POSITION, OneEuroOptions::ORIENTATION)
    }

    fn at(x: f64) -> Placement {
        Placement { position_m: DVec3::new(x, 0.0, 0.0), orientation: DQuat::from_rotation_y(x) }
    }

    /// Returns the results of the filter for single numbers, as the reference.
    fn scalar_reference(samples: &[(f64, f64)], o: OneEuroOptions) -> Vec<f64> {
        let alpha = |fc: f64, te: f64| 1.0 / (1.0 + 1.0 / (2.0 * std::f64::consts::PI * fc) / te);
        let (mut x_hat, mut dx_hat, mut previous, mut out) = (0.0, 0.0, (0.0, 0.0), Vec::new());
        for (i, &(t, x)) in samples.iter().enumerate() {
            if i == 0 {
                x_hat = x;
            } else {
                let te = t - previous.0;
                let a_d = alpha(o.derivative_cutoff_hz, te);
                dx_hat = a_d * (x - previous.1) / te + (1.0 - a_d) * dx_hat;
                let a = alpha(o.min_cutoff_hz + o.beta * f64::abs(dx_hat), te);
                x_hat = a * x + (1.0 - a) * x_hat;
            }
            previous = (t, x);
            out.push(x_hat);
        }
        out
    }

    proptest! {
        #[test]
        fn equals_the_scalar_filter_on_one_axis(
            steps in prop::collection::vec((0.001..0.1f64, -1.0..1.0f64), 1..60),
        ) {
            let mut t = 0.0;
            let samples: Vec<_> = steps.iter().map(|&(dt, x)| { t += dt; (t, x) }).collect();
            let mut f = filter();
            let positions = scalar_reference(&samples, OneEuroOptions::POSITION);
            let angles = scalar_reference(&samples, OneEuroOptions::ORIENTATION);
            for (i, &(t, x)) in samples.iter().enumerate() {
                let (smooth, _) = f.step(at(x), None, t);
                prop_assert!((smooth.position_m.x - positions[i]).abs() < 1e-9);
                // For rotation about one axis, the quaternion filter equals the scalar one on the angle.
                let angle = rotation_vector(smooth.orientation).y;
                prop_assert!((angle - angles[i]).abs() < 1e-6, "{angle} {}", angles[i]);
            }
        }

        #[test]
        fn stays_within_the_samples(xs in prop::collection::vec(-2.0..2.0f64, 2..80)) {
            let mut f = filter();
            let low = xs.iter().copied().fold(f64::MAX, f64::min);
            let high = xs.iter().copied().fold(f64::MIN, f64::max);
            for (i, &x) in xs.iter().enumerate() {
                let (s, _) = f.step(at(x), None, i as f64 * 0.01);
                prop_assert!(s.position_m.x >= low - 1e-12 && s.position_m.x <= high + 1e-12);
                prop_assert!((s.orientation.length() - 1.0).abs() < 1e-9);
            }
        }
    }

    /// Returns noise of `rms` metres from a small linear congruential generator.
    fn noise(seed: &mut u64, size: f64) -> f64 {
        *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((*seed >> 33) as f64 / f64::from(1u32 << 30) - 1.0) * size
    }

    #[test]
    fn jitter_at_rest_falls_and_fast_motion_lags_little() {
        let (mut f, mut seed, mut sum_in, mut sum_out) = (filter(), 1, 0.0, 0.0);
        for i in 0..2000 {
            let x = noise(&mut seed, 0.001);
            let (s, _) = f.step(at(x), None, f64::from(i) * 0.01);
            if i > 100 {
                sum_in += x * x;
                sum_out += s.position_m.x * s.position_m.x;
            }
        }
        assert!(sum_out < 0.25 * sum_in, "rms {} of {}", sum_out.sqrt(), sum_in.sqrt());

        let mut f = filter();
        let mut lag_s = 0.0;
        for i in 0..200 {
            let t = f64::from(i) * 0.01;
            let (s, v) = f.step(at(t), None, t);
            lag_s = t - s.position_m.x;
            if i == 199 {
                assert!((v.linear_m_s.x - 1.0).abs() < 0.01);
                assert!((v.angular_rad_s.y - 1.0).abs() < 0.01);
            }
        }
        assert!(lag_s < 0.010, "lag at 1 m/s is {lag_s} s");
    }

    #[test]
    fn stale_samples_change_nothing_and_gaps_restart() {
        let mut f = filter();
        f.step(at(0.0), None, 1.0);
        let before = f.step(at(0.1), None, 1.01);
        assert_eq!(f.step(at(5.0), None, 1.01), before);
        assert_eq!(f.step(at(5.0), None, 0.2), before);
        assert_eq!(f.step(at(5.0), None, 3.0), (at(5.0), Velocity::default()));
    }
}
