//! The effects of actions on the tool and through it on the sculpture: choices of the tool, commands for the document,
//! and presses and drags on the picture.
//!
//! Positions on the picture are in pixels and come with the [`Picker`] of that picture.

use glam::{Quat, UVec3, Vec2, Vec3};

use super::Editor;
use super::draw::{DrawTool, Pressed};
use super::lead::{LeadEffect, Led};
use super::marker;
use super::pointer::PointerUse;
use super::sizes::gauge_at;
use super::stroke::{PointerGuide, PointerLead, SolidGuide, StrokeScene};
use super::symmetry::SymmetryPart;
use super::tool::{NextPress, ToolEdit, ToolKind};
use super::tool_view::ToolView;
use crate::command::{Area, Command, MaskChange};
use crate::input::{Action, ActionEvent, DrawKind, ToolMode};
use crate::picking::Picker;
use crate::sculpture::Placement;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::VoxelBox;
use crate::tools::brush::BrushId;
use crate::tools::brush::keys::{OUTLINE, RADIUS};
use crate::tools::brush::spec::Inverse;
use crate::tools::drawn::MAX_POINTS;
use crate::tools::symmetry::Parity;

/// Factor on the tool's size for one press of a key.
const GROWTH: f32 = 1.15;
/// Factor on the tool's size for one notch of the wheel.
pub(super) const GROWTH_PER_NOTCH: f32 = 1.1;

impl Editor {
    /// Executes an action that is triggered once. Ignores actions that do not concern the editor.
    pub fn act(&mut self, action: Action, picker: &Picker) {
        match action {
            // An unfinished drawing is undone before finished work.
            Action::Undo | Action::DropBox if self.take_back_press() => {}
            Action::Undo => self.run(Command::Undo { steps: Some(1) }),
            Action::Redo => self.run(Command::Redo { steps: Some(1) }),
            Action::Fill => self.run(Command::Fill { area: Area::Grid, colour: None }),
            Action::Clear => self.run(Command::Clear { area: Area::Grid }),
            Action::TurnUpright(up) => self.run(Command::Orient(up.turned_upright())),
            Action::RotateGrid(axis) => {
                self.run(Command::Orient(Orientation::quarter_turn(axis.index())));
            }
            Action::Solid(solid) => {
                self.tool.solid = solid;
                self.tool.kind = ToolKind::Solid;
            }
            Action::Brush(brush) => self.tool.kind = ToolKind::Brush(brush),
            Action::Draw(kind) => {
                self.tool.kind = ToolKind::Draw(kind);
                self.draw.drop_unfinished();
            }
            Action::Mode(mode) => {
                self.tool.set_mode(mode);
                if !matches!(self.tool.kind, ToolKind::Draw(_)) {
                    self.tool.kind = ToolKind::Solid;
                }
            }
            Action::NextToolMode => self.tool.set_mode(self.tool.mode.next()),
            Action::Grow => self.resize(1.0, GROWTH),
            Action::Shrink => self.resize(-1.0, GROWTH),
            Action::LeadSize => self.begin_leading(Led::Size),
            Action::LeadStrength => self.begin_leading(Led::Strength),
            Action::ResetTool if self.tool.kind == ToolKind::Marker => {
                self.mark(marker::first(self.document().grid()));
            }
            Action::ResetTool => {
                let frame = self.document().contents().frame;
                self.tool.reset_pose(&frame);
                self.leave_ground();
            }
            Action::AlignTool => self.tool.set_turn_deg(Vec3::ZERO),
            Action::Nudge(step) => {
                self.move_tool(picker.sight().screen_axes().step(step), picker);
            }
            Action::Stretch(step) => self.stretch(picker.sight().screen_axes().step(step)),
            Action::ToggleFollow => self.tool.follow = !self.tool.follow,
            Action::ToggleSnap => self.tool.snap = !self.tool.snap,
            Action::PickHere => self.pick_colour(picker),
            Action::Flood => self.flood(picker),
            Action::Wand => self.wand(picker),
            Action::InvertMask => self.run(Command::Mask(MaskChange::Invert)),
            Action::ClearMask => self.run(Command::Mask(MaskChange::Clear)),
            Action::MirrorPlane => self.toggle_symmetry(SymmetryPart::Plane),
            Action::Radial => self.toggle_symmetry(SymmetryPart::Axis),
            Action::Mirror(axis) => {
                let mut symmetry = self.document().symmetry();
                let parity = &mut symmetry.axes[axis.index()];
                *parity = if parity.is_some() { None } else { Some(Parity::Even) };
                self.execute(&Command::Symmetry(symmetry));
            }
            Action::Repeat => {
                let super::tool::ArrayOptions { count, step } = self.tool.array;
                self.run(Command::Array { count, step });
            }
            _ => {
                let document = self.commands.document();
                let commands = self.marker.act(action, document, &mut self.tool, picker);
                commands.into_iter().for_each(|command| self.run(command));
            }
        }
    }

