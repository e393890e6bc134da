//! An eye: one view of the world, mono or one of a stereo pair, and the rays through its pixels in grid coordinates.
//!
//! Eye space is right-handed, x right, y up, looking along -z. Clip space is Vulkan's: x right,
//! y down, depth reversed (1 at the near plane, 0 at infinity).

use glam::{Affine3A, Mat4, UVec2, Vec3, Vec4};

/// A view: pose, projection and size in pixels.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Eye {
    /// The rigid map from world to eye coordinates.
    pub eye_from_world: Affine3A,
    /// Clip from eye, reversed depth, y down.
    pub projection: Mat4,
    /// Size in pixels.
    pub size: UVec2,
}

/// The tangents of the half angles of a view frustum. Left and down are usually negative.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Frustum {
    /// Left edge.
    pub left: f32,
    /// Right edge.
    pub right: f32,
    /// Lower edge.
    pub down: f32,
    /// Upper edge.
    pub up: f32,
}

impl Frustum {
    /// Returns a symmetric frustum from the vertical angle and the aspect ratio width / height.
    pub fn symmetric(fov_y_rad: f32, aspect: f32) -> Frustum {
        let up = (0.5 * fov_y_rad).tan();
        let right = up * aspect;
        Frustum { left: -right, right, down: -up, up }
    }

    /// Returns the off-axis perspective with reversed depth and no far plane.
    pub fn projection(&self, near: f32) -> Mat4 {
        let (w, h) = (self.right - self.left, self.up - self.down);
        Mat4::from_cols(
            Vec4::new(2.0 / w, 0.0, 0.0, 0.0),
            Vec4::new(0.0, -2.0 / h, 0.0, 0.0),
            Vec4::new((self.right + self.left) / w, -(self.up + self.down) / h, 0.0, -1.0),
            Vec4::new(0.0, 0.0, near, 0.0),
        )
    }
}

/// The rays of an eye through the centres of its pixels, in grid coordinates:
/// `origin + t * direction(x, y)`, directions not normalised.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PixelRays {
    /// The eye in grid coordinates.
    pub origin: Vec3,
    /// Direction through the upper left corner of the picture.
    pub corner: Vec3,
    /// Change of direction from a pixel to its right neighbour.
    pub step_x: Vec3,
    /// Change of direction from a pixel to the one below.
    pub step_y: Vec3,
    /// Width and height of the picture in pixels.
    pub size: UVec2,
}

impl PixelRays {
    /// Returns the rays of a picture without pixels.
    pub fn of_nothing() -> PixelRays {
        PixelRays {
            origin: Vec3::ZERO,
            corner: Vec3::NEG_Z,
            step_x: Vec3::X,
            step_y: Vec3::NEG_Y,
            size: UVec2::ZERO,
        }
    }

    /// Returns a function that gives the shorter edge of a pixel, in voxels, at the depth of a point in grid coordinates:
    /// 0 or less for points that are not before the eye.
    pub fn pixel_edges_vx(&self) -> impl Fn(Vec3) -> f32 + use<> {
        let forward = self.step_x.cross(self.step_y).normalize_or_zero();
        let shorter = self.step_x.length().min(self.step_y.length());
        let (origin, per_depth) = (self.origin, shorter / self.corner.dot(forward));
        move |point| (point - origin).dot(forward) * per_depth
    }

    /// Returns the direction of the ray through the centre of pixel (x, y), y counted downwards.
    #[inline(always)]
    pub fn direction(&self, x: u32, y: u32) -> Vec3 {
        self.direction_at(x as f32 + 0.5, y as f32 + 0.5)
    }

    /// Returns the direction through any point of the picture, in pixels from its upper left corner.
    #[inline(always)]
    pub fn direction_at(&self, x: f32, y: f32) -> Vec3 {
        self.corner + self.step_x * x + self.step_y * y
    }
}

impl Eye {
    /// Returns the rays in the coordinates of a grid placed by `world_from_grid`: the inverted model-view-projection,
    /// evaluated once. Directions have length 1 along the eye's axis, so that `t` is the distance from the eye plane in
    /// world units.
    pub fn pixel_rays(&self, world_from_grid: &Affine3A) -> PixelRays {
        let grid_from_eye = (self.eye_from_world * *world_from_grid).inverse();
        let p = &self.projection;
        // A point of the picture (cx, cy in clip space) lies on the eye ray (a, b, -1):
        // cx = p00 a - p20, cy = p11 b - p21.
        let ray = |cx: f32, cy: f32| {
            let a = (cx + p.z_axis.x) / p.x_axis.x;
            let b = (cy + p.z_axis.y) / p.y_axis.y;
            grid_from_eye.transform_vector3(Vec3::new(a, b, -1.0))
        };
        let corner = ray(-1.0, -1.0);
        let size = self.size.as_vec2();
        PixelRays {
            origin: grid_from_eye.translation.into(),
            corner,
            step_x: (ray(1.0, -1.0) - corner) / size.x,
            step_y: (ray(-1.0, 1.0) - corner) / size.y,
            size: self.size,
        }
    }

    /// Returns the map from homogeneous grid coordinates to clip space.
    pub fn clip_from_grid(&self, world_from_grid: &Affine3A) -> Mat4 {
        self.projection * Mat4::from(self.eye_from_world * *world_from_grid)
    }

    /// Returns the world position of the eye.
    pub fn position(&self) -> Vec3 {
        self.eye_from_world.inverse().translation.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Camera;
    use glam::Vec2;

    /// The ray through a pixel and the projection of a point on that ray must agree.
    #[test]
    fn rays_and_projection_are_inverse() {
        let camera = Camera { eye: Vec3::new(3.0, 2.0, 5.0), ..Camera::default() };
        let mut eye = camera.eye(UVec2::new(64, 48));
        eye.projection = Frustum { left: -0.3, right: 0.5, down: -0.2, up: 0.4 }.projection(0.1);
        let world_from_grid = Affine3A::from_rotation_y(0.7)
            * Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.5))
            * Affine3A::from_translation(Vec3::new(-4.0, 1.0, 2.0));
        let rays = eye.pixel_rays(&world_from_grid);
        let clip_from_grid = eye.clip_from_grid(&world_from_grid);
        for (x, y) in [(0, 0), (63, 47), (10, 30)] {
            let point = rays.origin + rays.direction(x, y) * 3.0;
            let clip = clip_from_grid * point.extend(1.0);
            let pixel = (Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5) * eye.size.as_vec2();
            assert!(pixel.abs_diff_eq(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 1e-3), "{pixel}");
            assert!((clip.w - 3.0).abs() < 1e-4, "t is the distance from the eye plane");
            assert!((clip.z - 0.1).abs() < 1e-5, "reversed depth: z_clip is the near distance");
        }
    }
}
