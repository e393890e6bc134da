//! Drawings that take several presses: a box that is raised once its base stands, and a curve by points.
//!
//! Nothing is held between the presses, so the view may change: each event brings the view of the moment. Takes pixels;
//! a finished drawing becomes a command, as after a drag. Knows no window and no keys.

use glam::Vec2;

use super::block::{self, Raised};
use super::drawing::{Drawing, Sketch};
use super::points::{Points, Pressed};
use super::tube;
use super::view::View;
use crate::editor::Editor;
use crate::editor::tool::ToolKind;
use crate::input::{DrawKind, ToolMode};
use crate::picking::Picker;
use crate::picking::geometry::surface_point;
use crate::tools::drawn::MAX_POINTS;

/// A drawing under way, between the presses or during one of them.
#[derive(Clone, Debug)]
pub(in crate::editor) struct Unfinished {
    /// It does the inverse of what the tool does.
    inverse: bool,
    what: What,
}

#[derive(Clone, Debug)]
enum What {
    Box(Raised),
    Curve(Points),
}

impl Unfinished {
    fn kind(&self) -> DrawKind {
        match self.what {
            What::Box(_) => DrawKind::Box,
            What::Curve(_) => DrawKind::Curve,
        }
    }

    fn mode(&self, tool: ToolMode) -> ToolMode {
        if self.inverse { tool.inverted() } else { tool }
    }
}

/// How far a drawing by several presses is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Progress {
    /// A box is raised: voxels out of the face, below 0 into it.
    Raised(i32),
    /// A curve has so many points.
    Points(usize),
}

impl Editor {
    /// Keeps a drag that is unfinished: the base of a box whose height the pointer leads, or, after a click, a curve.
    /// Returns every other drag.
    pub(super) fn leave_unfinished(&mut self, drawing: Drawing) -> Option<Drawing> {
        let what = match drawing.kind() {
            DrawKind::Box if self.tool.draws.height_by_pointer => {
                drawing.base().map(|base| What::Box(Raised::new(base)))
            }
            DrawKind::Curve if drawing.is_click() => {
                Some(What::Curve(Points::new(drawing.start())))
            }
            _ => None,
        };
        let Some(what) = what else { return Some(drawing) };
        let inverse = drawing.mode() != self.tool.mode;
        self.unfinished = Some(Unfinished { inverse, what });
        None
    }

    /// The unfinished drawing; none once another tool is in hand.
    fn unfinished_now(&self) -> Option<&Unfinished> {
        let in_hand = |drawn: &&Unfinished| self.tool.kind == ToolKind::Draw(drawn.kind());
        self.unfinished.as_ref().filter(in_hand)
    }

    /// Whether something waits for the next press. Another tool in hand gives it up.
    pub(in crate::editor) fn has_unfinished(&mut self) -> bool {
        if self.unfinished_now().is_none() {
            self.unfinished = None;
        }
        self.unfinished.is_some()
    }

    /// How far what is drawn by several presses is, if there is any.
    pub fn progress(&self) -> Option<Progress> {
        let drawn = self.unfinished_now()?;
        Some(match &drawn.what {
            What::Box(raised) => Progress::Raised(raised.layers(self.goes_out(drawn))),
            What::Curve(points) => Progress::Points(points.count()),
        })
    }

    /// Whether a box goes out of its face where the pointer does not say so.
    fn goes_out(&self, drawn: &Unfinished) -> bool {
        drawn.mode(self.tool.mode) == ToolMode::Add
    }

    /// The button is pressed at a pixel; true if that was the last press.
    pub(in crate::editor) fn press_unfinished(&mut self, at: Vec2, picker: &Picker) -> bool {
        let (view, seen) = self.seen_at(at, picker);
        let pressed = match self.unfinished.as_mut().map(|drawn| &mut drawn.what) {
            Some(What::Box(raised)) => {
                raised.lead(&view, at);
                Pressed::Finished
            }
            Some(What::Curve(points)) => points.press(&view, at, seen),
            None => return false,
        };
        match pressed {
            Pressed::Added => {}
            Pressed::Finished => self.finish_unfinished(),
            Pressed::Full => {
                self.note(format!("A tube has at most {MAX_POINTS} points: finish this one first"));
            }
        }
        pressed == Pressed::Finished
    }

