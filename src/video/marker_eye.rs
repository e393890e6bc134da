//! The eye of a camera: the view that matches the video behind the sculpture, and the placement of the sculpture on a
//! marker.
//!
//! Takes the camera's pose, its lens and the framing of its video; returns an [`Eye`]. The two match only if the video
//! is shown undistorted.

use glam::{Affine3A, Mat3, UVec2, Vec2, Vec3};

use super::{Framing, Intrinsics};
use crate::view::eye::{Eye, Frustum};

/// The placement of a sculpture on a marker: upright at its centre, with the world's y axis out of
/// the paper.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MarkerPlacement {
    /// Lowest point of the sculpture in the world, which touches the paper.
    pub ground: f32,
    /// Metres per world unit, above 0.
    pub m_per_unit: f32,
}

impl MarkerPlacement {
    /// Returns the transform from the world to the marker's axes (x right, y up on the paper, z out of it, metres).
    pub fn marker_from_world(&self) -> Affine3A {
        let turn = Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y);
        Affine3A::from_mat3(turn * self.m_per_unit)
            * Affine3A::from_translation(Vec3::new(0.0, -self.ground, 0.0))
    }

    /// Returns the eye of a camera. `camera_from_marker` in metres, with the camera's axes x right, y up and z
    /// backwards; `near` in world units; `size` in pixels.
    pub fn eye(
        &self,
        camera_from_marker: Affine3A,
        lens: &Intrinsics,
        framing: &Framing,
        size: UVec2,
        near: f32,
    ) -> Eye {
        // Eye space is in world units.
        let eye_from_world = Affine3A::from_scale(Vec3::splat(self.m_per_unit.recip()))
            * camera_from_marker
            * self.marker_from_world();
        Eye { eye_from_world, projection: framed(&lens.frustum(), framing).projection(near), size }
    }
}

/// Returns the frustum of the screen from that of the frame, `whole`. A mirrored frame swaps left and right.
fn framed(whole: &Frustum, framing: &Framing) -> Frustum {
    let (low, high) =
        (framing.picture_from_screen(Vec2::ZERO), framing.picture_from_screen(Vec2::ONE));
    let across = |share: f32| whole.left + (whole.right - whole.left) * share;
    let down = |share: f32| whole.up + (whole.down - whole.up) * share;
    Frustum { left: across(low.x), right: across(high.x), up: down(low.y), down: down(high.y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::Fit;
    use glam::{DVec2, Quat};
    use proptest::prelude::*;

    fn camera() -> Affine3A {
        Affine3A::from_rotation_translation(
            Quat::from_rotation_x(-0.7) * Quat::from_rotation_z(0.4),
            Vec3::new(0.02, -0.03, -0.5),
        )
    }

    fn lens() -> Intrinsics {
        let even = Intrinsics::pinhole(640, 480, 0.8);
        Intrinsics { cx: 331.0, cy: 222.5, fx: 600.0, fy: 590.0, ..even }
    }

    proptest! {
        /// Checks that a point of the world is drawn at its position in the camera's picture.
        #[test]
        fn sculpture_and_picture_match(
            x in -3.0f32..3.0, y in 0.0f32..3.0, z in -3.0f32..3.0,
            width in 200u32..2000, height in 200u32..2000, mirror: bool,
        ) {
            let stand = MarkerPlacement { ground: -1.5, m_per_unit: 0.03 };
            let (lens, size) = (lens(), UVec2::new(width, height));
            for fit in [Fit::Fit, Fit::Fill, Fit::Stretch] {
                let framing = Framing::new(UVec2::new(640, 480), size, fit, mirror);
                let eye = stand.eye(camera(), &lens, &framing, size, 0.01);
                let world = Vec3::new(x, y, z);
                let clip = eye.projection * eye.eye_from_world.transform_point3(world).extend(1.0);
                let seen = Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5;
                let p = (camera() * stand.marker_from_world()).transform_point3(world);
                let ray = DVec2::new(f64::from(p.x), f64::from(-p.y)) / f64::from(-p.z);
                let expected = framing.screen_from_picture(lens.uv_from_ray(ray).as_vec2());
                prop_assert!(seen.distance(expected) < 1e-3, "{seen} {expected}");
                prop_assert!((clip.w * stand.m_per_unit + p.z).abs() < 1e-3, "world units");
            }
        }
    }

    #[test]
    fn the_ground_lies_on_the_paper_and_up_is_out_of_it() {
        let stand = MarkerPlacement { ground: 2.0, m_per_unit: 0.01 };
        let map = stand.marker_from_world();
        assert!(map.transform_point3(Vec3::new(0.0, 2.0, 0.0)).abs_diff_eq(Vec3::ZERO, 1e-6));
        let up = map.transform_vector3(Vec3::Y);
        assert!(up.abs_diff_eq(Vec3::new(0.0, 0.0, 0.01), 1e-6));
        // The front of the sculpture faces the lower edge of the marker, towards the person.
        let front = map.transform_vector3(Vec3::Z);
        assert!(front.abs_diff_eq(Vec3::new(0.0, -0.01, 0.0), 1e-6));
    }
}
