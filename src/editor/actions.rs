//! The effects of actions on the tool and, through it, on the sculpture: choices of the tool, commands for the
//! document, and presses and drags on the picture.
//!
//! Places on the picture are in pixels and come with the [`Picker`] of that picture.

use glam::{Quat, UVec3, Vec2, Vec3};

use super::Editor;
use super::lead::Led;
use super::stroke::{Guide, PointerGuide, PointerLead, Scene};
use super::tool::{NextPress, ToolKind};
use crate::command::{Area, Command, MaskChange};
use crate::input::{Action, ToolMode};
use crate::picking::Picker;
use crate::sculpture::Placement;
use crate::sculpture::orientation::Orientation;
use crate::tools::brush::BrushId;
use crate::tools::brush::keys::{OUTLINE, RADIUS};
use crate::tools::brush::spec::Inverse;
use crate::tools::symmetry::Parity;

/// Factor on the tool's size for one press of a key.
const GROWTH: f32 = 1.15;
/// Factor on the tool's size for one notch of the wheel.
pub(super) const GROWTH_PER_NOTCH: f32 = 1.1;

impl Editor {
    /// Carries out an action that asks once. Actions of others than the editor do nothing here.
    pub fn act(&mut self, action: Action, picker: &Picker) {
        match action {
            // An unfinished drawing is taken back before finished work.
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
                self.unfinished = None;
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
            Action::ResetTool if self.tool.kind == ToolKind::Marker => self.reset_marker(),
            Action::ResetTool => {
                self.tool.reset_pose(self.document().grid().dims());
                self.leave_ground();
            }
            Action::AlignTool => self.tool.set_turn_deg(Vec3::ZERO),
            Action::Nudge(step) => {
                self.move_tool(picker.sight().screen_axes().step(step), picker);
            }
            Action::Stretch(step) => {
                let side = picker.sight().screen_axes().step(step);
                match self.tool.kind {
                    ToolKind::Marker => self.stretch_marker(side),
                    ToolKind::Solid => {
                        self.tool.stretch(side, 1.0);
                        self.leave_ground();
                    }
                    ToolKind::Brush(_) | ToolKind::Draw(_) => {}
                }
            }
            Action::ToggleFollow => self.tool.follow = !self.tool.follow,
            Action::ToggleSnap => self.tool.snap = !self.tool.snap,
            Action::PickHere => self.pick_colour(picker),
            Action::Flood => self.flood(picker),
            Action::Wand => self.wand(picker),
            Action::InvertMask => self.run(Command::Mask(MaskChange::Invert)),
            Action::ClearMask => self.run(Command::Mask(MaskChange::Clear)),
            Action::MirrorPlane => self.toggle_plane(),
            Action::Radial => self.toggle_radial(),
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
            _ => self.act_on_area(action, picker),
        }
    }

