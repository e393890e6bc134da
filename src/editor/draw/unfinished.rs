//! Drawings of several presses: a box that is raised from its base, and a curve by points.
//!
//! The view may change between the presses: each event brings the present view. Takes pixels; a finished drawing
//! becomes a command, as after a drag. Knows no window and no keys.

use glam::{Vec2, Vec3};

use super::block::{self, Raised};
use super::drawing::{Drawing, Sketch};
use super::drawn::Drawn;
use super::points::{CurvePoints, Pressed};
use super::tube;
use super::view::DrawView;
use crate::editor::tool::ToolState;
use crate::editor::tool_view::ToolView;
use crate::input::{DrawKind, ToolMode};
use crate::picking::Picker;
use crate::picking::geometry::surface_point;

/// A drawing in progress, between the presses or during one.
#[derive(Clone, Debug)]
pub(super) struct Unfinished {
    /// It does the inverse of the tool.
    inverse: bool,
    what: What,
}

#[derive(Clone, Debug)]
enum What {
    Box(Raised),
    Curve(CurvePoints),
}

/// The progress of a drawing of several presses.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Progress {
    /// A box is raised by so many voxels out of the face, negative into it.
    Raised(i32),
    /// A curve has so many points.
    Points(usize),
}

impl Unfinished {
    /// Returns the continuation of a finished drag: the base of a box whose height the pointer sets, or, after a click,
    /// a curve. Returns `None` if the drag is complete.
    pub fn of(drawing: &Drawing, tool: &ToolState) -> Option<Unfinished> {
        let what = match drawing.kind() {
            DrawKind::Box if tool.draws.height_by_pointer => {
                What::Box(Raised::new(drawing.base()?))
            }
            DrawKind::Curve if drawing.is_click() => What::Curve(CurvePoints::new(drawing.start())),
            _ => return None,
        };
        Some(Unfinished { inverse: drawing.mode() != tool.mode, what })
    }

    pub fn kind(&self) -> DrawKind {
        match self.what {
            What::Box(_) => DrawKind::Box,
            What::Curve(_) => DrawKind::Curve,
        }
    }

    fn mode(&self, tool: ToolMode) -> ToolMode {
        if self.inverse { tool.inverted() } else { tool }
    }

    /// Returns its progress.
    pub fn progress(&self, tool: ToolMode) -> Progress {
        match &self.what {
            What::Box(raised) => Progress::Raised(raised.layers(self.goes_out(tool))),
            What::Curve(points) => Progress::Points(points.count()),
        }
    }

    /// Returns whether a box extends out of its face by default.
    fn goes_out(&self, tool: ToolMode) -> bool {
        self.mode(tool) == ToolMode::Add
    }

    /// Handles a press at a pixel.
    pub fn press(&mut self, at: Vec2, tool_view: &ToolView, picker: &Picker) -> Pressed {
        let (view, seen) = seen_at(at, tool_view, picker);
        match &mut self.what {
            What::Box(raised) => {
                raised.lead(&view, at);
                Pressed::Finished
            }
            What::Curve(points) => points.press(&view, at, seen),
        }
    }

    /// Moves the pointer to a pixel.
    pub fn lead(&mut self, at: Vec2, tool_view: &ToolView, picker: &Picker) {
        let (view, seen) = seen_at(at, tool_view, picker);
        match &mut self.what {
            What::Box(raised) => raised.lead(&view, at),
            What::Curve(points) => points.lead(&view, at, seen),
        }
    }

    /// Releases the button.
    pub fn release(&mut self) {
        if let What::Curve(points) = &mut self.what {
            points.release();
        }
    }

    /// Returns whether the button holds a point of it.
    pub fn is_held(&self) -> bool {
        matches!(&self.what, What::Curve(points) if points.is_held())
    }

    /// Undoes the last press. Returns false if nothing remains.
    pub fn take_back(&mut self) -> bool {
        match &mut self.what {
            What::Curve(points) => points.take_back(),
            What::Box(_) => false,
        }
    }

    /// Returns the finished drawing.
    pub fn finished(&self, view: &ToolView) -> Drawn {
        let mode = self.mode(view.tool.mode);
        let change = view.tool.change(mode);
        let edges = view.edges();
        let command = match &self.what {
            What::Box(raised) => {
                let corners = raised.corners(mode == ToolMode::Add);
                Some(change.by_solid(block::cuboid(edges, corners), None))
            }
            What::Curve(points) => {
                let solid = tube::through(&points.places(), view.tool.draws.radii, edges);
                solid.map(|solid| change.by_drawn_solid(solid))
            }
        };
        let commands = command.into_iter().collect();
        Drawn { kind: self.kind(), mode, commands, floating: Vec::new() }
    }

    /// Returns its preview lines. `is_pointed`: the pointer is over the picture.
    pub fn sketch(&self, is_pointed: bool, tool_view: &ToolView, picker: &Picker) -> Sketch {
        let tool = tool_view.tool;
        let view = DrawView::new(picker.sight(), tool_view.grid());
        let (lines, faint) = match &self.what {
            What::Box(raised) => {
                (block::edges_of(raised.corners(self.goes_out(tool.mode))), Vec::new())
            }
            What::Curve(points) => points.sketch(&view, tool.draws.radii, is_pointed),
        };
        Sketch { mode: self.mode(tool.mode), lines, faint }
    }
}

/// Returns the present view, and the surface point at a pixel if the drawing follows the surface.
fn seen_at(at: Vec2, tool_view: &ToolView, picker: &Picker) -> (DrawView, Option<Vec3>) {
    let grid = tool_view.grid();
    let map = picker.map().filter(|_| tool_view.tool.draws.on_surface);
    let seen = map.and_then(|map| surface_point(map, grid, at));
    (DrawView::new(picker.sight(), grid), seen.map(|seen| seen.point))
}
