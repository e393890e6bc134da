//! The software shader: from an index map, the sculpture with its normals, and lights to a picture.
//!
//! The result is RGBA with alpha 0 where no voxel is seen. Runs on all cores, without allocating.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, f32x16, i32x16, prelude::*, u32x16};
use glam::{Affine3A, UVec3};
use rayon::prelude::*;

use super::illumination::{Illumination, LANES, SurfacePoints};
use super::light::Lighting;
use super::normal_field::{PackedNormal, unpack_many};
use super::occlusion::OpennessTables;
use super::pixels::Pixels;
use super::source::ShadeSource;
use crate::sculpture::{NO_VOXEL, Rgb};
use crate::surface::{IndexMap, PixelRect};

/// Rows of pixels that one parallel task shades.
const BAND_ROWS: usize = 32;
/// Width of the strips of a band: the bricks of a strip stay in the first-level cache.
const STRIP_PX: usize = 64;

/// Poses of the sculpture and the eye.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ShadePose {
    /// The map from world to eye coordinates.
    pub eye_from_world: Affine3A,
    /// The map from grid coordinates (voxels) to world units.
    pub world_from_grid: Affine3A,
}

/// Shades every pixel of `map`. `out` takes the size of the map and keeps its memory.
pub fn shade(
    map: &IndexMap,
    source: &ShadeSource,
    pose: &ShadePose,
    lighting: &Lighting,
    out: &mut Pixels,
) {
    out.reset(map.rays.size);
    let rect = PixelRect::of_picture(map.rays.size);
    shade_rect(map, source, pose, lighting, rect, out);
}

/// Shades again the pixels of `rect` (cut to the picture). `out` must have the size of the map; a
/// picture of another size is shaded as a whole.
pub fn shade_rect(
    map: &IndexMap,
    source: &ShadeSource,
    pose: &ShadePose,
    lighting: &Lighting,
    rect: PixelRect,
    out: &mut Pixels,
) {
    shade_at(Level::new(), map, source, pose, lighting, rect, out);
}

/// [`shade_rect`] with a choice of vector instructions.
#[allow(clippy::too_many_arguments)]
fn shade_at(
    level: Level,
    map: &IndexMap,
    source: &ShadeSource,
    pose: &ShadePose,
    lighting: &Lighting,
    rect: PixelRect,
    out: &mut Pixels,
) {
    let picture = PixelRect::of_picture(map.rays.size);
    let rect = if out.size == map.rays.size { rect.intersect(picture) } else { picture };
    out.reset(map.rays.size);
    if rect.is_empty() {
        return;
    }
    let shader = Shader {
        source: *source,
        places: Places::of(source.grid.dims()),
        illumination: Illumination::new(lighting, &pose.eye_from_world, &pose.world_from_grid),
        occlusion: lighting.occlusion,
    };
    let width = map.rays.size.x as usize;
    let columns = rect.min.x as usize..rect.max.x as usize;
    let pixels = rect.min.y as usize * width..rect.max.y as usize * width;
    let band = width * BAND_ROWS;
    let normals = map.normals.get(pixels.clone());
    out.rgba[pixels.clone()]
        .par_chunks_mut(band)
        .zip(map.voxels[pixels].par_chunks(band))
        .enumerate()
        .for_each(|(i, (out, voxels))| {
            let normals = normals.map(|normals| &normals[i * band..][..voxels.len()]);
            let seen = Seen { voxels, normals };
            dispatch!(level, simd => shader.shade(simd, width, columns.clone(), seen, out));
        });
}

/// Pixels of an index map.
#[derive(Clone, Copy)]
struct Seen<'a> {
    voxels: &'a [u32],
    normals: Option<&'a [u16]>,
}

impl<'a> Seen<'a> {
    #[inline(always)]
    fn part(&self, range: Range<usize>) -> Seen<'a> {
        Seen {
            voxels: &self.voxels[range.clone()],
            normals: self.normals.map(|normals| &normals[range]),
        }
    }
}

/// What all pixels of a picture share.
struct Shader<'a> {
    source: ShadeSource<'a>,
    places: Places,
    illumination: Illumination,
    occlusion: bool,
}

/// What one task works with.
#[derive(Default)]
struct Scratch {
    points: SurfacePoints,
    tables: OpennessTables,
}

