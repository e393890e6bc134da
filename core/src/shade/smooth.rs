//! The interpolation filters of the software shader: normals and colours of a pixel become weighted means over the
//! neighbouring pixels that show the same surface.
//!
//! The weight of a neighbour falls with its distance in the picture, the distance of its voxel from the plane through
//! the pixel's own voxel, and the angle between the normals (a cross bilateral filter: Tomasi and Manduchi, "Bilateral
//! filtering for gray and color images", 1998). So edges stay sharp: pixels behind another surface, or round a corner,
//! have no weight.
//!
//! The neighbours are 3x3 or 5x5 samples, spaced such that the outermost is about one voxel away:
//! for a distant surface they are adjacent pixels, for a near one they are fractions of a voxel apart.
//! That turns steps from voxel to voxel into a gradual change.
//!
//! Takes the surface of each pixel, returns the means. Knows no grid and no light.

use glam::{UVec2, Vec3};
use rayon::prelude::*;

use super::light::Smoothing;
use crate::sculpture::NO_VOXEL;

/// Distance from the plane at which a neighbour's weight becomes 0, in voxels.
const PLANE_REACH_VX: f32 = 2.0;

/// The surface point of a pixel. Vectors are in eye space.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct PixelSurface {
    /// Centre of the voxel.
    pub position: Vec3,
    /// Unit length, or zero if there is none.
    pub normal: Vec3,
    /// Linear colour.
    pub colour: Vec3,
}

/// A picture of surface points.
pub(super) struct Surfaces<'a> {
    pub size: UVec2,
    /// [`NO_VOXEL`] where no voxel is visible.
    pub voxels: &'a [u32],
    pub shown: &'a [PixelSurface],
    /// Mean edge of a voxel in eye space.
    pub voxel_edge: f32,
    /// Size of a pixel at distance 1 from the eye.
    pub pixel_at_1: f32,
}

impl Surfaces<'_> {
    /// Computes the mean normals (unit length) and colours of every pixel, row by row. `normals` and `colours` select
    /// the neighbourhoods; values that are not filtered are copied.
    pub fn smooth(&self, normals: Smoothing, colours: Smoothing, out: &mut Vec<PixelSurface>) {
        out.clear();
        out.extend_from_slice(self.shown);
        let width = self.size.x as usize;
        if width == 0 {
            return;
        }
        out.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, out) in row.iter_mut().enumerate() {
                let at = UVec2::new(x as u32, y as u32);
                if self.voxels[x + y * width] == NO_VOXEL {
                    continue;
                }
                if colours == normals {
                    let mean = self.mean(at, normals);
                    (out.normal, out.colour) = (mean.normal, mean.colour);
                    continue;
                }
                if normals != Smoothing::Off {
                    out.normal = self.mean(at, normals).normal;
                }
                if colours != Smoothing::Off {
                    out.colour = self.mean(at, colours).colour;
                }
            }
        });
    }

    fn mean(&self, at: UVec2, smoothing: Smoothing) -> PixelSurface {
        let width = self.size.x as usize;
        let centre = self.shown[at.x as usize + at.y as usize * width];
        let reach = smoothing.reach();
        let step = self.step_px(-centre.position.z, reach);
        let (mut normal, mut colour, mut sum) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (x, y) = (at.x as i32 + dx * step, at.y as i32 + dy * step);
                if x < 0 || y < 0 || x >= self.size.x as i32 || y >= self.size.y as i32 {
                    continue;
                }
                let place = x as usize + y as usize * width;
                if self.voxels[place] == NO_VOXEL {
                    continue;
                }
                let other = self.shown[place];
                let weight = self.weight(&centre, &other) * tent(dx, reach) * tent(dy, reach);
                normal += other.normal * weight;
                colour += other.colour * weight;
                sum += weight;
            }
        }
        // The pixel itself always counts.
        let normal = normal.normalize_or(centre.normal);
        PixelSurface { normal, colour: colour / sum, ..centre }
    }

    /// Returns the weight of `other` beside `centre`, 0 to 1.
    fn weight(&self, centre: &PixelSurface, other: &PixelSurface) -> f32 {
        let off_vx = (other.position - centre.position).dot(centre.normal) / self.voxel_edge;
        let plane = (1.0 - (off_vx / PLANE_REACH_VX).powi(2)).max(0.0);
        // A missing normal matches all others.
        let alike = match centre.normal == Vec3::ZERO || other.normal == Vec3::ZERO {
            true => 1.0,
            false => centre.normal.dot(other.normal).max(0.0),
        };
        plane * (alike * alike) * (alike * alike)
    }

    /// Returns the distance between neighbours in pixels, such that the outermost is about one voxel away.
    fn step_px(&self, distance: f32, reach: i32) -> i32 {
        let voxel_px = self.voxel_edge / (distance.max(f32::MIN_POSITIVE) * self.pixel_at_1);
        ((voxel_px / reach as f32).round() as i32).clamp(1, 64)
    }
}

