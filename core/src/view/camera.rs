//! The camera of a screen without head tracking: an eye point that looks at a target.

use glam::camera::rh;
use glam::{UVec2, Vec3};

use super::eye::{Eye, Frustum};

/// Distance of a camera that approximates an orthographic one, in diameters of the visible object: at 640x480 no point
/// is then farther than a quarter of a pixel from its exact position.
const AFAR_DIAMETERS: f32 = 240.0;
/// The largest distance in voxels. In single precision, the rays of a picture are off by some millionths of their
/// length.
const AFAR_VX: f32 = 240_000.0;

/// Width of a picture over that of the points framed in it.
pub const FRAME_MARGIN: f32 = 1.08;

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
    /// Returns a camera that looks at the world's origin from `direction`, at the distance from which a ball of
    /// `radius` about it fills most of the picture's height.
    pub fn framing(radius: f32, direction: Vec3, up: Vec3) -> Camera {
        let fov_y_rad = 45f32.to_radians();
        let distance = 1.05 * radius / (0.5 * fov_y_rad).sin();
        let direction = direction.try_normalize().unwrap_or(Vec3::Z);
        // Looking straight along `up` leaves the roll undefined: use another axis.
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

    /// Returns a camera that looks at the centre of `points` from `direction`, as near as possible with all of them in
    /// a picture of `aspect` (width / height). At `zoom` 1 a small margin remains.
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
        let slope_y = (0.5 * fov_y_rad).tan() / FRAME_MARGIN;
        let slope_x = slope_y * aspect;
        // A point (x, y, z) relative to the target is in the picture of an eye `distance` away if |x| <= slope_x
        // (distance - z), and likewise for y.
        let distance = points
            .iter()
            .map(|&point| turn * (point - target))
            .map(|p| p.z + (p.x.abs() / slope_x).max(p.y.abs() / slope_y))
            .fold(f32::MIN_POSITIVE, f32::max)
            / zoom;
        let eye = target + camera.eye.normalize() * distance;
        Camera { eye, target, near: distance * 1e-3, ..camera }
    }

    /// Returns an orthographic camera, up to a fraction of a pixel: so distant, and with so narrow an angle of view,
    /// that its rays are practically parallel around the target, within `diameter` world units or `diameter_vx` voxels.
    /// So samplers and picking, whose rays all start in the eye, need no special case.
    ///
    /// The picture shows the same part of the plane through the target as this camera's does. The more it magnifies,
    /// the nearer the eye is: small details need exact rays more than parallel ones.
    pub fn orthographic(&self, diameter: f32, diameter_vx: f32) -> Camera {
        let from_target = self.eye - self.target;
        let half_height = from_target.length() * (0.5 * self.fov_y_rad).tan();
        let magnification = (0.5 * diameter / half_height).max(1.0);
        let diameters = (AFAR_DIAMETERS / magnification.sqrt()).min(AFAR_VX / diameter_vx.max(1.0));
        // Never within the object.
        let distance = diameter * diameters.max(2.0);
        Camera {
            eye: self.target + from_target.normalize_or(Vec3::Z) * distance,
            fov_y_rad: 2.0 * (half_height / distance).atan(),
            near: 1e-3 * distance,
            ..*self
        }
    }

    /// Returns the eye for a picture of `size` pixels.
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
    use crate::sculpture::Placement;
    use glam::{DVec2, EulerRot, Quat, Vec2};
    use proptest::prelude::*;

    proptest! {
        /// Points of a sculpture, projected and by the rays of their pixels, lie where parallel rays see them.
        #[test]
        fn an_orthographic_camera_is_a_parallel_projection_within_a_quarter_pixel(
            turn in prop::array::uniform3(-3.0f32..3.0),
            at in prop::array::uniform3(0.0f32..1.0),
            edge in 8u32..512, scale in 0.1f32..10.0,
        ) {
            let size = UVec2::new(640, 480);
            let dims = glam::UVec3::new(edge, edge / 2 + 1, edge);
            let rotation = Quat::from_euler(EulerRot::XYZ, turn[0], turn[1], turn[2]);
            let placement = Placement { rotation, scale, ..Placement::default() };
            let world_from_grid = placement.world_from_grid(dims, Vec3::ONE);
            let diameter_vx = dims.as_vec3().length();
            let usual = Camera::framing(0.5 * scale * diameter_vx, Vec3::Z, Vec3::Y);
            let camera = usual.orthographic(scale * diameter_vx, diameter_vx);
            let eye = camera.eye(size);
            let point = dims.as_vec3() * Vec3::from(at);
            // Parallel, in double precision.
            let world = world_from_grid.as_daffine3().transform_point3(point.as_dvec3());
            let height = 2.0 * (0.5 * f64::from(usual.fov_y_rad)).tan() * f64::from(usual.eye.z);
            let px_per_unit = 480.0 / height;
            let expected = DVec2::new(320.0 + world.x * px_per_unit, 240.0 - world.y * px_per_unit);
            let clip = eye.clip_from_grid(&world_from_grid) * point.extend(1.0);
            let projected = (Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5) * size.as_vec2();
            let off = projected.as_dvec2().distance(expected);
            prop_assert!(off < 0.25, "projected at {projected}, not {expected}: {off}");
            // The ray through that position passes the point as closely.
            let rays = eye.pixel_rays(&world_from_grid);
            let direction = rays.direction_at(expected.x as f32, expected.y as f32);
            let met = rays.origin + direction * (clip.w);
            let passes = f64::from(met.distance(point) * scale) * px_per_unit;
            prop_assert!(passes < 0.25, "the ray passes at {passes} px");
        }
    }

    #[test]
    fn an_orthographic_camera_shows_the_same_window_and_comes_nearer_as_it_magnifies() {
        let usual = Camera::framing(100.0, Vec3::new(1.0, 2.0, 3.0), Vec3::Y);
        let window = |camera: &Camera| {
            2.0 * (0.5 * camera.fov_y_rad).tan() * camera.eye.distance(camera.target)
        };
        let mut before = f32::INFINITY;
        for nearer in [1.0, 0.3, 0.05, 0.01] {
            let camera = Camera { eye: usual.eye * nearer, ..usual };
            let afar = camera.orthographic(200.0, 200.0);
            assert!((window(&afar) / window(&camera) - 1.0).abs() < 1e-3, "{nearer}");
            let distance = afar.eye.length();
            assert!(distance < before && distance > 1000.0, "{distance}");
            before = distance;
        }
        // However large the grid, rays are exact to fractions of a voxel.
        assert!(usual.orthographic(200.0, 7094.0).eye.length() < 200.0 / 7094.0 * 1.001 * AFAR_VX);
    }

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
