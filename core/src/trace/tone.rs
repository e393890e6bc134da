//! Maps linear light to the values of a screen.
//!
//! Khronos PBR Neutral tone mapping (Khronos Group, 2024) without its correction for reflections, since surfaces are
//! matt: light up to 0.8 stays unchanged, brighter light is compressed below white and slowly loses its hue. So the
//! colours of the sculpture are shown unchanged.
//!
//! A denoised picture changes so slowly over ground and sky that the steps of 8 bits would show as rings around the
//! sculpture. So values are dithered: a pattern of the pixels decides whether they are rounded up or down, and its mean
//! over some pixels is the value.

use glam::Vec3;
use rayon::prelude::*;

use super::film::Film;
use crate::shade::Pixels;

/// The light above which it is compressed.
const START_COMPRESSION: f32 = 0.8;
/// The rate at which very bright light turns white.
const DESATURATION: f32 = 0.15;

/// Returns the picture for a screen, opaque; `exposure_ev` doubles the light with each unit.
pub fn display_pixels(film: &Film, exposure_ev: f32) -> Pixels {
    display_with_gain(film, exposure_ev.exp2())
}

/// Performs [`display_pixels`] on a film that still has the sums of `samples` samples.
pub fn preview_pixels(film: &Film, samples: u32, exposure_ev: f32) -> Pixels {
    display_with_gain(film, exposure_ev.exp2() / samples.max(1) as f32)
}

fn display_with_gain(film: &Film, gain: f32) -> Pixels {
    let mut pixels = Pixels::new(film.size());
    let width = film.size().x.max(1) as usize;
    let rows = pixels.rgba.par_chunks_mut(width).zip(film.pixels().par_chunks(width));
    rows.enumerate().for_each(|(y, (out, row))| {
        for (x, (rgba, pixel)) in out.iter_mut().zip(row).enumerate() {
            let rounding = rounding(x, y);
            let level = |linear| (srgb_level(linear) + rounding) as u8;
            let [r, g, b] = neutral(pixel.radiance * gain).to_array().map(level);
            *rgba = [r, g, b, 255];
        }
    });
    pixels
}

/// Returns the dither offset added to the value of a pixel before it is truncated: 0 to 1, evenly distributed among
/// neighbouring pixels (Jimenez, "Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014: interleaved
/// gradient noise).
fn rounding(x: usize, y: usize) -> f32 {
    (52.982_918 * (0.067_110_56 * x as f32 + 0.005_837_15 * y as f32).fract()).fract()
}

/// Maps light of any strength to 0 to 1.
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

/// Converts a linear value to sRGB, 0 to 255, by the curve of IEC 61966-2-1.
fn srgb_level(linear: f32) -> f32 {
    let v = match linear <= 0.003_130_8 {
        true => linear * 12.92,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    };
    v.clamp(0.0, 1.0) * 255.0
}

#[cfg(test)]
mod tests {
    use super::super::film::PixelSum;
    use super::super::linear::linear_colour;
    use super::*;
    use crate::sculpture::Rgb;
    use glam::UVec2;

    #[test]
    fn colours_come_back_and_light_is_compressed_evenly() {
        for value in 0..=255 {
            let [linear, ..] = linear_colour(Rgb::new(value, 0, 0)).to_array();
            assert_eq!((srgb_level(linear) + 0.5) as u8, value);
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

    /// Light that grows by two levels over a picture grows evenly, without steps that would be visible as rings.
    #[test]
    fn gentle_slopes_of_light_have_no_steps() {
        let size = UVec2::new(512, 64);
        let light = |x: u32| 0.2 + 0.004 * x as f32 / size.x as f32;
        let pixel =
            |i: u32| PixelSum { radiance: Vec3::splat(light(i % size.x)), ..PixelSum::default() };
        let film = Film::of_sums(size, (0..size.element_product()).map(pixel).collect(), 1);
        let pixels = display_pixels(&film.unwrap(), 0.0);
        let mut means = Vec::new();
        for left in (0..size.x).step_by(32) {
            let block = (0..size.y).flat_map(|y| (left..left + 32).map(move |x| (x, y)));
            let sum: f32 =
                block.map(|(x, y)| f32::from(pixels.rgba[(x + y * size.x) as usize][0])).sum();
            let mean = sum / (32 * size.y) as f32;
            let exact = srgb_level(light(left + 16));
            assert!((mean - exact).abs() < 0.1, "{left}: {mean}, not {exact}");
            means.push(mean);
        }
        assert!(means.is_sorted() && means[15] > means[0] + 1.0, "{means:?}");
    }
}
