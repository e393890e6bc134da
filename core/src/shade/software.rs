//! The software shader: from an index map, the sculpture with its normals, and lights to a picture.
//!
//! The result is RGBA with alpha 0 where no voxel is seen. Runs on all cores, without allocating.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, f32x16, i32x16, prelude::*, u32x16};
use glam::{Affine3A, UVec3};
use rayon::prelude::*;

use super::illumination::{Illumination, LANES, SurfacePoints};
use super::light::Lighting;
use super::normal_field::{NO_PAGE, PackedNormal, PlaceOfNormal, unpack_many};
use super::occlusion::{OpennessTables, corners_of, openness_of_many};
use super::pixels::Pixels;
use super::source::ShadeSource;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::{NO_VOXEL, Rgb};
use crate::surface::{IndexMap, PixelRect};

/// Rows of pixels that one parallel task shades.
const BAND_ROWS: usize = 32;
/// Width of the strips of a band: the bricks of a strip stay in the first-level cache.
const STRIP_PX: usize = 64;

/// The part of a voxel's coordinates that tells its place in its brick.
const IN_BRICK: u32 = BRICK_EDGE_VX - 1;

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
        let coords: [u32x16<S>; 3] =
            [places[0].bitcast(), places[1].bitcast(), places[2].bitcast()];
        let [x, y, z] = [coords[0].to_array(), coords[1].to_array(), coords[2].to_array()];
        let bricks = self.places.bricks(coords).to_array();
        let voxels = voxels.to_array();
        // The pixels whose voxel is not that of the one before, as it often is.
        let mut others = seen.to_bitmask() as u32;
        for lane in 1..LANES {
            others &= !(u32::from(voxels[lane] == voxels[lane - 1]) << lane);
        }
        let mut normals = self.normals(others, &bricks, [&x, &y, &z]);
        let material = self.source.material;
        let mut last = 0;
        for lane in 0..LANES {
            if others >> lane & 1 != 0 {
                let [x, y, z] = [x[lane] & IN_BRICK, y[lane] & IN_BRICK, z[lane] & IN_BRICK];
                let rgb = material.rgb(bricks[lane] as usize, local_index(x, y, z));
                last = packed(rgb);
            }
            points.colour[lane] = last;
        }
        if self.occlusion {
            self.openness(simd, others, coords, &bricks, points, tables);
        }
        if let Some(sun) = &self.illumination.sun {
            for lane in 0..LANES {
                if others >> lane & 1 != 0 {
                    let v = UVec3::new(x[lane], y[lane], z[lane]);
                    let outwards = self.source.outwards(v, PackedNormal(normals[lane] as u16));
                    points.sunlit[lane] = sun.reaching(self.source.grid, v, outwards);
                } else if lane > 0 {
                    points.sunlit[lane] = points.sunlit[lane - 1];
                }
            }
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
                let v = UVec3::new(x[lane], y[lane], z[lane]);
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

impl Shader<'_> {
    /// The packed normals of the voxels of sixteen pixels; those of `others` are looked up, the rest are as before
    /// them. In steps for all, so that the memory that one needs is waited for together with that of the others.
    #[inline(always)]
    fn normals(
        &self,
        others: u32,
        bricks: &[u32; LANES],
        [x, y, z]: [&[u32; LANES]; 3],
    ) -> [u32; LANES] {
        let field = self.source.normals;
        let mut pages = [NO_PAGE; LANES];
        for lane in 0..LANES {
            pages[lane] = field.page(bricks[lane] as usize);
        }
        let mut places = [PlaceOfNormal::NONE; LANES];
        for lane in 0..LANES {
            if others >> lane & 1 != 0 {
                let bit = x[lane] & IN_BRICK | (y[lane] & IN_BRICK) << 3;
                let layer = (z[lane] & IN_BRICK) as usize;
                places[lane] = field.pages().place_of_normal(pages[lane], layer, bit);
            }
        }
        let mut normals = [0; LANES];
        let mut last = 0;
        for lane in 0..LANES {
            if others >> lane & 1 != 0 {
                last = u32::from(field.pages().normal_at(places[lane]).0);
            }
            normals[lane] = last;
        }
        normals
    }

    /// The openness of the voxels of sixteen pixels, from the tables that are kept of their bricks, or those made
    /// here.
    #[inline(always)]
    fn openness<S: Simd>(
        &self,
        simd: S,
        others: u32,
        coords: [u32x16<S>; 3],
        bricks: &[u32; LANES],
        points: &mut SurfacePoints,
        tables: &mut OpennessTables,
    ) {
        let [x, y, z] = [coords[0].to_array(), coords[1].to_array(), coords[2].to_array()];
        let mut corners = [[0; LANES]; 8];
        let mut missing = 0;
        let mut last = [0; 8];
        for lane in 0..LANES {
            if others >> lane & 1 != 0 {
                match self.source.normals.openness(bricks[lane] as usize) {
                    Some(table) => {
                        let local = UVec3::new(x[lane], y[lane], z[lane]) & IN_BRICK;
                        last = corners_of(table, local);
                    }
                    None => missing |= 1 << lane,
                }
            }
            for (corner, value) in corners.iter_mut().zip(last) {
                corner[lane] = value;
            }
        }
        openness_of_many(simd, coords, &corners).store_array(&mut points.open);
        if missing != 0 {
            for lane in 0..LANES {
                if missing >> lane & 1 != 0 {
                    let v = UVec3::new(x[lane], y[lane], z[lane]);
                    points.open[lane] = tables.openness(self.source.grid, v);
                } else if others >> lane & 1 == 0 && lane > 0 {
                    points.open[lane] = points.open[lane - 1];
                }
            }
        }
    }
}

/// A colour as [`SurfacePoints`] takes it.
fn packed(Rgb([r, g, b]): Rgb) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

/// Coordinates of voxels from their index, and of bricks.
pub(super) struct Places {
    row: u32,
    slice: u32,
    brick_dims: UVec3,
}

impl Places {
    pub fn of(dims: UVec3) -> Places {
        let brick_dims = dims.map(|edge| edge.div_ceil(BRICK_EDGE_VX));
        Places { row: dims.x, slice: dims.x * dims.y, brick_dims }
    }

    /// The linear indices of the bricks of voxels at these coordinates.
    #[inline(always)]
    fn bricks<S: Simd>(&self, coords: [u32x16<S>; 3]) -> u32x16<S> {
        const LOG2: u32 = BRICK_EDGE_VX.trailing_zeros();
        let [x, y, z] = coords;
        (x >> LOG2) + ((y >> LOG2) + (z >> LOG2) * self.brick_dims.y) * self.brick_dims.x
    }

    /// Of voxels.
    #[inline(always)]
    pub fn coords<S: Simd>(&self, simd: S, voxels: u32x16<S>) -> [i32x16<S>; 3] {
        let (z, in_slice) = divide(simd, voxels, self.slice);
        let (y, x) = divide(simd, in_slice, self.row);
        [x.bitcast(), y.bitcast(), z.bitcast()]
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
