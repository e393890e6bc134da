//! Placing the symmetry: a mirror plane where a press meets the surface, an axis of rotation that stands on it, or either
//! where a hand holds it.
//!
//! Each change is a command. A plane or axis that is placed along an axis of the grid, or nearly so, lies exactly along
//! it.

use glam::{Quat, Vec2, Vec3};

use super::Editor;
use super::surface_guide::normal_around;
use crate::command::Command;
use crate::picking::Picker;
use crate::tools::symmetry::{MirrorPlane, Radial};

/// How far around a press the surface says where an axis points, in units of the smallest edge of a voxel.
const GROUND: f32 = 6.0;
/// Cosine of the angle within which a direction is taken for an axis of the grid: three degrees.
const NEARLY: f32 = 0.99863;
/// How often a tool is repeated at first.
pub const FIRST_COUNT: u32 = 6;

/// The part of the symmetry that is placed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Placed {
    /// The mirror plane.
    Plane,
    /// The axis of rotation.
    Axis,
}

impl Editor {
    /// Puts a mirror plane across the middle of the grid, from left to right, or takes it away.
    pub(super) fn toggle_plane(&mut self) {
        let mut symmetry = self.document().symmetry();
        symmetry.plane = match symmetry.plane {
            Some(_) => None,
            None => Some(MirrorPlane { at_vx: self.middle_vx(), normal: Vec3::X }),
        };
        self.execute(&Command::Symmetry(symmetry));
    }

    /// Repeats tools around an upright axis through the middle of the grid, or no longer.
    pub(super) fn toggle_radial(&mut self) {
        let mut symmetry = self.document().symmetry();
        symmetry.radial = match symmetry.radial {
            Some(_) => None,
            None => Some(Radial { at_vx: self.middle_vx(), axis: Vec3::Y, count: FIRST_COUNT }),
        };
        self.execute(&Command::Symmetry(symmetry));
    }

    fn middle_vx(&self) -> Vec3 {
        (self.document().grid().dims() / 2).as_vec3()
    }

    /// Places it where a press meets the surface: a plane along the line of sight and the vertical of the picture, an axis
    /// out of the surface.
    pub(super) fn place_symmetry(&mut self, what: Placed, at: Vec2, picker: &Picker) {
        let grid = self.document().grid();
        let Some(point) = self.target(at, picker) else {
            self.note("Press on the surface to place it there");
            return;
        };
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let direction = match what {
            Placed::Plane => {
                let rays = &picker.sight().rays;
                let way = |at: Vec2| (rays.direction_at(at.x, at.y) * edges).normalize_or_zero();
                let ahead = way(at);
                let right = way(at + Vec2::X) - ahead;
                (right - ahead * right.dot(ahead)).normalize_or(Vec3::X)
            }
            Placed::Axis => {
                let around = normal_around(grid, point, GROUND);
                around.unwrap_or_else(|| picker.normal(grid, at, false)).normalize_or(Vec3::Y)
            }
        };
        self.put_symmetry(what, point, direction);
    }

    /// Puts it where a hand holds it: a plane across the hand, an axis upright in it.
    pub(super) fn hold_symmetry(&mut self, what: Placed, at_vx: Vec3, rotation: Quat) {
        let own = match what {
            Placed::Plane => Vec3::X,
            Placed::Axis => Vec3::Y,
        };
        self.put_symmetry(what, at_vx, rotation * own);
    }

    fn put_symmetry(&mut self, what: Placed, at_vx: Vec3, direction: Vec3) {
        let (at_vx, direction) = snapped(at_vx, direction);
        let mut symmetry = self.document().symmetry();
        match what {
            Placed::Plane => symmetry.plane = Some(MirrorPlane { at_vx, normal: direction }),
            Placed::Axis => {
                let count = symmetry.radial.map_or(FIRST_COUNT, |radial| radial.count);
                symmetry.radial = Some(Radial { at_vx, axis: direction, count });
            }
        }
        if symmetry != self.document().symmetry() {
            self.execute(&Command::Symmetry(symmetry));
        }
    }
}

/// Along the grid if that is nearly so, and then between voxels or through their middles.
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
    fn what_is_nearly_along_the_grid_lies_along_it() {
        let at = Vec3::new(1.3, 2.7, 3.1);
        let (there, direction) = snapped(at, Vec3::new(-0.02, 0.01, -0.9997));
        assert_eq!((there, direction), (Vec3::new(1.5, 2.5, 3.0), Vec3::Z));
        let oblique = Vec3::new(0.6, 0.8, 0.0);
        assert_eq!(snapped(at, oblique), (at, oblique));
    }
}
