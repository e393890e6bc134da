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
mod slices;
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
use self::slices::{HeldSlices, SeriesSlices};
use super::frame::AxisFrame;
use super::numbers::volume;
use super::reading::{Reading, Scan};
use super::unpack::malformed;
use crate::format::FormatError;
use crate::format::spec::{FormatSpec, Import, Sign};
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
    drop(bytes);
    let series = SeriesSlices {
        files: &found.files,
        planes: &layers.planes,
        layout,
        padding,
        dims,
        reading,
    };
    reading.progress.begin("reading slices");
    let read = match series.may_stay() {
        true => series.layered(voxel_size, description),
        false => series.held(file).map(|held| {
            let HeldSlices { samples, file_bytes, is_filled } = held;
            (volume(dims, voxel_size, samples, description).into(), file_bytes, is_filled)
        }),
    };
    reading.progress.end();
    let (volume, file_bytes, is_filled) = read?;
    if is_filled {
        notes.push(
            "what lies outside of the scanner's field (PixelPaddingValue) was taken as the least density inside"
                .to_string(),
        );
    }
    let volumes = layers.volumes;
    Ok((Scan { volume, frame, kind, is_label: false, volumes, notes }, file_bytes))
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
