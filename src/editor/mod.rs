//! The editor: what a person does to the sculpture. Tools, strokes, the marker, long work and the
//! session that carries out commands.
//!
//! [`Editor`] takes actions, pointer positions with a [`Picker`], and commands; it changes the document through its
//! session alone. It returns the further effects of an edit as [`Outcome`]s, which its owner takes after every call
//! ([`Editor::take_outcomes`]). Its parts own the state of each tool: they see what they need of the rest, and return
//! commands; the editor carries these out. Knows no egui, no window, no camera and no Vulkan.
//!
//! This file has the state, the commands and the strokes; what keys and the pointer ask for is in `actions`, what a hand
//! asks for in `hand_events`.

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

use crate::command::Command;
use crate::document::Document;
use crate::format;
use crate::format::options::ExportOptions;
use crate::input::pen::PenTouch;
use crate::notice::Notice;
use crate::picking::Picker;
use crate::progress::Report;
use crate::session::{Done, Session, SessionError};

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

/// The session with everything that a person has in hand.
pub struct Editor {
    commands: CommandRunner,
    pub tool: ToolState,
    /// The tool in a hand in the room of a headset.
    pub hand: HandTool,
    stroke: Option<Stroke>,
    /// Where the tool stands on the surface.
    anchor: SurfaceAnchor,
    marker: MarkerTool,
    /// The solid that is being drawn.
    draw: DrawTool,
    pointer: Pointer,
    /// How a pen or the trigger of a hand is pressed; fully where nothing tells.
    grip: Grip,
    /// The size or the strength of the tool follows the pointer.
    leading: Leading,
}

