//! DICOM (dicomstandard.org): one file, a folder, or any file of a series, of which the others in its folder are read,
//! too; several frames in one file.
//!
//! Takes a path; gives a volume of one series, its first layer the lowest along the normal of the slices. Discards
//! everything that names the patient.

mod data_set;
mod folder;
mod jpeg2000;
mod padding;
mod phases;
mod pixels;
mod plane;
mod series;
mod syntax;
mod tags;
#[cfg(test)]
mod tests;

use std::path::Path;

use glam::{DVec3, UVec3, Vec3};

use self::data_set::{DataSet, MAGIC, MAGIC_AT, ReadExtent};
use self::padding::Padding;
use self::pixels::PixelLayout;
use self::plane::{FrameData, FramePlane};
use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan};
use super::unpack::malformed;
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::format::{FormatError, go_on};
use crate::sculpture::grid::MAX_AXIS_VX;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(MAGIC_AT, MAGIC), Sign::Likely(data_set::is_dicom)],
    folder: Some(folder::has_dicom),
    ..FormatSpec::new(
        "DICOM",
        &["dcm", "dicom"],
        Import::Scan(|reading| read(reading.path, reading)),
    )
};

/// Reads the series to which the file `path` belongs, or the only one of the folder `path`. Returns it with the total
/// length of its files.
fn read(path: &Path, reading: &Reading) -> Result<(Scan, u64), FormatError> {
    let found = folder::find(path, reading)?;
    let mut notes = found.notes;
    let file = reading.read(&found.files[0])?;
    let (syntax, bytes) =
        data_set::open(&file, ReadExtent::Whole, reading.rest_bytes(file.len() as u64))?;
    let data = DataSet::parse(&bytes, syntax, ReadExtent::Whole)?;
    let layout = PixelLayout::of(&data)?;
    let frames = frames(&data)?;
    let planes = match frames {
        1 => found.planes,
        _ => parallel_planes(&data, frames, &mut notes),
    };
    let layers = series::layers(planes, found.named, reading)?;
    notes.extend(layers.notes);
    let (count, file_count) = (layers.planes.len(), found.files.len());
    let Some(depth) = u32::try_from(count).ok().filter(|depth| *depth <= MAX_AXIS_VX) else {
        return Err(FormatError::Scan(format!(
            "{count} slices; at most {MAX_AXIS_VX} are read; leave some out of the folder"
        )));
    };
    let dims = UVec3::new(layout.columns, layout.rows, depth);
    let first = FrameData { data: &data, frame: layers.planes[0].frame };
    let voxel_size = spacing(&first, layers.distance_mm, depth > 1, &mut notes);
    let frame = match layers.planes[0].axes {
        // To the patient's right and front.
        Some([row, column]) => AxisFrame::Patient(
            [row, column, row.cross(column)].map(|v| DVec3::new(-v.x, -v.y, v.z)),
        ),
        None => AxisFrame::Unknown,
    };
    if layout.is_negative() {
        notes.push("light and dark are swapped, as the file asks for (MONOCHROME1)".to_string());
    }
    reading.admit(dims, voxel_size)?;
    let padding = Padding::of(&data, &layout);
    let text = |tag| data.text(tag);
    let description = text(tags::SERIES_DESCRIPTION).unwrap_or_default().into_bytes();
    let modality = text(tags::MODALITY).unwrap_or_default().escape_debug().to_string();
    let kind = match (file_count, frames) {
        (1, 1) => format!("DICOM {modality}, one file{}", syntax.packing()),
        (1, frames) => format!("DICOM {modality}, frames: {frames}{}", syntax.packing()),
        (files, _) => format!("DICOM {modality}, series of {files} files{}", syntax.packing()),
    };
    drop(data);
    let mut stack = SliceStack { layout, layers: Layered::default(), dims, reading, bytes: 0 };
    reading.progress.begin("reading slices");
    let added = match file_count {
        1 => stack.add(&file, &layers.planes),
        _ => {
            drop(bytes);
            drop(file);
            // Layers that repeat a slice are consecutive.
            layers.planes.chunk_by(|a, b| a.file == b.file).try_for_each(|planes| {
                stack.add(&reading.read(&found.files[planes[0].file])?, planes)
            })
        }
    };
    reading.progress.end();
    added?;
    let file_bytes = stack.bytes;
    if let Some(padding) = padding.filter(|_| !stack.layers.is_scaled)
        && padding.fill(&mut stack.layers.data, layout.number)
    {
        notes.push(
            "what lies outside of the scanner's field (PixelPaddingValue) was taken as the least density inside"
                .to_string(),
        );
    }
    let samples = stack.layers.into_samples(layout.number);
    let volume = volume(dims, voxel_size, samples, description);
    let volumes = layers.volumes;
    Ok((Scan { volume: volume.into(), frame, kind, is_label: false, volumes, notes }, file_bytes))
}

