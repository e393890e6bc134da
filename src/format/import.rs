//! Owns how a volume becomes a sculpture: which voxels exist and what colours they get.
//!
//! Works brick by brick in parallel. Memory for colours is counted before it is taken, and taken
//! only for bricks in which an existing voxel differs from the base colour. Knows no files.

use glam::UVec3;
use rayon::prelude::*;
use tracing::warn;

use super::FormatError;
use super::histogram::Histogram;
use super::options::{Colouring, Existence, ExportForm, ImportOptions};
use super::ramp::Ramp;
use super::signature::Signature;
use super::threshold;
use super::volume::{Samples, Volume};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::colour::{unpack8, unpack16};
use crate::sculpture::history::Contents;
use crate::sculpture::material::Page;
use crate::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};

/// Bricks painted between two reports.
const PAINT_BATCH: usize = 1 << 13;
/// RGBA voxels of this opacity or more exist.
const OPAQUE: f64 = 128.0;
/// Share of the voxels below the brightest end of a ramp; the rest are outliers such as metal.
const RAMP_QUANTILE: f64 = 0.999;

/// Makes a sculpture of a volume.
pub fn to_contents(
    volume: &Volume,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Contents, FormatError> {
    let signature = trusted_signature(volume);
    let job = Job { volume, options, limits, signature, progress };
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
        Samples::U8 => job.densities(|[v]| f32::from(*v), true),
        Samples::U16Le => job.densities(|v| f32::from(u16::from_le_bytes(*v)), true),
        Samples::U16Be => job.densities(|v| f32::from(u16::from_be_bytes(*v)), true),
        Samples::I16Le => job.densities(|v| f32::from(i16::from_le_bytes(*v)), true),
        Samples::I16Be => job.densities(|v| f32::from(i16::from_be_bytes(*v)), true),
        Samples::F32Le => job.densities(|v| f32::from_le_bytes(*v), false),
        Samples::F32Be => job.densities(|v| f32::from_be_bytes(*v), false),
        Samples::Bytes(n) => Err(FormatError::Components(n)),
    }
}

/// The histogram of a volume of densities.
pub fn histogram(volume: &Volume) -> Option<Histogram> {
    fn of<const B: usize>(
        volume: &Volume,
        value: impl Fn(&[u8; B]) -> f32 + Sync,
        whole: bool,
    ) -> Option<Histogram> {
        Some(Histogram::of(volume.data.as_chunks().0, value, whole))
    }
    match volume.samples {
        Samples::U8 => of(volume, |[v]| f32::from(*v), true),
        Samples::U16Le => of(volume, |v| f32::from(u16::from_le_bytes(*v)), true),
        Samples::U16Be => of(volume, |v| f32::from(u16::from_be_bytes(*v)), true),
        Samples::I16Le => of(volume, |v| f32::from(i16::from_le_bytes(*v)), true),
        Samples::I16Be => of(volume, |v| f32::from(i16::from_be_bytes(*v)), true),
        Samples::F32Le => of(volume, |v| f32::from_le_bytes(*v), false),
        Samples::F32Be => of(volume, |v| f32::from_be_bytes(*v), false),
        Samples::Rgb8 | Samples::Rgba8 | Samples::Bytes(_) => None,
    }
}

/// What this program noted when it wrote the volume.
pub fn trusted_signature(volume: &Volume) -> Option<Signature> {
    match Signature::find(&volume.texts, volume.samples)? {
        Ok(signature) => Some(signature),
        Err(reason) => {
            warn!("the file's virtual-sculpture line is ignored: {reason}");
            None
        }
    }
}

struct Job<'a> {
    volume: &'a Volume,
    options: &'a ImportOptions,
    limits: &'a Limits,
    signature: Option<Signature>,
    progress: &'a dyn Progress,
}

