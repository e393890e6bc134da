//! Converts a volume to a sculpture: determines which voxels exist, and their colours.
//!
//! Works by bricks, in parallel. Memory for colours is checked before it is allocated, and allocated only for bricks in
//! which an existing voxel differs from the base colour. Knows no files.

use std::sync::atomic::{AtomicU32, Ordering};

use fearless_simd::{Level, dispatch};
use glam::UVec3;
use rayon::prelude::*;
use tracing::warn;

use super::budget::check_colour_budget;
use super::histogram::{Histogram, SampleRange};
use super::labels;
use super::options::{Colouring, Existence, ExportForm, ImportOptions};
use super::ramp::Ramp;
use super::signature::Signature;
use super::threshold;
use super::volume::{Samples, Volume};
use super::{FormatError, go_on};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::colour::{unpack8, unpack16};
use crate::sculpture::history::Contents;
use crate::sculpture::material::{MAX_PAGE_BYTES, Page, PageView};
use crate::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};
use crate::tools::pieces;

/// Number of bricks painted between two reports of progress.
const PAINT_BATCH: usize = 1 << 13;
/// RGBA voxels of this opacity or more exist.
pub(super) const OPAQUE: f64 = 128.0;
/// Fraction of the voxels below the upper end of a ramp; the rest are outliers such as metal.
pub(super) const RAMP_QUANTILE: f64 = 0.999;

pub(super) const U8: SampleRange = SampleRange::Whole { first: 0, count: 1 << 8 };
const U16: SampleRange = SampleRange::Whole { first: 0, count: 1 << 16 };
const I16: SampleRange = SampleRange::Whole { first: i16::MIN as i32, count: 1 << 16 };

/// Wraps in `Some` an expression that uses the conversion of a density from its bytes and its range of values, compiled
/// for each density type; `None` for other types.
macro_rules! with_density {
    ($samples:expr, |$value:ident, $values:ident| $body:expr) => {
        with_density!(@each $samples, $value, $values, $body,
            (U8, 1, U8, |v| f32::from(v[0])),
            (U16Le, 2, U16, |v| f32::from(u16::from_le_bytes(*v))),
            (U16Be, 2, U16, |v| f32::from(u16::from_be_bytes(*v))),
            (I16Le, 2, I16, |v| f32::from(i16::from_le_bytes(*v))),
            (I16Be, 2, I16, |v| f32::from(i16::from_be_bytes(*v))),
            (F32Le, 4, SampleRange::Any, |v| f32::from_le_bytes(*v)),
            (F32Be, 4, SampleRange::Any, |v| f32::from_be_bytes(*v)))
    };
    (@each $samples:expr, $value:ident, $values:ident, $body:expr,
        $(($name:ident, $bytes:literal, $range:expr, |$v:ident| $read:expr)),*) => {
        match $samples {
            $(Samples::$name => {
                let ($value, $values) = (|$v: &[u8; $bytes]| $read, $range);
                Some($body)
            })*
            Samples::Rgb8 | Samples::Rgba8 | Samples::Bytes(_) => None,
        }
    };
}

