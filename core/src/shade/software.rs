//! The software shader: from an index map, the sculpture with its normals, and lights to a picture.
//!
//! The result is RGBA with alpha 0 where no voxel is visible. Runs on all cores, without allocating.

use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch, f32x16, i32x16, prelude::*, u32x16};
use glam::{Affine3A, UVec3};
use rayon::prelude::*;

use super::illumination::{Illumination, LANES, SurfacePoints};
use super::light::Lighting;
use super::mask_tint::mask_tint;
use super::normal_field::{NO_PAGE, PackedNormal, SurfaceRecord, unpack_many};
use super::occlusion::OpennessTables;
use super::pixels::Pixels;
use super::shadow::ShadowSun;
use super::source::ShadeSource;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_index};
use crate::sculpture::material::PageReader;
use crate::sculpture::{ColourDepth, Grid, NO_VOXEL, Rgb};
use crate::surface::{IndexMap, PixelRect, VoxelNumbering};

/// Rows of pixels that one parallel task shades.
const BAND_ROWS: usize = 32;
/// Width of the strips of a band: the bricks of a strip stay in the first-level cache.
const STRIP_PX: usize = 64;

/// The distance between the pixels that are sampled to find the bricks of a strip.
const SAMPLE_STEP_PX: usize = STRIP_PX / LANES;

/// The bits of a voxel's coordinates that give its position in its brick.
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

/// Reshades the pixels of `rect` (cut to the picture). `out` must have the size of the map; a picture of another size
/// is shaded as a whole.
pub fn shade_rect(
    map: &IndexMap,
    source: &ShadeSource,
    pose: &ShadePose,
    lighting: &Lighting,
    rect: PixelRect,
    out: &mut Pixels,
) {
    Shader::new(map, source, pose, lighting).shade_rect(Level::new(), rect, out);
}

/// Pixels of an index map.
#[derive(Clone, Copy)]
struct IndexPixels<'a> {
    voxels: &'a [u32],
    normals: Option<&'a [u16]>,
}

impl<'a> IndexPixels<'a> {
    #[inline(always)]
    fn part(&self, range: Range<usize>) -> IndexPixels<'a> {
        IndexPixels {
            voxels: &self.voxels[range.clone()],
            normals: self.normals.map(|normals| &normals[range]),
        }
    }
}

/// The data that all pixels of a picture share.
struct Shader<'a> {
    source: ShadeSource<'a>,
    map: &'a IndexMap,
    places: VoxelPlaces<'a>,
    /// The size in leaves, by which the table of normals numbers bricks.
    leaf_dims: UVec3,
    illumination: Illumination,
    occlusion: bool,
    /// Whether any voxel may have a visible colour of its own.
    has_colours: bool,
    /// The colour of all others.
    base: u32,
    /// The voxels that are shown as protected, and the depth of their colours.
    tinted: Option<(&'a Grid, ColourDepth)>,
}

/// The data looked up for sixteen pixels.
#[derive(Default)]
struct PixelLookups {
    /// In the grid.
    coords: [[u32; LANES]; 3],
    /// The numbers of their bricks in the table of normals.
    entries: [u32; LANES],
    /// In their brick: `x + 8 y + 64 z`.
    locals: [u32; LANES],
    /// [`SurfaceRecord`]s.
    records: [u32; LANES],
    points: SurfacePoints,
}

impl PixelLookups {
    fn coords(&self, lane: usize) -> UVec3 {
        UVec3::from(self.coords.each_ref().map(|axis| axis[lane]))
    }
}

/// The buffers of one task.
#[derive(Default)]
struct StripScratch {
    /// A row of a strip.
    row: [PixelLookups; STRIP_PX / LANES],
    tables: OpennessTables,
}

impl<'a> Shader<'a> {
    fn new(
        map: &'a IndexMap,
        source: &ShadeSource<'a>,
        pose: &ShadePose,
        lighting: &Lighting,
    ) -> Shader<'a> {
        let illumination = Illumination::new(lighting, &pose.eye_from_world, &pose.world_from_grid);
        Shader {
            source: *source,
            has_colours: illumination.colour.is_none() && source.material.page_count() > 0,
            base: packed(illumination.colour.unwrap_or(source.material.base())),
            tinted: source.mask.map(|mask| (mask, source.colours(illumination.colour).depth())),
            map,
            places: VoxelPlaces::of(&map.numbering),
            leaf_dims: source.normals.table().leaf_dims(),
            illumination,
            occlusion: lighting.occlusion,
        }
    }

    /// Performs [`shade_rect`] with selected vector instructions.
    fn shade_rect(&self, level: Level, rect: PixelRect, out: &mut Pixels) {
        let map = self.map;
        let picture = PixelRect::of_picture(map.rays.size);
        let rect = if out.size == map.rays.size { rect.intersect(picture) } else { picture };
        out.reset(map.rays.size);
        if rect.is_empty() {
            return;
        }
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
                let seen = IndexPixels { voxels, normals };
                dispatch!(level, simd => self.shade(simd, width, columns.clone(), seen, out));
            });
    }
}