    /// Makes the tool, or the marker, one voxel longer on a side.
    fn stretch(&mut self, side: Vec3) {
        match self.tool.kind {
            ToolKind::Marker => {
                let marker = self.document().selection().marker();
                self.mark(marker::stretched(marker, side));
            }
            ToolKind::Solid => {
                self.tool.stretch(side, 1.0);
                self.leave_ground();
            }
            ToolKind::Brush(_) | ToolKind::Draw(_) => {}
        }
    }

    /// Returns the action that a drag or a hold of `action` means: a drag of `Sculpt` that began beside the sculpture
    /// rotates it.
    pub fn meant(&self, action: Action) -> Action {
        self.pointer.meant(action)
    }

    /// Begins a drag or a hold.
    pub fn begin(&mut self, action: Action, at: Option<Vec2>, picker: &Picker) {
        let inverse = action == Action::SculptInverse;
        match (action, at) {
            (Action::Apply | Action::Sculpt, _) if self.tool.next_press.is_some() => {
                match self.tool.next_press.take() {
                    Some(NextPress::Flood) => self.flood(picker),
                    Some(NextPress::Wand) => self.wand(picker),
                    Some(NextPress::Symmetry(what)) => {
                        if let Some(at) = at.or(self.pointer.at) {
                            self.place_symmetry(what, at, picker);
                        }
                    }
                    Some(NextPress::Pick) | None => self.pick_colour(picker),
                }
            }
            (Action::Apply, _) if self.draw.is_waiting(&self.tool) => self.finish_unfinished(),
            (
                Action::Sculpt
                | Action::SculptInverse
                | Action::SculptSmooth
                | Action::MoveTool
                | Action::MoveToolDeep,
                Some(at),
            ) if self.draw.is_waiting(&self.tool) => {
                // The rest of the last press does nothing.
                self.pointer.lifted |= self.press_unfinished(at, picker) && action.is_stroke();
            }
            (Action::Apply, _) => self.apply_tool(picker),
            (Action::PickColour, _) => self.pick_colour(picker),
            (Action::Sculpt | Action::SculptInverse, Some(at))
                if self.tool.kind == ToolKind::Marker =>
            {
                self.begin_marker(at, inverse, picker);
            }
            (Action::Sculpt | Action::SculptInverse | Action::SculptSmooth, Some(at)) => {
                self.begin_sculpting(action, at, picker);
            }
            _ => {}
        }
    }

    fn begin_sculpting(&mut self, action: Action, at: Vec2, picker: &Picker) {
        if let ToolKind::Draw(kind) = self.tool.kind
            && action != Action::SculptSmooth
        {
            let inverse = action == Action::SculptInverse;
            self.pointer.rotates_instead = !self.begin_drawing(kind, inverse, at, picker);
            return;
        }
        let target = self.target(at, picker);
        self.pointer.rotates_instead = target.is_none();
        let Some(point) = target else { return };
        let tool = &self.tool;
        if let Some(brush) = picture_brush_for(action, tool.kind) {
            let mut options = *tool.brushes.of(brush);
            if let Some(other) = brush.spec().options_of {
                let other = tool.brushes.of(other);
                other.iter().for_each(|(param, value)| options.set_value(param.key, value));
            }
            // It works where the brush in hand shows its outline.
            if let Some(in_hand) = tool.brush_options() {
                options.set(RADIUS, in_hand.get(RADIUS));
                if in_hand.has(OUTLINE) {
                    options.set(OUTLINE, in_hand.get(OUTLINE));
                }
            }
            let inverse = brush.spec().inverse == Inverse::Sense;
            let unpaints = action == Action::SculptInverse && inverse;
            self.stroking().begin_picture_brush(options, unpaints, at, picker);
            return;
        }
        if let Some(brush) = tool.brush() {
            if tool.follow {
                self.lead_tool_to(at, point, picker);
            }
            let inverse = action == Action::SculptInverse;
            self.stroking().begin_clay(brush, inverse, Some(at), picker);
            return;
        }
        let inverse = action == Action::SculptInverse;
        // Removes the paint, so that the bare colour shows.
        let unpaints = inverse && tool.mode == ToolMode::Recolour;
        let mode = if inverse && !unpaints { tool.mode.inverted() } else { tool.mode };
        if tool.follow {
            self.lead_tool_to(at, point, picker);
            let guide = |scene: &StrokeScene| {
                SolidGuide::Surface(PointerGuide::new(at, point, scene, picker))
            };
            self.stroking().begin_solid(mode, unpaints, guide);
        } else {
            self.stroking().begin_solid(mode, unpaints, |_| SolidGuide::Tool { hovering: None });
        }
    }

