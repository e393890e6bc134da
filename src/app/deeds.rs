//! Owns what each action and intent leads to: commands for the session, another view, another
//! tool, a window that opens.

use glam::{Vec2, Vec3};

use super::stroke::Guide;
use super::workbench::Workbench;
use crate::command::{Area, Command};
use crate::config::RenderMode;
use crate::format::options::ExportForm;
use crate::input::{Action, Side};
use crate::sculpture::Placement;
use crate::ui::Intent;
use crate::ui::files::FileTask;

/// Factor on the tool's size for one press of a key.
const GROWTH: f32 = 1.15;
/// Factor on the tool's size for one notch of the wheel.
const GROWTH_PER_NOTCH: f32 = 1.1;

impl Workbench {
    pub(super) fn carry_out(&mut self, intent: Intent) {
        match intent {
            Intent::Do(action) => self.act(action),
            Intent::Run(command) => self.run(command, false),
            Intent::Leave => {
                // If something is still to be written, leaving waits for its success.
                match &mut self.waiting {
                    Some((_, leave)) => *leave = true,
                    None => self.leave(),
                }
            }
            Intent::SaveAndLeave => self.save(true),
        }
    }

    /// Carries out an action that asks once.
    pub(super) fn act(&mut self, action: Action) {
        let dims = self.session.document().grid().dims();
        match action {
            Action::New => self.ui.new_dialog.open = true,
            Action::Open => self.ui.files.open(FileTask::Open, self.session.path()),
            Action::Save => self.save(false),
            Action::SaveAs => self.ui.files.open(FileTask::SaveAs, self.session.path()),
            Action::Quit if self.session.modified() => self.ui.leave_open = true,
            Action::Quit => self.leave(),
            Action::Help => self.ui.help_open = !self.ui.help_open,
            Action::Undo => self.run(Command::Undo { steps: Some(1) }, false),
            Action::Redo => self.run(Command::Redo { steps: Some(1) }, false),
            Action::Fill => self.run(Command::Fill { area: Area::Grid, colour: None }, false),
            Action::Clear => self.run(Command::Clear { area: Area::Grid }, false),
            Action::Cancel if self.stroke.is_some() => self.cancel_stroke(),
            Action::Cancel => {
                self.ui.close_top();
            }
            Action::Solid(solid) => self.ui.hand.solid = solid,
            Action::Mode(mode) => self.ui.hand.mode = mode,
            Action::Grow => self.ui.hand.scale_by(GROWTH),
            Action::Shrink => self.ui.hand.scale_by(1.0 / GROWTH),
            Action::ResetTool => self.ui.hand.reset_pose(dims),
            Action::Nudge(step) => {
                let by = self.sight().screen_axes().step(step);
                self.move_tool(by);
            }
            Action::ToggleFollow => self.ui.hand.follow = !self.ui.hand.follow,
            Action::ResetView => self.look_from(Side::Corner),
            Action::LookFrom(side) => self.look_from(side),
            Action::NextRenderMode => self.ui.view.mode = next_mode(self.ui.view.mode),
            // These are held or dragged and come by `begin`.
            Action::Apply
            | Action::Sculpt
            | Action::SculptInverse
            | Action::TurnSculpture
            | Action::PanSculpture
            | Action::MoveTool
            | Action::MoveToolDeep
            | Action::TurnTool
            | Action::Zoom
            | Action::ResizeTool => {}
        }
    }

    /// A drag or a hold begins.
    pub(super) fn begin(&mut self, action: Action, at: Option<Vec2>) {
        let mode = match action {
            Action::SculptInverse => self.ui.hand.mode.inverted(),
            _ => self.ui.hand.mode,
        };
        match (action, at) {
            (Action::Apply, _) => self.begin_stroke(mode, Guide::Tool),
            (Action::Sculpt | Action::SculptInverse, Some(at)) => {
                let target = self.target(at);
                self.turns_instead = target.is_none();
                match target {
                    None => {}
                    Some(point) if self.ui.hand.follow => {
                        let depth = self.sight().depth(point);
                        self.ui.hand.move_to(point);
                        let seen = self.seen.clone();
                        self.begin_stroke(mode, Guide::Surface { seen, at, depth });
                    }
                    Some(_) => self.begin_stroke(mode, Guide::Tool),
                }
            }
            _ => {}
        }
    }

    /// A drag goes on.
    pub(super) fn drag(&mut self, action: Action, at: Vec2, by: Vec2) {
        let placement = *self.session.document().placement();
        match action {
            Action::Sculpt | Action::SculptInverse if self.turns_instead => {
                self.place(self.stage.turned(&placement, by, self.ui.view.up));
            }
            Action::Sculpt | Action::SculptInverse => match &self.stroke {
                Some(stroke) if matches!(stroke.guide, Guide::Surface { .. }) => {
                    self.lead_stroke(at);
                }
                _ => self.drag_tool(by, false),
            },
            Action::TurnSculpture => {
                self.place(self.stage.turned(&placement, by, self.ui.view.up));
            }
            Action::PanSculpture => self.place(self.stage.shifted(&placement, by)),
            Action::MoveTool => self.drag_tool(by, false),
            Action::MoveToolDeep => self.drag_tool(by, true),
            Action::TurnTool => {
                let world_turn = self.stage.turn_of(by);
                let grid_turn = placement.rotation.inverse() * world_turn * placement.rotation;
                self.ui.hand.turn_by(grid_turn);
            }
            _ => {}
        }
    }

