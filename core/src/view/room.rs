//! The physical room: rigid poses in metres, similarities, and the placement of the sculpture's world in the room.
//!
//! The room is right-handed, x right, y up, in metres, as in OpenXR. World units are those of the
//! sculpture (a voxel edge). One similarity maps between them, so that an eye in the room becomes an
//! eye of the world: rigid in world units, with the near plane scaled accordingly.

use glam::{Affine3A, Quat, UVec2, Vec3};

use super::eye::{Eye, Frustum};
use crate::sculpture::Placement;

/// The near plane, in metres.
pub const NEAR_M: f32 = 0.02;
/// Largest plausible distance of a tracked pose from the room's origin, in metres.
pub const FARTHEST_M: f32 = 1000.0;

/// Position and rotation of an object in the room; it faces along its own -z.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct RoomPose {
    /// Position in metres.
    pub position: Vec3,
    /// Rotation from the pose's axes to the room's.
    pub rotation: Quat,
}

impl RoomPose {
    /// Returns the unit vector along which it faces.
    pub fn forward(&self) -> Vec3 {
        self.rotation * Vec3::NEG_Z
    }

    /// Maps a point from the pose's own coordinates (metres) to the room.
    pub fn at(&self, own: Vec3) -> Vec3 {
        self.position + self.rotation * own
    }

    /// Maps a point of the room to the pose's own coordinates.
    pub fn own(&self, room: Vec3) -> Vec3 {
        self.rotation.inverse() * (room - self.position)
    }

    /// Composes two poses: maps `other`, given relative to this one, to the room.
    pub fn then(&self, other: &RoomPose) -> RoomPose {
        RoomPose {
            position: self.at(other.position),
            rotation: (self.rotation * other.rotation).normalize(),
        }
    }

    /// Returns whether the pose is plausible: all numbers are finite, the position is within [`FARTHEST_M`], and the
    /// rotation is normalised.
    pub fn is_plausible(&self) -> bool {
        // Comparisons with NaN are false.
        self.position.abs().max_element() <= FARTHEST_M
            && self.position.is_finite()
            && (self.rotation.length_squared() - 1.0).abs() < 1e-2
    }
}

/// A similarity transform: scales, then rotates, then translates.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Similarity {
    /// Rotation, applied after scaling.
    pub rotation: Quat,
    /// Uniform scale, applied first.
    pub scale: f32,
    /// Translation, applied last.
    pub translation: Vec3,
}

impl Similarity {
    /// The similarity that changes nothing.
    pub const IDENTITY: Similarity =
        Similarity { rotation: Quat::IDENTITY, scale: 1.0, translation: Vec3::ZERO };

    /// Returns the rigid map that moves `from` to `to`.
    pub fn carrying(from: &RoomPose, to: &RoomPose) -> Similarity {
        let rotation = (to.rotation * from.rotation.inverse()).normalize();
        Similarity { rotation, scale: 1.0, translation: to.position - rotation * from.position }
    }

    /// Returns the similarity that rotates and scales about `centre`, which moves to `to`.
    pub fn about(centre: Vec3, rotation: Quat, scale: f32, to: Vec3) -> Similarity {
        Similarity { rotation, scale, translation: to - rotation * centre * scale }
    }

    /// Maps a point.
    pub fn apply(&self, point: Vec3) -> Vec3 {
        self.rotation * point * self.scale + self.translation
    }

    /// Returns the similarity that undoes this one.
    pub fn inverse(&self) -> Similarity {
        let (rotation, scale) = (self.rotation.inverse(), 1.0 / self.scale);
        Similarity { rotation, scale, translation: rotation * -self.translation * scale }
    }

    /// Composes two similarities: first `self`, then `next`.
    pub fn then(&self, next: &Similarity) -> Similarity {
        Similarity {
            rotation: (next.rotation * self.rotation).normalize(),
            scale: next.scale * self.scale,
            translation: next.apply(self.translation),
        }
    }

    /// Returns whether all numbers are finite and the scale is positive.
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite()
            && self.translation.is_finite()
            && self.scale.is_finite()
            && self.scale > 0.0
    }
}

/// The view of one eye of a headset, in the room.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RoomView {
    /// Its pose in the room.
    pub pose: RoomPose,
    /// Its frustum.
    pub frustum: Frustum,
}

/// The placement of the world in the room.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Room {
    /// Its scale is in metres per world unit.
    pub room_from_world: Similarity,
}

impl Room {
    /// Returns a room with the world's origin `distance_m` in front of the head and `drop_m` below it, upright and
    /// facing the user regardless of the head's pitch, with `metres_per_unit`.
    pub fn before(head: &RoomPose, distance_m: f32, drop_m: f32, metres_per_unit: f32) -> Room {
        let forward = head.forward();
        // Looking straight up or down, the head's own up axis gives the forward direction.
        let flat = Vec3::new(forward.x, 0.0, forward.z);
        let flat = match flat.length_squared() > 1e-4 {
            true => flat,
            false => head.rotation * Vec3::Y * Vec3::new(1.0, 0.0, 1.0) * -forward.y.signum(),
        };
        let ahead = flat.normalize_or(Vec3::NEG_Z);
        let yaw = (-ahead.x).atan2(-ahead.z);
        Room {
            room_from_world: Similarity {
                rotation: Quat::from_rotation_y(yaw),
                scale: metres_per_unit,
                translation: head.position + ahead * distance_m - Vec3::Y * drop_m,
            },
        }
    }

