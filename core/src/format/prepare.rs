//! Prepares a volume for its conversion: crops it to the requested region, and resamples it to cubic voxels.
//!
//! Takes and gives a [`Volume`] of the same sample type, or one that stays in its files. Sizes are known, and memory is checked, before anything is
//! read or allocated. Knows no file.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::budget::check_budget;
use super::options::{Colouring, Cubic, ImportOptions};
use super::scan::ScanVolume;
use super::volume::{Samples, Volume};
use super::{FormatError, go_on};
use crate::progress::Progress;

/// Edges that differ by less than this fraction are equal.
const SAME_EDGE: f32 = 1e-5;

/// Returns the size and the voxel edges of a volume of `dims` after [`prepare`].
pub fn prepared(
    dims: UVec3,
    voxel_size: Vec3,
    options: &ImportOptions,
) -> Result<(UVec3, Vec3), FormatError> {
    let dims = match options.region {
        Some(region) if region.high.cmplt(dims).all() => region.dims(),
        Some(region) => return Err(FormatError::Region { region, dims }),
        None => dims,
    };
    let edge = match options.cubic {
        Cubic::No => return Ok((dims, voxel_size)),
        Cubic::Finest => voxel_size.min_element(),
        Cubic::EdgeMm(edge) => edge,
    };
    let is_same = (voxel_size - edge).abs().max_element() <= SAME_EDGE * edge;
    // The voxel size in a header may be an invalid length; that is reported later.
    if is_same || !voxel_size.is_finite() || voxel_size.min_element() <= 0.0 {
        return Ok((dims, voxel_size));
    }
    let counts = dims.as_dvec3() * voxel_size.as_dvec3() / f64::from(edge);
    Ok((counts.round().as_uvec3().max(UVec3::ONE), Vec3::splat(edge)))
}