    /// Returns the action that a drag or a hold of `action` stands for: a drag of `Sculpt` that began beside the
    /// sculpture rotates it.
    pub fn meant(&self, action: Action) -> Action {
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth
                if self.rotates_instead && !self.lifted =>
            {
                Action::TurnSculpture
            }
            _ => action,
        }
    }

    /// A drag or a hold begins.
    pub fn begin(&mut self, action: Action, at: Option<Vec2>, picker: &Picker) {
        let inverse = action == Action::SculptInverse;
        match (action, at) {
            (Action::Apply | Action::Sculpt, _) if self.tool.next_press.is_some() => {
                match self.tool.next_press.take() {
                    Some(NextPress::Flood) => self.flood(picker),
                    Some(NextPress::Wand) => self.wand(picker),
                    Some(NextPress::Symmetry(what)) => {
                        if let Some(at) = at.or(self.pointer) {
                            self.place_symmetry(what, at, picker);
                        }
                    }
                    Some(NextPress::Pick) | None => self.pick_colour(picker),
                }
            }
            (Action::Apply, _) if self.has_unfinished() => self.finish_unfinished(),
            (
                Action::Sculpt
                | Action::SculptInverse
                | Action::SculptSmooth
                | Action::MoveTool
                | Action::MoveToolDeep,
                Some(at),
            ) if self.has_unfinished() => {
                // The rest of the last press does nothing.
                self.lifted |= self.press_unfinished(at, picker) && action.is_stroke();
            }
            (Action::Apply, _) => self.apply_tool(picker),
            (Action::PickColour, _) => self.pick_colour(picker),
            (Action::Sculpt | Action::SculptInverse, Some(at))
                if self.tool.kind == ToolKind::Marker =>
            {
                self.rotates_instead = !self.begin_marker(at, inverse, picker);
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
            self.rotates_instead = !self.begin_drawing(kind, inverse, at, picker);
            return;
        }
        let target = self.target(at, picker);
        self.rotates_instead = target.is_none();
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
            self.begin_picture_brush(options, unpaints, at, picker);
            return;
        }
        if let Some(brush) = tool.brush() {
            if tool.follow {
                self.lead_tool_to(at, point, picker);
            }
            self.begin_clay(brush, action == Action::SculptInverse, Some(at), picker);
            return;
        }
        let inverse = action == Action::SculptInverse;
        // Paint goes, and the bare colour is seen again.
        let unpaints = inverse && tool.mode == ToolMode::Recolour;
        let mode = if inverse && !unpaints { tool.mode.inverted() } else { tool.mode };
        if tool.follow {
            self.lead_tool_to(at, point, picker);
            let guide = |scene: &Scene| Guide::Surface(PointerGuide::new(at, point, scene, picker));
            self.begin_solid(mode, unpaints, guide);
        } else {
            self.begin_solid(mode, unpaints, |_| Guide::Tool { hovering: None });
        }
    }

    /// Uses the tool where it is, by key, button or pad.
    fn apply_tool(&mut self, picker: &Picker) {
        match self.tool.kind {
            ToolKind::Solid => {
                let over = self.pointer.zip(self.ground());
                self.begin_solid(self.tool.mode, false, |scene| Guide::Tool {
                    hovering: over.map(|(at, point)| PointerGuide::new(at, point, scene, picker)),
                });
            }
            ToolKind::Marker => self.act(Action::SelectMarker, picker),
            ToolKind::Brush(brush) if brush.spec().is_in_picture() => {
                let tool = || picker.sight().pixel_of(self.tool.centre_vx);
                if let Some(at) = self.pointer.or_else(tool) {
                    self.begin_picture_brush(*self.tool.brushes.of(brush), false, at, picker);
                }
            }
            ToolKind::Brush(brush) => {
                let hovering = self.pointer.filter(|_| self.ground().is_some());
                self.begin_clay(brush, false, hovering, picker);
            }
            ToolKind::Draw(kind) => {
                if let Some(at) = self.pointer {
                    self.begin_drawing(kind, false, at, picker);
                }
            }
        }
    }

    /// A drag of `by` pixels goes on.
    pub fn drag(&mut self, action: Action, at: Vec2, by: Vec2, picker: &Picker) {
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth if self.lifted => {}
            _ if self.drawing.is_some() => self.lead_drawing(at, picker),
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth => match &self.stroke {
                _ if self.unfinished.is_some() => self.lead_unfinished(at, picker),
                _ if self.marker.drag.is_some() => self.drag_marker(at, picker),
                Some(stroke) if stroke.pointer() != PointerLead::None => {
                    self.lead_stroke(at, picker);
                }
                _ => self.drag_tool(by, false, picker),
            },
            Action::PickColour => self.pick_colour(picker),
            Action::MoveTool | Action::MoveToolDeep if self.has_unfinished() => {
                self.lead_unfinished(at, picker);
            }
            Action::MoveTool | Action::MoveToolDeep if self.tool.picture_brush().is_some() => {
                self.lead_by_pointer(at, picker);
            }
            Action::MoveTool => self.drag_tool(by, false, picker),
            Action::MoveToolDeep => self.drag_tool(by, true, picker),
            _ => {}
        }
    }

    /// Ends strokes and drags of the pointer over the picture, since the view has leapt; else they
    /// would go on somewhere else. Nothing more is done until the button is released.
    ///
    /// The pointer itself has no speed limit: a mouse may cross the picture between two events, and
    /// its path over the surface, dragged or hovering with a key held, is lifted at edges (`stroke`)
    /// and bounded (`stroke::path`).
    pub fn lift(&mut self) {
        let stroke = self.stroke.as_ref().is_some_and(|stroke| stroke.depends_on_picture());
        let drag = self.marker.drag.take().is_some() | self.drawing.take().is_some();
        // A drawing made with several presses goes on in the new view.
        self.release_unfinished();
        if stroke {
            self.end_stroke();
        }
        if stroke || drag {
            self.lifted = true;
            self.note("The view jumped, so the stroke has ended; press again to continue");
        }
    }

    /// A drag or a hold is over.
    pub fn end(&mut self, action: Action) {
        self.release_unfinished();
        match action {
            Action::Sculpt | Action::SculptInverse | Action::SculptSmooth | Action::Apply => {
                self.rotates_instead = false;
                self.lifted = false;
                self.marker.drag = None;
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

    /// Takes the colour of the voxel that the pointer points at.
    fn pick_colour(&mut self, picker: &Picker) {
        let grid = self.document().grid();
        if let Some(voxel) = self.pointer.and_then(|at| picker.voxel(grid, at)) {
            self.take_colour_of(voxel);
        }
    }

    /// Recolours the patch that the pointer points at.
    fn flood(&mut self, picker: &Picker) {
        let grid = self.document().grid();
        if let Some(voxel) = self.pointer.and_then(|at| picker.voxel(grid, at)) {
            self.flood_from(voxel);
        }
    }

    /// Recolours the patch of one colour around a voxel of the surface.
    pub(super) fn flood_from(&mut self, at: UVec3) {
        let (colour, tolerance) = (self.tool.colour, self.tool.flood_tolerance);
        self.tool.used_colour();
        self.run(Command::Flood { at, colour, tolerance });
    }

    pub(super) fn take_colour_of(&mut self, voxel: UVec3) {
        let colour = self.document().contents().rgb(voxel);
        if std::mem::replace(&mut self.tool.colour, colour) != colour {
            tracing::debug!("colour {colour} taken");
        }
    }

    /// Makes the tool larger by notches of the wheel, or smaller if they are negative.
    pub fn resize_by_wheel(&mut self, notches: f32) {
        self.resize(notches, GROWTH_PER_NOTCH);
    }

    /// Makes the tool larger (`notches` above 0) or smaller, by `factor` a notch.
    pub(super) fn resize(&mut self, notches: f32, factor: f32) {
        let factor = factor.powf(notches.clamp(-20.0, 20.0));
        match self.tool.kind {
            ToolKind::Solid => self.tool.scale_by(factor),
            ToolKind::Brush(brush) => self.tool.brushes.scale(brush, factor),
            ToolKind::Draw(kind) => self.tool.draws.scale(kind, factor),
            ToolKind::Marker => self.scale_marker(notches),
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

    /// Moves the tool along the axes of the grid that lie across the screen and up it, or across
    /// and into it.
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

    /// Moves the sculpture.
    pub fn place(&mut self, placement: Placement) {
        self.execute(&Command::Place(placement));
    }
}

/// The brush under an outline in the picture that an action uses with a tool in hand, if it uses one.
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