    /// Returns the eye in the world that corresponds to `view` in the room, for a picture of `size` pixels.
    pub fn eye(&self, view: &RoomView, size: UVec2) -> Eye {
        let pose = self.in_world(&view.pose);
        let world_from_eye = Affine3A::from_rotation_translation(pose.rotation, pose.position);
        let near = NEAR_M / self.room_from_world.scale;
        Eye {
            eye_from_world: world_from_eye.inverse(),
            projection: view.frustum.projection(near),
            size,
        }
    }

    /// Maps a pose of the room to the world, with its position in world units.
    pub fn in_world(&self, pose: &RoomPose) -> RoomPose {
        let world_from_room = self.room_from_world.inverse();
        RoomPose {
            position: world_from_room.apply(pose.position),
            rotation: (world_from_room.rotation * pose.rotation).normalize(),
        }
    }

    /// Returns the placement of a sculpture after the room's contents were moved by `by`.
    pub fn carried(&self, placement: &Placement, by: &Similarity) -> Placement {
        let by = self.room_from_world.then(by).then(&self.room_from_world.inverse());
        Placement {
            rotation: (by.rotation * placement.rotation).normalize(),
            translation: by.apply(placement.translation),
            scale: by.scale * placement.scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec3, Vec2};
    use std::f32::consts::FRAC_PI_2;

    fn pose(position: Vec3, rotation: Quat) -> RoomPose {
        RoomPose { position, rotation }
    }

    #[test]
    fn similarities_compose_and_invert() {
        let a = Similarity {
            rotation: Quat::from_rotation_y(0.7),
            scale: 2.5,
            translation: Vec3::new(1.0, -2.0, 0.5),
        };
        let b = Similarity::about(
            Vec3::new(0.3, 0.2, 0.1),
            Quat::from_rotation_x(-1.1),
            0.4,
            Vec3::splat(5.0),
        );
        let p = Vec3::new(3.0, 4.0, -1.0);
        assert!(a.then(&b).apply(p).abs_diff_eq(b.apply(a.apply(p)), 1e-4));
        assert!(a.then(&a.inverse()).apply(p).abs_diff_eq(p, 1e-4));
        assert!(b.apply(Vec3::new(0.3, 0.2, 0.1)).abs_diff_eq(Vec3::splat(5.0), 1e-5));
    }

    #[test]
    fn the_sculpture_stands_upright_before_the_head() {
        for nod in [0.0, 0.4, -0.9, FRAC_PI_2, -FRAC_PI_2] {
            let head = pose(
                Vec3::new(1.0, 1.6, 2.0),
                Quat::from_rotation_y(FRAC_PI_2) * Quat::from_rotation_x(nod),
            );
            let room = Room::before(&head, 0.7, 0.3, 0.002);
            // Turned a quarter to the left, ahead is -x.
            let origin = room.room_from_world.apply(Vec3::ZERO);
            assert!(origin.abs_diff_eq(Vec3::new(0.3, 1.3, 2.0), 1e-4), "{nod}: {origin}");
            let up = room.room_from_world.rotation * Vec3::Y;
            assert!(up.abs_diff_eq(Vec3::Y, 1e-5));
            let towards = room.room_from_world.rotation * Vec3::Z;
            assert!(towards.abs_diff_eq(Vec3::X, 1e-4), "{nod}: it faces the person");
        }
    }

    /// OpenXR's mapping (metres, room) and the renderer's (units, world) lead to the same pixel and the same depth.
    #[test]
    fn an_eye_of_the_world_sees_what_the_view_of_the_room_sees() {
        let head = pose(Vec3::new(0.2, 1.5, 0.3), Quat::from_rotation_y(0.3));
        let room = Room::before(&head, 0.6, 0.2, 0.004);
        let frustum = Frustum { left: -0.9, right: 0.7, down: -0.8, up: 0.6 };
        let view = RoomView {
            pose: pose(Vec3::new(0.25, 1.55, 0.2), Quat::from_rotation_x(-0.2)),
            frustum,
        };
        let size = UVec2::new(320, 240);
        let eye = room.eye(&view, size);
        let world = Vec3::new(10.0, -20.0, 30.0);
        let seen = eye.projection * (eye.eye_from_world.transform_point3(world)).extend(1.0);
        let direct = view.frustum.projection(NEAR_M)
            * view.pose.own(room.room_from_world.apply(world)).extend(1.0);
        let pixel = |clip: glam::Vec4| Vec2::new(clip.x, clip.y) / clip.w;
        assert!(pixel(seen).abs_diff_eq(pixel(direct), 1e-4));
        assert!((seen.z / seen.w - direct.z / direct.w).abs() < 1e-5);
        let m = eye.eye_from_world.matrix3;
        assert!((m.determinant() - 1.0).abs() < 1e-4, "rigid");
    }

    #[test]
    fn a_carried_sculpture_moves_in_the_room_as_the_hand_does() {
        let room = Room::before(&pose(Vec3::Y * 1.6, Quat::IDENTITY), 0.7, 0.3, 0.01);
        let placement = Placement {
            rotation: Quat::from_rotation_z(0.3),
            translation: Vec3::new(4.0, 5.0, 6.0),
            scale: 1.5,
        };
        let by = Similarity {
            rotation: Quat::from_rotation_y(0.5),
            scale: 2.0,
            translation: Vec3::new(0.1, 0.2, -0.3),
        };
        let carried = room.carried(&placement, &by);
        let (dims, edges) = (UVec3::new(4, 6, 8), Vec3::ONE);
        for corner in [Vec3::ZERO, Vec3::new(4.0, 6.0, 8.0), Vec3::new(4.0, 0.0, 2.0)] {
            let in_room = |p: &Placement| {
                room.room_from_world.apply(p.world_from_grid(dims, edges).transform_point3(corner))
            };
            assert!(in_room(&carried).abs_diff_eq(by.apply(in_room(&placement)), 1e-3));
        }
    }
}
