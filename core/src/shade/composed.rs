//! Composition without a rasterizer: a shaded picture over its background, with the depth of each pixel. The twin of
//! `shaders/composite.wgsl` and `shaders/background.frag.wgsl`, for CPU devices.
//!
//! From an index map and its shaded picture to rows of colours and depths. Runs on all cores, without allocating.

use fearless_simd::{Level, Simd, dispatch, f32x16, prelude::*, u32x16};
use glam::{Mat4, Vec3};
use rayon::prelude::*;

use super::Pixels;
use super::software::VoxelPlaces;
use crate::sculpture::NO_VOXEL;
use crate::sculpture::vectors::for_axes;
use crate::surface::{IndexMap, PixelRect};

/// Pixels that are composed at once.
const LANES: usize = 16;

/// The least number of pixels that are worth a task of their own.
const TASK_PIXELS: usize = 1 << 13;

/// A component of a direction smaller than this counts as this, as for rays.
const STANDSTILL: f32 = 1e-20;

/// A picture to compose.
#[derive(Clone, Copy, Debug)]
pub struct Composition<'a> {
    /// The visible voxels.
    pub map: &'a IndexMap,
    /// Shaded from `map`.
    pub pixels: &'a Pixels,
    /// The projection of the depths, reversed and infinite.
    pub projection: Mat4,
    /// A gradient, in sRGB from 0 to 1, from the upper to the lower edge of the picture. If `None`, the background is
    /// transparent.
    pub background: Option<[Vec3; 2]>,
    /// Interpolates the gradient in linear light, as on targets that a device encodes, rather than in sRGB.
    pub is_linear: bool,
    /// Stores the blue channel first, rather than red.
    pub is_bgra: bool,
    /// The visible rect: nothing is visible outside it.
    pub visible: PixelRect,
}

/// Sixteen pixels of a row.
struct PixelGroup<S: Simd> {
    /// Position of the first pixel in the picture.
    at: [u32; 2],
    voxels: u32x16<S>,
    /// The pixels as little-endian numbers.
    pixels: u32x16<S>,
}

