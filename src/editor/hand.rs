//! The tool in a hand in the room of a headset: it goes where the hand is and is used there, and the
//! sculpture is carried along.
//!
//! Takes [`HandEvent`]s in the coordinates of the room; every change is a command, as with the mouse.

use glam::{Affine3A, Quat, UVec3, Vec3};

use super::Editor;
use super::actions::GROWTH_PER_NOTCH;
use super::stroke::Guide;
use super::symmetry::Placed;
use super::tool::{NextPress, ToolKind};
use crate::command::Command;
use crate::input::hands::HandEvent;
use crate::picking::Picker;
use crate::surface::raycast;
use crate::tools::brush::footprint::{Coverage, Footprint};
use crate::tools::brush::keys::{OUTLINE, RADIUS};
use crate::view::{Pose, Room};

/// Where a brush in a hand has the width that is shown, in metres from it.
const SPRAY_REACH_M: f32 = 0.1;
/// Tangent of the angle between two rays of its cone.
const SPRAY_STEP: f32 = 0.0085;
/// The tool is led no farther from the grid's origin than this, in voxels.
const FARTHEST_VX: f32 = 1e7;
/// Smallest and largest scale at which a sculpture is held, in world units a voxel edge.
const SCALES: std::ops::RangeInclusive<f32> = 0.02..=100.0;

/// The state that a hand keeps between two events.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct HandTool {
    /// The pose to which the hand last led the tool, in the room; none while no hand leads it.
    pose: Option<Pose>,
    /// The stroke under way is the hand's, not the mouse's.
    stroke: bool,
    /// The part of the symmetry that goes with the hand.
    symmetry: Option<Placed>,
    /// The marker goes with the hand, from this point of the grid.
    marker: Option<Vec3>,
}

impl HandTool {
    /// Whether the hand uses the tool.
    pub fn is_working(&self) -> bool {
        self.stroke || self.marker.is_some() || self.symmetry.is_some()
    }

    /// Whether the tool goes with the hand.
    pub fn is_leading(&self) -> bool {
        self.pose.is_some()
    }

    /// No hand leads the tool any more.
    pub fn put_down(&mut self) {
        self.pose = None;
    }
}

impl Editor {
    /// Carries out the request of a hand. Requests that concern the board and the room itself are not handled here.
    pub fn hand_event(&mut self, event: &HandEvent, room: &Room, picker: &Picker) {
        match *event {
            HandEvent::Carry(by) => {
                let to = room.carried(self.document().placement(), &by);
                if SCALES.contains(&to.scale) && to.translation.is_finite() {
                    self.execute(&Command::Place(to));
                }
            }
            HandEvent::Tool(pose) => self.lead_by_hand(&pose, room, picker),
            HandEvent::Press => self.press_by_hand(room, picker),
            HandEvent::Pressure(pressure) => self.set_pressure(pressure),
            HandEvent::Release => self.release_by_hand(),
            HandEvent::Resize(notches) => self.resize(notches, GROWTH_PER_NOTCH),
            HandEvent::Pick => self.pick_by_hand(room),
            HandEvent::Undo => self.run(Command::Undo { steps: Some(1) }),
            HandEvent::Redo => self.run(Command::Redo { steps: Some(1) }),
            HandEvent::ToggleBoard
            | HandEvent::Recentre
            | HandEvent::Point(_)
            | HandEvent::PointAway
            | HandEvent::Click(_)
            | HandEvent::Scroll(_) => {}
        }
    }

    fn release_by_hand(&mut self) {
        (self.hand.marker, self.hand.symmetry) = (None, None);
        self.end_held_drawing();
        if std::mem::take(&mut self.hand.stroke) {
            self.end_stroke();
        }
    }

    fn lead_by_hand(&mut self, pose: &Pose, room: &Room, picker: &Picker) {
        if self.is_stroking() && !self.hand.stroke {
            // The mouse is at work.
            return;
        }
        let own = self.in_grid(pose, room);
        let near = own.position.is_finite() && own.position.abs().max_element() <= FARTHEST_VX;
        if !near || !own.rotation.is_finite() {
            // There is nothing to be done there.
            self.release_by_hand();
            return;
        }
        let turn = own.rotation * self.tool.rotation().inverse();
        self.hand.pose = Some(*pose);
        let gauge = self.hand_gauge(pose, room);
        self.tool.brushes.set_gauge(gauge);
        if let Some(what) = self.hand.symmetry {
            self.hold_symmetry(what, own.position, own.rotation);
            return;
        }
        match self.tool.kind {
            ToolKind::Marker => {
                if let Some(from) = &mut self.hand.marker {
                    let by = own.position - std::mem::replace(from, own.position);
                    self.shift_marker(by);
                }
            }
            ToolKind::Brush(brush) if brush.spec().is_in_picture() => {
                self.tool.centre_vx = own.position;
                if self.hand.stroke
                    && let Some(footprint) = self.cone(room)
                {
                    self.aim_stroke(footprint);
                }
            }
            ToolKind::Brush(_) => {
                self.tool.centre_vx = own.position;
                self.tool_moved(picker);
                self.catch_up();
            }
            ToolKind::Draw(_) => {
                self.tool.centre_vx = own.position;
                self.lead_held_drawing(own.position);
            }
            ToolKind::Solid => {
                self.tool.turn_by(turn);
                self.tool.move_to(own.position);
                self.tool_moved(picker);
            }
        }
    }

