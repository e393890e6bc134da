//! The editor: the person's work on the sculpture. Tools, strokes, the marker, long work and the session that executes
//! commands.
//!
//! [`Editor`] takes actions, pointer positions with a [`Picker`], and commands; it changes the document only through
//! its session. It returns the further effects of an edit as [`Outcome`]s, which its owner takes after every call
//! ([`Editor::take_outcomes`]). Its parts own the state of each tool: they see what they need of the rest, and return
//! commands for the editor to execute. Knows no egui, no window, no camera and no Vulkan.
//!
//! This file has the state, the commands and the strokes; `actions` handles keys and the pointer, `hand_events` a hand.

mod actions;
mod autosave;
pub mod brushes;
mod commands;
pub mod draw;
pub mod hand;
mod hand_events;
mod idle;
pub mod job;
mod lead;
mod marker;
mod outcome;
pub mod pen_use;
mod pointer;
mod pressure;
pub mod questions;
pub mod recovery;
pub mod sizes;
pub mod stroke;
mod surface_anchor;
mod surface_guide;
pub mod symmetry;
pub mod tool;
pub mod tool_change;
mod tool_view;
pub mod wand;

use std::time::{Duration, Instant};

use glam::{Vec2, Vec3};

use crate::command::{Command, CommandClass};
use crate::document::Document;
use crate::format;
use crate::format::options::ExportOptions;
use crate::input::pen::PenTouch;
use crate::notice::Notice;
use crate::picking::Picker;
use crate::progress::ProgressReport;
use crate::session::{FinishedWork, Session, SessionError};

use commands::CommandRunner;
use draw::{DrawTool, Drawn, Progress, Sketch};
use hand::HandTool;
use idle::may_add;
use job::{Busy, Failure, Then};
use lead::Leading;
use marker::MarkerTool;
use pointer::Pointer;
use pressure::Grip;
use questions::{ChangedOnDisk, Next};
use stroke::{Stroke, Stroking};
use surface_anchor::SurfaceAnchor;
use tool::ToolState;
use tool_view::ToolView;

pub use outcome::Outcome;
pub use pointer::PointerUse;

/// The session with all tools.
pub struct Editor {
    commands: CommandRunner,
    pub tool: ToolState,
    /// The tool in a hand in the room of a headset.
    pub hand: HandTool,
    stroke: Option<Stroke>,
    /// The tool's anchor on the surface.
    anchor: SurfaceAnchor,
    marker: MarkerTool,
    /// The drawing in progress.
    draw: DrawTool,
    pointer: Pointer,
    /// The pressure of a pen or of a hand's trigger; full if nothing reports one.
    grip: Grip,
    /// The size or the strength of the tool follows the pointer.
    leading: Leading,
}

impl Editor {
    pub fn new(session: Session) -> Editor {
        Editor {
            tool: ToolState::new(&session.document().contents().frame),
            commands: CommandRunner::new(session),
            hand: HandTool::default(),
            stroke: None,
            anchor: SurfaceAnchor::default(),
            marker: MarkerTool::default(),
            draw: DrawTool::default(),
            pointer: Pointer::default(),
            grip: Grip::default(),
            leading: Leading::default(),
        }
    }

    pub fn session(&self) -> &Session {
        self.commands.session()
    }

    pub fn session_mut(&mut self) -> &mut Session {
        self.commands.session_mut()
    }

    pub fn document(&self) -> &Document {
        self.commands.document()
    }

    /// Returns the outcomes since the last call, in order.
    pub fn take_outcomes(&mut self) -> Vec<Outcome> {
        self.commands.take_outcomes()
    }

    /// Returns the position of the pointer, in pixels of the picture.
    pub fn pointer(&self) -> Option<Vec2> {
        self.pointer.at
    }

    /// Sets the position of the pointer.
    pub fn set_pointer(&mut self, at: Option<Vec2>) {
        self.pointer.at = at;
    }

    /// Returns the number of voxels that commands have changed since the start, for haptics.
    pub fn voxels_changed(&self) -> u64 {
        self.commands.voxels_changed()
    }

    fn note(&mut self, text: impl Into<String>) {
        self.commands.note(text);
    }

