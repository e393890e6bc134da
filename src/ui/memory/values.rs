//! Numbers in the text that is remembered: read with care, written as a person would.
//!
//! Knows neither the text nor the options that the numbers are for.

/// Returns a remembered number, or the usual one if there is none in the range: NaN is in no range.
pub fn within(value: Option<f64>, range: std::ops::RangeInclusive<f32>, usual: f32) -> f32 {
    value.map(|value| value as f32).filter(|value| range.contains(value)).unwrap_or(usual)
}

/// Returns the number as a person would write it.
pub fn neat(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
