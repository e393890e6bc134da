//! Options of pens: the pressure curve.

use serde::Deserialize;

use crate::options::{InvalidOption, require_in};

/// Available exponents.
pub const EXPONENTS: std::ops::RangeInclusive<f32> = 0.25..=4.0;
/// Pressures that may count as full.
pub const FULL: std::ops::RangeInclusive<f32> = 0.2..=1.0;

/// Maps a tablet's pressure to that of a tool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PenCurve {
    /// 1 is linear; less strengthens a light press, more weakens it.
    pub exponent: f32,
    /// The pressure that counts as full, as a share of the tablet's range.
    pub full_at: f32,
}

impl Default for PenCurve {
    fn default() -> PenCurve {
        PenCurve { exponent: 1.0, full_at: 1.0 }
    }
}

impl PenCurve {
    /// Returns the effective pressure, 0 to 1, for a pressure of 0 to 1. It never falls as the pressure grows.
    pub fn of(&self, pressure: f32) -> f32 {
        let pressure = if pressure.is_nan() { 1.0 } else { pressure.clamp(0.0, 1.0) };
        (pressure / self.full_at.clamp(*FULL.start(), *FULL.end())).min(1.0).powf(self.exponent)
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PenOptions {
    pub curve: f32,
    pub full_at: f32,
}

impl Default for PenOptions {
    fn default() -> PenOptions {
        let PenCurve { exponent, full_at } = PenCurve::default();
        PenOptions { curve: exponent, full_at }
    }
}

impl PenOptions {
    pub fn curve(&self) -> PenCurve {
        PenCurve { exponent: self.curve, full_at: self.full_at }
    }

    pub fn check(&self) -> Result<(), InvalidOption> {
        require_in(EXPONENTS, "curve", self.curve, "must be 0.25 to 4")?;
        require_in(FULL, "full_at", self.full_at, "must be 0.2 to 1")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_from_nothing_to_all_and_bends_as_it_is_told() {
        let curves = [0.25, 1.0, 4.0].map(|exponent| PenCurve { exponent, full_at: 0.8 });
        for curve in curves {
            assert_eq!(curve.of(0.0), 0.0);
            assert_eq!([0.8, 0.9, 1.0, 7.0, f32::NAN].map(|p| curve.of(p)), [1.0; 5]);
            let values: Vec<f32> = (0..=100).map(|i| curve.of(i as f32 / 100.0)).collect();
            assert!(values.is_sorted(), "{curve:?}");
        }
        let [light, straight, heavy] = curves.map(|curve| curve.of(0.4));
        assert!(light > straight && straight > heavy);
        assert!((straight - 0.5).abs() < 1e-6);
    }
}