    /// Returns the part of the editor that the tools see.
    fn view(&self) -> ToolView<'_> {
        ToolView { document: self.commands.document(), tool: &self.tool, anchor: &self.anchor }
    }

    /// Returns the grid point under a pixel: on the visible surface, or, while the grid is empty, in the view plane
    /// through the last use of the tool.
    pub fn target(&self, at: Vec2, picker: &Picker) -> Option<Vec3> {
        self.view().target(at, picker)
    }

    /// Writes the sculpture to its file; asks for a name if it has none of the program's own.
    pub fn save(&mut self, next: Option<Next>) {
        match self.session().path().map(|p| p.to_path_buf()) {
            Some(_) if self.session().is_read_only() => {
                self.note("The file was opened read-only: choose another name");
                self.commands.push(Outcome::NameNeeded(next));
            }
            Some(path) if format::is_sculpture(&path) => {
                let then = next.map_or(Then::Stay, Then::Go);
                self.run_then(Command::Save { path, export: ExportOptions::default() }, then);
            }
            _ => self.commands.push(Outcome::NameNeeded(next)),
        }
    }

    /// Saves to a file that another program has changed, at the person's request.
    pub fn overwrite(&mut self, file: ChangedOnDisk) {
        let ChangedOnDisk { path, found, next } = file;
        self.session_mut().accept_change_on_disk(&path, found);
        let then = next.map_or(Then::Stay, Then::Go);
        self.run_then(Command::Save { path, export: ExportOptions::default() }, then);
    }

    /// Executes a requested command, but asks first if it would lose unsaved work.
    pub fn run_unless_work_is_lost(&mut self, command: Command) {
        let replaces = command.class() == CommandClass::Replace;
        if replaces {
            self.end_stroke();
        }
        // During long work it is refused anyway.
        let idle = !self.is_busy() && !self.commands.has_stroke_in_question();
        if replaces && self.session().modified() && idle {
            self.commands.push(Outcome::Unsaved(Next::Run(command)));
        } else {
            self.run(command);
        }
    }

    /// Executes a command outside of strokes. Long work runs on another thread.
    pub fn run(&mut self, command: Command) {
        self.run_then(command, Then::Stay);
    }

    /// Executes such a command, and then a step that would lose unsaved work.
    pub fn run_then(&mut self, command: Command, then: Then) {
        self.end_stroke();
        let done = self.commands.run(&command, then);
        self.follow(&command, done);
    }

    /// Executes a command that takes no time, and reports an error. Returns true if it was done.
    pub fn execute(&mut self, command: &Command) -> bool {
        let done = self.commands.execute(command);
        self.follow(command, done);
        done
    }

    /// Updates the tools after a command that succeeded or failed.
    fn follow(&mut self, command: &Command, done: bool) {
        if done && matches!(command, Command::Begin { .. }) {
            self.commands.note_walls(may_add(&self.tool));
        }
        self.follow_replacement();
    }

    /// Resets the tools if the sculpture has been replaced, and moves them along with the coordinates of its grid.
    fn follow_replacement(&mut self) {
        self.stroking().follow_shift();
        if self.commands.take_replaced() {
            self.draw = DrawTool::default();
            self.tool.reset_pose(&self.commands.document().contents().frame);
            self.anchor.forget(&self.tool);
        }
    }

    /// Executes a command that the history cannot keep, at the person's request.
    pub fn run_irreversibly(&mut self, command: Command) {
        if self.is_busy() {
            return self.commands.refuse(&command);
        }
        self.execute(&Command::Irreversible(true));
        if command == Command::End {
            self.commands.keep_stroke_in_question();
        } else {
            self.run(command);
        }
        if self.is_busy() {
            // Its result is applied when the job is done.
            self.commands.set_job_irreversible();
        } else {
            self.execute(&Command::Irreversible(false));
        }
    }

    /// Reverts a stroke that cannot be undone and that the person has not chosen to keep.
    pub fn drop_stroke_in_question(&mut self) {
        self.commands.drop_stroke_in_question();
    }

    /// Returns whether there is long work.
    pub fn is_busy(&self) -> bool {
        self.commands.is_busy()
    }

    /// Returns the long work as the interface shows it.
    pub fn busy(&self) -> Option<Busy> {
        self.commands.busy()
    }

    /// Runs `work`, the long part of `command`, on a thread. The former work must be over.
    pub fn start_work<W>(&mut self, work: W, command: &Command, then: Then)
    where
        W: FnOnce(&ProgressReport) -> Result<FinishedWork, SessionError> + Send + 'static,
    {
        self.commands.start_work(work, command, then);
    }

    /// Runs work on a thread that does not change the sculpture, and reports its result unless it is empty. Refused
    /// during other work. Returns whether it began.
    pub fn start_side_work<W>(&mut self, work: W, sign: &'static str) -> bool
    where
        W: FnOnce(&ProgressReport) -> Result<String, Failure> + Send + 'static,
    {
        self.commands.start_side_work(work, sign)
    }

    /// Runs work on a thread that restores a session to replace this one, with a notice. Refused during other work.
    pub fn start_recovery<W>(&mut self, work: W)
    where
        W: FnOnce(&ProgressReport) -> Result<(Session, Notice), Failure> + Send + 'static,
    {
        self.commands.start_recovery(work);
    }

    /// Applies the result of long work, once it is done.
    pub fn follow_job(&mut self) {
        if self.commands.is_job_finished() {
            self.finish_job();
        }
    }

    /// Waits for long work, if there is any, and applies its result.
    pub fn finish_job(&mut self) {
        let next = self.commands.finish_job();
        self.follow_replacement();
        if let Some(command) = next {
            self.run_unless_work_is_lost(command);
        }
    }

    /// Asks long work to stop where it can.
    pub fn cancel_job(&mut self) {
        self.commands.cancel_job();
    }

    /// Leaves the program after long work: waits for a save, and cancels anything else.
    pub fn leave_after_job(&mut self) {
        self.commands.leave_after_job();
    }

    /// Writes the sculpture's file if it has had unsaved changes for `every` (`None`: never). Returns when to ask
    /// again; `None` if there is nothing to save. `is_free`: no question is open.
    pub fn autosave(
        &mut self,
        every: Option<Duration>,
        now: Instant,
        is_free: bool,
    ) -> Option<Duration> {
        self.commands.autosave(every, now, is_free)
    }

    /// Returns whether an unfinished stroke changes voxels.
    pub fn is_stroking(&self) -> bool {
        self.stroke.is_some()
    }

    /// Returns the present stroke with the part of the editor that it works on.
    fn stroking(&mut self) -> Stroking<'_> {
        let Editor { stroke, commands, tool, anchor, grip, .. } = self;
        Stroking { stroke, commands, tool, anchor, grip }
    }

    /// Sets the touch of a pen, a finger or a hand's trigger; `None` for a mouse, which presses fully.
    pub fn set_touch(&mut self, touch: Option<PenTouch>) {
        self.grip.touch(touch);
    }

    /// Does the work that is too slow for every event of a frequent device. Called once per picture.
    pub fn catch_up(&mut self) {
        self.stroking().catch_up();
    }

    /// Uses a held brush again where it is, if it repeats and has not been used for a while. Returns the seconds until
    /// the next call. `now_s`: on any clock; `by_hand`: in a headset.
    pub fn dwell(&mut self, now_s: f64, by_hand: bool, picker: &Picker) -> Option<f64> {
        self.stroking().dwell(now_s, by_hand, picker)
    }

    fn end_stroke(&mut self) {
        let in_hand = self.hand.is_leading();
        self.stroking().end(in_hand);
    }

    pub fn cancel_stroke(&mut self) {
        self.stroking().cancel();
    }

    /// Calls the drawing tool with its view of the editor.
    fn draw_with_view<T>(&mut self, act: impl FnOnce(&mut DrawTool, &ToolView) -> T) -> T {
        let Editor { commands, tool, anchor, draw, .. } = self;
        act(draw, &ToolView { document: commands.document(), tool, anchor })
    }

    /// Executes a finished drawing, if there is one.
    fn carry_out_drawn(&mut self, drawn: Option<Drawn>) {
        if let Some(drawn) = drawn {
            drawn.carry_out(&mut self.commands, &mut self.tool, self.hand.is_leading());
        }
    }

    /// Cancels the drawing in progress, or the action of the next press. Returns false if there is neither.
    pub fn cancel_drawing(&mut self) -> bool {
        let was_meant = self.tool.next_press.take().is_some();
        // The button that is still pressed has no further effect.
        self.pointer.lifted |= self.draw.is_dragged() | self.draw.is_held();
        let was_drawn = self.draw.cancel(&self.tool);
        was_drawn || was_meant
    }

    /// Returns whether there is a drawing in progress.
    pub fn is_drawing(&self) -> bool {
        self.draw.is_drawing(&self.tool)
    }

    /// Returns the progress of a drawing of several presses, if there is one.
    pub fn progress(&self) -> Option<Progress> {
        self.draw.progress(&self.tool)
    }

    /// Returns the present drawing, or the one that a press would begin, as lines.
    pub fn sketch(&self, picker: &Picker) -> Option<Sketch> {
        let (in_hand, stroking) = (self.hand.is_leading(), self.is_stroking());
        self.draw.sketch(self.pointer.at, in_hand, stroking, &self.view(), picker)
    }

    /// Returns the guide of a drag of the marker: the plane in which it moves, as lines of a lattice, or the line along
    /// which a face is pulled.
    pub fn marker_guide(&self) -> Vec<[Vec3; 2]> {
        self.marker.guide(self.document())
    }
}