impl Shader<'_> {
    /// Shades some columns of rows of pixels, strip by strip.
    #[inline(always)]
    fn shade<S: Simd>(
        &self,
        simd: S,
        width: usize,
        columns: Range<usize>,
        seen: IndexPixels,
        out: &mut [[u8; 4]],
    ) {
        let mut scratch = StripScratch::default();
        for left in columns.clone().step_by(STRIP_PX) {
            let strip = left..columns.end.min(left + STRIP_PX);
            self.fetch(simd, width, strip.clone(), seen.voxels);
            for (y, out) in out.chunks_exact_mut(width).enumerate() {
                let row = seen.part(y * width + strip.start..y * width + strip.end);
                let out = &mut out[strip.clone()];
                if let Ok(voxels) = row.voxels.try_into() {
                    self.shade_row(simd, voxels, row.normals, &mut scratch, out);
                } else {
                    let mut voxels = [NO_VOXEL; STRIP_PX];
                    voxels[..out.len()].copy_from_slice(row.voxels);
                    self.shade_row(simd, &voxels, row.normals, &mut scratch, out);
                }
            }
        }
    }

    /// Prefetches the memory for a strip of a band, all at once: the pixels' own look-ups depend on each other. Uses
    /// sampled pixels, which meet most bricks. Has no effect on the picture.
    #[inline(always)]
    fn fetch<S: Simd>(&self, simd: S, width: usize, strip: Range<usize>, voxels: &[u32]) {
        let field = self.source.normals;
        let (table, pages) = (field.table(), field.pages());
        let mut wanted = [NO_PAGE; BAND_ROWS / SAMPLE_STEP_PX * LANES];
        let rows = voxels.chunks_exact(width).step_by(SAMPLE_STEP_PX);
        for (row, wanted) in rows.zip(wanted.chunks_exact_mut(LANES)) {
            let mut samples = [0; LANES];
            let row = row[strip.clone()].iter().step_by(SAMPLE_STEP_PX);
            for (sample, voxel) in samples.iter_mut().zip(row) {
                *sample = if *voxel == NO_VOXEL { 0 } else { *voxel };
            }
            let coords = self.places.coords(simd, u32x16::load_array(simd, samples));
            let bricks = self.entries(coords.map(|axis| axis.bitcast())).to_array();
            for (brick, wanted) in bricks.into_iter().zip(wanted) {
                *wanted = table.page_of_entry(brick);
            }
        }
        std::hint::black_box(pages.fetch(&wanted));
    }

    /// Shades the pixels of a row that see `voxels`; the last ones may be beyond `out`. `own`: normals of the pixels;
    /// those of the voxels replace missing ones. Performs each step for all pixels, so that their memory accesses
    /// overlap.
    #[inline(always)]
    fn shade_row<S: Simd>(
        &self,
        simd: S,
        voxels: &[u32; STRIP_PX],
        own: Option<&[u16]>,
        StripScratch { row, tables }: &mut StripScratch,
        out: &mut [[u8; 4]],
    ) {
        let (groups, _) = voxels.as_chunks::<LANES>();
        let mut seen = [0; STRIP_PX / LANES];
        for ((voxels, found), seen) in groups.iter().zip(row.iter_mut()).zip(&mut seen) {
            let voxels = u32x16::load_array_ref(simd, voxels);
            let exist = voxels.simd_ne(NO_VOXEL);
            *seen = exist.to_bitmask() as u32;
            if *seen != 0 {
                self.locate(simd, exist.select(voxels, u32x16::splat(simd, 0)), found);
            }
        }
        let field = self.source.normals;
        let (table, records) = (field.table(), field.pages().records());
        for (found, _) in row.iter_mut().zip(seen).filter(|(_, seen)| *seen != 0) {
            for lane in 0..LANES {
                let page = table.page_of_entry(found.entries[lane]);
                found.records[lane] = records.at(page, found.locals[lane]).0;
            }
        }
        let mut reader = self.source.material.reader();
        for (i, out) in out.chunks_mut(LANES).enumerate() {
            let (voxels, found) = (&groups[i], &mut row[i]);
            if seen[i] == 0 {
                out.fill([0; 4]);
                continue;
            }
            if self.has_colours {
                self.colours(found, &mut reader);
            }
            if let Some((mask, depth)) = self.tinted {
                tint(mask, depth, found);
            }
            if self.occlusion {
                self.openness(simd, seen[i], found, tables);
            }
            if let Some(sun) = &self.illumination.sun {
                self.sunlight(sun, seen[i], voxels, found);
            }
            self.normals(simd, seen[i], own.map(|own| &own[LANES * i..]), found);
            let exist = u32x16::load_array_ref(simd, voxels).simd_ne(NO_VOXEL);
            let colours = self.illumination.shade(simd, &found.points);
            let colours = exist.select(colours, u32x16::splat(simd, 0)).to_array().map(u32::to_le);
            let pixels: &[[u8; 4]; LANES] = bytemuck::cast_ref(&colours);
            out.copy_from_slice(&pixels[..out.len()]);
        }
    }

    /// Computes the coordinates of voxels.
    #[inline(always)]
    fn locate<S: Simd>(&self, simd: S, voxels: u32x16<S>, found: &mut PixelLookups) {
        let places = self.places.coords(simd, voxels);
        for (place, position) in places.iter().zip(&mut found.points.position) {
            (place.to_float::<f32x16<S>>() + 0.5).store_array(position);
        }
        let [x, y, z]: [u32x16<S>; 3] =
            [places[0].bitcast(), places[1].bitcast(), places[2].bitcast()];
        for (axis, coords) in [x, y, z].iter().zip(&mut found.coords) {
            axis.store_array(coords);
        }
        self.entries([x, y, z]).store_array(&mut found.entries);
        let local = (x & IN_BRICK) | (y & IN_BRICK) << 3 | (z & IN_BRICK) << 6;
        local.store_array(&mut found.locals);
        found.points.colour = [self.base; LANES];
    }

    /// Returns the numbers of the bricks of voxels at these coordinates in the table of normals
    /// ([`PageTable::page_of_entry`](super::normal_field::PageTable::page_of_entry)).
    #[inline(always)]
    fn entries<S: Simd>(&self, [x, y, z]: [u32x16<S>; 3]) -> u32x16<S> {
        let leaf = (x >> 6) + ((y >> 6) + (z >> 6) * self.leaf_dims.y) * self.leaf_dims.x;
        // The order of voxels in a brick, with bricks in their place.
        let octant = (x >> 5 & 1) | (y >> 5 & 1) << 1 | (z >> 5 & 1) << 2;
        let within = (x >> 3 & 3) | (y >> 3 & 3) << 2 | (z >> 3 & 3) << 4;
        leaf << 9 | octant << 6 | within
    }

    /// Looks up the colours of voxels that have their own.
    #[inline(always)]
    fn colours(&self, found: &mut PixelLookups, reader: &mut PageReader) {
        let (mut last, mut page) = (u32::MAX, None);
        for lane in 0..LANES {
            if found.entries[lane] != last {
                last = found.entries[lane];
                page = reader.page(found.coords(lane) / BRICK_EDGE_VX);
            }
            if let Some(page) = page {
                let [x, y, z] = [0, 3, 6].map(|bit| found.locals[lane] >> bit & IN_BRICK);
                found.points.colour[lane] = packed(page.rgb(local_index(x, y, z)));
            }
        }
    }

    /// Computes the share of ambient light that reaches the voxels of the lanes `seen`.
    #[inline(always)]
    fn openness<S: Simd>(
        &self,
        simd: S,
        seen: u32,
        found: &mut PixelLookups,
        tables: &mut OpennessTables,
    ) {
        let records = u32x16::load_array_ref(simd, &found.records);
        let open = (records >> SurfaceRecord::OPENNESS).to_float::<f32x16<S>>() * (1.0 / 255.0);
        open.store_array(&mut found.points.open);
        // Voxels within the solid, and those of a sculpture that has just been opened.
        let missing = records.simd_eq(SurfaceRecord::NONE.0).to_bitmask() as u32 & seen;
        for lane in bits(missing) {
            found.points.open[lane] = tables.openness(self.source.grid, found.coords(lane));
        }
    }

    /// Computes the share of the sun's light that reaches the voxels of the lanes `seen`.
    #[inline(always)]
    fn sunlight(
        &self,
        sun: &ShadowSun,
        seen: u32,
        voxels: &[u32; LANES],
        found: &mut PixelLookups,
    ) {
        for lane in bits(seen) {
            found.points.sunlit[lane] = if lane > 0 && voxels[lane] == voxels[lane - 1] {
                found.points.sunlit[lane - 1]
            } else {
                let (v, record) = (found.coords(lane), SurfaceRecord(found.records[lane]));
                sun.reaching(self.source.grid, v, self.source.outwards(v, record.normal()))
            };
        }
    }

    /// Looks up the normals of pixels or of their voxels.
    #[inline(always)]
    fn normals<S: Simd>(&self, simd: S, seen: u32, own: Option<&[u16]>, found: &mut PixelLookups) {
        let none = u32::from(PackedNormal::NONE.0);
        let mut normals = u32x16::load_array_ref(simd, &found.records) & 0xFFFF;
        if let Some(own) = own {
            let mut of_pixels = [none; LANES];
            for (normal, own) in of_pixels.iter_mut().zip(own) {
                *normal = u32::from(*own);
            }
            let of_pixels = u32x16::load_array(simd, of_pixels);
            normals = of_pixels.simd_eq(none).select(normals, of_pixels);
        }
        for (component, out) in unpack_many(simd, normals).iter().zip(&mut found.points.gradient) {
            component.store_array(out);
        }
        for lane in bits(normals.simd_eq(none).to_bitmask() as u32 & seen) {
            let estimate = self.source.estimate(found.coords(lane)).to_array();
            for (axis, component) in estimate.into_iter().enumerate() {
                found.points.gradient[axis][lane] = component;
            }
        }
    }
}