    /// A drag or a hold is over.
    pub(super) fn end(&mut self, action: Action) {
        match action {
            Action::Sculpt | Action::SculptInverse | Action::Apply => {
                self.turns_instead = false;
                self.end_stroke();
            }
            _ => {}
        }
    }

    /// The pointer moves with nothing held.
    pub(super) fn hover(&mut self, at: Vec2) {
        if self.ui.hand.follow
            && self.follows_pointer()
            && let Some(point) = self.target(at)
        {
            self.ui.hand.move_to(point);
            self.tool_moved();
        }
    }

    pub(super) fn wheel(&mut self, action: Action, notches: f32, at: Vec2) {
        match action {
            Action::Zoom => {
                let placement = *self.session.document().placement();
                let placement = self.stage.zoomed(&placement, notches, at);
                self.place(placement);
            }
            Action::ResizeTool => {
                self.ui.hand.scale_by(GROWTH_PER_NOTCH.powf(notches.clamp(-20.0, 20.0)));
            }
            _ => {}
        }
    }

    /// Shows all of the grid from a side.
    pub(super) fn look_from(&mut self, side: Side) {
        let document = self.session.document();
        let placement = self.stage.looking_from(side, self.ui.view.up, document.placement());
        self.stage.show_all(document.grid(), &placement);
        self.place(placement);
    }

    /// In a table of bindings without `Sculpt` the tool is moved by drags alone.
    fn follows_pointer(&self) -> bool {
        self.presets
            .get(self.ui.preset)
            .is_some_and(|bindings| bindings.triggers(Action::Sculpt).next().is_some())
    }

    fn move_tool(&mut self, by: Vec3) {
        let to = self.ui.hand.centre_vx + by;
        self.ui.hand.centre_vx = to;
        self.tool_moved();
    }

    /// Moves the tool along the axes of the grid that lie across the screen and up it, or across
    /// and into it.
    fn drag_tool(&mut self, by: Vec2, deep: bool) {
        let sight = self.sight();
        let axes = sight.screen_axes();
        let at = self.ui.hand.centre_vx;
        let second = if deep { -axes.near } else { axes.up };
        let across = axes.right * sight.along(axes.right, by.x, at);
        self.move_tool(across + second * sight.along(second, -by.y, at));
    }

    fn place(&mut self, placement: Placement) {
        self.execute(&Command::Place(placement));
    }

    fn save(&mut self, leave: bool) {
        match self.session.path().map(|p| p.to_path_buf()) {
            // A file that this run has not written may hold more than a sculpture does.
            Some(path) if self.written.as_ref() == Some(&path) => {
                self.run(Command::Save { path, form: ExportForm::Auto }, leave);
            }
            path => {
                let task = if leave { FileTask::SaveAndLeave } else { FileTask::SaveAs };
                self.ui.files.open(task, path.as_deref());
            }
        }
    }

    /// Carries out a command that is no part of a stroke; work on files only after its sign has
    /// been shown.
    fn run(&mut self, command: Command, leave: bool) {
        self.end_stroke();
        let sign = match &command {
            Command::Open { .. } => "Opening …",
            Command::Save { .. } => "Saving …",
            Command::New(_) => "Making a new sculpture …",
            _ => {
                self.execute(&command);
                return;
            }
        };
        self.ui.busy = Some(sign.to_string());
        self.waiting = Some((command, leave));
    }

    /// Does the long work whose sign is on the screen now.
    pub(super) fn do_waiting(&mut self) {
        let Some((command, leave)) = self.waiting.take() else { return };
        self.ui.busy = None;
        if self.execute(&command) {
            if let Command::Save { path, .. } = command {
                self.ui.toasts.note(format!("Saved {}", path.display()));
                self.written = Some(path);
            }
            if leave {
                self.leave();
            }
        }
    }

    /// Carries out a command; says what went wrong. True if it was done.
    pub(super) fn execute(&mut self, command: &Command) -> bool {
        let dims = self.session.document().grid().dims();
        match self.session.execute(command, &()) {
            Ok(_) => {
                let now = self.session.document().grid().dims();
                if now != dims || matches!(command, Command::New(_) | Command::Open { .. }) {
                    self.seen = None;
                    self.ui.hand.reset_pose(now);
                    self.look_from(Side::Corner);
                }
                true
            }
            Err(error) => {
                tracing::warn!("{command}: {error}");
                self.ui.toasts.error(error.to_string());
                false
            }
        }
    }
}

fn next_mode(mode: RenderMode) -> RenderMode {
    let at = RenderMode::ALL.iter().position(|m| *m == mode).unwrap_or(0);
    RenderMode::ALL[(at + 1) % RenderMode::ALL.len()]
}
