//! Tone mapping: maps the linear light of a surface, which has no upper bound, to the 0 to 1 of a picture.
//!
//! Every curve has the form `x (a x + b) / (x (c x + d) + e)` for each channel. So shaders on the device take it as
//! five numbers and need no branch, and no mapping is the curve `x`.

use fearless_simd::{Simd, f32x16};

/// How the light of a surface becomes that of a picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneMapping {
    /// Unchanged; values above 1 are clamped.
    #[default]
    Off,
    /// The filmic curve: dark tones are lifted, bright ones fade into white. The fit of the reference rendering
    /// transform of ACES by K. Narkowicz, "ACES Filmic Tone Mapping Curve" (2015).
    Filmic,
}

/// The coefficients of a curve.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ToneCurve {
    /// `a`, `b`, `c`, `d`.
    pub factors: [f32; 4],
    /// `e`.
    pub floor: f32,
}

impl ToneMapping {
    /// All values.
    pub const ALL: [ToneMapping; 2] = [ToneMapping::Off, ToneMapping::Filmic];

    /// Returns its curve.
    pub fn curve(self) -> ToneCurve {
        match self {
            ToneMapping::Off => ToneCurve { factors: [0.0, 1.0, 0.0, 0.0], floor: 1.0 },
            ToneMapping::Filmic => ToneCurve { factors: [2.51, 0.03, 2.43, 0.59], floor: 0.14 },
        }
    }
}

impl ToneCurve {
    /// Returns the curve at `light`, which is not negative, before clamping to 1.
    #[inline(always)]
    pub(super) fn map<S: Simd>(&self, light: f32x16<S>) -> f32x16<S> {
        let [a, b, c, d] = self.factors;
        // Divisions are most of the work of shading, and this one would change nothing.
        if [a, b, c, d] == [0.0, 1.0, 0.0, 0.0] && self.floor == 1.0 {
            return light;
        }
        light * (light * a + b) / (light * (light * c + d) + self.floor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch, prelude::*};

    fn mapped(tone: ToneMapping, light: [f32; 16]) -> [f32; 16] {
        let curve = tone.curve();
        dispatch!(Level::new(), simd => {
            curve.map(f32x16::load_array_ref(simd, &light)).to_array()
        })
    }

    #[test]
    fn without_tone_mapping_light_stays_as_it_is_to_the_bit() {
        let light = std::array::from_fn(|i| 0.37 * i as f32);
        assert_eq!(mapped(ToneMapping::Off, light), light);
    }

    #[test]
    fn the_filmic_curve_rises_from_black_lifts_dark_tones_and_ends_near_white() {
        let light: [f32; 16] = std::array::from_fn(|i| 0.02 * 1.6f32.powi(i as i32));
        let found = mapped(ToneMapping::Filmic, light);
        assert!(found.is_sorted() && found[15] > 0.95 && found[15] < 1.04, "{found:?}");
        let [black, grey, white, ..] =
            mapped(ToneMapping::Filmic, std::array::from_fn(|i| [0.0, 0.18, 1.0][i.min(2)]));
        assert_eq!(black, 0.0);
        // As published: 0.18 and 1 become 0.267 and 0.804.
        assert!((grey - 0.267).abs() < 1e-3 && (white - 0.8038).abs() < 1e-3, "{grey} {white}");
    }
}
