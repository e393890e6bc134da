//! Placing the symmetry: a mirror plane where a press meets the surface, an axis of rotation that stands on it, or
//! either where a hand holds it.
//!
//! Takes a symmetry and gives a changed one. A plane or axis placed within a few degrees of a grid axis snaps to it.

use glam::{UVec3, Vec2, Vec3};

use super::surface_guide::normal_around;
use crate::picking::Picker;
use crate::sculpture::Grid;
use crate::tools::symmetry::{MirrorPlane, Radial, Symmetry};

/// Radius around a press in which the surface defines an axis, in units of the smallest edge of a voxel.
const GROUND: f32 = 6.0;
/// Cosine of the angle within which a direction snaps to a grid axis: three degrees.
const NEARLY: f32 = 0.99863;
/// Default number of repetitions of a tool.
pub const FIRST_COUNT: u32 = 6;

/// The part of the symmetry to place.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SymmetryPart {
    /// The mirror plane.
    Plane,
    /// The axis of rotation.
    Axis,
}

impl SymmetryPart {
    /// Returns the direction of a plane's normal or of an axis placed at `point`, seen at a pixel: a plane contains the
    /// line of sight and the vertical of the picture, an axis points out of the surface.
    pub(super) fn direction_at(self, point: Vec3, at: Vec2, grid: &Grid, picker: &Picker) -> Vec3 {
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        match self {
            SymmetryPart::Plane => {
                let rays = &picker.sight().rays;
                let way = |at: Vec2| (rays.direction_at(at.x, at.y) * edges).normalize_or_zero();
                let ahead = way(at);
                let right = way(at + Vec2::X) - ahead;
                (right - ahead * right.dot(ahead)).normalize_or(Vec3::X)
            }
            SymmetryPart::Axis => {
                let around = normal_around(grid, point, GROUND);
                around.unwrap_or_else(|| picker.normal(grid, at, false)).normalize_or(Vec3::Y)
            }
        }
    }

    /// Returns the direction in a hand that holds it upright: a plane across the hand, an axis upright in it.
    pub(super) fn direction_in_hand(self) -> Vec3 {
        match self {
            SymmetryPart::Plane => Vec3::X,
            SymmetryPart::Axis => Vec3::Y,
        }
    }

    /// Returns a symmetry with it at a point.
    pub(super) fn put(self, mut symmetry: Symmetry, at_vx: Vec3, direction: Vec3) -> Symmetry {
        let (at_vx, direction) = snapped(at_vx, direction);
        match self {
            SymmetryPart::Plane => symmetry.plane = Some(MirrorPlane { at_vx, normal: direction }),
            SymmetryPart::Axis => {
                let count = symmetry.radial.map_or(FIRST_COUNT, |radial| radial.count);
                symmetry.radial = Some(Radial { at_vx, axis: direction, count });
            }
        }
        symmetry
    }

    /// Returns a symmetry without it, or if it has none, with a plane across the middle of a grid of `dims` voxels,
    /// from left to right, or an upright axis through it.
    pub(super) fn toggled(self, mut symmetry: Symmetry, dims: UVec3) -> Symmetry {
        let at_vx = (dims / 2).as_vec3();
        match self {
            SymmetryPart::Plane => {
                let plane = MirrorPlane { at_vx, normal: Vec3::X };
                symmetry.plane = symmetry.plane.is_none().then_some(plane);
            }
            SymmetryPart::Axis => {
                let radial = Radial { at_vx, axis: Vec3::Y, count: FIRST_COUNT };
                symmetry.radial = symmetry.radial.is_none().then_some(radial);
            }
        }
        symmetry
    }
}

/// Snaps a direction to a grid axis if it is near one, and then the point to the border or the middle of voxels.
fn snapped(at_vx: Vec3, direction: Vec3) -> (Vec3, Vec3) {
    let along = Vec3::AXES.into_iter().find(|axis| direction.dot(*axis).abs() >= NEARLY);
    match along {
        Some(axis) => ((at_vx * 2.0).round() * 0.5, axis),
        None => (at_vx, direction),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_direction_near_a_grid_axis_snaps_to_it() {
        let at = Vec3::new(1.3, 2.7, 3.1);
        let (there, direction) = snapped(at, Vec3::new(-0.02, 0.01, -0.9997));
        assert_eq!((there, direction), (Vec3::new(1.5, 2.5, 3.0), Vec3::Z));
        let oblique = Vec3::new(0.6, 0.8, 0.0);
        assert_eq!(snapped(at, oblique), (at, oblique));
    }
}