impl Shader<'_> {
    /// Shades some columns of rows of pixels, sixteen at a time.
    #[inline(always)]
    fn shade<S: Simd>(
        &self,
        simd: S,
        width: usize,
        columns: Range<usize>,
        seen: Seen,
        out: &mut [[u8; 4]],
    ) {
        let mut scratch = Scratch::default();
        for left in columns.clone().step_by(STRIP_PX) {
            let strip = left..columns.end.min(left + STRIP_PX);
            for (y, out) in out.chunks_exact_mut(width).enumerate() {
                let row = seen.part(y * width + strip.start..y * width + strip.end);
                let (voxels, rest) = row.voxels.as_chunks();
                let (out, out_rest) = out[strip.clone()].as_chunks_mut();
                let normals = |i: usize| row.normals.map(|normals| &normals[i * LANES..]);
                for (i, (voxels, out)) in voxels.iter().zip(out).enumerate() {
                    *out = self.shade_few(simd, voxels, normals(i), &mut scratch);
                }
                if !rest.is_empty() {
                    let own = normals(voxels.len());
                    let mut voxels = [NO_VOXEL; LANES];
                    voxels[..rest.len()].copy_from_slice(rest);
                    let pixels = self.shade_few(simd, &voxels, own, &mut scratch);
                    out_rest.copy_from_slice(&pixels[..rest.len()]);
                }
            }
        }
    }

    /// Shades sixteen pixels. `own`: normals of their own, which the voxels' stand in for where there is none.
    #[inline(always)]
    fn shade_few<S: Simd>(
        &self,
        simd: S,
        voxels: &[u32; LANES],
        own: Option<&[u16]>,
        Scratch { points, tables }: &mut Scratch,
    ) -> [[u8; 4]; LANES] {
        let voxels = u32x16::load_array_ref(simd, voxels);
        let seen = voxels.simd_ne(NO_VOXEL);
        if !seen.any_true() {
            return [[0; 4]; LANES];
        }
        // Lanes without a voxel are computed as if they saw the first one.
        let nothing = u32x16::splat(simd, 0);
        let places = self.places.coords(simd, seen.select(voxels, nothing));
        for (place, position) in places.iter().zip(&mut points.position) {
            (place.to_float::<f32x16<S>>() + 0.5).store_array(position);
        }
        let [x, y, z] = places.map(|axis| axis.to_array());
        let voxels = voxels.to_array();
        let mut normals = [0; LANES];
        let mut last = NO_VOXEL;
        for lane in 0..LANES {
            let voxel = voxels[lane];
            if voxel == last && lane > 0 {
                // Neighbouring pixels often show the same voxel.
                normals[lane] = normals[lane - 1];
                points.colour[lane] = points.colour[lane - 1];
                points.open[lane] = points.open[lane - 1];
                points.sunlit[lane] = points.sunlit[lane - 1];
            } else if voxel != NO_VOXEL {
                let v = UVec3::new(x[lane] as u32, y[lane] as u32, z[lane] as u32);
                let (normal, rgb) = self.source.surface(v);
                normals[lane] = u32::from(normal.0);
                points.colour[lane] = packed(rgb);
                if self.occlusion {
                    points.open[lane] = tables.openness(self.source.grid, v);
                }
                if let Some(sun) = &self.illumination.sun {
                    let outwards = self.source.outwards(v, normal);
                    points.sunlit[lane] = sun.reaching(self.source.grid, v, outwards);
                }
            }
            last = voxel;
        }
        for (normal, own) in normals.iter_mut().zip(own.unwrap_or_default()) {
            if *own != PackedNormal::NONE.0 {
                *normal = u32::from(*own);
            }
        }
        let normals = u32x16::load_array(simd, normals);
        for (component, out) in unpack_many(simd, normals).iter().zip(&mut points.gradient) {
            component.store_array(out);
        }
        let none = normals.simd_eq(u32::from(PackedNormal::NONE.0));
        if none.any_true() {
            for lane in (0..LANES).filter(|lane| none.to_bitmask() >> lane & 1 != 0) {
                let v = UVec3::new(x[lane] as u32, y[lane] as u32, z[lane] as u32);
                let estimate = self.source.estimate(v).to_array();
                for (axis, component) in estimate.into_iter().enumerate() {
                    points.gradient[axis][lane] = component;
                }
            }
        }
        let colours = seen.select(self.illumination.shade(simd, points), nothing);
        bytemuck::cast(colours.to_array().map(u32::to_le))
    }
}

/// A colour as [`SurfacePoints`] takes it.
fn packed(Rgb([r, g, b]): Rgb) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

/// Coordinates of voxels from their index.
struct Places {
    row: u32,
    slice: u32,
}

impl Places {
    fn of(dims: UVec3) -> Places {
        Places { row: dims.x, slice: dims.x * dims.y }
    }

    #[inline(always)]
    fn coords<S: Simd>(&self, simd: S, voxels: u32x16<S>) -> [i32x16<S>; 3] {
        let (z, in_slice) = divide(simd, voxels, self.slice);
        let (y, x) = divide(simd, in_slice, self.row);
        [x, y, z].map(|v| v.bitcast())
    }
}

/// Quotient and remainder. The quotient must be below 2^20 and the divisor below 2^30: then the
/// quotient by floating point is at most one off.
#[inline(always)]
fn divide<S: Simd>(simd: S, value: u32x16<S>, divisor: u32) -> (u32x16<S>, u32x16<S>) {
    let zero = u32x16::splat(simd, 0);
    let one = u32x16::splat(simd, 1);
    let by = u32x16::splat(simd, divisor);
    let guess = (value.to_float::<f32x16<S>>() * (1.0 / divisor as f32)).to_int::<u32x16<S>>();
    let rest = value - guess * by;
    let too_high = rest.simd_ge(1 << 31);
    let guess = guess - too_high.select(one, zero);
    let rest = rest + too_high.select(by, zero);
    let too_low = rest.simd_ge(by);
    (guess + too_low.select(one, zero), rest - too_low.select(by, zero))
}

#[cfg(test)]
mod tests;
