//! Numbers in the remembered text: read with validation, written in short form.
//!
//! Knows neither the text nor the options.

/// Returns a remembered number if it is in the range, or else the default. NaN is in no range.
pub fn within(value: Option<f64>, range: std::ops::RangeInclusive<f32>, usual: f32) -> f32 {
    value.map(|value| value as f32).filter(|value| range.contains(value)).unwrap_or(usual)
}

/// Returns the number in its short decimal form.
pub fn neat(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}
