//! Tools that draw solids: a drag over the picture becomes a lasso, a box, a tube, a turned solid or letters.
//!
//! Takes pixels of the picture. Every solid is a command that scripts can write, too: mirrored, limited to the
//! selection and undone like others. The files beside this one interpret each drag, and the drawings of several
//! presses. Knows no window and no egui.

mod block;
mod drawing;
mod drawn;
pub mod glyphs;
mod held;
mod lathe;
pub mod options;
mod outline;
mod points;
mod text;
mod thin;
mod tube;
mod unfinished;
mod view;

use glam::{Vec2, Vec3};

use super::surface_guide::normal_around;
use super::tool::{ToolKind, ToolState};
use super::tool_view::ToolView;
use crate::input::{DrawKind, ToolMode};
use crate::picking::geometry::surface_point;
use crate::picking::{Picker, SurfacePoint};

use drawing::{DragStart, Drawing};
use held::HeldPath;
use unfinished::Unfinished;
use view::DrawView;

pub use drawing::Sketch;
pub(super) use drawn::Drawn;
pub use options::DrawOptions;
pub(super) use points::Pressed;
pub use unfinished::Progress;

/// The present drawing: by a drag, by several presses or by a hand.
#[derive(Default)]
pub(super) struct DrawTool {
    /// A drag.
    drawing: Option<Drawing>,
    /// A drawing of several presses, between them or during one.
    unfinished: Option<Unfinished>,
    held: HeldPath,
}

impl DrawTool {
    /// Begins a drag of a drawing tool. Returns false if it would have no effect there.
    pub fn begin(
        &mut self,
        kind: DrawKind,
        inverse: bool,
        at: Vec2,
        view: &ToolView,
        picker: &Picker,
    ) -> bool {
        if self.drawing.is_some() {
            return true;
        }
        self.drawing = started(kind, inverse, at, view, picker).map(|drawing| {
            let follows = matches!(kind, DrawKind::Line | DrawKind::Curve);
            match follows && view.tool.draws.on_surface {
                true => drawing.with_surface(picker, view.grid()),
                false => drawing,
            }
        });
        self.drawing.is_some()
    }

    /// Continues the drag, if there is one.
    pub fn lead(&mut self, at: Vec2, view: &ToolView, picker: &Picker) {
        let Some(drawing) = self.drawing.as_mut().filter(|_| at.is_finite()) else { return };
        if drawing.kind() == DrawKind::Text {
            let ground =
                ground_at(DrawKind::Text, drawing.mode(), at, view, picker, drawing.view());
            ground.into_iter().for_each(|ground| drawing.stand_on(ground));
        }
        drawing.lead(at, view.grid());
    }

    /// Ends the drag. Returns the drawn solid, unless there is none or more presses follow, or advice on what to draw
    /// instead.
    pub fn end(&mut self, view: &ToolView) -> Option<Result<Drawn, String>> {
        let drawing = self.drawing.take()?;
        if let Some(unfinished) = Unfinished::of(&drawing, view.tool) {
            self.unfinished = Some(unfinished);
            return None;
        }
        let (kind, mode, grid) = (drawing.kind(), drawing.mode(), view.grid());
        let options = &view.tool.draws;
        let floating = match mode {
            ToolMode::Add => drawing.floating(options, grid),
            _ => Vec::new(),
        };
        let commands = drawing.commands(options, view.tool.change(mode), grid);
        Some(commands.map(|commands| Drawn { kind, mode, commands, floating }))
    }

    /// Cancels the drag. Returns false if there is none.
    pub fn drop_drag(&mut self) -> bool {
        self.drawing.take().is_some()
    }

    /// Returns whether the pointer draws with its button.
    pub fn is_dragged(&self) -> bool {
        self.drawing.is_some()
    }

    /// Returns whether the pointer is drawing something.
    pub fn is_drawing(&self, tool: &ToolState) -> bool {
        self.drawing.is_some() || self.waiting(tool).is_some()
    }

    /// Returns the unfinished drawing; `None` once another tool is in hand.
    fn waiting(&self, tool: &ToolState) -> Option<&Unfinished> {
        let in_hand = |drawn: &&Unfinished| tool.kind == ToolKind::Draw(drawn.kind());
        self.unfinished.as_ref().filter(in_hand)
    }

    /// Returns the progress of a drawing of several presses, if there is one.
    pub fn progress(&self, tool: &ToolState) -> Option<Progress> {
        Some(self.waiting(tool)?.progress(tool.mode))
    }

    /// Returns whether a drawing waits for the next press. Cancels it if another tool is in hand.
    pub fn is_waiting(&mut self, tool: &ToolState) -> bool {
        if self.waiting(tool).is_none() {
            self.unfinished = None;
        }
        self.unfinished.is_some()
    }

    /// Returns whether there is an unfinished drawing of any tool.
    pub fn has_unfinished(&self) -> bool {
        self.unfinished.is_some()
    }

    /// Cancels the unfinished drawing.
    pub fn drop_unfinished(&mut self) {
        self.unfinished = None;
    }

    /// Handles a press for the unfinished drawing. Returns `None` if there is none.
    pub fn press(&mut self, at: Vec2, view: &ToolView, picker: &Picker) -> Option<Pressed> {
        Some(self.unfinished.as_mut()?.press(at, view, picker))
    }