/// Converts a volume to a sculpture, with the axes of the file. `signature` is that of [`trusted_signature`].
pub fn to_contents(
    volume: &Volume,
    signature: Option<Signature>,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, FormatError> {
    let job = VolumeImport { volume, options, limits, signature, progress };
    let form = signature.map(|s| s.form);
    let packed = match options.colouring {
        Colouring::Packed => true,
        Colouring::Auto => form == Some(ExportForm::Packed),
        _ => false,
    };
    if packed {
        return job.packed();
    }
    match volume.samples {
        Samples::Rgb8 => job.colours(|v: &[u8; 3]| (v[0].max(v[1]).max(v[2]), *v), 1.0),
        Samples::Rgba8 => job.colours(|[r, g, b, a]: &[u8; 4]| (*a, [*r, *g, *b]), OPAQUE),
        Samples::Bytes(n) => Err(FormatError::Components(n)),
        densities => with_density!(densities, |value, values| job.densities(value, values))
            .unwrap_or(Err(FormatError::Components(densities.bytes()))),
    }
}

/// Returns the histogram of a volume of densities.
pub fn histogram(volume: &Volume) -> Option<Histogram> {
    with_density!(volume.samples, |value, values| {
        Histogram::of(volume.data.as_chunks().0, value, values)
    })
}

/// Returns the signature stored with the volume, if this program wrote it.
pub fn trusted_signature(volume: &Volume) -> Option<Signature> {
    match Signature::find(&volume.texts, volume.samples)? {
        Ok(signature) => Some(signature),
        Err(reason) => {
            warn!("the file's virtual-sculpture line is ignored: {reason}");
            None
        }
    }
}

struct VolumeImport<'a> {
    volume: &'a Volume,
    options: &'a ImportOptions,
    limits: &'a Limits,
    signature: Option<Signature>,
    progress: &'a dyn Progress,
}

