//! The board: the panel of the interface in the room, attached to the off hand, and the ray of the
//! main hand that points at it, which is held still while the trigger is pulled.

use glam::{Quat, Vec2, Vec3};

use super::Change;
use crate::view::RoomPose;

/// Offset from the palm to the middle of the board's lower edge, in the hand's space, in metres.
const ABOVE_HAND_M: Vec3 = Vec3::new(0.0, 0.06, -0.04);
/// Tilt of the board from upright towards the hand's own tilt.
const LEAN_RAD: f32 = -0.35;
/// Length of the ray, in metres.
const REACH_M: f32 = 3.0;

/// A board in the room.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Board {
    /// The pose of its centre; x right, y up, z out of its front.
    pub pose: RoomPose,
    /// Width and height in metres.
    pub size_m: Vec2,
}

/// The hit of a ray on a board.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BoardHit {
    /// Position from the upper left corner, 0 to 1 each.
    pub at: Vec2,
    /// In metres of the room.
    pub point: Vec3,
    /// Distance from the hand, in metres.
    pub distance_m: f32,
}

impl BoardHit {
    /// Returns whether it is within the board.
    fn is_inside(&self) -> bool {
        self.at.cmpge(Vec2::ZERO).all() && self.at.cmple(Vec2::ONE).all()
    }
}

impl Board {
    /// Returns a board of `size_m` attached to the hand with this grip pose.
    pub fn on_hand(grip: &RoomPose, size_m: Vec2) -> Board {
        let foot = RoomPose { position: ABOVE_HAND_M, rotation: Quat::from_rotation_x(LEAN_RAD) };
        let middle = RoomPose { position: Vec3::Y * (0.5 * size_m.y), rotation: Quat::IDENTITY };
        Board { pose: grip.then(&foot).then(&middle), size_m }
    }

    /// Returns the hit of a hand's ray on the front of the board, if there is one.
    pub fn hit(&self, aim: &RoomPose) -> Option<BoardHit> {
        self.hit_plane(aim).filter(BoardHit::is_inside)
    }

    /// Returns the hit of a hand's ray on the plane of the board's front, also outside of the board.
    fn hit_plane(&self, aim: &RoomPose) -> Option<BoardHit> {
        let (origin, direction) = (self.pose.own(aim.position), aim.forward());
        let direction = self.pose.rotation.inverse() * direction;
        // The back cannot be clicked.
        if !aim.is_plausible() || origin.z <= 0.0 || direction.z >= -1e-4 {
            return None;
        }
        let distance_m = -origin.z / direction.z;
        let own = origin + direction * distance_m;
        let at = Vec2::new(own.x / self.size_m.x + 0.5, 0.5 - own.y / self.size_m.y);
        (distance_m <= REACH_M).then(|| BoardHit { at, point: self.pose.at(own), distance_m })
    }
}

/// The point under a ray, held still while the trigger is pulled, since pulling turns the hand. A larger movement of
/// the ray drags.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Pointing {
    /// The ray of the last call.
    before: Option<BoardHit>,
    /// The smallest recent travel of the trigger.
    least: f32,
    kept: Option<BoardHit>,
    dragging: bool,
}

impl Pointing {
    /// Largest turn of the hand by a pull, as a tangent: 1.5 degrees.
    const DRIFT: f32 = 0.026;
    /// Travel of the trigger at which a pull begins.
    const BEGUN: f32 = 0.05;

    /// Returns the hand's point on `board`. `travel`: of the trigger, 0 to 1; `change`: of its switch; `down`: the
    /// present state of its switch.
    pub fn step(
        &mut self,
        board: &Board,
        aim: &RoomPose,
        travel: f32,
        change: Option<Change>,
        down: bool,
    ) -> Option<BoardHit> {
        let travel = if travel.is_finite() { travel } else { 0.0 };
        let now = board.hit_plane(aim);
        let hit = now.filter(BoardHit::is_inside);
        let before = std::mem::replace(&mut self.before, hit);
        let near = |kept: &BoardHit| {
            now.is_some_and(|now| {
                let drift_m = ((now.at - kept.at) * board.size_m).length();
                drift_m <= Self::DRIFT * kept.distance_m
            })
        };
        let held = down || change == Some(Change::Released);
        if !held {
            self.dragging = false;
            self.least = self.least.min(travel);
        }
        let pulled = held || travel >= self.least + Self::BEGUN;
        if !pulled {
            self.kept = None;
        } else if self.kept.is_none() && (!held || change == Some(Change::Pressed)) {
            // Its position before the finger moved.
            self.kept = before.filter(near).or(hit);
        }
        match self.kept {
            Some(kept) if !self.dragging && near(&kept) => Some(kept),
            Some(_) if held => {
                self.dragging = true;
                hit
            }
            // The ray moves elsewhere with the trigger half pulled.
            Some(_) => {
                (self.kept, self.least) = (None, travel);
                hit
            }
            None => hit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec2 = Vec2::new(0.6, 0.4);

    fn board() -> Board {
        Board {
            pose: RoomPose { position: Vec3::new(0.0, 1.3, -0.5), ..RoomPose::default() },
            size_m: SIZE,
        }
    }

    fn ray(from: Vec3, to: Vec3) -> RoomPose {
        RoomPose {
            position: from,
            rotation: Quat::from_rotation_arc(Vec3::NEG_Z, (to - from).normalize()),
        }
    }

    #[test]
    fn corners_are_where_they_look() {
        let from = Vec3::new(0.3, 1.2, 0.1);
        for (corner, at) in [
            (Vec3::new(-0.29, 1.49, -0.5), Vec2::new(0.01 / 0.6, 0.01 / 0.4)),
            (Vec3::new(0.29, 1.11, -0.5), Vec2::new(0.59 / 0.6, 0.39 / 0.4)),
            (Vec3::new(0.0, 1.3, -0.5), Vec2::splat(0.5)),
        ] {
            let hit = board().hit(&ray(from, corner)).unwrap();
            assert!(hit.at.abs_diff_eq(at, 1e-3), "{hit:?}");
            assert!(hit.point.abs_diff_eq(corner, 1e-3));
        }
    }

    #[test]
    fn a_ray_beside_it_away_from_it_or_from_behind_misses() {
        let from = Vec3::new(0.0, 1.3, 0.2);
        assert!(board().hit(&ray(from, Vec3::new(0.31, 1.3, -0.5))).is_none());
        assert!(board().hit(&ray(from, Vec3::new(0.0, 1.3, 9.0))).is_none());
        let behind = Vec3::new(0.0, 1.3, -1.0);
        assert!(board().hit(&ray(behind, Vec3::new(0.0, 1.3, -0.5))).is_none());
        let far = Vec3::new(0.0, 1.3, 4.0);
        assert!(board().hit(&ray(far, Vec3::new(0.0, 1.3, -0.5))).is_none());
        assert!(board().hit(&ray(from, Vec3::NAN)).is_none());
    }

    #[test]
    fn it_stands_above_the_hand_and_faces_the_person() {
        let grip = RoomPose { position: Vec3::new(-0.2, 1.2, -0.4), rotation: Quat::IDENTITY };
        let board = Board::on_hand(&grip, SIZE);
        assert!(board.pose.position.y > 1.2 + 0.15);
        let eye = Vec3::new(0.0, 1.6, 0.0);
        assert!(board.pose.own(eye).z > 0.0, "its front is visible");
        let turned = RoomPose { rotation: Quat::from_rotation_y(0.5), ..grip };
        let front = Board::on_hand(&turned, SIZE).pose.rotation * Vec3::Z;
        assert!(front.x > 0.3, "it rotates with the hand");
    }
}