    /// Uses the tool where it is, by key, button or gamepad.
    fn apply_tool(&mut self, picker: &Picker) {
        match self.tool.kind {
            ToolKind::Solid => {
                let over = self.pointer.at.zip(self.anchor.ground());
                let mode = self.tool.mode;
                self.stroking().begin_solid(mode, false, |scene| SolidGuide::Tool {
                    hovering: over
                        .map(|(at, ground)| PointerGuide::new(at, ground.point, scene, picker)),
                });
            }
            ToolKind::Marker => self.act(Action::SelectMarker, picker),
            ToolKind::Brush(brush) if brush.spec().is_in_picture() => {
                let tool = || picker.sight().pixel_of(self.tool.centre_vx);
                if let Some(at) = self.pointer.at.or_else(tool) {
                    let options = *self.tool.brushes.of(brush);
                    self.stroking().begin_picture_brush(options, false, at, picker);
                }
            }
            ToolKind::Brush(brush) => {
                let hovering = self.pointer.at.filter(|_| self.anchor.ground().is_some());
                self.stroking().begin_clay(brush, false, hovering, picker);
            }
            ToolKind::Draw(kind) => {
                if let Some(at) = self.pointer.at {
                    self.begin_drawing(kind, false, at, picker);
                }
            }
        }
    }