impl Composition<'_> {
    /// Writes the pixels of `rect`, which lies in the picture, row by row without gaps. Depths are 0 where no voxel is
    /// visible.
    pub fn compose(&self, rect: PixelRect, colours: &mut [[u8; 4]], depths: &mut [f32]) {
        let width = rect.max.x.saturating_sub(rect.min.x) as usize;
        if width == 0 {
            return;
        }
        let (level, places) = (Level::new(), VoxelPlaces::of(&self.map.numbering));
        let task_rows = (TASK_PIXELS / width).max(1);
        let tasks = colours
            .par_chunks_mut(task_rows * width)
            .zip(depths.par_chunks_mut(task_rows * width))
            .enumerate();
        tasks.for_each(|(i, (colours, depths))| {
            let first = rect.min.y + (i * task_rows) as u32;
            let rows = colours.chunks_exact_mut(width).zip(depths.chunks_exact_mut(width));
            for (y, (colours, depths)) in (first..).zip(rows) {
                let from = [rect.min.x, y];
                dispatch!(level, simd => self.compose_row(simd, &places, from, colours, depths));
            }
        });
    }

    /// Composes the pixels of a row, starting at this one.
    #[inline(always)]
    fn compose_row<S: Simd>(
        &self,
        simd: S,
        places: &VoxelPlaces,
        [left, y]: [u32; 2],
        colours: &mut [[u8; 4]],
        depths: &mut [f32],
    ) {
        let background = self.background_of_row(y);
        let visible = self.visible;
        let seen = if visible.rows().contains(&y) { visible.min.x..visible.max.x } else { 0..0 };
        let end = left + colours.len() as u32;
        let seen = seen.start.clamp(left, end)..seen.end.clamp(left, end);
        let seen = if seen.is_empty() { left..left } else { seen };
        let [before, after] = [(seen.start - left) as usize, (seen.end - left) as usize];
        for unseen in [0..before, after..colours.len()] {
            colours[unseen.clone()].fill(background);
            depths[unseen].fill(0.0);
        }
        let first = (self.map.rays.size.x * y) as usize;
        let range = first + seen.start as usize..first + seen.end as usize;
        let (voxels, pixels) = (&self.map.voxels[range.clone()], &self.pixels.rgba[range]);
        let (colours, depths) = (&mut colours[before..after], &mut depths[before..after]);
        let background = u32::from_le_bytes(background);
        for i in (0..voxels.len()).step_by(LANES) {
            let x = seen.start + i as u32;
            let count = LANES.min(voxels.len() - i);
            // The last group of a row may be smaller.
            let (mut few_voxels, mut few_pixels) = ([NO_VOXEL; LANES], [[0; 4]; LANES]);
            few_voxels[..count].copy_from_slice(&voxels[i..i + count]);
            few_pixels[..count].copy_from_slice(&pixels[i..i + count]);
            let few_pixels: [u32; LANES] = bytemuck::cast(few_pixels);
            let group = PixelGroup {
                at: [x, y],
                voxels: u32x16::load_array(simd, few_voxels),
                pixels: u32x16::load_array(simd, few_pixels),
            };
            let (few_colours, few_depths) = self.compose_few(simd, places, group, background);
            let few_colours: [[u8; 4]; LANES] = bytemuck::cast(few_colours.to_array());
            colours[i..i + count].copy_from_slice(&few_colours[..count]);
            depths[i..i + count].copy_from_slice(&few_depths.to_array()[..count]);
        }
    }

    /// Returns the pixels' colours, as little-endian numbers, and depths.
    #[inline(always)]
    fn compose_few<S: Simd>(
        &self,
        simd: S,
        places: &VoxelPlaces,
        PixelGroup { at: [x, y], voxels, pixels }: PixelGroup<S>,
        background: u32,
    ) -> (u32x16<S>, f32x16<S>) {
        let splat = |v: f32| f32x16::splat(simd, v);
        let (background, infinite) = (u32x16::splat(simd, background), splat(0.0));
        let seen = voxels.simd_ne(NO_VOXEL);
        if !seen.any_true() {
            return (background, infinite);
        }
        let rays = &self.map.rays;
        let low = places.coords(simd, seen.select(voxels, u32x16::splat(simd, 0)));
        let centre_x = splat(x as f32 + 0.5) + f32x16::load_array(simd, IN_TURN);
        let centre_y = y as f32 + 0.5;
        let enter = for_axes(
            #[inline(always)]
            |axis| {
                let direction =
                    centre_x * rays.step_x[axis] + rays.corner[axis] + rays.step_y[axis] * centre_y;
                let standing = direction.abs().simd_lt(STANDSTILL);
                let direction = standing.select(splat(STANDSTILL), direction);
                let forward = direction.simd_gt(0.0);
                let plane =
                    low[axis].to_float::<f32x16<S>>() + forward.select(splat(0.0), splat(1.0));
                (plane - rays.origin[axis]) * (splat(1.0) / direction)
            },
        );
        let t = enter[0].max(enter[1]).max(enter[2]);
        // Clip z of a point is `z_axis.z * z + w_axis.z`; its z in eye space is -t. An eye inside the voxel sees it at
        // the near plane.
        let depth = (t * -self.projection.z_axis.z + self.projection.w_axis.z) / t;
        let depth = t.simd_gt(0.0).select(depth, splat(1.0)).max(0.0).min(1.0);
        let colours = match self.is_bgra {
            true => pixels & 0xFF00 | (pixels & 0xFF) << 16 | pixels >> 16 & 0xFF,
            false => pixels,
        };
        (seen.select(colours | 0xFF00_0000, background), seen.select(depth, infinite))
    }

    /// Returns the colour of the background in a row of pixels.
    fn background_of_row(&self, y: u32) -> [u8; 4] {
        let Some([top, bottom]) = self.background else { return [0; 4] };
        let down = (y as f32 + 0.5) / self.map.rays.size.y as f32;
        let colour = match self.is_linear {
            true => top.powf(2.2).lerp(bottom.powf(2.2), down).to_array().map(encoded),
            false => top.lerp(bottom, down).to_array(),
        };
        let [r, g, b] = colour.map(|c| (c.clamp(0.0, 1.0) * 255.0).round_ties_even() as u8);
        if self.is_bgra { [b, g, r, 255] } else { [r, g, b, 255] }
    }
}