impl Editor {
    pub fn new(session: Session) -> Editor {
        Editor {
            tool: ToolState::new(session.document().grid().dims()),
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

    /// Returns the outcomes of the calls since the last time, in order.
    pub fn take_outcomes(&mut self) -> Vec<Outcome> {
        self.commands.take_outcomes()
    }

    /// Returns where the pointer is, in pixels of the picture.
    pub fn pointer(&self) -> Option<Vec2> {
        self.pointer.at
    }

    /// Takes where the pointer is.
    pub fn set_pointer(&mut self, at: Option<Vec2>) {
        self.pointer.at = at;
    }

    /// Voxels that commands have changed since the start, for what makes changes felt.
    pub fn voxels_changed(&self) -> u64 {
        self.commands.voxels_changed()
    }

    fn note(&mut self, text: impl Into<String>) {
        self.commands.note(text);
    }

    /// What the tools see.
    fn view(&self) -> ToolView<'_> {
        ToolView { document: self.commands.document(), tool: &self.tool, anchor: &self.anchor }
    }

    /// Returns the point of the grid under a pixel: on the surface that is seen, or while the grid is empty in the
    /// plane of the view in which the tool was used last.
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

    /// Saves to a file that another program has changed, since the person wants that.
    pub fn overwrite(&mut self, file: ChangedOnDisk) {
        let ChangedOnDisk { path, found, next } = file;
        self.session_mut().accept_change_on_disk(&path, found);
        let then = next.map_or(Then::Stay, Then::Go);
        self.run_then(Command::Save { path, export: ExportOptions::default() }, then);
    }

    /// Carries out a command that was asked for, but asks first if it would lose unsaved work.
    pub fn run_unless_work_is_lost(&mut self, command: Command) {
        let replaces = matches!(command, Command::New(_) | Command::Open { .. });
        if replaces {
            self.end_stroke();
        }
        // While there is long work it is refused anyhow.
        let idle = !self.is_busy() && !self.commands.has_stroke_in_question();
        if replaces && self.session().modified() && idle {
            self.commands.push(Outcome::Unsaved(Next::Run(command)));
        } else {
            self.run(command);
        }
    }

    /// Carries out a command that is no part of a stroke; long work runs on another thread.
    pub fn run(&mut self, command: Command) {
        self.run_then(command, Then::Stay);
    }

    /// The same, and then what would lose unsaved work.
    pub fn run_then(&mut self, command: Command, then: Then) {
        self.end_stroke();
        let done = self.commands.run(&command, then);
        self.follow(&command, done);
    }

    /// Carries out a command that takes no time; says what went wrong. True if it was done.
    pub fn execute(&mut self, command: &Command) -> bool {
        let done = self.commands.execute(command);
        self.follow(command, done);
        done
    }

    /// Lets the tools follow a command that was carried out, or was not.
    fn follow(&mut self, command: &Command, done: bool) {
        if done && matches!(command, Command::Begin { .. }) {
            self.commands.note_walls(may_add(&self.tool));
        }
        self.follow_replacement();
    }

    /// Lets the tools begin anew if another sculpture is there.
    fn follow_replacement(&mut self) {
        if self.commands.take_replaced() {
            self.draw = DrawTool::default();
            self.tool.reset_pose(self.commands.document().grid().dims());
            self.anchor.forget(&self.tool);
        }
    }

    /// Carries out what the history cannot keep, since the person wants it.
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
            // Its result is put in place when the job is done.
            self.commands.set_job_irreversible();
        } else {
            self.execute(&Command::Irreversible(false));
        }
    }

    /// Takes back a stroke that cannot be undone and that the person has not chosen to keep.
    pub fn drop_stroke_in_question(&mut self) {
        self.commands.drop_stroke_in_question();
    }

    /// Returns whether long work is under way.
    pub fn is_busy(&self) -> bool {
        self.commands.is_busy()
    }

    /// Long work under way, as the interface shows it.
    pub fn busy(&self) -> Option<Busy> {
        self.commands.busy()
    }

    /// Runs `work`, the long part of `command`, on a thread; the last is over.
    pub fn start_work<W>(&mut self, work: W, command: &Command, then: Then)
    where
        W: FnOnce(&Report) -> Result<Done, SessionError> + Send + 'static,
    {
        self.commands.start_work(work, command, then);
    }

    /// Runs work that changes nothing of the sculpture on a thread, and tells what it returns unless it is empty. Refused
    /// while there is other work; returns whether it began.
    pub fn start_side_work<W>(&mut self, work: W, sign: &'static str) -> bool
    where
        W: FnOnce(&Report) -> Result<String, Failure> + Send + 'static,
    {
        self.commands.start_side_work(work, sign)
    }

    /// Runs work on a thread that brings back a session, to go on with instead of this one, with a notice. Refused while
    /// there is other work.
    pub fn start_recovery<W>(&mut self, work: W)
    where
        W: FnOnce(&Report) -> Result<(Session, Notice), Failure> + Send + 'static,
    {
        self.commands.start_recovery(work);
    }

    /// Puts in place what came of long work, once it is done.
    pub fn follow_job(&mut self) {
        if self.commands.is_job_finished() {
            self.finish_job();
        }
    }

    /// Waits for long work, if there is any, and puts in place what came of it.
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

    /// The program is to be left while work is under way: a save is waited for, anything else is
    /// given up.
    pub fn leave_after_job(&mut self) {
        self.commands.leave_after_job();
    }

    /// Writes the sculpture's file if it has had unsaved changes for `every`. Returns when to ask again; none if there is
    /// nothing to save. `every` none: never. `is_free`: no question is open.
    pub fn autosave(
        &mut self,
        every: Option<Duration>,
        now: Instant,
        is_free: bool,
    ) -> Option<Duration> {
        self.commands.autosave(every, now, is_free)
    }

    /// Returns whether voxels are being changed by a stroke that is not finished.
    pub fn is_stroking(&self) -> bool {
        self.stroke.is_some()
    }

    /// Returns the stroke in hand, with what it works on.
    fn stroking(&mut self) -> Stroking<'_> {
        let Editor { stroke, commands, tool, anchor, grip, .. } = self;
        Stroking { stroke, commands, tool, anchor, grip }
    }

    /// Takes how a pen, a finger or the trigger of a hand touches; none for a mouse, which presses fully.
    pub fn set_touch(&mut self, touch: Option<PenTouch>) {
        self.grip.touch(touch);
    }

    /// Does what would be too slow for every event, since a device may speak often. To be called once for each picture.
    pub fn catch_up(&mut self) {
        self.stroking().catch_up();
    }

    /// Uses a brush that goes on for as long as it is held once more where it is, if it has not been used for a while.
    /// Returns after how long to ask again, in seconds. `now_s`: on any clock; `by_hand`: in a headset.
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

    /// Lets the tool that draws see the rest.
    fn draw_with_view<T>(&mut self, act: impl FnOnce(&mut DrawTool, &ToolView) -> T) -> T {
        let Editor { commands, tool, anchor, draw, .. } = self;
        act(draw, &ToolView { document: commands.document(), tool, anchor })
    }

    /// Carries out what was drawn, if anything.
    fn carry_out_drawn(&mut self, drawn: Option<Drawn>) {
        if let Some(drawn) = drawn {
            drawn.carry_out(&mut self.commands, &mut self.tool, self.hand.is_leading());
        }
    }

    /// Gives up what is being drawn, or what the next press was to do; false if there is neither.
    pub fn cancel_drawing(&mut self) -> bool {
        let was_meant = self.tool.next_press.take().is_some();
        // The button that is still pressed does nothing more.
        self.pointer.lifted |= self.draw.is_dragged() | self.draw.is_held();
        let was_drawn = self.draw.cancel(&self.tool);
        was_drawn || was_meant
    }

    /// Returns whether something is being drawn.
    pub fn is_drawing(&self) -> bool {
        self.draw.is_drawing(&self.tool)
    }

    /// Returns how far what is drawn by several presses is, if there is any.
    pub fn progress(&self) -> Option<Progress> {
        self.draw.progress(&self.tool)
    }

    /// Returns the drawing under way, or the one that a press would begin, as lines.
    pub fn sketch(&self, picker: &Picker) -> Option<Sketch> {
        let (in_hand, stroking) = (self.hand.is_leading(), self.is_stroking());
        self.draw.sketch(self.pointer.at, in_hand, stroking, &self.view(), picker)
    }

    /// Returns the plane that a drag keeps the marker in, as lines of a lattice, or the line along which it pulls a
    /// face.
    pub fn marker_guide(&self) -> Vec<[Vec3; 2]> {
        self.marker.guide(self.document())
    }
}