    /// Moves the pointer of the unfinished drawing to a pixel.
    pub fn lead_unfinished(&mut self, at: Vec2, view: &ToolView, picker: &Picker) {
        if !at.is_finite() || !self.is_waiting(view.tool) {
            return;
        }
        if let Some(drawn) = &mut self.unfinished {
            drawn.lead(at, view, picker);
        }
    }

    /// Releases the button.
    pub fn release(&mut self) {
        if let Some(drawn) = &mut self.unfinished {
            drawn.release();
        }
    }

    /// Ends the unfinished drawing, and returns it as a finished one.
    pub fn finish(&mut self, view: &ToolView) -> Option<Drawn> {
        Some(self.unfinished.take()?.finished(view))
    }

    /// Returns whether the button holds a point of the unfinished drawing.
    pub fn is_held(&self) -> bool {
        self.unfinished.as_ref().is_some_and(Unfinished::is_held)
    }

    /// Undoes the last press of the unfinished drawing: the last point of a curve or, if it is the only one, the whole
    /// drawing. Returns false if there is nothing.
    pub fn take_back_press(&mut self, tool: &ToolState) -> bool {
        if !self.is_waiting(tool) {
            return false;
        }
        self.unfinished.take_if(|drawn| !drawn.take_back());
        true
    }

    /// Cancels everything. Returns false if there is nothing.
    pub fn cancel(&mut self, tool: &ToolState) -> bool {
        let was_drawn = self.drop_drag() | self.held.cancel() | self.is_waiting(tool);
        self.unfinished = None;
        was_drawn
    }

    /// Begins a drawing by the hand at a grid point. Returns false if the tool draws over a picture.
    pub fn begin_in_hand(&mut self, kind: DrawKind, at_vx: Vec3) -> bool {
        let is_drawn = kind.spec().by_hand;
        if is_drawn {
            self.held.begin(at_vx);
        }
        is_drawn
    }

    /// Continues the drawing by the hand, if there is one.
    pub fn lead_in_hand(&mut self, to_vx: Vec3, tool: &ToolState) {
        self.held.lead(to_vx, tool.kind == ToolKind::Draw(DrawKind::Line));
    }

    /// Ends the drawing by the hand, and returns it as a finished one.
    pub fn end_in_hand(&mut self, view: &ToolView) -> Option<Drawn> {
        self.held.end(view)
    }

    /// Returns the present drawing, or the one that a press would begin, as lines. `pointer`: in pixels; `in_hand`: a
    /// hand in a headset holds the tool; `stroking`: there is a stroke.
    pub fn sketch(
        &self,
        pointer: Option<Vec2>,
        in_hand: bool,
        stroking: bool,
        view: &ToolView,
        picker: &Picker,
    ) -> Option<Sketch> {
        let (options, grid) = (&view.tool.draws, view.grid());
        if let Some(drawing) = &self.drawing {
            return Some(drawing.sketch(options, grid));
        }
        if let Some(drawn) = self.waiting(view.tool) {
            return Some(drawn.sketch(pointer.is_some(), view, picker));
        }
        let ToolKind::Draw(kind) = view.tool.kind else { return None };
        if in_hand {
            return Some(self.held.sketch(view));
        }
        let at = pointer.filter(|_| !stroking)?;
        Some(started(kind, false, at, view, picker)?.sketch(options, grid))
    }
}

/// Returns the drawing that a press at a pixel begins.
fn started(
    kind: DrawKind,
    inverse: bool,
    at: Vec2,
    tool_view: &ToolView,
    picker: &Picker,
) -> Option<Drawing> {
    let view = DrawView::new(picker.sight(), tool_view.grid());
    // The inverse of a side is the other side.
    let inverts = inverse && kind != DrawKind::Plane;
    let mode = tool_view.tool.mode;
    let mode = if inverts { mode.inverted() } else { mode };
    let ground = ground_at(kind, mode, at, tool_view, picker, &view)?;
    Some(Drawing::new(kind, mode, inverse, view, ground, at))
}

/// Returns the start of a drag: on the surface, or else where the tool can use it.
fn ground_at(
    kind: DrawKind,
    mode: ToolMode,
    at: Vec2,
    tool_view: &ToolView,
    picker: &Picker,
    view: &DrawView,
) -> Option<DragStart> {
    let grid = tool_view.grid();
    let seen = picker.map().and_then(|map| surface_point(map, grid, at));
    match kind {
        DrawKind::Box => {
            let wall = || block::far_wall(view, at).filter(|_| mode == ToolMode::Add);
            seen.or_else(wall).map(|SurfacePoint { point, face }| DragStart { point, face })
        }
        DrawKind::Text => {
            let point = tool_view.target(at, picker)?;
            let face = normal_around(grid, point, text::GROUND)
                .or(seen.map(|seen| seen.face))
                .unwrap_or(Vec3::ZERO);
            Some(DragStart { point, face })
        }
        _ => {
            let middle = || picker.sight().at_depth(at, picker.sight().depth(view.middle()));
            let point = seen.map_or_else(middle, |seen| seen.point);
            Some(DragStart { point, face: Vec3::ZERO })
        }
    }
}