impl VolumeImport<'_> {
    fn densities<const B: usize>(
        &self,
        value: impl Fn(&[u8; B]) -> f32 + Sync + Copy,
        values: SampleRange,
    ) -> Result<Contents, FormatError> {
        let own = self.signature.is_some_and(|s| s.form == ExportForm::Densities);
        let colouring = match self.options.colouring {
            Colouring::Auto if own => Colouring::None,
            chosen => chosen,
        };
        let is_plain = matches!(colouring, Colouring::Auto | Colouring::None);
        let bounds = match self.options.existence {
            Existence::Auto => own.then_some((OPAQUE, f64::INFINITY)),
            chosen => chosen.bounds(),
        };
        let depth = if colouring == Colouring::None { ColourDepth::None } else { self.depth() };
        self.check_grid()?;
        if colouring == Colouring::Labels {
            let colours = labels::colours();
            let exists = within(bounds.unwrap_or((f64::NEG_INFINITY, f64::INFINITY)), value);
            let is_label = |v: &[u8; B]| value(v) != 0.0 && exists(v);
            return self.build(depth, is_label, |v| labels::colour(&colours, value(v)));
        }
        if let (Some(bounds), true) = (bounds, is_plain) {
            return self.build(depth, within(bounds, value), |_| Rgb::STONE);
        }
        let histogram = Histogram::of(self.voxels(), value, values);
        let bounds = bounds.unwrap_or_else(|| (threshold::automatic(&histogram), f64::INFINITY));
        if is_plain {
            return self.build(depth, within(bounds, value), |_| Rgb::STONE);
        }
        let top = histogram.quantile(RAMP_QUANTILE).min(bounds.1).max(bounds.0);
        let ramp = match colouring {
            Colouring::Tissue => Ramp::tissue(bounds.0, top),
            _ => Ramp::grey(bounds.0, top),
        };
        self.build(depth, within(bounds, value), |v| ramp.colour(value(v)))
    }

    /// Colours the voxels. `of` returns the value to compare with a threshold, and the colour.
    fn colours<const B: usize>(
        &self,
        of: impl Fn(&[u8; B]) -> (u8, [u8; 3]) + Sync,
        default_threshold: f64,
    ) -> Result<Contents, FormatError> {
        let depth = match self.options.colouring {
            Colouring::None => ColourDepth::None,
            Colouring::Grey | Colouring::Tissue | Colouring::Labels => {
                let samples = self.volume.samples;
                return Err(FormatError::NotDensities {
                    colouring: self.options.colouring,
                    samples,
                });
            }
            Colouring::Auto | Colouring::Packed => self.depth(),
        };
        let bounds = self.options.existence.bounds();
        let (least, most) = bounds.unwrap_or((default_threshold, f64::INFINITY));
        let exists = |v: &[u8; B]| (least..=most).contains(&f64::from(of(v).0));
        self.build(depth, exists, |v| Rgb(of(v).1))
    }

    fn packed(&self) -> Result<Contents, FormatError> {
        if self.options.existence != Existence::Auto {
            return Err(FormatError::ThresholdOfPacked);
        }
        let depth = |own| self.options.colour_depth.unwrap_or(own);
        match self.volume.samples {
            Samples::U8 => self.build(depth(ColourDepth::Bits8), |[v]| *v != 0, |[v]| unpack8(*v)),
            Samples::U16Be => self.build(
                depth(ColourDepth::Bits16),
                |v| *v != [0; 2],
                |v| unpack16(u16::from_be_bytes(*v)),
            ),
            Samples::U16Le => self.build(
                depth(ColourDepth::Bits16),
                |v| *v != [0; 2],
                |v| unpack16(u16::from_le_bytes(*v)),
            ),
            Samples::Rgb8 => self.build(depth(ColourDepth::Bits24), |v| *v != [0; 3], |v| Rgb(*v)),
            other => Err(FormatError::NotPacked(other)),
        }
    }

    /// Returns the colour depth: the requested one, else the original one, else the greatest.
    fn depth(&self) -> ColourDepth {
        let own = self.signature.filter(|s| s.form != ExportForm::Densities);
        self.options.colour_depth.or(own.map(|s| s.colour_depth)).unwrap_or(ColourDepth::Bits24)
    }

    fn voxels<const B: usize>(&self) -> &[[u8; B]] {
        self.volume.data.as_chunks().0
    }

    fn check_grid(&self) -> Result<(), FormatError> {
        let Volume { dims, voxel_size, .. } = *self.volume;
        Ok(Grid::check(dims, voxel_size, self.limits.grid_bytes)?)
    }

    fn build<const B: usize>(
        &self,
        depth: ColourDepth,
        exists: impl Fn(&[u8; B]) -> bool + Sync,
        colour: impl Fn(&[u8; B]) -> Rgb + Sync,
    ) -> Result<Contents, FormatError> {
        let Volume { dims, voxel_size, .. } = *self.volume;
        let mut grid = Grid::new(dims, voxel_size, self.limits.grid_bytes)?;
        let base = self.signature.map_or(Rgb::STONE, |s| s.base);
        let voxels = self.voxels();
        let index = |v: UVec3| {
            v.x as usize + dims.x as usize * (v.y as usize + dims.y as usize * v.z as usize)
        };
        self.progress.begin("filling the grid");
        let layers = dims.z.div_ceil(BRICK_EDGE_VX);
        let begun = AtomicU32::new(0);
        grid.fill_bricks(|brick| {
            if self.progress.is_cancelled() {
                return Brick::EMPTY;
            }
            // Reported once per layer of bricks; layers are filled in parallel.
            if brick.x == 0 && brick.y == 0 {
                let before = begun.fetch_add(1, Ordering::Relaxed);
                self.progress.advance(before as f32 / layers as f32);
            }
            let corner = brick * BRICK_EDGE_VX;
            let room = (dims - corner).min(UVec3::splat(BRICK_EDGE_VX));
            let mut rows = [0u64; 8];
            // Plain loops, compiled once for each generation of vector instructions.
            dispatch!(Level::new(), _simd => for z in 0..room.z {
                for y in 0..room.y {
                    let start = index(corner + UVec3::new(0, y, z));
                    let row = &voxels[start..start + room.x as usize];
                    rows[z as usize] |= row_bits(row, &exists) << (8 * y);
                }
            });
            Brick::from_rows(&rows)
        });
        self.progress.end();
        go_on(self.progress)?;
        if self.options.largest_piece {
            pieces::keep_largest(&mut grid, self.limits.grid_bytes, self.progress)?;
        }
        if self.options.fill_holes {
            pieces::fill_holes(&mut grid, self.limits.grid_bytes, self.progress)?;
        }
        let material = self.paint(&grid, depth, base, &|corner, brick, page| {
            brick.for_each(|local| {
                let voxel = &voxels[index(corner + UVec3::from(local_coords(local)))];
                // A filled hole has the base colour.
                if exists(voxel) {
                    depth.write(colour(voxel), &mut page[local as usize * depth.bytes()..]);
                }
            });
        })?;
        Ok(Contents::new(grid, material))
    }

    /// Colours all existing voxels. `fill` writes the colours of the voxels of a brick, given by its lowest corner, to
    /// the packed ones of all its voxels. It is called through a pointer once per brick, so that the parallel loops are compiled once and not
    /// per voxel type.
    fn paint(
        &self,
        grid: &Grid,
        depth: ColourDepth,
        base: Rgb,
        fill: &(dyn Fn(UVec3, &Brick, &mut [u8]) + Sync),
    ) -> Result<Material, FormatError> {
        let material = Material::for_grid(grid, depth, base);
        if depth == ColourDepth::None {
            return Ok(material);
        }
        let blank = material.base_page();
        let page_of = |b: UVec3| -> Option<Page> {
            let mut buffer = [0; MAX_PAGE_BYTES];
            let colours = &mut buffer[..material.page_bytes()];
            PageView::of(&blank, depth).write_to(colours);
            fill(b * BRICK_EDGE_VX, grid.brick(b), colours);
            let page = Page::of_bytes(colours, depth);
            (page != blank).then_some(page)
        };
        let filled: Vec<UVec3> = grid.nonempty_bricks().map(|(b, _)| b).collect();
        let budget = self.limits.colour_bytes;
        if material.bytes_for_pages(filled.len() as u64, u64::MAX) > budget {
            // It may still fit, since bricks may have few colours, or none but the base colour.
            let bytes =
                |b: &UVec3| page_of(*b).map_or((0, 0), |page| (1, page.heap_bytes() as u64));
            let add = |(a, b): (u64, u64), (c, d): (u64, u64)| (a + c, b + d);
            let (pages, bytes) = filled.par_iter().map(bytes).reduce(|| (0, 0), add);
            check_colour_budget(material.bytes_for_pages(pages, bytes), budget)?;
        }
        self.progress.begin("colouring");
        let mut painted = Material::for_grid(grid, depth, base);
        for (i, batch) in filled.chunks(PAINT_BATCH).enumerate() {
            go_on(self.progress)?;
            let page = |b: &UVec3| page_of(*b).map(|page| (*b, page));
            painted.set_pages(batch.par_iter().filter_map(page).collect());
            self.progress.advance((i * PAINT_BATCH) as f32 / filled.len() as f32);
        }
        self.progress.end();
        Ok(painted)
    }
}

