//! Off-axis views: a rectangle on a screen as a window into the world, seen by an eye anywhere in
//! front of it.
//!
//! Takes positions in metres on the screen's axes: origin at the screen's centre, x right, y up, z towards the viewer.
//! Returns [`Eye`]s. Does not know the source of positions. The projection is that of R. Kooima: "Generalized
//! Perspective Projection", 2009, for a screen that is a plane of constant z.

use glam::{Affine3A, Mat3, Quat, UVec2, Vec2, Vec3};

use super::eye::{Eye, Frustum};

/// The least distance of an eye from the plane of the screen, in metres. Eyes that are nearer, or behind the plane, are
/// moved to this distance: they would have no picture.
pub const NEAREST_EYE_M: f32 = 0.05;

/// A rectangle in the plane of the screen, in metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ScreenPlane {
    /// Its centre, relative to the screen's.
    pub centre_m: Vec2,
    /// Width of the picture on the screen.
    pub width_m: f32,
    /// Height of the picture on the screen.
    pub height_m: f32,
}

/// Pose of the screen in the world, and the scale between them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ScreenInWorld {
    /// The point of the world, in world units, at the middle of the rectangle.
    pub centre: Vec3,
    /// Rotation from screen axes to world axes.
    pub rotation: Quat,
    /// World units per metre in front of the screen, above 0.
    pub units_per_m: f32,
}

/// The positions of two eyes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Head {
    /// The point between the eyes, on the screen's axes.
    pub position_m: Vec3,
    /// Rotation from the head's axes to the screen's.
    pub orientation: Quat,
    /// Distance between the eyes along the head's x axis.
    pub eye_distance_m: f32,
}

impl Head {
    /// Returns the left and the right eye, on the screen's axes.
    pub fn eyes_m(&self) -> [Vec3; 2] {
        let half = self.orientation * Vec3::X * (0.5 * self.eye_distance_m);
        [self.position_m - half, self.position_m + half]
    }
}

impl ScreenPlane {
    /// Returns the rectangle of a whole screen.
    pub fn new(width_m: f32, height_m: f32) -> ScreenPlane {
        ScreenPlane { centre_m: Vec2::ZERO, width_m, height_m }
    }

    /// Returns the part from `low` to `high`, both as fractions of width and height from the upper left corner.
    pub fn part(&self, low: Vec2, high: Vec2) -> ScreenPlane {
        let size = Vec2::new(self.width_m, self.height_m);
        let middle = 0.5 * (low + high) - 0.5;
        ScreenPlane {
            centre_m: self.centre_m + middle * Vec2::new(size.x, -size.y),
            width_m: size.x * (high.x - low.x),
            height_m: size.y * (high.y - low.y),
        }
    }

    /// Returns the corners top left, top right, bottom right, bottom left, on the screen's axes.
    pub fn corners_m(&self) -> [Vec3; 4] {
        let (x, y) = (0.5 * self.width_m, 0.5 * self.height_m);
        [(-x, y), (x, y), (x, -y), (-x, -y)]
            .map(|(x, y)| (self.centre_m + Vec2::new(x, y)).extend(0.0))
    }

    /// Returns the map from the screen's axes to the world.
    pub(crate) fn world_from_screen(&self, world: &ScreenInWorld) -> Affine3A {
        Affine3A::from_scale_rotation_translation(
            Vec3::splat(world.units_per_m),
            world.rotation,
            world.centre,
        ) * Affine3A::from_translation(-self.centre_m.extend(0.0))
    }

    /// Returns the view of an eye at `eye_m` on the screen's axes through the rectangle, `size` pixels large. `near` is
    /// in world units.
    pub fn eye(&self, eye_m: Vec3, world: &ScreenInWorld, size: UVec2, near: f32) -> Eye {
        let from_eye = self.centre_m - eye_m.truncate();
        let depth = eye_m.z.max(NEAREST_EYE_M);
        let frustum = Frustum {
            left: (from_eye.x - 0.5 * self.width_m) / depth,
            right: (from_eye.x + 0.5 * self.width_m) / depth,
            down: (from_eye.y - 0.5 * self.height_m) / depth,
            up: (from_eye.y + 0.5 * self.height_m) / depth,
        };
        let position = self.world_from_screen(world).transform_point3(eye_m.with_z(depth));
        let eye_from_world = Affine3A::from_mat3(Mat3::from_quat(world.rotation.inverse()))
            * Affine3A::from_translation(-position);
        Eye { eye_from_world, projection: frustum.projection(near), size }
    }

