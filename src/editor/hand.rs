//! The tool in a hand in the room of a headset: its position in the grid, and the voxel that it points at.
//!
//! Takes poses in the coordinates of the room; changes nothing.

use glam::{Affine3A, Quat, UVec3, Vec3};

use super::symmetry::SymmetryPart;
use super::tool::ToolState;
use crate::document::Document;
use crate::surface::raycast;
use crate::tools::brush::footprint::{Coverage, Footprint};
use crate::tools::brush::keys::{OUTLINE, RADIUS};
use crate::view::{Room, RoomPose};

/// Distance from a brush in a hand at which it has its displayed width, in metres.
const SPRAY_REACH_M: f32 = 0.1;
/// Tangent of the angle between two rays of its cone.
const SPRAY_STEP: f32 = 0.0085;

/// The state of a hand between two events.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct HandTool {
    /// The last pose of the tool in the hand, in the room; `None` while no hand holds it.
    pub(super) pose: Option<RoomPose>,
    /// The present stroke is the hand's, not the mouse's.
    pub(super) stroke: bool,
    /// The part of the symmetry that follows the hand.
    pub(super) symmetry: Option<SymmetryPart>,
    /// The marker follows the hand from this grid point.
    pub(super) marker: Option<Vec3>,
}

impl HandTool {
    /// Returns whether the hand uses the tool.
    pub fn is_working(&self) -> bool {
        self.stroke || self.marker.is_some() || self.symmetry.is_some()
    }

    /// Returns whether the tool follows the hand.
    pub fn is_leading(&self) -> bool {
        self.pose.is_some()
    }

    /// Takes the tool out of the hand.
    pub fn put_down(&mut self) {
        self.pose = None;
    }

    /// Returns the voxel that the tool in the hand touches, or else the one that it points at.
    pub(super) fn voxel(&self, document: &Document, room: &Room) -> Option<UVec3> {
        let pose = &self.pose?;
        let at = grid_point(document, pose.position, room);
        let ahead = (grid_point(document, pose.at(Vec3::NEG_Z), room) - at).normalize_or_zero();
        let grid = document.grid();
        let here = at.floor().as_ivec3();
        match grid.get(here) {
            true => Some(here.as_uvec3()),
            false => raycast::cast(grid, at, ahead).map(|hit| hit.voxel),
        }
    }

    /// Returns the cone of the brush in the hand, if it is one under an outline.
    pub fn cone(&self, document: &Document, tool: &ToolState, room: &Room) -> Option<Footprint> {
        let options = tool.brushes.of(tool.picture_brush()?);
        let pose = self.pose?;
        let eye_vx = grid_point(document, pose.position, room);
        let way = |own: Vec3| grid_point(document, pose.at(own * SPRAY_REACH_M), room) - eye_vx;
        let gauge = hand_gauge(document, &pose, room);
        Some(Footprint {
            eye_vx,
            aim: way(Vec3::NEG_Z),
            across: way(Vec3::X) * SPRAY_STEP,
            down: way(Vec3::NEG_Y) * SPRAY_STEP,
            radius: tool.brushes.radius_px(options.get(RADIUS), Some(gauge)),
            outline: options.get(OUTLINE),
            coverage: Coverage::Visible,
        })
    }
}

/// Returns the size of a virtual pixel for a hand, in units of the smallest edge.
pub(super) fn hand_gauge(document: &Document, pose: &RoomPose, room: &Room) -> f32 {
    let size = document.grid().voxel_size();
    let at = |own: Vec3| grid_point(document, pose.at(own * SPRAY_REACH_M), room);
    let across = (at(Vec3::X) - at(Vec3::ZERO)) * size / size.min_element();
    across.length() * SPRAY_STEP
}

/// Returns a point of the room in grid coordinates.
pub fn grid_point(document: &Document, point: Vec3, room: &Room) -> Vec3 {
    let world = room.room_from_world.inverse().apply(point);
    grid_from_world(document).transform_point3(world)
}

/// Returns a pose of the room in the grid: position in voxels, rotation about axes of the grid.
pub(super) fn in_grid(document: &Document, pose: &RoomPose, room: &Room) -> RoomPose {
    let world = room.in_world(pose);
    let rotation: Quat = document.placement().rotation.inverse();
    RoomPose {
        position: grid_from_world(document).transform_point3(world.position),
        rotation: (rotation * world.rotation).normalize(),
    }
}

fn grid_from_world(document: &Document) -> Affine3A {
    document.world_from_grid().inverse()
}
