//! Handles the events of a hand in the room of a headset: the tool follows the hand and is used there, and the
//! sculpture is carried.
//!
//! Takes [`HandEvent`]s in the coordinates of the room; every change is a command, as with the mouse.

use super::Editor;
use super::actions::GROWTH_PER_NOTCH;
use super::hand::{hand_gauge, in_grid};
use super::stroke::{SolidGuide, StrokeScene};
use super::tool::{NextPress, ToolKind};
use crate::command::Command;
use crate::input::hands::HandEvent;
use crate::input::pen::PenTouch;
use crate::picking::Picker;
use crate::view::{Room, RoomPose};

/// Largest distance of the tool from the grid's origin, in voxels.
const FARTHEST_VX: f32 = 1e7;
/// Smallest and largest scale of a held sculpture, in world units per voxel edge.
const SCALES: std::ops::RangeInclusive<f32> = 0.02..=100.0;

impl Editor {
    /// Handles an event of a hand. Events that concern the board or the room itself are not handled here.
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
            HandEvent::Pressure(pressure) => {
                self.set_touch(Some(PenTouch::of_pressure(pressure)));
            }
            HandEvent::Release => self.release_by_hand(),
            HandEvent::Resize(notches) => self.resize(notches, GROWTH_PER_NOTCH),
            HandEvent::Pick => {
                if let Some(voxel) = self.hand.voxel(self.document(), room) {
                    self.take_colour_of(voxel);
                }
            }
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
        let drawn = self.draw_with_view(|draw, view| draw.end_in_hand(view));
        self.carry_out_drawn(drawn);
        if std::mem::take(&mut self.hand.stroke) {
            self.end_stroke();
        }
    }

    fn lead_by_hand(&mut self, pose: &RoomPose, room: &Room, picker: &Picker) {
        if self.is_stroking() && !self.hand.stroke {
            // The mouse is in use.
            return;
        }
        let own = in_grid(self.document(), pose, room);
        let near = own.position.is_finite() && own.position.abs().max_element() <= FARTHEST_VX;
        if !near || !own.rotation.is_finite() {
            // There is nothing to do there.
            self.release_by_hand();
            return;
        }
        let turn = own.rotation * self.tool.rotation().inverse();
        self.hand.pose = Some(*pose);
        let gauge = hand_gauge(self.document(), pose, room);
        self.tool.brushes.set_gauge(gauge);
        if let Some(what) = self.hand.symmetry {
            self.put_symmetry(what, own.position, own.rotation * what.direction_in_hand());
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
                    && let Some(footprint) = self.hand.cone(self.document(), &self.tool, room)
                {
                    self.stroking().aim(footprint);
                }
            }
            ToolKind::Brush(_) => {
                self.tool.centre_vx = own.position;
                self.tool_moved(picker);
                self.catch_up();
            }
            ToolKind::Draw(_) => {
                self.tool.centre_vx = own.position;
                self.draw.lead_in_hand(own.position, &self.tool);
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
                // It follows the hand until the trigger is released.
                self.hand.symmetry = Some(what);
                return;
            }
            match (next, self.hand.voxel(self.document(), room)) {
                (NextPress::Flood, Some(voxel)) => self.flood_from(voxel),
                (NextPress::Wand, Some(voxel)) => self.wand_from(voxel),
                (NextPress::Pick, Some(voxel)) => self.take_colour_of(voxel),
                (NextPress::Symmetry(_), _) | (_, None) => {}
            }
            return;
        }
        let mode = self.tool.mode;
        match self.tool.kind {
            ToolKind::Solid => {
                let guide = |_: &StrokeScene| SolidGuide::Tool { hovering: None };
                self.stroking().begin_solid(mode, false, guide);
            }
            ToolKind::Brush(brush) if brush.spec().is_in_picture() => {
                if let Some(footprint) = self.hand.cone(self.document(), &self.tool, room) {
                    let options = *self.tool.brushes.of(brush);
                    let radius_vx = footprint.across.length() * footprint.radius;
                    let spacing_vx = (brush.spec().spacing * radius_vx).max(1.0);
                    self.stroking().begin_cone(options, footprint, spacing_vx);
                }
            }
            ToolKind::Brush(brush) => self.stroking().begin_clay(brush, false, None, picker),
            ToolKind::Draw(kind) => {
                if !self.draw.begin_in_hand(kind, self.tool.centre_vx) {
                    self.note(
                        "This tool draws over a picture: in a headset, use the line or the curve",
                    );
                }
            }
            ToolKind::Marker => {
                let document = self.commands.document();
                self.hand.marker =
                    self.hand.pose.map(|pose| in_grid(document, &pose, room).position);
            }
        }
        self.hand.stroke = self.is_stroking();
    }
}
