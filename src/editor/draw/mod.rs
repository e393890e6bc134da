//! Tools that draw solids: a drag over the picture becomes a lasso, a box, a tube, a turned solid or letters.
//!
//! Takes pixels of the picture. Every solid is a command, as any script may write it: mirrored, limited to the
//! selection and undone like others. The meaning of each drag, and the drawings that take several presses, are in the
//! files beside this one. Knows no window and no egui.

mod block;
mod drawing;
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

use super::Editor;
use super::surface_guide::normal_around;
use super::tool::ToolKind;
use crate::command::Command;
use crate::input::{DrawKind, ToolMode};
use crate::picking::geometry::surface_point;
use crate::picking::{Picker, SurfacePoint};

pub use drawing::Sketch;
pub(super) use drawing::{Drawing, Ground};
pub use options::DrawOptions;
pub use unfinished::Progress;
pub(super) use unfinished::Unfinished;
use view::View;

impl Editor {
    /// A drag of a tool that draws begins; false if it would mean nothing there.
    pub(super) fn begin_drawing(
        &mut self,
        kind: DrawKind,
        inverse: bool,
        at: Vec2,
        picker: &Picker,
    ) -> bool {
        if self.is_stroking() || self.drawing.is_some() {
            return true;
        }
        self.drawing = self.started(kind, inverse, at, picker).map(|drawing| {
            let follows = matches!(kind, DrawKind::Line | DrawKind::Curve);
            match follows && self.tool.draws.on_surface {
                true => drawing.with_surface(picker, self.document().grid()),
                false => drawing,
            }
        });
        self.drawing.is_some()
    }

    /// Returns the drawing that a press at a pixel begins.
    fn started(&self, kind: DrawKind, inverse: bool, at: Vec2, picker: &Picker) -> Option<Drawing> {
        let grid = self.document().grid();
        let view = View::new(picker.sight(), grid);
        // The inverse of a side is the other side.
        let inverts = inverse && kind != DrawKind::Plane;
        let mode = if inverts { self.tool.mode.inverted() } else { self.tool.mode };
        let ground = self.ground_at(kind, mode, at, picker, &view)?;
        Some(Drawing::new(kind, mode, inverse, view, ground, at))
    }

    /// Where a drag begins: on the surface, or else where the tool has a use for it.
    fn ground_at(
        &self,
        kind: DrawKind,
        mode: ToolMode,
        at: Vec2,
        picker: &Picker,
        view: &View,
    ) -> Option<Ground> {
        let grid = self.document().grid();
        let seen = picker.map().and_then(|map| surface_point(map, grid, at));
        match kind {
            DrawKind::Box => {
                let wall = || block::far_wall(view, at).filter(|_| mode == ToolMode::Add);
                seen.or_else(wall).map(|SurfacePoint { point, face }| Ground { point, face })
            }
            DrawKind::Text => {
                let point = self.target(at, picker)?;
                let face = normal_around(grid, point, text::GROUND)
                    .or(seen.map(|seen| seen.face))
                    .unwrap_or(Vec3::ZERO);
                Some(Ground { point, face })
            }
            _ => {
                let middle = || picker.sight().at_depth(at, picker.sight().depth(view.middle()));
                let point = seen.map_or_else(middle, |seen| seen.point);
                Some(Ground { point, face: Vec3::ZERO })
            }
        }
    }

    /// The drag goes on, if there is one.
    pub(super) fn lead_drawing(&mut self, at: Vec2, picker: &Picker) {
        let Some(mut drawing) = self.drawing.take() else { return };
        if at.is_finite() {
            if drawing.kind() == DrawKind::Text {
                let view = drawing.view();
                let ground = self.ground_at(DrawKind::Text, drawing.mode(), at, picker, view);
                ground.into_iter().for_each(|ground| drawing.stand_on(ground));
            }
            drawing.lead(at, self.document().grid());
        }
        self.drawing = Some(drawing);
    }

    /// Ends the drag: the drawn form is made, unless more presses follow.
    pub(super) fn end_drawing(&mut self) {
        let drawing = self.drawing.take().and_then(|drawing| self.leave_unfinished(drawing));
        let Some(drawing) = drawing else { return };
        let mode = drawing.mode();
        let grid = self.document().grid();
        let floating = match mode {
            ToolMode::Add => drawing.floating(&self.tool.draws, grid),
            _ => Vec::new(),
        };
        match drawing.commands(&self.tool.draws, self.tool.change(mode), grid) {
            Ok(commands) => self.carry_out_drawn(drawing.kind(), mode, commands),
            Err(why) => return self.note(why),
        }
        if !floating.is_empty() {
            let signs: Vec<String> = floating.iter().map(|sign| format!("“{sign}”")).collect();
            let (signs, verb) =
                (signs.join(", "), if signs.len() == 1 { "floats" } else { "float" });
            self.note(format!("{signs} {verb}: there is no surface there"));
        }
    }

    /// Carries out what was drawn, as one step of the history, and says why nothing has changed if nothing has.
    fn carry_out_drawn(&mut self, kind: DrawKind, mode: ToolMode, commands: Vec<Command>) {
        let before = self.voxels_changed;
        if matches!(mode, ToolMode::Add | ToolMode::Recolour) {
            self.tool.used_colour();
        }
        let done = match &commands[..] {
            [command] => self.execute(command),
            _ => self.execute_as_one(kind.name(), &commands),
        };
        if done && self.voxels_changed == before {
            self.explain_idle(&commands);
        } else if done {
            let beyond = commands.iter().any(|command| self.goes_beyond(command));
            self.note_cut_off(beyond);
        }
    }

    /// Carries out commands as one step of the history, or none of them.
    fn execute_as_one(&mut self, label: &str, commands: &[Command]) -> bool {
        if !self.execute(&Command::Begin { label: label.into() }) {
            return false;
        }
        let all = commands.iter().all(|command| self.execute(command));
        self.execute(if all { &Command::End } else { &Command::Cancel }) && all
    }

    /// Gives up what is being drawn, or what the next press was to do; false if there is neither.
    pub fn cancel_drawing(&mut self) -> bool {
        let was_meant = self.tool.next_press.take().is_some();
        let was_held = !std::mem::take(&mut self.held_way).is_empty();
        let was_drawn = self.drawing.take().is_some();
        // The button that is still pressed does nothing more.
        self.lifted |= was_drawn;
        let was_unfinished = self.cancel_unfinished();
        was_drawn || was_unfinished || was_held || was_meant
    }

    /// Whether something is being drawn.
    pub fn is_drawing(&self) -> bool {
        self.drawing.is_some() || self.progress().is_some()
    }

    /// Returns the drawing under way, or the one that a press would begin, as lines.
    pub fn sketch(&self, picker: &Picker) -> Option<Sketch> {
        if let Some(drawing) = &self.drawing {
            return Some(drawing.sketch(&self.tool.draws, self.document().grid()));
        }
        if let Some(sketch) = self.unfinished_sketch(picker) {
            return Some(sketch);
        }
        let ToolKind::Draw(kind) = self.tool.kind else { return None };
        if self.hand.is_leading() {
            return Some(self.held_sketch());
        }
        let at = self.pointer.filter(|_| !self.is_stroking())?;
        Some(
            self.started(kind, false, at, picker)?.sketch(&self.tool.draws, self.document().grid()),
        )
    }
}