    fn press_by_hand(&mut self, room: &Room, picker: &Picker) {
        if self.is_stroking() {
            return;
        }
        if let Some(next) = self.tool.next_press.take() {
            if let NextPress::Symmetry(what) = next {
                // It goes with the hand until the trigger is let go.
                self.hand.symmetry = Some(what);
                return;
            }
            match (next, self.voxel_by_hand(room)) {
                (NextPress::Flood, Some(voxel)) => self.flood_from(voxel),
                (NextPress::Wand, Some(voxel)) => self.wand_from(voxel),
                (NextPress::Pick, Some(voxel)) => self.take_colour_of(voxel),
                (NextPress::Symmetry(_), _) | (_, None) => {}
            }
            return;
        }
        match self.tool.kind {
            ToolKind::Solid => {
                self.begin_solid(self.tool.mode, false, |_| Guide::Tool { hovering: None });
            }
            ToolKind::Brush(brush) if brush.spec().is_in_picture() => {
                if let Some(footprint) = self.cone(room) {
                    let options = *self.tool.brushes.of(brush);
                    let radius_vx = footprint.across.length() * footprint.radius;
                    let spacing_vx = (brush.spec().spacing * radius_vx).max(1.0);
                    self.begin_cone(options, footprint, spacing_vx);
                }
            }
            ToolKind::Brush(brush) => self.begin_clay(brush, false, None, picker),
            ToolKind::Draw(kind) => self.begin_held_drawing(kind, self.tool.centre_vx),
            ToolKind::Marker => {
                self.hand.marker = self.hand.pose.map(|pose| self.in_grid(&pose, room).position);
            }
        }
        self.hand.stroke = self.is_stroking();
    }

    /// Takes the colour of the voxel that the tool in the hand touches, or else points at.
    fn pick_by_hand(&mut self, room: &Room) {
        if let Some(voxel) = self.voxel_by_hand(room) {
            self.take_colour_of(voxel);
        }
    }

    /// The voxel that the tool in the hand touches, or else points at.
    fn voxel_by_hand(&self, room: &Room) -> Option<UVec3> {
        let pose = &self.hand.pose?;
        let at = self.grid_point(pose.position, room);
        let ahead = (self.grid_point(pose.at(Vec3::NEG_Z), room) - at).normalize_or_zero();
        let grid = self.document().grid();
        let here = at.floor().as_ivec3();
        match grid.get(here) {
            true => Some(here.as_uvec3()),
            false => raycast::cast(grid, at, ahead).map(|hit| hit.voxel),
        }
    }

    /// The cone in which the brush in the hand works, if it holds one that does.
    pub fn cone(&self, room: &Room) -> Option<Footprint> {
        let options = self.tool.brushes.of(self.tool.picture_brush()?);
        let pose = self.hand.pose?;
        let grid_from_room = |point: Vec3| self.grid_point(point, room);
        let eye_vx = grid_from_room(pose.position);
        let way = |own: Vec3| grid_from_room(pose.at(own * SPRAY_REACH_M)) - eye_vx;
        let gauge = self.hand_gauge(&pose, room);
        Some(Footprint {
            eye_vx,
            aim: way(Vec3::NEG_Z),
            across: way(Vec3::X) * SPRAY_STEP,
            down: way(Vec3::NEG_Y) * SPRAY_STEP,
            radius: self.tool.brushes.radius_px(options.get(RADIUS), Some(gauge)),
            outline: options.get(OUTLINE),
            coverage: Coverage::Visible,
        })
    }

    /// How large what stands for a pixel is in a hand, in units of the smallest edge.
    fn hand_gauge(&self, pose: &Pose, room: &Room) -> f32 {
        let size = self.document().grid().voxel_size();
        let at = |own: Vec3| self.grid_point(pose.at(own * SPRAY_REACH_M), room);
        let across = (at(Vec3::X) - at(Vec3::ZERO)) * size / size.min_element();
        across.length() * SPRAY_STEP
    }

    /// A point of the room in grid coordinates.
    pub fn grid_point(&self, point: Vec3, room: &Room) -> Vec3 {
        let world = room.room_from_world.inverse().apply(point);
        self.grid_from_world().transform_point3(world)
    }

    /// A pose of the room in the grid: position in voxels, rotation about axes of the grid.
    fn in_grid(&self, pose: &Pose, room: &Room) -> Pose {
        let world = room.in_world(pose);
        let rotation: Quat = self.document().placement().rotation.inverse();
        Pose {
            position: self.grid_from_world().transform_point3(world.position),
            rotation: (rotation * world.rotation).normalize(),
        }
    }

    fn grid_from_world(&self) -> Affine3A {
        self.document().world_from_grid().inverse()
    }
}
