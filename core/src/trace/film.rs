//! The film of a final picture: the sums of samples, pixel by pixel, then their means.
//!
//! Takes the samples of each pixel in order; returns linear light and the auxiliary values for filters and other
//! programs: colour, normal and position of the surface, coverage, and the uncertainty of the light. Knows no rays.

use glam::{UVec2, Vec3};
use rayon::prelude::*;

use super::scene::PathVertex;

/// The most pixels of a final picture: 8192x8192.
pub const MAX_PIXELS: u64 = 1 << 26;

/// The least albedo as a divisor of light.
const LEAST_ALBEDO: f32 = 0.01;

/// One sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    radiance: Vec3,
    albedo: Vec3,
    normal: Vec3,
    /// Depth along the eye's axis, in the world; 0 for the background.
    depth: f32,
    /// 1 if any surface is visible.
    surface: f32,
    /// 1 if the sculpture is visible.
    alpha: f32,
}

impl Sample {
    pub fn background(radiance: Vec3) -> Sample {
        let zero = Vec3::ZERO;
        Sample { radiance, albedo: zero, normal: zero, depth: 0.0, surface: 0.0, alpha: 0.0 }
    }

    pub(crate) fn of_surface(
        surface: &PathVertex,
        radiance: Vec3,
        depth: f32,
        alpha: f32,
    ) -> Sample {
        let PathVertex { albedo, normal, .. } = *surface;
        Sample { radiance, albedo, normal, depth, surface: 1.0, alpha }
    }
}

/// The samples of a pixel: sums, then means.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PixelSum {
    /// Linear light, Rec. 709.
    pub radiance: Vec3,
    /// Share of light that the surface reflects; 0 for the background.
    pub albedo: Vec3,
    /// Mean normal in the world, shorter where normals differ; 0 for the background.
    pub normal: Vec3,
    /// Depth along the eye's axis, in world units, of the surface only.
    pub depth: f32,
    /// Share of the samples that meet sculpture or ground.
    pub surface: f32,
    /// Share of the samples that meet the sculpture.
    pub alpha: f32,
    /// Mean luminance of the light before it is multiplied by colours.
    pub light: f32,
    /// The square of the standard error of `light`.
    pub variance: f32,
}

/// Returns the luminance of linear light.
pub(super) fn luminance(light: Vec3) -> f32 {
    light.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Returns the divisor of radiance that yields the light that falls on a surface. Background counts as white.
pub(super) fn divisor(albedo: Vec3, surface: f32) -> Vec3 {
    (albedo + (1.0 - surface)).max(Vec3::splat(LEAST_ALBEDO))
}

impl PixelSum {
    pub(super) fn add(&mut self, sample: &Sample) {
        self.radiance += sample.radiance;
        self.albedo += sample.albedo;
        self.normal += sample.normal;
        self.depth += sample.depth;
        self.surface += sample.surface;
        self.alpha += sample.alpha;
        let light = luminance(sample.radiance / divisor(sample.albedo, sample.surface));
        self.light += light;
        self.variance += light * light;
    }

    fn close(&mut self, count: u32) {
        let share = 1.0 / count as f32;
        let depth = if self.surface > 0.0 { self.depth / self.surface } else { 0.0 };
        self.radiance *= share;
        self.albedo *= share;
        self.normal *= share;
        self.depth = depth;
        self.surface *= share;
        self.alpha *= share;
        self.light *= share;
        let squared = self.light * self.light;
        let spread = self.variance * share - squared;
        // A single sample tells nothing about others.
        self.variance = if count > 1 { spread.max(0.0) / (count - 1) as f32 } else { squared };
    }
}

/// A final picture in linear light.
#[derive(Clone, PartialEq, Debug)]
pub struct Film {
    size: UVec2,
    pixels: Vec<PixelSum>,
}

impl Film {
    /// Returns an empty film; `None` for more than [`MAX_PIXELS`], or none.
    pub(super) fn new(size: UVec2) -> Option<Film> {
        let count = u64::from(size.x) * u64::from(size.y);
        let pixels =
            (1..=MAX_PIXELS).contains(&count).then(|| vec![PixelSum::default(); count as usize])?;
        Some(Film { size, pixels })
    }

    /// Returns the film of sums of `samples` samples each from another tracer. `None` unless there is one for each
    /// pixel.
    pub fn of_sums(size: UVec2, pixels: Vec<PixelSum>, samples: u32) -> Option<Film> {
        let count = u64::from(size.x) * u64::from(size.y);
        (pixels.len() as u64 == count).then(|| {
            let mut film = Film { size, pixels };
            film.close(samples);
            film
        })
    }

    /// Returns the width and height in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Returns the pixels row by row from the top.
    pub fn pixels(&self) -> &[PixelSum] {
        &self.pixels
    }

    /// Returns the film with another radiance in each pixel.
    pub(super) fn with_radiance(mut self, radiance: &[Vec3]) -> Film {
        self.pixels.iter_mut().zip(radiance).for_each(|(pixel, light)| pixel.radiance = *light);
        self
    }

    pub(super) fn par_rows_mut(
        &mut self,
    ) -> impl IndexedParallelIterator<Item = (u32, &mut [PixelSum])> {
        let rows = self.pixels.par_chunks_mut(self.size.x as usize).enumerate();
        rows.map(|(y, row)| (y as u32, row))
    }

    /// Converts the sums of `count` samples to means.
    pub(super) fn close(&mut self, count: u32) {
        self.pixels.par_iter_mut().for_each(|pixel| pixel.close(count));
    }
}
