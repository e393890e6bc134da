//! Reference pictures: images in the scene to sculpt from, each on a side of the sculpture.
//!
//! Defines their positions and placement; `app` reads the files. Must not know the window that changes them.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine3A, Mat3, UVec3, Vec2, Vec3};

use crate::input::Side;
use crate::render::ReferencePicture;
use crate::shade::Pixels;
use crate::viewpoint::turntable::side_frame;

/// Cosine of the largest angle between the view and a side that counts as seen: 5 degrees.
const ALONG: f32 = 0.9962;
/// Gap between the grid and the pictures behind and in front of it, in voxels.
const GAP_VX: f32 = 2.0;
/// Valid heights of pictures, and offsets to either side, in voxels.
pub const HEIGHT_RANGE_VX: std::ops::RangeInclusive<f32> = 1.0..=16384.0;
pub const OFFSET_RANGE_VX: std::ops::RangeInclusive<f32> = -16384.0..=16384.0;

/// The depth of a picture along the view of its side.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Layer {
    #[default]
    Behind,
    Middle,
    Before,
}

impl Layer {
    pub const ALL: [Layer; 3] = [Layer::Behind, Layer::Middle, Layer::Before];

    pub const fn name(self) -> &'static str {
        match self {
            Layer::Behind => "behind",
            Layer::Middle => "middle",
            Layer::Before => "in front",
        }
    }
}

/// A reference picture.
#[derive(Clone, PartialEq, Debug)]
pub struct Reference {
    pub path: PathBuf,
    /// `None` while the file has not been read, or if it cannot be.
    pub pixels: Option<Arc<Pixels>>,
    pub shown: bool,
    /// The side from which it is seen.
    pub side: Side,
    /// Shown only when the view is along that side.
    pub locked: bool,
    pub layer: Layer,
    /// 0 to 1.
    pub opacity: f32,
    pub height_vx: f32,
    /// Offset of its centre from that of the grid, to the right and up.
    pub offset_vx: Vec2,
}

impl Reference {
    /// Creates a picture as high as the grid, seen from `side`.
    pub fn new(
        path: PathBuf,
        pixels: Option<Arc<Pixels>>,
        side: Side,
        height_vx: f32,
    ) -> Reference {
        Reference {
            path,
            pixels,
            shown: true,
            side,
            locked: false,
            layer: Layer::Behind,
            opacity: 0.6,
            height_vx,
            offset_vx: Vec2::ZERO,
        }
    }

    /// Returns the picture as drawn for an eye that sees the grid's axes in the directions `axes_in_picture`; `None`
    /// before its file was read.
    pub fn placed(
        &self,
        dims: UVec3,
        voxel_size: Vec3,
        up: Vec3,
        axes_in_picture: &[Vec3; 3],
    ) -> Option<ReferencePicture> {
        let pixels = self.pixels.clone()?;
        let frame = side_frame(self.side, up);
        let opacity = if self.is_seen(&frame, axes_in_picture) { self.opacity } else { 0.0 };
        // Lengths are in the shortest edge of a voxel, which keeps the picture's proportions.
        let unit = voxel_size / voxel_size.min_element();
        let extent = dims.as_vec3() * unit;
        let height = self.height_vx;
        let width = height * pixels.size.x as f32 / pixels.size.y.max(1) as f32;
        let [right, upwards, towards] = [frame.x_axis, frame.y_axis, frame.z_axis];
        let reach = 0.5 * (towards.abs() * extent).element_sum() + GAP_VX;
        let along = match self.layer {
            Layer::Behind => -reach,
            Layer::Middle => 0.0,
            Layer::Before => reach,
        };
        let middle = 0.5 * extent + right * self.offset_vx.x + upwards * self.offset_vx.y;
        let corner = middle + towards * along - right * (0.5 * width) + upwards * (0.5 * height);
        let axes = Mat3::from_cols(right * width, -upwards * height, towards);
        let grid_from_units = Mat3::from_diagonal(1.0 / unit);
        let grid_from_picture =
            Affine3A::from_mat3_translation(grid_from_units * axes, grid_from_units * corner);
        Some(ReferencePicture { pixels, grid_from_picture, opacity })
    }

    fn is_seen(&self, frame: &Mat3, axes_in_picture: &[Vec3; 3]) -> bool {
        self.shown && (!self.locked || looks_along(frame, axes_in_picture))
    }

