//! The placement of the sculpture in the room of a headset: when it is put before the head, and what happens to its own
//! placement then.
//!
//! Takes the sculpture's extent and the head's pose; returns the similarity between room and world, and what the
//! workspace must reset. Knows no session and no document.

use glam::{UVec3, Vec3};

use crate::screen::headset::HeadsetOptions;
use crate::view::{Room, RoomPose};

/// Voxels and edge lengths of a sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Extent {
    pub dims: UVec3,
    pub voxel_size: Vec3,
}

impl Extent {
    /// Returns the longest side in world units.
    fn longest(&self) -> f32 {
        (self.dims.as_vec3() * self.voxel_size).max_element()
    }
}

/// The part of the sculpture's own placement that is reset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reset {
    /// Position, scale and orientation.
    Upright,
    /// Position and scale; the sculpture keeps its orientation.
    Position,
}

/// The placement of the world in the room.
pub struct RoomPlacement {
    size_m: f32,
    distance_m: f32,
    drop_m: f32,
    /// With the sculpture's extent at that time.
    room: Option<(Room, Extent)>,
    /// The sculpture should be placed before the head again.
    recentring: bool,
    /// The sculpture has been placed by this session or an earlier one.
    placed: bool,
}

impl RoomPlacement {
    /// Starts without a room. `placed`: an earlier session has placed the sculpture, so it keeps its orientation.
    pub fn new(settings: &HeadsetOptions, placed: bool) -> RoomPlacement {
        let HeadsetOptions { size_m, distance_m, drop_m, .. } = *settings;
        RoomPlacement { size_m, distance_m, drop_m, room: None, recentring: false, placed }
    }

    /// Returns the room, once the sculpture has been placed before a head.
    pub fn room(&self) -> Option<Room> {
        self.room.map(|(room, _)| room)
    }

    pub fn is_placed(&self) -> bool {
        self.placed
    }

    /// Places the sculpture before the head at the next update.
    pub fn recentre(&mut self) {
        self.recentring = true;
    }

    /// Places the sculpture before the head if it is not in the room yet, has another extent, or should be recentred.
    pub fn update(&mut self, extent: Extent, head: &RoomPose) -> Option<Reset> {
        let is_other = self.room.is_some_and(|(_, former)| former != extent);
        let recentring = std::mem::take(&mut self.recentring);
        if self.room.is_some() && !is_other && !recentring {
            return None;
        }
        let metres_per_unit = self.size_m / extent.longest();
        let room = Room::before(head, self.distance_m, self.drop_m, metres_per_unit);
        self.room = Some((room, extent));
        if is_other || !std::mem::replace(&mut self.placed, true) {
            Some(Reset::Upright)
        } else {
            recentring.then_some(Reset::Position)
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    const EXTENT: Extent = Extent { dims: UVec3::new(64, 32, 16), voxel_size: Vec3::ONE };

    fn head(x: f32) -> RoomPose {
        RoomPose { position: Vec3::new(x, 1.6, 0.0), rotation: Quat::IDENTITY }
    }

    fn centre_x(placement: &RoomPlacement) -> f32 {
        placement.room().unwrap().room_from_world.translation.x
    }

    #[test]
    fn a_sculpture_is_placed_once_and_stays_where_it_is() {
        let mut placement = RoomPlacement::new(&HeadsetOptions::default(), false);
        assert!(placement.room().is_none() && !placement.is_placed());
        assert_eq!(placement.update(EXTENT, &head(0.0)), Some(Reset::Upright));
        assert!(placement.is_placed());
        assert_eq!(placement.update(EXTENT, &head(1.0)), None);
        assert!(centre_x(&placement).abs() < 1e-6, "it does not move with the head");
        let scale = placement.room().unwrap().room_from_world.scale;
        assert_eq!(scale, 0.5 / 64.0, "the longest side is half a metre");
    }

    #[test]
    fn recentring_keeps_the_orientation() {
        let mut placement = RoomPlacement::new(&HeadsetOptions::default(), false);
        placement.update(EXTENT, &head(0.0));
        placement.recentre();
        assert_eq!(placement.update(EXTENT, &head(1.0)), Some(Reset::Position));
        assert!((centre_x(&placement) - 1.0).abs() < 1e-6);
        assert_eq!(placement.update(EXTENT, &head(2.0)), None, "once");
    }

    #[test]
    fn a_sculpture_of_another_extent_is_placed_anew() {
        let mut placement = RoomPlacement::new(&HeadsetOptions::default(), false);
        placement.update(EXTENT, &head(0.0));
        let other = Extent { voxel_size: Vec3::splat(2.0), ..EXTENT };
        assert_eq!(placement.update(other, &head(1.0)), Some(Reset::Upright));
        assert!((centre_x(&placement) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_later_session_places_the_room_and_leaves_the_sculpture_as_it_is() {
        let mut placement = RoomPlacement::new(&HeadsetOptions::default(), true);
        assert_eq!(placement.update(EXTENT, &head(1.0)), None);
        assert!((centre_x(&placement) - 1.0).abs() < 1e-6);
    }
}
