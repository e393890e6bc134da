//! The positions and directions of frames, with the values that distinguish phases.
//!
//! Takes data sets; knows neither other frames nor how they are stacked.

use glam::DVec3;

use super::data_set::DataSet;
use super::tags::{self, Tag};

/// Directions of rows and columns that differ by less, in each component, are the same.
const SAME_DIRECTION: f64 = 1e-2;
/// Slices closer than this are at the same position.
pub const SAME_PLACE_MM: f64 = 1e-3;

/// The position of a frame of a file.
#[derive(Clone, Debug)]
pub struct FramePlane {
    /// Index of the file, and of the frame in it.
    pub file: usize,
    pub frame: usize,
    /// Number in the series, for sorting where positions are unknown.
    pub number: f64,
    /// The centre of the first pixel, in mm: left, back, head.
    pub position: Option<DVec3>,
    /// Directions of rows and columns.
    pub axes: Option<[DVec3; 2]>,
    /// The file's values for each of [`tags::PHASES`].
    pub phases: Vec<String>,
}

/// The data of a frame: its own groups in a multi-frame file take precedence, then the shared groups, then the file.
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

impl FramePlane {
    /// Reads the plane of a frame from a file's data set.
    pub fn of(data: &DataSet, file: usize, frame: usize) -> FramePlane {
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
            // The position in the file is that of its first frame.
            position = None;
        }
        let number = data.decimals::<1>(tags::INSTANCE_NUMBER).map_or(0.0, |[number]| number);
        let content = data.items(tags::FRAME_GROUPS).get(frame);
        let content = content.and_then(|groups| groups.items(tags::CONTENT_GROUP).first());
        let phase = |tag: &Tag| {
            let bits = |data: &DataSet| data.u16(*tag).map(|number| format!("#{number:05}"));
            // Frames store their times in binary.
            content.and_then(bits).or_else(|| data.text(*tag)).unwrap_or_default()
        };
        let phases = tags::PHASES.iter().map(phase).collect();
        FramePlane { file, frame, number, position, axes, phases }
    }

    /// Returns whether both can lie in one volume.
    pub(crate) fn is_parallel(&self, other: &FramePlane) -> bool {
        let close = |(a, b): (&DVec3, &DVec3)| (a - b).abs().max_element() < SAME_DIRECTION;
        match (&self.axes, &other.axes) {
            (Some(a), Some(b)) => a.iter().zip(b).all(close),
            (None, None) => true,
            _ => false,
        }
    }
}