/// Returns the planes of the frames of a file that are parallel to the first.
fn parallel_planes(data: &DataSet, frames: usize, notes: &mut Vec<String>) -> Vec<FramePlane> {
    let planes: Vec<FramePlane> = (0..frames).map(|frame| FramePlane::of(data, 0, frame)).collect();
    let first = planes[0].clone();
    let all = planes.len();
    let parallel: Vec<FramePlane> =
        planes.into_iter().filter(|plane| plane.is_parallel(&first)).collect();
    if parallel.len() < all {
        notes.push(format!("frames left out, of another direction: {}", all - parallel.len()));
    }
    parallel
}

/// Returns the number of frames of a file.
fn frames(data: &DataSet) -> Result<usize, FormatError> {
    match data.decimals::<1>(tags::FRAMES) {
        None => Ok(1),
        Some([frames]) if (1.0..=f64::from(MAX_AXIS_VX)).contains(&frames) => Ok(frames as usize),
        Some([frames]) => Err(malformed("the DICOM header", format!("{frames} frames"))),
    }
}

/// Returns the edges of a voxel in millimetres.
fn spacing(
    of: &FrameData,
    distance_mm: Option<f64>,
    is_stack: bool,
    notes: &mut Vec<String>,
) -> Vec3 {
    let is_length = |mm: &f64| (1e-6..1e6).contains(mm);
    let within = of.decimals::<2>(tags::MEASURES_GROUP, tags::PIXEL_SPACING);
    let within = within.or_else(|| of.data.decimals(tags::IMAGER_PIXEL_SPACING));
    let within = within.filter(|both| both.iter().all(is_length));
    let said =
        |tag| of.decimals::<1>(tags::MEASURES_GROUP, tag).map(|[mm]| mm.abs()).filter(is_length);
    let along = distance_mm
        .filter(is_length)
        .or_else(|| said(tags::SPACING_BETWEEN_SLICES).or_else(|| said(tags::SLICE_THICKNESS)));
    if within.is_none() || along.is_none() && is_stack {
        notes.push("the file does not say how large a voxel is; 1 mm was taken".to_string());
    }
    // Between rows, then between columns.
    let [y, x] = within.unwrap_or([1.0; 2]);
    Vec3::new(x as f32, y as f32, along.unwrap_or(1.0) as f32)
}

/// Layers as they are read: stored numbers while all have the same scale, else scaled values.
#[derive(Default)]
struct Layered {
    data: Vec<u8>,
    scale: Option<[f64; 2]>,
    is_scaled: bool,
}

impl Layered {
    fn add(&mut self, frame: Vec<u8>, number: Number, scale: [f64; 2]) {
        let own = *self.scale.get_or_insert(scale);
        if own != scale && !self.is_scaled {
            self.data = number.to_floats(&self.data, false, own);
            self.is_scaled = true;
        }
        if self.is_scaled {
            self.data.append(&mut number.to_floats(&frame, false, scale));
        } else {
            self.data.extend_from_slice(&frame);
        }
    }

    fn into_samples(self, number: Number) -> (crate::format::Samples, Vec<u8>) {
        match self.is_scaled {
            true => (crate::format::Samples::F32Le, self.data),
            false => number.into_samples(self.data, false, self.scale.unwrap_or([1.0, 0.0])),
        }
    }
}

/// A volume that grows by a slice at a time.
struct SliceStack<'a> {
    layout: PixelLayout,
    layers: Layered,
    dims: UVec3,
    reading: &'a Reading<'a>,
    /// Total length of the files so far, in bytes.
    bytes: u64,
}

impl SliceStack<'_> {
    /// Appends frames of a file.
    fn add(&mut self, file: &[u8], planes: &[FramePlane]) -> Result<(), FormatError> {
        let (progress, number) = (self.reading.progress, self.layout.number);
        let rest_bytes = self.reading.rest_bytes(file.len() as u64);
        let whole = number.check(self.dims, rest_bytes)?;
        let (syntax, bytes) = data_set::open(file, ReadExtent::Whole, rest_bytes)?;
        let data = DataSet::parse(&bytes, syntax, ReadExtent::Whole)?;
        let layout = PixelLayout::of(&data)?;
        if !layout.fits(&self.layout) {
            return Err(FormatError::Scan(
                "the files of the series differ in size or type; keep each series in its own folder".to_string(),
            ));
        }
        let frames = frames(&data)?;
        self.bytes += file.len() as u64;
        for plane in planes {
            go_on(progress)?;
            let frame = layout.frame(&data, syntax, frames, plane.frame)?;
            if self.layers.data.is_empty() {
                self.layers.data.reserve_exact(whole as usize);
            }
            let of = FrameData { data: &data, frame: plane.frame };
            let value = |tag| of.decimals::<1>(tags::VALUES_GROUP, tag).map(|[value]| value);
            let slope = value(tags::SLOPE).filter(|slope| *slope != 0.0).unwrap_or(1.0);
            self.layers.add(frame, number, [slope, value(tags::INTERCEPT).unwrap_or(0.0)]);
            let layer_bytes = whole / u64::from(self.dims.z);
            let per = if self.layers.is_scaled { 4.0 / number.bytes() as f32 } else { 1.0 };
            let done = self.layers.data.len() as f32 / per / layer_bytes as f32;
            progress.advance(done / self.dims.z as f32);
        }
        Ok(())
    }
}
