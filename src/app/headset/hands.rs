//! Owns what hands in a room do to the work: the tool goes where the hand is and is used there,
//! the sculpture is carried along.
//!
//! Takes [`HandEvent`]s in the coordinates of the room; every change is a command, as with the mouse.

use glam::{Affine3A, Quat, Vec3};

use crate::app::actions::GROWTH_PER_NOTCH;
use crate::app::stroke::Guide;
use crate::app::workspace::Workspace;
use crate::command::Command;
use crate::input::Action;
use crate::input::hands::HandEvent;
use crate::sculpture::Placement;
use crate::surface::raycast;
use crate::tools::spray::{Footprint, MAX_FOOTPRINT};
use crate::ui::Tool;
use crate::view::{Pose, Room};

/// Where a spray held in a hand has the width that is shown, in metres from it.
const CAN_REACH_M: f32 = 0.1;
/// Tangent of the angle between two rays of such a spray.
const CAN_STEP: f32 = 0.0085;
/// How far it goes before it is used again, as a share of its radius there.
const CAN_SPACING: f32 = 0.35;
/// The tool is led no farther from the grid's origin than this, in voxels.
const FARTHEST_VX: f32 = 1e7;
/// Smallest and largest scale at which a sculpture is held, in world units a voxel edge.
const SCALES: std::ops::RangeInclusive<f32> = 0.02..=100.0;

/// What hands hold between two looks.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Held {
    /// The stroke in hand is a hand's, not the mouse's.
    stroke: bool,
    /// The marker goes with the hand, from this point of the grid.
    marker: Option<Vec3>,
}

impl Held {
    /// Whether a hand uses a tool.
    pub fn is_working(&self) -> bool {
        self.stroke || self.marker.is_some()
    }
}

impl Workspace {
    /// Does what a hand asks for. What concerns the board and the room itself is not done here.
    pub(super) fn do_by_hand(&mut self, event: &HandEvent, room: &Room, held: &mut Held) {
        match *event {
            HandEvent::Carry(by) => {
                let to = room.carried(self.session().document().placement(), &by);
                if SCALES.contains(&to.scale) && to.translation.is_finite() {
                    self.place(to);
                }
            }
            HandEvent::Tool(pose) => self.lead_by_hand(&pose, room, held),
            HandEvent::Press => self.press_by_hand(room, held),
            HandEvent::Release => self.release_by_hand(held),
            HandEvent::Resize(notches) => self.resize(notches, GROWTH_PER_NOTCH),
            HandEvent::Pick => self.pick_by_hand(room),
            HandEvent::Undo => self.act(Action::Undo),
            HandEvent::Redo => self.act(Action::Redo),
            HandEvent::ToggleBoard
            | HandEvent::Recentre
            | HandEvent::Point(_)
            | HandEvent::PointAway
            | HandEvent::Click(_)
            | HandEvent::Scroll(_) => {}
        }
    }

    fn release_by_hand(&mut self, held: &mut Held) {
        held.marker = None;
        if std::mem::take(&mut held.stroke) {
            self.end_stroke();
        }
    }

    fn lead_by_hand(&mut self, pose: &Pose, room: &Room, held: &mut Held) {
        if self.stroke_in_hand() && !held.stroke {
            // The mouse is at work.
            return;
        }
        let own = self.in_grid(pose, room);
        let near = own.position.is_finite() && own.position.abs().max_element() <= FARTHEST_VX;
        if !near || !own.rotation.is_finite() {
            // There is nothing to be done there.
            self.release_by_hand(held);
            return;
        }
        let turn = own.rotation * self.ui.hand.rotation().inverse();
        self.hand_pose = Some(*pose);
        match self.ui.hand.tool {
            Tool::Marker => {
                if let Some(from) = &mut held.marker {
                    let by = own.position - std::mem::replace(from, own.position);
                    self.shift_marker(by);
                }
            }
            Tool::Spray(_) => {
                self.ui.hand.centre_vx = own.position;
                if held.stroke
                    && let Some(can) = self.can(room)
                {
                    self.lead_can(can);
                }
            }
            Tool::Solid => {
                self.ui.hand.turn_by(turn);
                self.ui.hand.move_to(own.position);
                self.tool_moved();
            }
        }
    }

