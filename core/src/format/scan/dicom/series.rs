//! The files of a DICOM series in a folder, and the order and the distances of their slices (PS3.3 C.7.6.2).
//!
//! Takes the first bytes of files; gives slices in the order of their places along the normal, on a regular grid, with
//! notes on what is missing, doubled or of unequal distances. Knows no pixels.

use glam::DVec3;

use super::super::Reading;
use super::data_set::DataSet;
use super::phases;
use super::tags::{self, Tag};
use crate::format::{FormatError, Volumes};
use crate::sculpture::grid::MAX_AXIS_VX;

/// Directions of rows and columns that differ by less, in each number, are the same.
const SAME_DIRECTION: f64 = 1e-2;
/// Distances that differ by less than this share are equal.
const SAME_DISTANCE: f64 = 0.02;
/// Slices closer than this lie at the same place.
pub const SAME_PLACE_MM: f64 = 1e-3;
/// Layers per slice beyond which distances are no volume's.
const MOST_LAYERS: usize = 4;
/// Slices that move sideways by more than this share of their distance were taken with a tilted gantry.
const TILT: f64 = 0.02;

/// Where a frame of a file lies.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Index of the file, and of the frame in it.
    pub file: usize,
    pub frame: usize,
    /// Of the series, to sort where places are not known.
    pub number: f64,
    /// The middle of the first pixel, in mm: left, back, head.
    pub position: Option<DVec3>,
    /// Directions of rows and columns.
    pub axes: Option<[DVec3; 2]>,
    /// The file's values for each of [`tags::PHASES`].
    pub phases: Vec<String>,
}

/// The frame of a multi-frame file whose groups say something, then what frames have in common, then the file.
pub struct FrameData<'a> {
    pub data: &'a DataSet<'a>,
    pub frame: usize,
}

impl FrameData<'_> {
    pub fn decimals<const N: usize>(&self, group: Tag, tag: Tag) -> Option<[f64; N]> {
        let of = |item: Option<&DataSet>| item?.items(group).first()?.decimals(tag);
        of(self.data.items(tags::FRAME_GROUPS).get(self.frame))
            .or_else(|| of(self.data.items(tags::SHARED_GROUPS).first()))
            .or_else(|| self.data.decimals(tag))
    }
}

impl Plane {
    /// Of a frame of a file's data set.
    pub fn of(data: &DataSet, file: usize, frame: usize) -> Plane {
        let of = FrameData { data, frame };
        let detector = || data.items(tags::DETECTORS).first()?.decimals::<6>(tags::ORIENTATION);
        let axes = of.decimals::<6>(tags::ORIENTATION_GROUP, tags::ORIENTATION).or_else(detector);
        let axes = axes.map(|v| [DVec3::from_slice(&v[..3]), DVec3::from_slice(&v[3..])]);
        let is_direction = |axes: &[DVec3; 2]| axes[0].cross(axes[1]).length() > 0.5;
        let axes = axes.filter(is_direction).map(|axes| axes.map(DVec3::normalize));
        let mut position = of.decimals(tags::POSITION_GROUP, tags::POSITION).map(DVec3::from_array);
        let offsets = data.all_decimals(tags::FRAME_OFFSETS).unwrap_or_default();
        if let (Some(offset), Some([row, column])) = (offsets.get(frame), axes) {
            // From the first frame, or along z from the patient's origin.
            let first = offsets.first().copied().unwrap_or(0.0);
            position = position.map(|p| p + row.cross(column) * (offset - first));
        } else if frame > 0 && data.items(tags::FRAME_GROUPS).is_empty() {
            // The place of the file is that of its first frame.
            position = None;
        }
        let number = data.decimals::<1>(tags::INSTANCE_NUMBER).map_or(0.0, |[number]| number);
        let content = data.items(tags::FRAME_GROUPS).get(frame);
        let content = content.and_then(|groups| groups.items(tags::CONTENT_GROUP).first());
        let phase = |tag: &Tag| {
            let bits = |data: &DataSet| data.u16(*tag).map(|number| format!("#{number:05}"));
            // Frames number their times in binary.
            content.and_then(bits).or_else(|| data.text(*tag)).unwrap_or_default()
        };
        let phases = tags::PHASES.iter().map(phase).collect();
        Plane { file, frame, number, position, axes, phases }
    }

    /// Whether both can lie in one volume.
    pub fn is_parallel(&self, other: &Plane) -> bool {
        let close = |(a, b): (&DVec3, &DVec3)| (a - b).abs().max_element() < SAME_DIRECTION;
        match (&self.axes, &other.axes) {
            (Some(a), Some(b)) => a.iter().zip(b).all(close),
            (None, None) => true,
            _ => false,
        }
    }
}

/// Slices as the layers of a volume.
#[derive(Debug)]
pub struct Layers {
    /// Which plane each layer shows, from the lowest layer to the highest.
    pub planes: Vec<Plane>,
    /// Between layers; none where positions do not say.
    pub distance_mm: Option<f64>,
    /// Which of several times, phases or echoes it is.
    pub volumes: Volumes,
    pub notes: Vec<String>,
}

