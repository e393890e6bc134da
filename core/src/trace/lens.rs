//! The lens of the camera: with a wide aperture only one distance is in focus.
//!
//! Maps the rays of an eye to those through points of its pupil: a thin lens. Knows no voxels and no light.

use glam::{Vec2, Vec3};

use crate::view::PixelRays;

/// The rays of a picture through the eye's pupil instead of a point: a thin lens.
#[derive(Clone, Copy, Debug)]
pub struct Pupil {
    /// The radius vector of the pupil to the right, in grid coordinates.
    pub right: Vec3,
    /// The radius vector upwards.
    pub up: Vec3,
    /// The distance in focus, in lengths of the rays' directions.
    pub focus: f32,
}

impl Pupil {
    /// Returns the ray from a point of the unit disc to the point where the eye's ray meets the plane of focus.
    pub(super) fn ray(&self, rays: &PixelRays, x: u32, y: u32, disc: Vec2) -> (Vec3, Vec3) {
        let offset = self.right * disc.x + self.up * disc.y;
        (rays.origin + offset, rays.direction(x, y) - offset / self.focus)
    }
}
