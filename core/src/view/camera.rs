//! The camera of a screen without head tracking: an eye point that looks at a target.

use glam::camera::rh;
use glam::{UVec2, Vec3};

use super::eye::{Eye, Frustum};

/// A perspective camera in world coordinates.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Camera {
    /// Position, in world units.
    pub eye: Vec3,
    /// The point looked at, in world units.
    pub target: Vec3,
    /// The direction that is up in the picture; need not be normalised.
    pub up: Vec3,
    /// Vertical angle of view.
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
    /// A camera that looks at the world's origin from `direction`, at the distance from which a ball
    /// of `radius` about it fills most of the picture's height.
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

    /// A camera that looks at the middle of `points` from `direction`, as near as possible with all of
    /// them in a picture of `aspect` (width / height). At `zoom` 1 a small margin remains.
    pub fn framing_points(
        points: &[Vec3],
        direction: Vec3,
        up: Vec3,
        fov_y_rad: f32,
        aspect: f32,
        zoom: f32,
    ) -> Camera {
        let low = points.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = points.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let target = (low + high) * 0.5;
        let camera = Camera { fov_y_rad, ..Camera::framing(1.0, direction, up) };
        let turn = rh::view::look_at_affine3a(camera.eye, Vec3::ZERO, camera.up).matrix3;
        let slope_y = (0.5 * fov_y_rad).tan() / 1.08;
        let slope_x = slope_y * aspect;
        // A point (x, y, z) as seen from the target is in the picture of an eye `distance` away
        // if |x| <= slope_x (distance - z), and so for y.
        let distance = points
            .iter()
            .map(|&point| turn * (point - target))
            .map(|p| p.z + (p.x.abs() / slope_x).max(p.y.abs() / slope_y))
            .fold(f32::MIN_POSITIVE, f32::max)
            / zoom;
        let eye = target + camera.eye.normalize() * distance;
        Camera { eye, target, near: distance * 1e-3, ..camera }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framed_points_are_in_the_picture_and_touch_its_rim() {
        for (direction, up) in [
            (Vec3::new(0.8, 0.6, 1.0), Vec3::Y),
            (Vec3::Z, Vec3::Y),
            (Vec3::Y, Vec3::Y),
            (Vec3::new(-1.0, 0.2, 0.1), Vec3::NEG_Z),
        ] {
            let (low, high) = (Vec3::new(10.0, -3.0, 2.0), Vec3::new(50.0, 4.0, 9.0));
            let points: Vec<Vec3> = (0..8)
                .map(|i| {
                    let pick = |bit: u32, axis: usize| {
                        if i >> bit & 1 == 0 { low[axis] } else { high[axis] }
                    };
                    Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
                })
                .collect();
            let size = UVec2::new(640, 480);
            let camera = Camera::framing_points(&points, direction, up, 0.8, 4.0 / 3.0, 1.0);
            let eye = camera.eye(size);
            let reach = points
                .iter()
                .map(|p| {
                    let clip = eye.projection * eye.eye_from_world.transform_point3(*p).extend(1.0);
                    assert!(clip.w > 0.0, "in front of the eye");
                    (clip.x.abs() / clip.w).max(clip.y.abs() / clip.w)
                })
                .fold(0.0, f32::max);
            assert!((0.9..0.95).contains(&reach), "{direction}: {reach}");
        }
    }
}
