//! Owns the camera of a screen without tracking: an eye point that looks at a target.

use glam::camera::rh;
use glam::{UVec2, Vec3};

use super::eye::{Eye, Frustum};

/// A perspective camera in world coordinates.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Camera {
    pub eye: Vec3,
    pub target: Vec3,
    pub up: Vec3,
    pub fov_y_rad: f32,
    /// Distance of the near plane.
    pub near: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera {
            eye: Vec3::new(0.0, 0.0, 10.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_rad: 45f32.to_radians(),
            near: 0.01,
        }
    }
}

impl Camera {
    /// Looks at the world's origin from `direction`, far enough for a ball of `radius` about it to
    /// fill most of the picture's height.
    pub fn framing(radius: f32, direction: Vec3, up: Vec3) -> Camera {
        let fov_y_rad = 45f32.to_radians();
        let distance = 1.05 * radius / (0.5 * fov_y_rad).sin();
        let direction = direction.try_normalize().unwrap_or(Vec3::Z);
        // Looking straight along `up` leaves the roll open: take another axis.
        let up = if direction.cross(up).length_squared() < 1e-6 {
            if direction.x.abs() < 0.9 { Vec3::X } else { Vec3::Z }
        } else {
            up
        };
        Camera {
            eye: direction * distance,
            target: Vec3::ZERO,
            up,
            fov_y_rad,
            near: distance * 1e-3,
        }
    }

    /// The same picture of what is around the target with another vertical angle of view: the eye
    /// comes nearer or goes away.
    pub fn with_fov(self, fov_y_rad: f32) -> Camera {
        let factor = (0.5 * self.fov_y_rad).sin() / (0.5 * fov_y_rad).sin();
        let eye = self.target + (self.eye - self.target) * factor;
        Camera { eye, fov_y_rad, near: self.near * factor, ..self }
    }

    /// The camera with eye and target moved by `offset`.
    pub fn moved(self, offset: Vec3) -> Camera {
        Camera { eye: self.eye + offset, target: self.target + offset, ..self }
    }

    /// The eye for a picture of `size` pixels.
    pub fn eye(&self, size: UVec2) -> Eye {
        let aspect = size.x as f32 / size.y.max(1) as f32;
        Eye {
            eye_from_world: rh::view::look_at_affine3a(self.eye, self.target, self.up),
            projection: Frustum::symmetric(self.fov_y_rad, aspect).projection(self.near),
            size,
        }
    }
}
