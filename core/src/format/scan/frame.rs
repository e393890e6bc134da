//! The directions of the axes of a scan, in the patient or in the world of the program that wrote it, and the one of
//! the 48 orientations that makes it upright, facing the viewer.

use glam::{DMat3, DVec3, IVec3, UVec3};

use crate::sculpture::orientation::Orientation;

/// Directions of the three axes of a file.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum AxisFrame {
    /// The file states nothing.
    #[default]
    Unknown,
    /// In the patient: x to the patient's right, y to the front (anterior), z to the head (superior).
    Patient([DVec3; 3]),
    /// In a world whose axes have no meaning.
    World([DVec3; 3]),
}

impl AxisFrame {
    /// Returns the axis-aligned orientation nearest to the file's, where y points to the head and z to the viewer, whom
    /// the patient faces. A reflection in the file's axes is undone, so that no mirror image is shown. Returns the
    /// upright orientation where directions are unknown or invalid.
    pub fn orientation(&self) -> Orientation {
        let axes = match self {
            AxisFrame::Unknown => return Orientation::UPRIGHT,
            // Facing the viewer, the patient's left is at the viewer's right.
            AxisFrame::Patient(axes) => axes.map(|v| DVec3::new(-v.x, v.z, v.y)),
            AxisFrame::World(axes) => *axes,
        };
        let axes = axes.map(DVec3::normalize_or_zero);
        let handedness = DMat3::from_cols_array_2d(&axes.map(|v| v.to_array())).determinant();
        let directions = |orientation: Orientation| {
            let middle = IVec3::ONE;
            let to = |from: IVec3| orientation.destination(middle + from, UVec3::splat(3)) - middle;
            [IVec3::X, IVec3::Y, IVec3::Z].map(|axis| to(axis).as_dvec3())
        };
        let fit = |orientation: Orientation| -> f64 {
            let to = directions(orientation);
            (0..3).map(|i| to[i].dot(axes[i])).sum()
        };
        let same_hand = |orientation: &Orientation| {
            let [x, y, z] = directions(*orientation);
            x.cross(y).dot(z) * handedness > 0.0
        };
        let possible = Orientation::all().filter(same_hand);
        possible.max_by(|a, b| fit(*a).total_cmp(&fit(*b))).unwrap_or_default()
    }

    /// Returns whether the file defines its up axis.
    pub fn knows_up(&self) -> bool {
        matches!(self, AxisFrame::Patient(_))
    }

    /// Returns for display the directions of the axes, and their deviation in angle.
    pub fn describe(&self) -> Option<String> {
        let (axes, names) = match self {
            AxisFrame::Unknown => return None,
            AxisFrame::Patient(axes) => {
                (axes, [["right", "left"], ["front", "back"], ["head", "feet"]])
            }
            AxisFrame::World(axes) => (axes, [["x", "-x"], ["y", "-y"], ["z", "-z"]]),
        };
        let mut oblique = 0.0f64;
        let words = axes.map(|v| {
            let v = v.normalize_or_zero();
            let along = (0..3).max_by(|a, b| v[*a].abs().total_cmp(&v[*b].abs())).unwrap_or(0);
            oblique = oblique.max(v[along].abs().min(1.0).acos().to_degrees());
            names[along][usize::from(v[along] < 0.0)]
        });
        let text = format!("x to {}, y to {}, z to {}", words[0], words[1], words[2]);
        Some(match oblique {
            angle if angle < 0.5 => text,
            angle => format!("{text}, up to {angle:.0} degrees oblique"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patients_stand_and_face_the_viewer_and_are_never_mirrored() {
        for from in Orientation::all() {
            // Axes of a file in any orientation relative to the patient.
            let to =
                |axis: IVec3| (from.destination(IVec3::ONE + axis, UVec3::splat(3)) - 1).as_dvec3();
            let axes = [IVec3::X, IVec3::Y, IVec3::Z].map(to);
            for tilt in [0.0, 0.3] {
                let tilt = glam::DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), tilt);
                let frame = AxisFrame::Patient(axes.map(|axis| tilt * axis * 2.0));
                let stand = frame.orientation();
                let shown = |axis: IVec3| {
                    (stand.destination(IVec3::ONE + axis, UVec3::splat(3)) - 1).as_dvec3()
                };
                for (axis, in_patient) in [IVec3::X, IVec3::Y, IVec3::Z].into_iter().zip(axes) {
                    let expected = DVec3::new(-in_patient.x, in_patient.z, in_patient.y);
                    assert_eq!(shown(axis), expected, "{from} {tilt}");
                }
            }
        }
    }

    #[test]
    fn unknown_axes_keep_their_orientation() {
        assert_eq!(AxisFrame::Unknown.orientation(), Orientation::UPRIGHT);
        assert_eq!(
            AxisFrame::World([DVec3::X, DVec3::Y, DVec3::Z]).orientation(),
            Orientation::UPRIGHT
        );
        for axes in [[DVec3::ZERO; 3], [DVec3::NAN; 3], [DVec3::X; 3]] {
            assert_eq!(AxisFrame::Patient(axes).orientation(), Orientation::UPRIGHT);
        }
        let frame = AxisFrame::Patient([DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z]);
        assert_eq!(frame.describe().as_deref(), Some("x to left, y to back, z to head"));
        let frame = AxisFrame::Patient([DVec3::NEG_X, DVec3::new(0.0, -1.0, 0.2), DVec3::Z]);
        assert!(frame.describe().is_some_and(|text| text.ends_with("11 degrees oblique")));
    }
}