    /// Returns the name of its file.
    pub fn name(&self) -> String {
        let name = self.path.file_name().map(|name| name.to_string_lossy().into_owned());
        name.unwrap_or_else(|| self.path.display().to_string())
    }
}

fn looks_along(frame: &Mat3, axes_in_picture: &[Vec3; 3]) -> bool {
    let towards = frame.z_axis;
    let seen: Vec3 = (0..3).map(|axis| axes_in_picture[axis] * towards[axis]).sum();
    seen.z > ALONG
}

/// Returns the side that the view is along, within 5 degrees.
pub fn side_seen(up: Vec3, axes_in_picture: &[Vec3; 3]) -> Option<Side> {
    sides().find(|side| looks_along(&side_frame(*side, up), axes_in_picture))
}

/// Returns the sides that pictures can be on.
pub fn sides() -> impl Iterator<Item = Side> {
    Side::ALL.into_iter().filter(|side| *side != Side::Corner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(side: Side, layer: Layer) -> Reference {
        let pixels = Arc::new(Pixels::new(glam::UVec2::new(200, 100)));
        Reference { layer, ..Reference::new("a.png".into(), Some(pixels), side, 50.0) }
    }

    #[test]
    fn a_picture_stands_on_its_side_upright_and_unmirrored() {
        let dims = UVec3::new(100, 80, 60);
        let axes = Vec3::AXES;
        let placed = |reference: &Reference| {
            let placed = reference.placed(dims, Vec3::ONE, Vec3::Y, &axes).unwrap();
            [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| {
                placed.grid_from_picture.transform_point3(Vec3::new(x, y, 0.0)).to_array()
            })
        };
        // From the front: x to the right, y up, and the viewer at large z.
        let front = placed(&reference(Side::Front, Layer::Behind));
        assert_eq!(front, [[0.0, 65.0, -2.0], [100.0, 65.0, -2.0], [0.0, 15.0, -2.0]]);
        let before = placed(&reference(Side::Front, Layer::Before));
        assert_eq!(before[0], [0.0, 65.0, 62.0]);
        // From the right: z to the left.
        let right = placed(&reference(Side::Right, Layer::Middle));
        assert_eq!(right, [[50.0, 65.0, 80.0], [50.0, 65.0, -20.0], [50.0, 15.0, 80.0]]);
        let moved =
            Reference { offset_vx: Vec2::new(3.0, 4.0), ..reference(Side::Front, Layer::Behind) };
        assert_eq!(placed(&moved)[0], [3.0, 69.0, -2.0]);
    }

    #[test]
    fn a_picture_keeps_its_proportions_over_long_voxels() {
        let size = Vec3::new(1.0, 2.0, 1.0);
        let reference = reference(Side::Front, Layer::Behind);
        let placed = reference.placed(UVec3::splat(64), size, Vec3::Y, &Vec3::AXES).unwrap();
        let edge = |v: Vec3| (placed.grid_from_picture.transform_vector3(v) * size).length();
        assert_eq!((edge(Vec3::X), edge(Vec3::Y)), (100.0, 50.0));
    }

    #[test]
    fn a_locked_picture_is_shown_only_to_who_looks_along_its_side() {
        let turned = |degrees: f32| {
            let turn = glam::Quat::from_rotation_y(degrees.to_radians());
            Vec3::AXES.map(|axis| turn * axis)
        };
        let mut locked = reference(Side::Front, Layer::Behind);
        locked.locked = true;
        let opacity = |reference: &Reference, degrees| {
            let axes = turned(degrees);
            reference.placed(UVec3::splat(64), Vec3::ONE, Vec3::Y, &axes).unwrap().opacity
        };
        assert_eq!([0.0, 4.0, 6.0, 180.0].map(|turn| opacity(&locked, turn)), [0.6, 0.6, 0.0, 0.0]);
        locked.locked = false;
        assert_eq!(opacity(&locked, 180.0), 0.6);
        locked.shown = false;
        assert_eq!(opacity(&locked, 0.0), 0.0);
        assert_eq!(side_seen(Vec3::Y, &turned(0.0)), Some(Side::Front));
        assert_eq!(side_seen(Vec3::Y, &turned(-90.0)), Some(Side::Right));
        assert_eq!(side_seen(Vec3::Y, &turned(30.0)), None);
    }
}