    /// Returns the views of the left and the right eye of a head.
    pub fn eyes(&self, head: &Head, world: &ScreenInWorld, size: UVec2, near: f32) -> [Eye; 2] {
        head.eyes_m().map(|eye_m| self.eye(eye_m, world, size, near))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: UVec2 = UVec2::new(640, 480);

    fn ndc(eye: &Eye, world: Vec3) -> Vec2 {
        let clip = eye.projection * eye.eye_from_world.transform_point3(world).extend(1.0);
        assert!(clip.w > 0.0, "before the eye");
        Vec2::new(clip.x, clip.y) / clip.w
    }

    fn head_m() -> impl Strategy<Value = Vec3> {
        [-1.0f32..1.0, -1.0f32..1.0, 0.1f32..2.0].prop_map(Vec3::from_array)
    }

    fn world() -> impl Strategy<Value = ScreenInWorld> {
        ([-5.0f32..5.0, -5.0f32..5.0, -5.0f32..5.0], -3.0f32..3.0, 0.5f32..200.0).prop_map(
            |(centre, turn, units_per_m)| ScreenInWorld {
                centre: Vec3::from_array(centre),
                rotation: Quat::from_euler(glam::EulerRot::YXZ, turn, 0.4 * turn, 0.1),
                units_per_m,
            },
        )
    }

    fn plane() -> ScreenPlane {
        ScreenPlane { centre_m: Vec2::new(0.05, -0.02), width_m: 0.5, height_m: 0.3 }
    }

    proptest! {
        #[test]
        fn corners_of_the_screen_are_corners_of_the_picture(head in head_m(), world in world()) {
            let plane = plane();
            let eye = plane.eye(head, &world, SIZE, 0.01);
            let to_world = plane.world_from_screen(&world);
            // Clip space has y downwards.
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            for (corner, (x, y)) in plane.corners_m().into_iter().zip(corners) {
                let seen = ndc(&eye, to_world.transform_point3(corner));
                prop_assert!(seen.distance(Vec2::new(x, y)) < 1e-3, "{seen}");
            }
        }

        #[test]
        fn points_in_the_plane_of_the_screen_stay_and_others_do_not(
            a in head_m(), b in head_m(), world in world(), x in -0.2f32..0.2, y in -0.1f32..0.1,
        ) {
            let plane = plane();
            let [from_a, from_b] = [a, b].map(|head| plane.eye(head, &world, SIZE, 0.01));
            let to_world = plane.world_from_screen(&world);
            let on = to_world.transform_point3(Vec3::new(x, y, 0.0));
            prop_assert!(ndc(&from_a, on).distance(ndc(&from_b, on)) < 1e-3);
            // A point behind the screen is visible where the line to the eye crosses it.
            let behind_m = Vec3::new(x, y, -0.4);
            for (head, eye) in [(a, from_a), (b, from_b)] {
                let crossing = head + (behind_m - head) * (head.z / (head.z + 0.4));
                let expected = (crossing.truncate() - plane.centre_m)
                    / (0.5 * Vec2::new(plane.width_m, -plane.height_m));
                let seen = ndc(&eye, to_world.transform_point3(behind_m));
                prop_assert!(seen.distance(expected) < 2e-3 * (1.0 + expected.length()));
            }
        }

        #[test]
        fn eye_space_has_world_units(head in head_m(), world in world()) {
            let plane = plane();
            let eye = plane.eye(head, &world, SIZE, 0.01);
            let middle = eye.eye_from_world.transform_point3(world.centre);
            prop_assert!((middle.z / world.units_per_m + head.z).abs() < 1e-3);
            let at = plane.world_from_screen(&world).transform_point3(head);
            prop_assert!(eye.position().distance(at) < 1e-3 * (1.0 + at.length()));
        }
    }

    #[test]
    fn two_eyes_lie_along_the_head() {
        let head = Head {
            position_m: Vec3::new(0.1, 0.0, 0.6),
            orientation: Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
            eye_distance_m: 0.06,
        };
        let [left, right] = head.eyes_m();
        assert!(left.abs_diff_eq(Vec3::new(0.1, -0.03, 0.6), 1e-6), "a head on its side");
        assert!(right.abs_diff_eq(Vec3::new(0.1, 0.03, 0.6), 1e-6));
        let world =
            ScreenInWorld { centre: Vec3::ZERO, rotation: Quat::IDENTITY, units_per_m: 10.0 };
        let [l, r] = plane().eyes(&head, &world, SIZE, 0.01);
        assert_eq!(l, plane().eye(left, &world, SIZE, 0.01));
        assert!((l.position().distance(r.position()) - 0.6).abs() < 1e-5);
    }

    #[test]
    fn an_eye_in_or_behind_the_screen_still_has_a_picture() {
        let world =
            ScreenInWorld { centre: Vec3::ZERO, rotation: Quat::IDENTITY, units_per_m: 10.0 };
        for z in [0.0, -1.0, NEAREST_EYE_M] {
            let eye = plane().eye(Vec3::new(0.1, 0.1, z), &world, SIZE, 0.01);
            assert!(eye.projection.is_finite());
            assert_eq!(eye, plane().eye(Vec3::new(0.1, 0.1, 0.05), &world, SIZE, 0.01));
        }
    }

    #[test]
    fn parts_are_counted_from_the_upper_left() {
        let screen = ScreenPlane::new(0.4, 0.2);
        assert_eq!(screen.part(Vec2::ZERO, Vec2::ONE), screen);
        let part = screen.part(Vec2::ZERO, Vec2::splat(0.5));
        assert!(part.corners_m()[0].abs_diff_eq(screen.corners_m()[0], 1e-6));
        assert!(part.corners_m()[2].abs_diff_eq(Vec3::ZERO, 1e-6));
    }
}