    /// The pointer goes to a pixel.
    pub(in crate::editor) fn lead_unfinished(&mut self, at: Vec2, picker: &Picker) {
        if !at.is_finite() || !self.has_unfinished() {
            return;
        }
        let (view, seen) = self.seen_at(at, picker);
        match self.unfinished.as_mut().map(|drawn| &mut drawn.what) {
            Some(What::Box(raised)) => raised.lead(&view, at),
            Some(What::Curve(points)) => points.lead(&view, at, seen),
            None => {}
        }
    }

    /// The view of the moment, and the place on the surface at a pixel where surfaces lead.
    fn seen_at(&self, at: Vec2, picker: &Picker) -> (View, Option<glam::Vec3>) {
        let grid = self.document().grid();
        let map = picker.map().filter(|_| self.tool.draws.on_surface);
        let seen = map.and_then(|map| surface_point(map, grid, at));
        (View::new(picker.sight(), grid), seen.map(|seen| seen.point))
    }

    /// The button is released.
    pub(in crate::editor) fn release_unfinished(&mut self) {
        if let Some(Unfinished { what: What::Curve(points), .. }) = &mut self.unfinished {
            points.release();
        }
    }

    /// Nothing more follows: it is made.
    pub(in crate::editor) fn finish_unfinished(&mut self) {
        let Some(drawn) = self.unfinished.take() else { return };
        let mode = drawn.mode(self.tool.mode);
        let change = self.tool.change(mode);
        let voxel_size = self.document().grid().voxel_size();
        let edges = voxel_size / voxel_size.min_element();
        let command = match &drawn.what {
            What::Box(raised) => {
                let corners = raised.corners(mode == ToolMode::Add);
                Some(change.by_solid(block::cuboid(edges, corners), None))
            }
            What::Curve(points) => {
                let form = tube::through(&points.places(), self.tool.draws.radii, edges);
                form.map(|form| change.by_drawn_solid(form))
            }
        };
        self.carry_out_drawn(drawn.kind(), mode, command.into_iter().collect());
    }

    /// Takes back the last press of what is not finished: the last point of a curve or, if there is no other, all of it.
    /// False if there is nothing.
    pub(in crate::editor) fn take_back_press(&mut self) -> bool {
        if !self.has_unfinished() {
            return false;
        }
        // The button that is still pressed does nothing more.
        self.lifted |= self.is_unfinished_held();
        let stays = match self.unfinished.as_mut().map(|drawn| &mut drawn.what) {
            Some(What::Curve(points)) => points.take_back(),
            _ => false,
        };
        if !stays {
            self.unfinished = None;
        }
        true
    }

    /// Gives it up; false if there is nothing.
    pub(super) fn cancel_unfinished(&mut self) -> bool {
        self.lifted |= self.is_unfinished_held();
        let was_there = self.has_unfinished();
        self.unfinished = None;
        was_there
    }

    fn is_unfinished_held(&self) -> bool {
        let what = self.unfinished.as_ref().map(|drawn| &drawn.what);
        matches!(what, Some(What::Curve(points)) if points.is_held())
    }

    /// The lines that show it.
    pub(super) fn unfinished_sketch(&self, picker: &Picker) -> Option<Sketch> {
        let drawn = self.unfinished_now()?;
        let view = View::new(picker.sight(), self.document().grid());
        let (lines, faint) = match &drawn.what {
            What::Box(raised) => {
                (block::edges_of(raised.corners(self.goes_out(drawn))), Vec::new())
            }
            What::Curve(points) => {
                points.sketch(&view, self.tool.draws.radii, self.pointer.is_some())
            }
        };
        Some(Sketch { mode: drawn.mode(self.tool.mode), lines, faint })
    }
}
