//! From linear light to the values of a screen, and from colours to linear light.
//!
//! Khronos PBR Neutral tone mapping (Khronos Group, 2024) without its correction for reflections, since surfaces are
//! matt: light up to 0.8 stays as it is, brighter light is compressed below white and slowly loses its hue. So the
//! colours of the sculpture are seen as they are.

use glam::Vec3;
use rayon::prelude::*;

use super::film::Film;
use crate::sculpture::Rgb;
use crate::shade::Pixels;

/// The light from which on it is compressed.
const START_COMPRESSION: f32 = 0.8;
/// How fast very bright light turns white.
const DESATURATION: f32 = 0.15;

/// The picture for a screen, opaque; `exposure_ev` doubles the light with each unit.
pub fn display_pixels(film: &Film, exposure_ev: f32) -> Pixels {
    display_with_gain(film, exposure_ev.exp2())
}

/// [`display_pixels`] of a film that still has the sums of `samples` samples.
pub fn preview_pixels(film: &Film, samples: u32, exposure_ev: f32) -> Pixels {
    display_with_gain(film, exposure_ev.exp2() / samples.max(1) as f32)
}

fn display_with_gain(film: &Film, gain: f32) -> Pixels {
    let mut pixels = Pixels::new(film.size());
    pixels.rgba.par_iter_mut().zip(film.pixels().par_iter()).for_each(|(rgba, pixel)| {
        let [r, g, b] = neutral(pixel.radiance * gain).to_array().map(srgb);
        *rgba = [r, g, b, 255];
    });
    pixels
}

/// Light of any strength to 0 to 1.
fn neutral(light: Vec3) -> Vec3 {
    let light = light.max(Vec3::ZERO);
    let peak = light.max_element();
    if peak < START_COMPRESSION {
        return light;
    }
    let rest = 1.0 - START_COMPRESSION;
    let new_peak = 1.0 - rest * rest / (peak + rest - START_COMPRESSION);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (light * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}

/// The sRGB value of a linear one, by the curve of IEC 61966-2-1.
fn srgb(linear: f32) -> u8 {
    let v = match linear <= 0.003_130_8 {
        true => linear * 12.92,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    };
    (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// sRGB to linear.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_and_light_is_compressed_evenly() {
        for value in 0..=255 {
            let [linear, ..] = linear_colour(Rgb::new(value, 0, 0)).to_array();
            assert_eq!(srgb(linear), value);
        }
        let mut last = 0.0;
        for step in 1..400 {
            let light = step as f32 * 0.05;
            let [r, g, b] = neutral(Vec3::splat(light)).to_array();
            assert!(r > last && r < 1.0 && r == g && g == b, "{light}: {r}");
            assert!(light > START_COMPRESSION || r == light);
            last = r;
        }
        // Very bright light is white, whatever its colour.
        let glare = neutral(Vec3::new(900.0, 600.0, 300.0));
        assert!(glare.min_element() > 0.97, "{glare}");
    }
}