/// Sorts parallel planes along their normal. Of several times, phases or echoes the one is taken that was asked for, or
/// that the file number `named` belongs to, or the first.
pub fn layers(
    mut planes: Vec<Plane>,
    named: Option<usize>,
    reading: &Reading,
) -> Result<Layers, FormatError> {
    let mut notes = Vec::new();
    let normal = planes
        .first()
        .and_then(|plane| plane.axes)
        .map(|[row, column]| row.cross(column).normalize());
    let place = |plane: &Plane| Some(plane.position?.dot(normal?));
    let places: Option<Vec<f64>> = planes.iter().map(place).collect();
    let Some(places) = places.filter(|_| planes.len() > 1) else {
        if planes.len() > 1 {
            notes.push("the file does not say where each slice lies; they are in the order of their numbers".to_string());
        }
        planes.sort_by(|a, b| a.number.total_cmp(&b.number).then(a.frame.cmp(&b.frame)));
        let volumes = reading.volumes(1)?;
        return Ok(Layers { planes, distance_mm: None, volumes, notes });
    };
    let mut placed: Vec<(f64, Plane)> = places.into_iter().zip(planes).collect();
    let order = |a: &(f64, Plane), b: &(f64, Plane)| {
        a.0.total_cmp(&b.0).then(a.1.number.total_cmp(&b.1.number)).then(a.1.frame.cmp(&b.1.frame))
    };
    placed.sort_by(order);
    let all = placed.len();
    let (volumes, mut placed) = phases::one_of(placed, named, reading)?;
    placed.dedup_by(|after, before| after.0 - before.0 < SAME_PLACE_MM);
    let phases = volumes.time.count;
    if phases > 1 && reading.options.time.is_none() {
        notes.push(format!(
            "its times, phases or echoes: {phases}; one was taken, whole: to have another, open one of its files, or choose it \
             with the option `time`"
        ));
    }
    if placed.len() < all {
        notes.push(format!(
            "slices left out, where another one lies at the same place, such as of another time or echo: {}",
            all - placed.len()
        ));
    }
    let [first, .., last] = &placed[..] else {
        let planes = placed.into_iter().map(|(_, plane)| plane).collect();
        return Ok(Layers { planes, distance_mm: None, volumes, notes });
    };
    if let (Some(from), Some(to)) = (first.1.position, last.1.position) {
        let (along, length) = (last.0 - first.0, (to - from).length());
        let sideways = (length * length - along * along).max(0.0).sqrt();
        if sideways > TILT * along {
            notes.push(format!(
                "the slices lie askew, as with a tilted gantry, by {:.0} degrees; the sculpture is slanted by as much",
                sideways.atan2(along).to_degrees()
            ));
        }
    }
    let (step, said) = step(&placed)?;
    notes.extend(said);
    let count = ((last.0 - first.0) / step).round() as usize + 1;
    if count == placed.len() {
        let distance_mm = Some((last.0 - first.0) / (count - 1) as f64);
        let planes = placed.into_iter().map(|(_, plane)| plane).collect();
        return Ok(Layers { planes, distance_mm, volumes, notes });
    }
    if count > MOST_LAYERS * placed.len() || count > MAX_AXIS_VX as usize {
        return Err(FormatError::Scan(format!(
            "its {} slices lie {step:.2} mm apart, with gaps as large as {:.0} mm; keep each stack of slices in its own folder",
            placed.len(),
            gaps(&placed).fold(0.0, f64::max)
        )));
    }
    let nearest = |layer: usize| {
        let at = first.0 + layer as f64 * step;
        let above = placed.partition_point(|(place, _)| *place < at).clamp(1, placed.len() - 1);
        let pair = &placed[above - 1..=above];
        let upper = at - pair[0].0 > pair[1].0 - at;
        pair[usize::from(upper)].1.clone()
    };
    let planes = (0..count).map(nearest).collect();
    Ok(Layers { planes, distance_mm: Some(step), volumes, notes })
}

fn gaps(placed: &[(f64, Plane)]) -> impl Iterator<Item = f64> {
    placed.windows(2).map(|pair| pair[1].0 - pair[0].0)
}

/// The distance of layers, and what to say about it.
fn step(placed: &[(f64, Plane)]) -> Result<(f64, Option<String>), FormatError> {
    let mut sorted: Vec<f64> = gaps(placed).collect();
    sorted.sort_by(f64::total_cmp);
    let (least, most, median) =
        (sorted[0], sorted[sorted.len() - 1], sorted[(sorted.len() - 1) / 2]);
    if most - least <= SAME_DISTANCE * median {
        return Ok((median, None));
    }
    let is_whole = |gap: &f64| {
        let times = gap / median;
        (times - times.round()).abs() <= 0.1 && times > 0.5
    };
    if sorted.iter().all(is_whole) {
        let missing: f64 = sorted.iter().map(|gap| (gap / median).round() - 1.0).sum();
        let note = format!("slices missing: {missing}; the nearest ones stand for them");
        return Ok((median, (missing > 0.0).then_some(note)));
    }
    let note = format!(
        "slices at unequal distances, from {least:.2} to {most:.2} mm: layers of {least:.2} mm show the nearest slices"
    );
    Ok((least, Some(note)))
}