/// Crops it to the region and resamples it, according to `options`. Old and new voxels together take at most
/// `budget_bytes`.
pub fn prepare(
    mut volume: Volume,
    options: &ImportOptions,
    is_label: bool,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Volume, FormatError> {
    let (dims, voxel_size) = prepared(volume.dims, volume.voxel_size, options)?;
    if let Some(region) = options.region {
        cut(&mut volume, region.low, region.dims());
    }
    if voxel_size == volume.voxel_size {
        return Ok(volume);
    }
    let bytes = dims.as_u64vec3().element_product() * u64::from(volume.samples.bytes());
    check_budget(bytes.saturating_add(volume.data.len() as u64), budget_bytes)?;
    let exact = is_label
        || !volume.samples.is_density()
        || matches!(options.colouring, Colouring::Packed | Colouring::Labels);
    progress.begin("resampling to cubic voxels");
    let job = Preparation { volume: &volume, dims, edge: voxel_size.x, progress };
    let data = if exact { job.nearest() } else { job.linear() };
    progress.end();
    go_on(progress)?;
    Ok(Volume { dims, voxel_size, data, samples: volume.samples, texts: volume.texts })
}

/// Performs [`prepare`] for a volume that may be in its files. There it stays, unless it is resampled.
pub fn prepare_scan(
    volume: ScanVolume,
    options: &ImportOptions,
    is_label: bool,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<ScanVolume, FormatError> {
    let (volume, options) = match volume {
        ScanVolume::Held(volume) => (volume, *options),
        ScanVolume::Layered(mut volume) => {
            let (_, voxel_size) = prepared(volume.dims, volume.voxel_size, options)?;
            if let Some(region) = options.region {
                volume.cut(region);
            }
            if voxel_size == volume.voxel_size {
                return Ok(ScanVolume::Layered(volume));
            }
            let volume = ScanVolume::Layered(volume).held(budget_bytes, progress)?;
            (volume, ImportOptions { region: None, ..*options })
        }
    };
    prepare(volume, &options, is_label, budget_bytes, progress).map(ScanVolume::Held)
}

/// Keeps a box of voxels. Works in place: a row never moves up.
fn cut(volume: &mut Volume, low: UVec3, dims: UVec3) {
    let bytes = volume.samples.bytes() as usize;
    let row = dims.x as usize * bytes;
    let mut at = 0;
    for z in low.z..low.z + dims.z {
        for y in low.y..low.y + dims.y {
            let from = volume.offset(low.x, y, z);
            volume.data.copy_within(from..from + row, at);
            at += row;
        }
    }
    volume.data.truncate(at);
    volume.data.shrink_to_fit();
    volume.dims = dims;
}

struct Preparation<'a> {
    volume: &'a Volume,
    dims: UVec3,
    edge: f32,
    progress: &'a dyn Progress,
}

/// The position of a new voxel between two old ones of an axis: the lower one, and the weight of the upper one.
#[derive(Clone, Copy)]
struct ResamplePosition {
    lower: usize,
    upper: usize,
    share: f32,
}

impl ResamplePosition {
    fn nearest(&self) -> usize {
        if self.share < 0.5 { self.lower } else { self.upper }
    }
}

impl Preparation<'_> {
    /// Returns the positions along an axis. The centres of both volumes coincide; the outermost voxels are extended.
    fn places(&self, axis: usize) -> Vec<ResamplePosition> {
        let (old, new) = (self.volume.dims[axis], self.dims[axis]);
        let step = f64::from(self.edge) / f64::from(self.volume.voxel_size[axis]);
        let place = |i: u32| {
            let from_middle = (f64::from(i) + 0.5 - f64::from(new) / 2.0) * step;
            let at = from_middle + f64::from(old) / 2.0 - 0.5;
            let at = at.clamp(0.0, f64::from(old - 1));
            let lower = at as usize;
            let upper = (lower + 1).min(old as usize - 1);
            ResamplePosition { lower, upper, share: (at - lower as f64) as f32 }
        };
        (0..new).map(place).collect()
    }

    /// Fills each slice of the new volume with `slice`, in parallel: it receives z and the slice's bytes.
    fn slices(&self, slice: &(dyn Fn(usize, &mut [u8]) + Sync)) -> Vec<u8> {
        let bytes = self.volume.samples.bytes() as usize;
        let per_slice = self.dims.x as usize * self.dims.y as usize * bytes;
        let mut data = vec![0; per_slice * self.dims.z as usize];
        let begun = AtomicU32::new(0);
        data.par_chunks_mut(per_slice).enumerate().for_each(|(z, target)| {
            if !self.progress.is_cancelled() {
                let before = begun.fetch_add(1, Ordering::Relaxed);
                self.progress.advance(before as f32 / self.dims.z as f32);
                slice(z, target);
            }
        });
        data
    }

    fn nearest(&self) -> Vec<u8> {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| self.places(axis));
        let bytes = self.volume.samples.bytes() as usize;
        self.slices(&|z, target| {
            for (y, row) in ys.iter().zip(target.chunks_mut(xs.len() * bytes)) {
                let from = self.volume.offset(0, y.nearest() as u32, zs[z].nearest() as u32);
                for (x, voxel) in xs.iter().zip(row.chunks_mut(bytes)) {
                    let at = from + x.nearest() * bytes;
                    voxel.copy_from_slice(&self.volume.data[at..at + bytes]);
                }
            }
        })
    }

    fn linear(&self) -> Vec<u8> {
        // Truncation rounds values shifted above 0.
        let i16_of = |v: f32| ((v + 32768.5) as i32 - 32768) as i16;
        match self.volume.samples {
            Samples::U8 => self.blend(|v: &[u8; 1]| v[0].into(), |v| [(v + 0.5) as u8]),
            Samples::U16Le => {
                self.blend(|v| u16::from_le_bytes(*v).into(), |v| ((v + 0.5) as u16).to_le_bytes())
            }
            Samples::U16Be => {
                self.blend(|v| u16::from_be_bytes(*v).into(), |v| ((v + 0.5) as u16).to_be_bytes())
            }
            Samples::I16Le => {
                self.blend(|v| i16::from_le_bytes(*v).into(), |v| i16_of(v).to_le_bytes())
            }
            Samples::I16Be => {
                self.blend(|v| i16::from_be_bytes(*v).into(), |v| i16_of(v).to_be_bytes())
            }
            Samples::F32Le => self.blend(|v| f32::from_le_bytes(*v), f32::to_le_bytes),
            Samples::F32Be => self.blend(|v| f32::from_be_bytes(*v), f32::to_be_bytes),
            Samples::Rgb8 | Samples::Rgba8 | Samples::Bytes(_) => self.nearest(),
        }
    }

    /// Interpolates trilinearly: first four rows to one, then along it.
    fn blend<const B: usize>(
        &self,
        read: impl Fn(&[u8; B]) -> f32 + Sync,
        write: impl Fn(f32) -> [u8; B] + Sync,
    ) -> Vec<u8> {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| self.places(axis));
        let width = self.volume.dims.x as usize;
        let row_at = |y: usize, z: usize| -> &[[u8; B]] {
            let from = self.volume.offset(0, y as u32, z as u32);
            self.volume.data[from..from + width * B].as_chunks().0
        };
        self.slices(&|z, target| {
            let z = &zs[z];
            let mut blended = vec![0.0; width];
            for (y, row) in ys.iter().zip(target.chunks_mut(xs.len() * B)) {
                let rows = [
                    (row_at(y.lower, z.lower), (1.0 - y.share) * (1.0 - z.share)),
                    (row_at(y.upper, z.lower), y.share * (1.0 - z.share)),
                    (row_at(y.lower, z.upper), (1.0 - y.share) * z.share),
                    (row_at(y.upper, z.upper), y.share * z.share),
                ];
                blended.fill(0.0);
                // A row of weight 0 is skipped, whatever it holds: 0 times infinity is NaN.
                for (row, share) in rows.iter().filter(|(_, share)| *share > 0.0) {
                    blended.iter_mut().zip(*row).for_each(|(sum, v)| *sum += read(v) * share);
                }
                for (x, voxel) in xs.iter().zip(row.as_chunks_mut().0) {
                    let lower = blended[x.lower];
                    let step = blended[x.upper] - lower;
                    *voxel = write(if x.share > 0.0 { lower + step * x.share } else { lower });
                }
            }
        })
    }
}
