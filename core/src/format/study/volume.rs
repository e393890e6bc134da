//! Describes a volume before it is imported: its histogram, its slices in the orientation of the sculpture, and which
//! voxels would exist.

use glam::{UVec2, UVec3, Vec3};

use super::Outlook;
use crate::format::budget::check_budget;
use crate::format::histogram::Histogram;
use crate::format::import::{OPAQUE, RAMP_QUANTILE, U8};
use crate::format::options::{Colouring, Cubic, Existence, ImportOptions, ScanRegion};
use crate::format::prepare::prepared;
use crate::format::ramp::Ramp;
use crate::format::scan::AxisFrame;
use crate::format::volume::{Samples, Volume};
use crate::format::{Densities, FileMetadata, FormatError, Volumes, budget_bytes, labels};
use crate::sculpture::orientation::Orientation;
use crate::sculpture::{Grid, Limits, Rgb};

/// A volume to be imported, in the orientation of its file.
#[derive(Debug)]
pub struct VolumeStudy {
    /// The voxels.
    pub volume: Volume,
    /// Statistics of the values that are compared with thresholds: densities, or for colours the opacity, or where
    /// there is none the maximum of red, green and blue.
    pub densities: Densities,
    /// Whether the file declares its numbers as labels.
    pub is_label: bool,
    /// Display name of the format and packing.
    pub kind: String,
    /// The channel and the time.
    pub volumes: Volumes,
    /// Notes on what was left out or interpreted otherwise.
    pub notes: Vec<String>,
    frame: AxisFrame,
}

/// The values that exist.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Existing {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub most: f64,
    /// Whether 0 does not exist, even between these.
    pub but_zero: bool,
}

impl Existing {
    /// Returns whether a value exists; false for NaN.
    #[inline]
    pub fn contains(&self, value: f32) -> bool {
        let wide = f64::from(value);
        wide >= self.least && wide <= self.most && !(self.but_zero && value == 0.0)
    }
}

impl VolumeStudy {
    pub(super) fn of(volume: Volume, source: FileMetadata) -> Result<VolumeStudy, FormatError> {
        let densities = match volume.samples {
            Samples::Bytes(n) => return Err(FormatError::Components(n)),
            Samples::Rgb8 | Samples::Rgba8 => of_colours(&volume),
            _ => Densities::of(&volume),
        };
        let densities = densities.ok_or(FormatError::Components(volume.samples.bytes()))?;
        let FileMetadata { kind, frame, is_label, volumes, notes, .. } = source;
        Ok(VolumeStudy { volume, densities, is_label, kind, volumes, notes, frame })
    }

    /// Returns whether the file defines its up axis.
    pub fn knows_up(&self) -> bool {
        self.frame.knows_up()
    }

    /// Returns the directions of the axes for display.
    pub fn orientation(&self) -> Option<String> {
        self.frame.describe()
    }

    /// Returns the rotation that makes the volume upright.
    pub fn turn(&self, options: &ImportOptions) -> Orientation {
        let up = if self.knows_up() { None } else { options.upright };
        self.frame.orientation().then(up.unwrap_or_default().turned_upright())
    }

    /// Returns which values would exist.
    pub fn existing(&self, options: &ImportOptions) -> Existing {
        let samples = self.volume.samples;
        let is_label = match options.colouring {
            Colouring::Labels => true,
            Colouring::Auto => self.is_label,
            _ => false,
        };
        let is_packed = options.colouring == Colouring::Packed;
        let usual = match samples {
            _ if is_label || is_packed => f64::NEG_INFINITY,
            Samples::Rgba8 => OPAQUE,
            Samples::Rgb8 => 1.0,
            _ => self.densities.threshold,
        };
        let chosen = options.existence.bounds().filter(|_| !is_packed);
        let (least, most) = chosen.unwrap_or((usual, f64::INFINITY));
        Existing { least, most, but_zero: is_label || is_packed }
    }

    /// Returns a function for the colours of existing values; `None` where they have the base colour, or that of the
    /// voxel itself.
    pub fn colour(&self, options: &ImportOptions) -> Option<Box<dyn Fn(f32) -> Rgb>> {
        let existing = self.existing(options);
        let from = existing.least;
        let top = || {
            let brightest = self.densities.histogram.quantile(RAMP_QUANTILE);
            brightest.min(existing.most).max(from)
        };
        match options.colouring {
            _ if !self.volume.samples.is_density() => None,
            Colouring::Auto if !self.is_label => None,
            Colouring::Auto | Colouring::Labels => {
                let colours = labels::colours();
                Some(Box::new(move |value| labels::colour(&colours, value)))
            }
            Colouring::Grey | Colouring::Tissue => {
                let is_grey = options.colouring == Colouring::Grey;
                let ramp = if is_grey { Ramp::grey } else { Ramp::tissue }(from, top());
                Some(Box::new(move |value| ramp.colour(value)))
            }
            Colouring::None | Colouring::Packed => None,
        }
    }

    /// Returns the value at a voxel of the file that is compared with thresholds.
    pub fn value(&self, voxel: UVec3) -> f32 {
        let at = self.volume.offset(voxel.x, voxel.y, voxel.z);
        match (self.volume.samples, self.volume.data.get(at..)) {
            (Samples::Rgb8, Some([r, g, b, ..])) => f32::from(*r.max(g).max(b)),
            (Samples::Rgba8, Some([_, _, _, a, ..])) => f32::from(*a),
            _ => self.volume.density(voxel).unwrap_or(f32::NAN),
        }
    }

    /// Returns the size of the upright volume.
    pub fn upright_dims(&self, turn: Orientation) -> UVec3 {
        turn.size(self.volume.dims)
    }