    /// Continues a drag by `by` pixels.
    pub fn drag(&mut self, action: Action, at: Vec2, by: Vec2, picker: &Picker) {
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth
                if self.pointer.lifted => {}
            _ if self.draw.is_dragged() => {
                self.draw_with_view(|draw, view| draw.lead(at, view, picker));
            }
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth => match &self.stroke {
                _ if self.draw.has_unfinished() => self.lead_unfinished(at, picker),
                _ if self.marker.is_dragged() => self.drag_marker(at, picker),
                Some(stroke) if stroke.pointer() != PointerLead::None => {
                    self.stroking().lead_to(at, picker);
                }
                _ => self.drag_tool(by, false, picker),
            },
            Action::PickColour => self.pick_colour(picker),
            Action::MoveTool | Action::MoveToolDeep if self.draw.is_waiting(&self.tool) => {
                self.lead_unfinished(at, picker);
            }
            Action::MoveTool | Action::MoveToolDeep if self.tool.picture_brush().is_some() => {
                self.stroking().lead_by_pointer(at, picker);
            }
            Action::MoveTool => self.drag_tool(by, false, picker),
            Action::MoveToolDeep => self.drag_tool(by, true, picker),
            _ => {}
        }
    }

    /// Ends strokes and drags of the pointer over the picture after a jump of the view, which would continue them
    /// elsewhere. Nothing more happens until the button is released.
    ///
    /// The pointer itself has no speed limit: a mouse may cross the picture between two events. Its path over the
    /// surface, dragged or hovering with a key held, is lifted at edges (`stroke`) and bounded (`stroke::path`).
    pub fn lift(&mut self) {
        let stroke = self.stroke.as_ref().is_some_and(|stroke| stroke.depends_on_picture());
        let drag = self.marker.release() | self.draw.drop_drag();
        // A drawing of several presses continues in the new view.
        self.draw.release();
        if stroke {
            self.end_stroke();
        }
        if stroke || drag {
            self.pointer.lifted = true;
            self.note("The view jumped, so the stroke has ended; press again to continue");
        }
    }

    /// Ends a drag or a hold.
    pub fn end(&mut self, action: Action) {
        self.draw.release();
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth | Action::Apply => {
                self.pointer.release();
                self.marker.release();
                self.end_drawing();
                self.end_stroke();
            }
            _ => {}
        }
    }

    /// Rotates the tool about axes of the world.
    pub fn turn_tool(&mut self, world_turn: Quat) {
        let rotation = self.document().placement().rotation;
        self.tool.turn_by(rotation.inverse() * world_turn * rotation);
    }

    /// Returns the voxel under the pointer.
    fn pointed(&self, picker: &Picker) -> Option<UVec3> {
        self.pointer.voxel(self.document().grid(), picker)
    }

    /// Takes the colour of the voxel under the pointer.
    fn pick_colour(&mut self, picker: &Picker) {
        if let Some(voxel) = self.pointed(picker) {
            self.take_colour_of(voxel);
        }
    }

    /// Recolours the patch under the pointer.
    fn flood(&mut self, picker: &Picker) {
        if let Some(voxel) = self.pointed(picker) {
            self.flood_from(voxel);
        }
    }

    /// Protects the voxels connected to the one under the pointer.
    fn wand(&mut self, picker: &Picker) {
        if let Some(voxel) = self.pointed(picker) {
            self.wand_from(voxel);
        }
    }

    /// Recolours the patch of one colour around a surface voxel.
    pub(super) fn flood_from(&mut self, at: UVec3) {
        let (colour, tolerance) = (self.tool.colour, self.tool.flood_tolerance);
        self.tool.used_colour();
        self.run(Command::Flood { at: at.as_ivec3(), colour, tolerance });
    }

    /// Protects the voxels connected to a surface voxel, or releases them.
    pub(super) fn wand_from(&mut self, at: UVec3) {
        self.run(self.tool.wand.command(at, self.tool.flood_tolerance));
    }

    /// Takes the colour of a voxel.
    pub(super) fn take_colour_of(&mut self, voxel: UVec3) {
        let colour = self.document().contents().rgb(voxel);
        if std::mem::replace(&mut self.tool.colour, colour) != colour {
            tracing::debug!("colour {colour} taken");
        }
    }

    /// Enlarges the tool by notches of the wheel, or shrinks it if they are negative.
    pub fn resize_by_wheel(&mut self, notches: f32) {
        self.resize(notches, GROWTH_PER_NOTCH);
    }

    /// Enlarges (`notches` above 0) or shrinks the tool by `factor` per notch.
    pub(super) fn resize(&mut self, notches: f32, factor: f32) {
        let factor = factor.powf(notches.clamp(-20.0, 20.0));
        match self.tool.kind {
            ToolKind::Solid => self.tool.scale_by(factor),
            ToolKind::Brush(brush) => self.tool.brushes.scale(brush, factor),
            ToolKind::Draw(kind) => self.tool.draws.scale(kind, factor),
            ToolKind::Marker => {
                let marker = self.document().selection().marker();
                self.mark(marker::scaled(marker, notches));
            }
        }
    }

    fn move_tool(&mut self, by: Vec3, picker: &Picker) {
        if self.tool.kind == ToolKind::Marker {
            self.shift_marker(by);
            return;
        }
        if let ToolKind::Draw(_) = self.tool.kind {
            return;
        }
        self.tool.centre_vx += by;
        self.leave_ground();
        self.tool_moved(picker);
    }

    /// Moves the tool along the grid axes that lie across the screen and up it, or across and into it.
    pub fn drag_tool(&mut self, by: Vec2, deep: bool, picker: &Picker) {
        let sight = picker.sight();
        let axes = sight.screen_axes();
        let at = match self.tool.kind {
            ToolKind::Marker => {
                let marker = self.document().selection().marker();
                (marker.min.as_vec3() + marker.max.as_vec3()) * 0.5
            }
            ToolKind::Solid | ToolKind::Brush(_) | ToolKind::Draw(_) => self.tool.centre_vx,
        };
        let second = if deep { -axes.near } else { axes.up };
        let across = axes.right * sight.along(axes.right, by.x, at);
        self.move_tool(across + second * sight.along(second, -by.y, at), picker);
    }

    /// Handles a tool moved by something other than the pointer: a stroke that it leads follows.
    pub(super) fn tool_moved(&mut self, picker: &Picker) {
        self.stroking().tool_moved(picker);
        if self.tool.picture_brush().is_some() {
            // The brush works at the visible position of the tool.
            self.pointer.at = picker.sight().pixel_of(self.tool.centre_vx);
        }
    }

    /// Moves the sculpture.
    pub fn place(&mut self, placement: Placement) {
        self.execute(&Command::Place(placement));
    }

    /// Handles a movement of the pointer without a button.
    pub fn hover(&mut self, at: Vec2, leads_tool: bool, picker: &Picker) {
        self.gauge(picker);
        // A brush that a key holds down follows the pointer.
        let is_led = self.stroking().lead_by_pointer(at, picker);
        // So does a drawing with a key held, or one of several presses.
        self.draw_with_view(|draw, view| draw.lead(at, view, picker));
        self.lead_unfinished(at, picker);
        if is_led && self.tool.picture_brush().is_none() {
            return;
        }
        // A hand that uses the tool keeps it from the pointer.
        if !self.tool.follow || !leads_tool || self.hand.is_working() {
            return;
        }
        let solid = self.tool.kind == ToolKind::Solid;
        if solid && self.stroke.as_ref().is_some_and(|stroke| stroke.is_led_over(picker)) {
            self.stroking().lead_to(at, picker);
        } else if let Some(point) = self.target(at, picker) {
            self.lead_tool_to(at, point, picker);
            if solid {
                self.stroking().tool_put(at, point, picker);
            }
        }
    }

    /// Sets the size of a pixel where the tool works: under the pointer, or else at the tool.
    fn gauge(&mut self, picker: &Picker) {
        if self.hand.is_leading() {
            return;
        }
        let point = self.pointer.at.and_then(|at| self.target(at, picker));
        let point = point.unwrap_or(self.tool.centre_vx);
        let gauge = gauge_at(self.document().grid(), point, picker);
        self.tool.brushes.set_gauge(gauge);
    }

    /// Puts the tool at a surface point that is seen at `at`.
    fn lead_tool_to(&mut self, at: Vec2, point: Vec3, picker: &Picker) {
        let grid = self.commands.document().grid();
        self.anchor.lead_tool_to(&mut self.tool, at, point, grid, picker);
    }

    /// Detaches the tool from the surface, so that the pointer no longer places it.
    pub fn leave_ground(&mut self) {
        self.anchor.leave(&self.tool);
    }

    /// Applies a change of the tool requested by a panel.
    pub fn edit_tool(&mut self, edit: ToolEdit) {
        let placed = matches!(edit, ToolEdit::Place(_));
        self.tool.edit(edit);
        if placed {
            self.leave_ground();
        }
    }

    /// Applies changed choices of the tool's anchor at once.
    pub fn keep_anchor(&mut self, pointer_use: PointerUse, picker: &Picker) {
        self.gauge(picker);
        let Some(taken) = self.anchor.choose(&self.tool) else { return };
        let led = self.stroke.is_some() || self.hand.is_leading();
        let led = led || !self.tool.follow || !pointer_use.leads_tool;
        let placed = self.tool.kind == ToolKind::Solid || self.tool.ball_brush().is_some();
        if !placed || led {
            return;
        }
        match (self.pointer.at.filter(|_| !pointer_use.dragging), self.anchor.ground()) {
            (Some(at), ground) if taken || ground.is_some() => {
                self.hover(at, pointer_use.leads_tool, picker);
            }
            (None, Some(ground)) => {
                let grid = self.commands.document().grid();
                self.anchor.put_tool(&mut self.tool, ground, grid);
            }
            _ => {}
        }
    }

    /// Returns whether the pointer controls the size or the strength of the tool.
    pub fn is_leading(&self) -> bool {
        self.leading.is_under_way()
    }

    fn begin_leading(&mut self, what: Led) {
        if let Err(why) = self.leading.begin(what, self.pointer.at, &mut self.tool) {
            self.note(why);
        }
    }

    /// Handles an event while the pointer controls the tool. Returns true if the event has no other meaning.
    pub fn lead_by(&mut self, event: &ActionEvent) -> bool {
        match self.leading.hear(event, &mut self.tool) {
            LeadEffect::Other => return false,
            LeadEffect::Taken => {}
            LeadEffect::Resize(notches) => self.resize(notches, 2.0),
        }
        true
    }

    /// Handles a press with the marker in hand. Beside everything, the drag rotates the sculpture.
    fn begin_marker(&mut self, at: Vec2, pull: bool, picker: &Picker) {
        let Editor { commands, tool, anchor, marker, .. } = self;
        let view = ToolView { document: commands.document(), tool, anchor };
        let marked = marker.press(at, pull, &view, picker);
        self.pointer.rotates_instead = !self.marker.is_dragged();
        marked.into_iter().for_each(|marked| self.mark(marked));
    }

    fn drag_marker(&mut self, at: Vec2, picker: &Picker) {
        let marked = self.marker.drag_to(at, &self.view(), picker);
        marked.into_iter().for_each(|marked| self.mark(marked));
    }

    /// Moves the marker like a drag of things at its depth.
    pub(super) fn shift_marker(&mut self, by: Vec3) {
        let marked = self.marker.shift(self.document().selection().marker(), by);
        marked.into_iter().for_each(|marked| self.mark(marked));
    }

    fn mark(&mut self, marker: VoxelBox) {
        if self.document().selection().marker() != marker {
            self.execute(&Command::Mark(marker));
        }
    }

    fn toggle_symmetry(&mut self, what: SymmetryPart) {
        let document = self.document();
        let symmetry = what.toggled(document.symmetry(), document.contents().frame.home);
        self.execute(&Command::Symmetry(symmetry));
    }

    /// Places a part of the symmetry where a press meets the surface.
    fn place_symmetry(&mut self, what: SymmetryPart, at: Vec2, picker: &Picker) {
        let Some(point) = self.target(at, picker) else {
            self.note("Press on the surface to place it there");
            return;
        };
        let direction = what.direction_at(point, at, self.document().grid(), picker);
        self.put_symmetry(what, point, direction);
    }

    /// Places a part of the symmetry.
    pub(super) fn put_symmetry(&mut self, what: SymmetryPart, at_vx: Vec3, direction: Vec3) {
        let (before, origin) = (self.document().symmetry(), self.document().origin());
        let symmetry = what.put(before, at_vx + origin.as_vec3(), direction);
        if symmetry != before {
            self.execute(&Command::Symmetry(symmetry));
        }
    }

    /// Begins a drag of a drawing tool. Returns false if it would have no effect there.
    fn begin_drawing(&mut self, kind: DrawKind, inverse: bool, at: Vec2, picker: &Picker) -> bool {
        let begin =
            |draw: &mut DrawTool, view: &ToolView| draw.begin(kind, inverse, at, view, picker);
        self.is_stroking() || self.draw_with_view(begin)
    }

    /// Ends the drag: makes the drawn solid, unless more presses follow.
    fn end_drawing(&mut self) {
        match self.draw_with_view(|draw, view| draw.end(view)) {
            Some(Err(why)) => self.note(why),
            drawn => self.carry_out_drawn(drawn.and_then(Result::ok)),
        }
    }

    /// Handles a press for the unfinished drawing. Returns true if that was the last press.
    fn press_unfinished(&mut self, at: Vec2, picker: &Picker) -> bool {
        let pressed = self.draw_with_view(|draw, view| draw.press(at, view, picker));
        match pressed {
            Some(Pressed::Finished) => self.finish_unfinished(),
            Some(Pressed::Full) => {
                self.note(format!("A tube has at most {MAX_POINTS} points: finish this one first"));
            }
            Some(Pressed::Added) | None => {}
        }
        pressed == Some(Pressed::Finished)
    }

    fn lead_unfinished(&mut self, at: Vec2, picker: &Picker) {
        self.draw_with_view(|draw, view| draw.lead_unfinished(at, view, picker));
    }

    /// Completes the unfinished drawing.
    fn finish_unfinished(&mut self) {
        let drawn = self.draw_with_view(|draw, view| draw.finish(view));
        self.carry_out_drawn(drawn);
    }

    /// Undoes the last press of the unfinished drawing. Returns false if there is none.
    fn take_back_press(&mut self) -> bool {
        let is_held = self.draw.is_held();
        let taken_back = self.draw.take_back_press(&self.tool);
        // The button that is still pressed has no further effect.
        self.pointer.lifted |= taken_back && is_held;
        taken_back
    }
}

/// Returns the brush under a picture outline that an action uses with a tool in hand, if it uses one.
fn picture_brush_for(action: Action, kind: ToolKind) -> Option<BrushId> {
    let brush = match (action, kind) {
        (Action::SculptSmooth, _) => BrushId::Smooth,
        (_, ToolKind::Brush(brush)) => brush,
        _ => return None,
    };
    let inverse = match brush.spec().inverse {
        Inverse::Brush(other) if action == Action::SculptInverse => other,
        _ => brush,
    };
    brush.spec().is_in_picture().then_some(inverse)
}
