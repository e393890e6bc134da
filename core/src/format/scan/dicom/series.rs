//! The files of a DICOM series in a folder: the order and the distances of their slices (PS3.3 C.7.6.2).
//!
//! Takes the first bytes of files; gives slices in the order of their positions along the normal, on a regular grid,
//! with notes on missing, duplicate or unevenly spaced slices. Knows no pixels.

use super::super::reading::Reading;
use super::phases;
use super::plane::{FramePlane, SAME_PLACE_MM};
use crate::format::{FormatError, Volumes};
use crate::sculpture::grid::MAX_AXIS_VX;

/// Distances that differ by less than this fraction are equal.
const SAME_DISTANCE: f64 = 0.02;
/// Greatest number of layers per slice; beyond that, the slices form no volume.
const MOST_LAYERS: usize = 4;
/// Sideways shift between slices, as a fraction of their distance, above which the gantry was tilted.
const TILT: f64 = 0.02;

/// Slices as the layers of a volume.
#[derive(Debug)]
pub struct SeriesLayers {
    /// The plane that each layer shows, from the lowest layer to the highest.
    pub planes: Vec<FramePlane>,
    /// Distance between layers; `None` where positions do not show it.
    pub distance_mm: Option<f64>,
    /// Which of several times, phases or echoes it is.
    pub volumes: Volumes,
    pub notes: Vec<String>,
}

/// Sorts parallel planes along their normal. Of several times, phases or echoes, takes the requested one, or that of
/// the file number `named`, or the first.
pub fn layers(
    mut planes: Vec<FramePlane>,
    named: Option<usize>,
    reading: &Reading,
) -> Result<SeriesLayers, FormatError> {
    let mut notes = Vec::new();
    let normal = planes
        .first()
        .and_then(|plane| plane.axes)
        .map(|[row, column]| row.cross(column).normalize());
    let place = |plane: &FramePlane| Some(plane.position?.dot(normal?));
    let places: Option<Vec<f64>> = planes.iter().map(place).collect();
    let Some(places) = places.filter(|_| planes.len() > 1) else {
        if planes.len() > 1 {
            notes.push("the file does not say where each slice lies; they are in the order of their numbers".to_string());
        }
        planes.sort_by(|a, b| a.number.total_cmp(&b.number).then(a.frame.cmp(&b.frame)));
        let volumes = reading.volumes(1)?;
        return Ok(SeriesLayers { planes, distance_mm: None, volumes, notes });
    };
    let mut placed: Vec<(f64, FramePlane)> = places.into_iter().zip(planes).collect();
    let order = |a: &(f64, FramePlane), b: &(f64, FramePlane)| {
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
        return Ok(SeriesLayers { planes, distance_mm: None, volumes, notes });
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
        return Ok(SeriesLayers { planes, distance_mm, volumes, notes });
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
    Ok(SeriesLayers { planes, distance_mm: Some(step), volumes, notes })
}

fn gaps(placed: &[(f64, FramePlane)]) -> impl Iterator<Item = f64> {
    placed.windows(2).map(|pair| pair[1].0 - pair[0].0)
}

/// Returns the distance of layers, and a note about it.
fn step(placed: &[(f64, FramePlane)]) -> Result<(f64, Option<String>), FormatError> {
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
