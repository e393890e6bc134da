//! The two eyes of a stereo picture without head tracking: parallel cameras whose frusta are shifted so that both see
//! the same window at the distance of convergence.
//!
//! Maps the eye between them to the left and the right one. Does not know how the two pictures are shown. The cameras
//! are not toed in: that would give points off the centre a vertical parallax (A. Woods, T. Docherty, R. Koch: "Image
//! Distortions in Stereoscopic Video Systems", SPIE 1915, 1993).

use glam::{Affine3A, Vec3};

use super::eye::Eye;

/// The distance between the eyes, and the distance at which their pictures coincide. Lengths are in world units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StereoRig {
    /// Distance between the eyes, 0 or more.
    pub eye_distance: f32,
    /// Distance from the eyes' plane to the plane that appears in the plane of the screen, above 0.
    pub convergence: f32,
    /// Exchanges the pictures of the two eyes, for screens that have them reversed.
    pub swap: bool,
}

impl StereoRig {
    /// Returns the pictures for the left and the right eye, in this order, of a head whose midpoint sees `mono`. A
    /// point `depth` in front of the eyes has the parallax (right minus left, positive behind the screen) `eye_distance
    /// * (1 - convergence / depth)` measured in the plane of convergence.
    pub fn eyes(&self, mono: &Eye) -> [Eye; 2] {
        let half = 0.5 * self.eye_distance;
        let [left, right] = [-half, half].map(|x| shifted(mono, x, self.convergence));
        if self.swap { [right, left] } else { [left, right] }
    }
}

/// Returns the eye moved by `x` to its right, which sees the same window at `convergence`.
fn shifted(mono: &Eye, x: f32, convergence: f32) -> Eye {
    let mut eye = *mono;
    eye.eye_from_world = Affine3A::from_translation(Vec3::new(-x, 0.0, 0.0)) * mono.eye_from_world;
    // Both tangents of the frustum shrink by x / convergence; their difference stays.
    eye.projection.z_axis.x -= mono.projection.x_axis.x * x / convergence;
    eye
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Camera;
    use crate::view::eye::Frustum;
    use glam::{UVec2, Vec2};
    use proptest::prelude::*;

    fn ndc(eye: &Eye, world: Vec3) -> Vec2 {
        let clip = eye.projection * eye.eye_from_world.transform_point3(world).extend(1.0);
        Vec2::new(clip.x, clip.y) / clip.w
    }

    fn mono() -> Eye {
        let camera = Camera { eye: Vec3::new(3.0, 2.0, 9.0), ..Camera::default() };
        let mut eye = camera.eye(UVec2::new(640, 480));
        // Off-centre, so that no result depends on symmetry.
        eye.projection = Frustum { left: -0.3, right: 0.5, down: -0.2, up: 0.4 }.projection(0.1);
        eye
    }

    proptest! {
        #[test]
        fn parallax_follows_its_formula_and_is_never_vertical(
            x in -2.0f32..2.0, y in -2.0f32..2.0, depth in 1.0f32..50.0,
            eye_distance in 0.0f32..1.0, convergence in 2.0f32..20.0,
        ) {
            let mono = mono();
            let rig = StereoRig { eye_distance, convergence, swap: false };
            let [left, right] = rig.eyes(&mono);
            let world = mono.eye_from_world.inverse().transform_point3(Vec3::new(x, y, -depth));
            let (l, r) = (ndc(&left, world), ndc(&right, world));
            prop_assert!((l.y - r.y).abs() < 1e-4);
            // 2 / (the window's width at convergence): from world units there to clip space.
            let ndc_per_unit = mono.projection.x_axis.x / convergence;
            let parallax = eye_distance * (1.0 - convergence / depth) * ndc_per_unit;
            prop_assert!((r.x - l.x - parallax).abs() < 2e-4, "{} {parallax}", r.x - l.x);
            let between = right.position().midpoint(left.position());
            prop_assert!(between.distance(mono.position()) < 1e-4);
            prop_assert!((right.position().distance(left.position()) - eye_distance).abs() < 1e-4);
        }

        #[test]
        fn points_at_the_convergence_distance_have_no_parallax(x in -2.0f32..2.0, y in -2.0f32..2.0, c in 2.0f32..20.0) {
            let mono = mono();
            let rig = StereoRig { eye_distance: 0.4, convergence: c, swap: false };
            let world = mono.eye_from_world.inverse().transform_point3(Vec3::new(x, y, -c));
            for eye in rig.eyes(&mono) {
                prop_assert!(ndc(&eye, world).distance(ndc(&mono, world)) < 1e-4);
            }
        }
    }

    #[test]
    fn the_left_eye_is_left_and_swap_exchanges_them() {
        let mono = mono();
        let rig = StereoRig { eye_distance: 0.4, convergence: 5.0, swap: false };
        let [left, right] = rig.eyes(&mono);
        let in_mono = |eye: &Eye| mono.eye_from_world.transform_point3(eye.position());
        assert!(in_mono(&left).abs_diff_eq(Vec3::new(-0.2, 0.0, 0.0), 1e-5));
        assert!(in_mono(&right).abs_diff_eq(Vec3::new(0.2, 0.0, 0.0), 1e-5));
        assert_eq!(StereoRig { swap: true, ..rig }.eyes(&mono), [right, left]);
        assert_eq!(StereoRig { eye_distance: 0.0, ..rig }.eyes(&mono), [mono, mono]);
    }
}