    /// Returns size and values of the slice at `at` across an axis (0 to 2) of the upright volume, rows from top to
    /// bottom. Across x it is seen from the right (the front at the left), across y from below (the front at the top),
    /// across z from the front. At most `most_px` values per side: larger ones are subsampled evenly.
    pub fn slice(
        &self,
        turn: Orientation,
        axis: usize,
        at: u32,
        most_px: u32,
    ) -> (UVec2, Vec<f32>) {
        let dims = self.upright_dims(turn);
        let ([across, down], reversed) = Self::picture_axes(axis);
        let full = UVec2::new(dims[across], dims[down]);
        let size = full.min(UVec2::splat(most_px.max(1)));
        let place = |i: u32, side: usize| {
            let i = (u64::from(i) * u64::from(full[side]) / u64::from(size[side])) as u32;
            if reversed[side] { full[side] - 1 - i } else { i }
        };
        let mut values = Vec::with_capacity(size.element_product() as usize);
        let mut voxel = UVec3::ZERO;
        voxel[axis] = at.min(dims[axis] - 1);
        for j in 0..size.y {
            voxel[down] = place(j, 1);
            for i in 0..size.x {
                voxel[across] = place(i, 0);
                let source = turn.source(voxel.as_ivec3(), self.volume.dims).as_uvec3();
                values.push(self.value(source));
            }
        }
        (size, values)
    }

    /// Returns the axes to the right and downwards of the slice across an axis, and whether they are reversed.
    pub fn picture_axes(axis: usize) -> ([usize; 2], [bool; 2]) {
        match axis {
            0 => ([2, 1], [true, true]),
            1 => ([0, 2], [false, true]),
            _ => ([0, 1], [false, true]),
        }
    }

    /// Returns the upright image of a box of the file.
    pub fn upright_region(&self, turn: Orientation, region: ScanRegion) -> ScanRegion {
        let at = |voxel: UVec3| turn.destination(voxel.as_ivec3(), self.volume.dims).as_uvec3();
        let (a, b) = (at(region.low), at(region.high));
        ScanRegion { low: a.min(b), high: a.max(b) }
    }

    /// Returns the box of the file for a box of the upright volume.
    pub fn region_in_file(&self, turn: Orientation, region: ScanRegion) -> ScanRegion {
        let at = |voxel: UVec3| turn.source(voxel.as_ivec3(), self.volume.dims).as_uvec3();
        let (a, b) = (at(region.low), at(region.high));
        ScanRegion { low: a.min(b), high: a.max(b) }
    }

    /// Returns the region of the whole file.
    pub fn whole(&self) -> ScanRegion {
        ScanRegion { low: UVec3::ZERO, high: self.volume.dims - 1 }
    }

    /// Returns the sculpture that an import of the volume would make; an error if it cannot be imported with these
    /// options.
    pub fn outlook(
        &self,
        options: &ImportOptions,
        limits: &Limits,
    ) -> Result<Outlook, FormatError> {
        let Volume { dims, voxel_size, samples, .. } = self.volume;
        let (prepared_dims, prepared_size) = prepared(dims, voxel_size, options)?;
        Grid::check(prepared_dims, prepared_size, limits.grid_bytes)?;
        let bytes = |dims: UVec3| voxels(dims) * u64::from(samples.bytes());
        let cut = bytes(options.region.map_or(dims, |region| region.dims()));
        // Old and new voxels exist together during resampling.
        let resampled = if prepared_size == voxel_size { 0 } else { bytes(prepared_dims) };
        check_budget(cut.saturating_add(resampled), budget_bytes(limits))?;
        let turn = self.turn(options);
        let colour_bytes = match options.colouring {
            Colouring::None => 0,
            Colouring::Auto if samples.is_density() && !self.is_label => 0,
            _ => voxels(prepared_dims) * options.colour_depth.map_or(3, |d| d.bytes() as u64),
        };
        Ok(Outlook {
            dims: turn.size(prepared_dims),
            voxel_size: Vec3::from(turn.permuted(prepared_size.to_array())),
            read_bytes: self.volume.data.len().max((cut + resampled) as usize) as u64,
            grid_bytes: Grid::bytes_for(prepared_dims),
            colour_bytes,
        })
    }

    /// Returns the options that make the sculpture as it was shown: an automatic threshold is that of the whole volume,
    /// even where the chosen part, or its cubic voxels, would have another one.
    pub fn settled(&self, options: &ImportOptions) -> ImportOptions {
        let region = options.region.filter(|region| *region != self.whole());
        let resampled = options.cubic != Cubic::No;
        let existing = self.existing(options);
        let open = options.existence == Existence::Auto && !existing.but_zero;
        let existence = match open && (region.is_some() || resampled) {
            true => Existence::Threshold(existing.least),
            false => options.existence,
        };
        ImportOptions { region, existence, ..*options }
    }
}

fn voxels(dims: UVec3) -> u64 {
    dims.as_u64vec3().element_product()
}

/// Computes the statistics of the values of colours that are compared with thresholds.
fn of_colours(volume: &Volume) -> Option<Densities> {
    let (histogram, threshold) = match volume.samples {
        Samples::Rgb8 => {
            let value = |[r, g, b]: &[u8; 3]| f32::from(*r.max(g).max(b));
            (Histogram::of(volume.data.as_chunks().0, value, U8), 1.0)
        }
        Samples::Rgba8 => {
            let value = |[_, _, _, a]: &[u8; 4]| f32::from(*a);
            (Histogram::of(volume.data.as_chunks().0, value, U8), OPAQUE)
        }
        _ => return None,
    };
    Some(Densities { histogram, threshold })
}