    fn press_by_hand(&mut self, room: &Room, held: &mut Held) {
        if self.stroke_in_hand() {
            return;
        }
        if std::mem::take(&mut self.ui.hand.eyedropper) {
            self.pick_by_hand(room);
            return;
        }
        match self.ui.hand.tool {
            Tool::Solid => self.begin_stroke(self.ui.hand.mode, Guide::Tool),
            Tool::Spray(kind) => {
                if let Some(can) = self.can(room) {
                    let options = *self.ui.hand.sprays.of(kind);
                    let radius_vx = can.across.length() * can.radius;
                    self.begin_can(kind, options, can, (CAN_SPACING * radius_vx).max(1.0));
                }
            }
            Tool::Marker => {
                held.marker = self.hand_pose.map(|pose| self.in_grid(&pose, room).position);
            }
        }
        held.stroke = self.stroke_in_hand();
    }

    /// Takes the colour of the voxel that the tool in the hand touches, or else points at.
    fn pick_by_hand(&mut self, room: &Room) {
        let Some(pose) = &self.hand_pose else { return };
        let at = self.grid_point(pose.position, room);
        let ahead = (self.grid_point(pose.at(Vec3::NEG_Z), room) - at).normalize_or_zero();
        let grid = self.session().document().grid();
        let here = at.floor().as_ivec3();
        let voxel = match grid.get(here) {
            true => Some(here.as_uvec3()),
            false => raycast::cast(grid, at, ahead).map(|hit| hit.voxel),
        };
        if let Some(voxel) = voxel {
            self.take_colour_of(voxel);
        }
    }

    /// The rays of the spray in the hand, if it holds one.
    pub(super) fn can(&self, room: &Room) -> Option<Footprint> {
        let options = self.ui.hand.sprays.of(self.ui.hand.spray()?);
        let pose = self.hand_pose?;
        let grid_from_room = |point: Vec3| self.grid_point(point, room);
        let eye_vx = grid_from_room(pose.position);
        let way = |own: Vec3| grid_from_room(pose.at(own * CAN_REACH_M)) - eye_vx;
        Some(Footprint {
            eye_vx,
            aim: way(Vec3::NEG_Z),
            across: way(Vec3::X) * CAN_STEP,
            down: way(Vec3::NEG_Y) * CAN_STEP,
            radius: options.radius_px.min(MAX_FOOTPRINT),
            outline: options.outline,
        })
    }

    /// A point of the room in grid coordinates.
    pub(super) fn grid_point(&self, point: Vec3, room: &Room) -> Vec3 {
        let world = room.room_from_world.inverse().apply(point);
        self.grid_from_world().transform_point3(world)
    }

    /// A pose of the room in the grid: position in voxels, rotation about axes of the grid.
    fn in_grid(&self, pose: &Pose, room: &Room) -> Pose {
        let world = room.in_world(pose);
        let rotation: Quat = self.session().document().placement().rotation.inverse();
        Pose {
            position: self.grid_from_world().transform_point3(world.position),
            rotation: (rotation * world.rotation).normalize(),
        }
    }

    fn grid_from_world(&self) -> Affine3A {
        self.world_from_grid().inverse()
    }

    /// Puts the sculpture upright in the middle of the world.
    pub(super) fn stand_upright(&mut self) {
        let up = self.ui.view.up;
        let placement = Placement::default();
        let front = crate::input::Side::Front;
        let upright = self.turntable.looking_from(front, up, &placement);
        self.place(upright);
    }

    /// Brings the sculpture back to the middle of the world at its own size, turned as it is.
    pub(super) fn bring_back(&mut self) {
        let rotation = self.session().document().placement().rotation;
        self.execute(&Command::Place(Placement { rotation, ..Placement::default() }));
    }
}

#[cfg(test)]
#[path = "hands_tests.rs"]
mod tests;
