//! Converts colours to linear light, by a table of the sRGB curve.
//!
//! Knows no light and no picture.

use glam::Vec3;

use crate::sculpture::Rgb;

/// Converts sRGB to linear.
pub(super) fn linear_colour(Rgb(channels): Rgb) -> Vec3 {
    Vec3::from(channels.map(|value| LINEAR[usize::from(value)]))
}

/// The linear values of sRGB values, by the curve of IEC 61966-2-1.
static LINEAR: std::sync::LazyLock<[f32; 256]> = std::sync::LazyLock::new(|| {
    std::array::from_fn(|value| {
        let value = value as f64 / 255.0;
        let linear = match value <= 0.040_45 {
            true => value / 12.92,
            false => ((value + 0.055) / 1.055).powf(2.4),
        };
        linear as f32
    })
});