/// Tints the colours of protected voxels.
#[inline(always)]
fn tint(mask: &Grid, depth: ColourDepth, found: &mut PixelLookups) {
    for lane in 0..LANES {
        let [x, y, z] = [0, 3, 6].map(|bit| found.locals[lane] >> bit & IN_BRICK);
        if mask.brick(found.coords(lane) / BRICK_EDGE_VX).get(x, y, z) {
            let [r, g, b, _] = found.points.colour[lane].to_le_bytes();
            let shown = mask_tint(Rgb([r, g, b]), found.coords(lane));
            found.points.colour[lane] = packed(depth.quantise(shown));
        }
    }
}

/// Returns the set bits of a mask, in ascending order.
#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (bit < 32).then_some(bit)
    })
}

/// Returns a colour in the form of [`SurfacePoints`].
fn packed(Rgb([r, g, b]): Rgb) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

/// Converts the numbers of an index map to the coordinates of their voxels.
pub(super) enum VoxelPlaces<'a> {
    Linear { row: u32, slice: u32 },
    Listed(&'a VoxelNumbering),
}

impl VoxelPlaces<'_> {
    pub fn of(numbering: &VoxelNumbering) -> VoxelPlaces<'_> {
        match numbering.linear_dims() {
            Some(dims) => VoxelPlaces::Linear { row: dims.x, slice: dims.x * dims.y },
            None => VoxelPlaces::Listed(numbering),
        }
    }

    /// Returns the coordinates of voxels; any of the grid, or of none, for [`NO_VOXEL`].
    #[inline(always)]
    pub(crate) fn coords<S: Simd>(&self, simd: S, voxels: u32x16<S>) -> [i32x16<S>; 3] {
        match *self {
            VoxelPlaces::Linear { row, slice } => {
                let (z, in_slice) = divide(simd, voxels, slice);
                let (y, x) = divide(simd, in_slice, row);
                [x.bitcast(), y.bitcast(), z.bitcast()]
            }
            VoxelPlaces::Listed(numbering) => {
                let places = listed(numbering, &voxels.to_array());
                places.map(|axis| i32x16::load_array(simd, axis))
            }
        }
    }
}

/// Looks up the coordinates of voxels, by axis.
#[inline(never)]
fn listed(numbering: &VoxelNumbering, voxels: &[u32; LANES]) -> [[i32; LANES]; 3] {
    let mut places = [[0; LANES]; 3];
    for (lane, &voxel) in voxels.iter().enumerate() {
        let voxel = numbering.coords(voxel);
        for (axis, places) in places.iter_mut().enumerate() {
            places[lane] = voxel[axis] as i32;
        }
    }
    places
}

/// Returns quotient and remainder. The quotient must be below 2^20 and the divisor below 2^30: then the floating-point
/// quotient is at most one off.
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
