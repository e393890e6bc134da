//! Removes the noise that remains in a final picture, without blurring edges.
//!
//! Takes a film, returns one with other radiances, by the edge-avoiding a-trous wavelet transform (Dammertz, Sewtz,
//! Hanika and Lensch, "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", 2010). It
//! filters the light that falls on surfaces, without their colours, so that these stay sharp. Weights fall with the
//! angle between normals, the distance from the other's plane, and the difference of light over its standard error
//! (after Schied et al., "Spatiotemporal Variance-Guided Filtering", 2017): more samples mean less filtering, and none
//! in the limit. The background has no noise and stays unchanged.

use glam::{IVec2, UVec2, Vec3};
use rayon::prelude::*;

use super::film::{Film, PixelSum, divisor, luminance};

/// The B3 spline of the transform.
const KERNEL: [f32; 5] = [1.0 / 16.0, 1.0 / 4.0, 3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];
/// Passes, each with twice the step of the one before it.
const LEVELS: u32 = 5;
/// Difference of light at which a weight is 1/e, in standard errors.
const STANDARD_ERRORS: f32 = 1.5;
/// Power of the cosine between normals.
const NORMAL_POWER: i32 = 48;
/// Relative difference of depths per pixel of distance at which a weight is 1/e.
const DEPTH_PER_PX: f32 = 0.004;

/// The light of a pixel without its colour, and the square of its standard error.
#[derive(Clone, Copy, Default)]
struct Light {
    light: Vec3,
    variance: f32,
}

/// Returns the film without noise.
pub fn denoise(film: Film) -> Film {
    let size = film.size();
    let mut lights: Vec<Light> = film.pixels().par_iter().map(without_colour).collect();
    let mut next = lights.clone();
    for level in 0..LEVELS {
        let filter = Filter { size, pixels: film.pixels(), lights: &lights, step: 1 << level };
        let width = size.x as usize;
        next.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, light) in row.iter_mut().enumerate() {
                *light = filter.at(IVec2::new(x as i32, y as i32));
            }
        });
        std::mem::swap(&mut lights, &mut next);
    }
    let coloured = |(light, pixel): (&Light, &PixelSum)| match pixel.surface > 0.0 {
        true => light.light * divisor(pixel.albedo, pixel.surface),
        false => pixel.radiance,
    };
    let radiance: Vec<Vec3> = lights.par_iter().zip(film.pixels()).map(coloured).collect();
    film.with_radiance(&radiance)
}

fn without_colour(pixel: &PixelSum) -> Light {
    let divisor = divisor(pixel.albedo, pixel.surface);
    Light { light: pixel.radiance / divisor, variance: pixel.variance }
}

struct Filter<'a> {
    size: UVec2,
    pixels: &'a [PixelSum],
    lights: &'a [Light],
    step: i32,
}

impl Filter<'_> {
    fn index(&self, at: IVec2) -> Option<usize> {
        let inside = at.cmpge(IVec2::ZERO).all() && at.cmplt(self.size.as_ivec2()).all();
        inside.then(|| at.x as usize + at.y as usize * self.size.x as usize)
    }

    fn at(&self, at: IVec2) -> Light {
        let Some(centre) = self.index(at) else { return Light::default() };
        let (pixel, here) = (&self.pixels[centre], self.lights[centre]);
        if pixel.surface == 0.0 {
            return here;
        }
        let brightness = luminance(here.light);
        let error = self.smooth_variance(at).sqrt() * STANDARD_ERRORS + 1e-4 * brightness + 1e-6;
        let (mut light, mut variance, mut sum) = (Vec3::ZERO, 0.0, 0.0);
        for (dy, ky) in (-2..=2).zip(KERNEL) {
            for (dx, kx) in (-2..=2).zip(KERNEL) {
                let offset = IVec2::new(dx, dy) * self.step;
                let Some(other) = self.index(at + offset) else { continue };
                let (other_pixel, there) = (&self.pixels[other], self.lights[other]);
                let alike = alike(pixel, other_pixel, offset);
                let differs = (luminance(there.light) - brightness).abs() / error;
                let weight = kx * ky * alike * (-differs).exp();
                light += there.light * weight;
                variance += there.variance * (weight * weight);
                sum += weight;
            }
        }
        Light { light: light / sum, variance: variance / (sum * sum) }
    }

    /// Returns the mean variance of 3x3 pixels: that of a single pixel is itself uncertain.
    fn smooth_variance(&self, at: IVec2) -> f32 {
        let (mut variance, mut sum) = (0.0, 0.0);
        for offset in (-1..=1).flat_map(|y| (-1..=1).map(move |x| IVec2::new(x, y))) {
            if let Some(other) = self.index(at + offset) {
                let weight =
                    if offset.x == 0 { 2.0 } else { 1.0 } * if offset.y == 0 { 2.0 } else { 1.0 };
                variance += self.lights[other].variance * weight;
                sum += weight;
            }
        }
        variance / sum
    }
}

/// Returns how likely two pixels show the same surface: 0 to 1.
fn alike(a: &PixelSum, b: &PixelSum, offset: IVec2) -> f32 {
    let cosine = a.normal.dot(b.normal).max(0.0)
        / (a.normal.length() * b.normal.length()).max(f32::MIN_POSITIVE);
    let covers = (1.0 - 4.0 * (a.surface - b.surface).abs()).max(0.0)
        * (1.0 - 4.0 * (a.alpha - b.alpha).abs()).max(0.0);
    if covers == 0.0 || cosine == 0.0 {
        return f32::from(offset == IVec2::ZERO);
    }
    let apart = (a.depth - b.depth).abs() / a.depth.max(b.depth).max(f32::MIN_POSITIVE);
    let slack = DEPTH_PER_PX * offset.as_vec2().length().max(1.0);
    covers * cosine.powi(NORMAL_POWER) * (-apart / slack).exp()
}