impl Job<'_> {
    fn densities<const B: usize>(
        &self,
        value: impl Fn(&[u8; B]) -> f32 + Sync + Copy,
        whole: bool,
    ) -> Result<Contents, FormatError> {
        let own = self.signature.is_some_and(|s| s.form == ExportForm::Densities);
        let colouring = match self.options.colouring {
            Colouring::Auto if own => Colouring::None,
            Colouring::Auto => Colouring::Grey,
            chosen => chosen,
        };
        let depth = if colouring == Colouring::None { ColourDepth::None } else { self.depth() };
        self.check_grid()?;
        let histogram = Histogram::of(self.voxels(), value, whole);
        let threshold = match self.options.existence {
            Existence::Threshold(threshold) => threshold,
            Existence::Auto if own => OPAQUE,
            Existence::Auto => threshold::automatic(&histogram),
        };
        let top = histogram.quantile(RAMP_QUANTILE).max(threshold);
        let ramp = match colouring {
            Colouring::Tissue => Ramp::tissue(threshold, top),
            _ => Ramp::grey(threshold, top),
        };
        let exists = |v: &[u8; B]| f64::from(value(v)) >= threshold;
        self.build(depth, exists, |v| ramp.colour(value(v)))
    }

    /// `of` gives what is compared with a threshold, and the colour.
    fn colours<const B: usize>(
        &self,
        of: impl Fn(&[u8; B]) -> (u8, [u8; 3]) + Sync,
        default_threshold: f64,
    ) -> Result<Contents, FormatError> {
        let depth = match self.options.colouring {
            Colouring::None => ColourDepth::None,
            Colouring::Grey | Colouring::Tissue => {
                let samples = self.volume.samples;
                return Err(FormatError::NotDensities {
                    colouring: self.options.colouring,
                    samples,
                });
            }
            Colouring::Auto | Colouring::Packed => self.depth(),
        };
        let threshold = match self.options.existence {
            Existence::Auto => default_threshold,
            Existence::Threshold(threshold) => threshold,
        };
        self.build(depth, |v| f64::from(of(v).0) >= threshold, |v| Rgb(of(v).1))
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

    /// Bits of colour as asked for, else as they were, else all.
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
        grid.fill_bricks(|brick| {
            let corner = brick * BRICK_EDGE_VX;
            let room = (dims - corner).min(UVec3::splat(BRICK_EDGE_VX));
            let mut rows = [0u64; 8];
            for z in 0..room.z {
                for y in 0..room.y {
                    let start = index(corner + UVec3::new(0, y, z));
                    let row = &voxels[start..start + room.x as usize];
                    let bits = row.iter().enumerate().map(|(x, v)| u64::from(exists(v)) << x);
                    rows[z as usize] |= bits.fold(0, |a, b| a | b) << (8 * y);
                }
            }
            Brick::from_rows(&rows)
        });
        self.progress.end();
        let material = self.paint(&grid, depth, base, |v| colour(&voxels[index(v)]))?;
        Ok(Contents { grid, material })
    }

    /// Gives every existing voxel the colour that `colour` names for its place.
    fn paint(
        &self,
        grid: &Grid,
        depth: ColourDepth,
        base: Rgb,
        colour: impl Fn(UVec3) -> Rgb + Sync,
    ) -> Result<Material, FormatError> {
        let mut material = Material::new(depth, base, grid.bricks().len());
        if depth == ColourDepth::None {
            return Ok(material);
        }
        let blank = blank_page(&material);
        let page_of = |brick: u32| -> Option<Page> {
            let corner = grid.brick_coords(brick as usize) * BRICK_EDGE_VX;
            let mut page = blank.clone();
            grid.bricks()[brick as usize].for_each(|local| {
                let rgb = colour(corner + UVec3::from(local_coords(local)));
                depth.write(rgb, &mut page[local as usize * depth.bytes()..]);
            });
            (page != blank).then_some(page)
        };
        let filled: Vec<u32> =
            (0..grid.bricks().len() as u32).filter(|&b| grid.counts()[b as usize] > 0).collect();
        let table_bytes = (grid.bricks().len() * size_of::<Option<Page>>()) as u64;
        let bytes_of = |pages: usize| table_bytes + (pages * material.page_bytes()) as u64;
        let budget = self.limits.colour_bytes;
        if bytes_of(filled.len()) > budget {
            // It may still fit, where bricks have the base colour all over.
            let pages = filled.par_iter().filter(|b| page_of(**b).is_some()).count();
            if bytes_of(pages) > budget {
                return Err(FormatError::ColourMemory {
                    needed_mib: bytes_of(pages).div_ceil(1 << 20),
                    budget_mib: budget >> 20,
                });
            }
        }
        self.progress.begin("colouring");
        for (i, batch) in filled.chunks(PAINT_BATCH).enumerate() {
            let pages: Vec<Option<Page>> = batch.par_iter().map(|b| page_of(*b)).collect();
            for (&brick, page) in batch.iter().zip(pages) {
                if page.is_some() {
                    material.swap_page(brick as usize, page);
                }
            }
            self.progress.advance((i * PAINT_BATCH) as f32 / filled.len() as f32);
        }
        self.progress.end();
        Ok(material)
    }
}

/// A page of nothing but the base colour.
fn blank_page(material: &Material) -> Page {
    let mut page = vec![0; material.page_bytes()].into_boxed_slice();
    for colour in page.chunks_exact_mut(material.depth().bytes()) {
        material.depth().write(material.base(), colour);
    }
    page
}