const IN_TURN: [f32; LANES] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Encodes linear light as sRGB.
fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;
    use crate::sculpture::Placement;
    use crate::surface::raycast;
    use crate::view::Camera;
    use glam::UVec2;

    /// Compares pixel by pixel, with any part of the picture composed alone as in the whole: each pixel has the voxel's
    /// colour and the depth at which its ray enters the voxel, or the background.
    #[test]
    fn a_picture_is_composed_pixel_by_pixel() {
        let grid = scenes::cheese(61, 30, 7).unwrap();
        let world_from_grid = Placement::default().world_from_grid(grid.dims(), grid.voxel_size());
        let eye = Camera::framing(40.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(UVec2::new(101, 77));
        let rays = eye.pixel_rays(&world_from_grid);
        let mut map = IndexMap::new(rays);
        raycast::sample(&grid, &rays, &mut map);
        let rgba =
            map.voxels.iter().map(|v| (v.wrapping_mul(0x9E37_79B1) | 0xFF00_0000).to_le_bytes());
        let pixels = Pixels { size: rays.size, rgba: rgba.collect() };
        let (top, bottom) = (Vec3::new(0.1, 0.5, 0.9), Vec3::new(1.0, 0.3, 0.0));
        let visible = PixelRect { min: UVec2::new(20, 9), max: UVec2::new(83, 70) };
        for (background, is_linear, is_bgra) in [
            (None, false, false),
            (Some([top, bottom]), false, false),
            (Some([top, bottom]), true, true),
        ] {
            let composition = Composition {
                map: &map,
                pixels: &pixels,
                projection: eye.projection,
                background,
                is_linear,
                is_bgra,
                visible,
            };
            for [left, upper, right, lower] in [
                [0, 0, 101, 77],
                [30, 20, 31, 60],
                [5, 60, 60, 77],
                [0, 0, 19, 9],
                [84, 0, 101, 77],
            ] {
                let rect =
                    PixelRect { min: UVec2::new(left, upper), max: UVec2::new(right, lower) };
                let count = ((right - left) * (lower - upper)) as usize;
                let (mut colours, mut depths) = (vec![[7; 4]; count], vec![7.0; count]);
                composition.compose(rect, &mut colours, &mut depths);
                let places = (upper..lower).flat_map(|y| (left..right).map(move |x| (x, y)));
                for ((x, y), (found, depth)) in places.zip(colours.iter().zip(&depths)) {
                    let is_visible = (20..83).contains(&x) && (9..70).contains(&y);
                    let at = (x + 101 * y) as usize;
                    let [r, g, b, a] = if is_visible && map.voxels[at] != NO_VOXEL {
                        let hit = raycast::cast(&grid, rays.origin, rays.direction(x, y)).unwrap();
                        let expected = eye.projection.w_axis.z / hit.t;
                        assert!((depth / expected - 1.0).abs() < 1e-4, "{depth}, not {expected}");
                        pixels.rgba[at].map(f32::from)
                    } else {
                        assert_eq!(*depth, 0.0);
                        let down = (y as f32 + 0.5) / 77.0;
                        let light = |c: f32| if is_linear { c.powf(2.2) } else { c };
                        let srgb = |c: f32| if is_linear { encoded(c) } else { c };
                        let mix = |a, b| srgb(light(a) * (1.0 - down) + light(b) * down) * 255.0;
                        match background {
                            Some(_) => [
                                mix(top.x, bottom.x),
                                mix(top.y, bottom.y),
                                mix(top.z, bottom.z),
                                255.0,
                            ],
                            None => [0.0; 4],
                        }
                    };
                    let expected = if is_bgra { [b, g, r, a] } else { [r, g, b, a] };
                    for (found, expected) in found.iter().zip(expected) {
                        assert!((f32::from(*found) - expected).abs() <= 0.51, "{x}, {y}");
                    }
                }
            }
        }
    }
}