/// Returns whether a density lies within inclusive bounds; false for NaN.
fn within<const B: usize>(
    (least, most): (f64, f64),
    value: impl Fn(&[u8; B]) -> f32 + Sync,
) -> impl Fn(&[u8; B]) -> bool + Sync {
    // The nearest f32 inside the bounds, so that values need not be widened.
    let (low, high) = (least as f32, most as f32);
    let low = if f64::from(low) < least { low.next_up() } else { low };
    let high = if f64::from(high) > most { high.next_down() } else { high };
    move |v| {
        let value = value(v);
        (value >= low) & (value <= high)
    }
}

/// Returns one bit for each of up to eight voxels, the lowest for the first.
#[inline(always)]
fn row_bits<const B: usize>(row: &[[u8; B]], exists: &impl Fn(&[u8; B]) -> bool) -> u64 {
    let mut bytes = [0u8; 8];
    match row.first_chunk::<8>() {
        Some(row) => bytes = row.each_ref().map(|v| u8::from(exists(v))),
        None => row.iter().zip(&mut bytes).for_each(|(v, byte)| *byte = u8::from(exists(v))),
    }
    // The factor moves the lowest bit of byte i to bit 56 + i, and nothing else there.
    u64::from_le_bytes(bytes).wrapping_mul(0x0102_0408_1020_4080) >> 56
}