/// Returns 1 in the middle, decreasing linearly to 0 just beyond the reach.
fn tent(offset: i32, reach: i32) -> f32 {
    1.0 - offset.abs() as f32 / (reach + 1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;

    fn vec(random: &mut Random) -> Vec3 {
        Vec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0
    }

    /// Computes the definition, in f64 and with other loops.
    fn naive(surfaces: &Surfaces, at: UVec2, reach: i32) -> (Vec3, Vec3) {
        let index = |x: i32, y: i32| (x + y * surfaces.size.x as i32) as usize;
        let centre = surfaces.shown[index(at.x as i32, at.y as i32)];
        let px = surfaces.voxel_edge / (-centre.position.z * surfaces.pixel_at_1);
        let step = (px / reach as f32).round().clamp(1.0, 64.0) as i32;
        let (mut normal, mut colour, mut sum) = ([0f64; 3], [0f64; 3], 0f64);
        for place in 0..(2 * reach + 1).pow(2) {
            let (dx, dy) = (place % (2 * reach + 1) - reach, place / (2 * reach + 1) - reach);
            let (x, y) = (at.x as i32 + dx * step, at.y as i32 + dy * step);
            let inside = (0..surfaces.size.x as i32).contains(&x)
                && (0..surfaces.size.y as i32).contains(&y);
            if !inside || surfaces.voxels[index(x, y)] == NO_VOXEL {
                continue;
            }
            let other = surfaces.shown[index(x, y)];
            let off = f64::from((other.position - centre.position).dot(centre.normal))
                / f64::from(surfaces.voxel_edge);
            let mut weight = (1.0 - (off * 0.5).powi(2)).max(0.0);
            weight *= f64::from(centre.normal.dot(other.normal)).max(0.0).powi(4);
            for offset in [dx, dy] {
                weight *= 1.0 - f64::from(offset.abs()) / f64::from(reach + 1);
            }
            sum += weight;
            for axis in 0..3 {
                normal[axis] += weight * f64::from(other.normal[axis]);
                colour[axis] += weight * f64::from(other.colour[axis]);
            }
        }
        let of = |v: [f64; 3]| Vec3::from(v.map(|c| c as f32));
        (of(normal).normalize(), of(colour.map(|c| c / sum)))
    }

    #[test]
    fn means_are_as_defined_for_each_of_the_two_filters() {
        let mut random = Random(8);
        let size = UVec2::new(40, 30);
        let count = (size.x * size.y) as usize;
        let shown: Vec<_> = (0..count)
            .map(|i| {
                // A slope with noise, so that some neighbours count and some do not.
                let base = Vec3::new((i % 40) as f32, (i / 40) as f32, -30.0);
                PixelSurface {
                    position: base * 0.1 + vec(&mut random) * 0.2,
                    normal: (Vec3::Z + vec(&mut random) * 0.8).normalize(),
                    colour: vec(&mut random).abs(),
                }
            })
            .collect();
        let voxels: Vec<u32> =
            (0..count).map(|i| if i % 7 == 3 { NO_VOXEL } else { i as u32 }).collect();
        for (voxel_edge, near, wide) in [(0.1, 1, 2), (0.5, 1, 2)] {
            let surfaces =
                Surfaces { size, voxels: &voxels, shown: &shown, voxel_edge, pixel_at_1: 0.03 };
            let mut out = Vec::new();
            surfaces.smooth(Smoothing::Near, Smoothing::Wide, &mut out);
            let mut both = Vec::new();
            surfaces.smooth(Smoothing::Wide, Smoothing::Wide, &mut both);
            for i in (0..count).filter(|&i| voxels[i] != NO_VOXEL) {
                let at = UVec2::new(i as u32 % 40, i as u32 / 40);
                let (near, wide) = (naive(&surfaces, at, near), naive(&surfaces, at, wide));
                assert!(out[i].normal.abs_diff_eq(near.0, 1e-5), "{at}");
                assert!(out[i].colour.abs_diff_eq(wide.1, 1e-5), "{at}");
                assert!(both[i].normal.abs_diff_eq(wide.0, 1e-5), "{at}");
                assert!(both[i].colour.abs_diff_eq(wide.1, 1e-5), "{at}");
            }
        }
    }

    #[test]
    fn edges_stay_and_what_is_off_stays() {
        // The left face is turned to the viewer, the right one to the side, and a third is far behind.
        let size = UVec2::new(30, 5);
        let shown: Vec<_> = (0..150)
            .map(|i| {
                let x = i % 30;
                let (normal, depth) = match x {
                    0..10 => (Vec3::Z, -10.0),
                    10..20 => (Vec3::X, -10.0),
                    _ => (Vec3::Z, -40.0),
                };
                let position = Vec3::new(x as f32 * 0.1, 0.0, depth);
                PixelSurface { position, normal, colour: Vec3::splat((x / 10) as f32) }
            })
            .collect();
        let surfaces =
            Surfaces { size, voxels: &[0; 150], shown: &shown, voxel_edge: 1.0, pixel_at_1: 0.01 };
        let mut out = Vec::new();
        surfaces.smooth(Smoothing::Wide, Smoothing::Wide, &mut out);
        assert_eq!(out, shown);
    }
}
