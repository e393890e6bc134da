//! Executes commands at once or on a thread, asks before work is lost, and reports commands that fail or change
//! nothing.
//!
//! [`CommandRunner`] owns the session and the long work. Takes commands; gives [`Outcome`]s. Knows no tool, no pointer
//! and no picture.

use std::time::{Duration, Instant};

use glam::IVec3;

use super::autosave::{Autosave, Due};
use super::idle::{IdleTool, StrokeTally, Trial, Walls, goes_beyond, is_explained};
use super::job::{Busy, Failure, Jobs, Product, Then};
use super::outcome::Outcome;
use super::questions::{ChangedOnDisk, Next, Unkept};
use crate::command::Command;
use crate::document::{Applied, CommandError, Document};
use crate::format;
use crate::notice::Notice;
use crate::progress::ProgressReport;
use crate::remedy::told;
use crate::sculpture::canvas_frame::Canvas;
use crate::sculpture::edit::EditStats;
use crate::session::{FinishedWork, Session, SessionError, Work};

/// Executes commands on the session that it owns.
pub(super) struct CommandRunner {
    session: Session,
    jobs: Jobs,
    autosave: Autosave,
    /// A stroke has ended that cannot be undone: the person is asked whether to keep it.
    stroke_in_question: bool,
    /// The effect of the present stroke; `None` between strokes.
    tally: Option<StrokeTally>,
    walls: Walls,
    /// Voxels that commands have changed since the start.
    voxels_changed: u64,
    /// The sculpture has been replaced since this was last asked.
    is_replaced: bool,
    /// How far the coordinates of the grid have moved, in voxels.
    shift_vx: IVec3,
    outcomes: Vec<Outcome>,
}

impl CommandRunner {
    pub fn new(session: Session) -> CommandRunner {
        CommandRunner {
            session,
            jobs: Jobs::default(),
            autosave: Autosave::default(),
            stroke_in_question: false,
            tally: None,
            walls: Walls::default(),
            voxels_changed: 0,
            is_replaced: false,
            shift_vx: IVec3::ZERO,
            outcomes: Vec::new(),
        }
    }

    pub fn session(&self) -> &Session {
        &self.session
    }

    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    pub fn document(&self) -> &Document {
        self.session.document()
    }

    /// Returns the outcomes since the last call, in order.
    pub fn take_outcomes(&mut self) -> Vec<Outcome> {
        std::mem::take(&mut self.outcomes)
    }

    /// Returns the number of voxels that commands have changed since the start.
    pub fn voxels_changed(&self) -> u64 {
        self.voxels_changed
    }

    /// Returns whether the sculpture has been replaced since the last call.
    pub fn take_replaced(&mut self) -> bool {
        std::mem::take(&mut self.is_replaced)
    }

    /// Adds an outcome.
    pub fn push(&mut self, outcome: Outcome) {
        self.outcomes.push(outcome);
    }

    pub fn note(&mut self, text: impl Into<String>) {
        self.push(Outcome::Notice(Notice::note(text)));
    }

    fn error(&mut self, text: impl Into<String>) {
        self.push(Outcome::Notice(Notice::error(text)));
    }

    /// Returns whether there is an open question about a stroke that cannot be undone.
    pub fn has_stroke_in_question(&self) -> bool {
        self.stroke_in_question
    }

    /// Executes a command that takes no time, and reports an error. Returns true if it was done.
    pub fn execute(&mut self, command: &Command) -> bool {
        let applied = self.carry_out(command);
        if let Some(applied) = applied {
            self.continue_steps(command, applied);
        }
        applied.is_some()
    }

    /// Executes a command outside of strokes. Long work runs on another thread, and `then` follows it. Returns true if
    /// it was done at once.
    pub fn run(&mut self, command: &Command, then: Then) -> bool {
        // A long step of an undo is a job of its own.
        let step = self.session.document().first_step(command);
        match self.session.prepare(&step) {
            Ok(Some(_)) if self.jobs.is_busy() => self.refuse(command),
            Ok(Some(work)) => {
                let rest = command.after_steps(1).filter(|_| step != *command);
                self.start_job(work, &step, rest.map_or(then, |rest| Then::Go(Next::Run(rest))));
            }
            Ok(None) => {
                let applied = self.carry_out(&step);
                if let Some(applied) = applied {
                    self.continue_steps(command, applied);
                }
                return applied.is_some();
            }
            Err(error) => self.tell(command, error),
        }
        false
    }

    /// Executes commands as one step of the history, or none of them. `adds`: they may add voxels at the walls.
    pub fn execute_as_one(&mut self, label: &str, adds: bool, commands: &[Command]) -> bool {
        if !self.open_step(label.into(), adds) {
            return false;
        }
        let all = commands.iter().all(|command| self.execute(command));
        self.execute(if all { &Command::End } else { &Command::Cancel }) && all
    }

    fn open_step(&mut self, label: String, adds: bool) -> bool {
        let is_open = self.execute(&Command::Begin { label });
        if is_open {
            self.note_walls(adds);
        }
        is_open
    }

    /// Opens the step of a stroke and counts its effect from here on. Returns true if it is open. `adds`: it may add
    /// voxels at the walls.
    pub fn begin_stroke(&mut self, label: String, adds: bool) -> bool {
        let is_open = self.open_step(label, adds);
        if is_open {
            self.tally = Some(StrokeTally::default());
        }
        is_open
    }

    /// Closes the step of the stroke. Returns its effect if it succeeds.
    pub fn end_stroke(&mut self) -> Option<StrokeTally> {
        let tally = self.tally.take();
        tally.filter(|_| self.execute(&Command::End))
    }

    /// Reverts the stroke.
    pub fn cancel_stroke(&mut self) {
        self.tally = None;
        self.execute(&Command::Cancel);
    }

    /// Reverts a stroke that cannot be undone and that the person has not chosen to keep.
    pub fn drop_stroke_in_question(&mut self) {
        if std::mem::take(&mut self.stroke_in_question) {
            self.execute(&Command::Cancel);
        }
    }

    /// Keeps a stroke that cannot be undone.
    pub fn keep_stroke_in_question(&mut self) {
        self.stroke_in_question = false;
        self.execute(&Command::End);
    }

    fn carry_out(&mut self, command: &Command) -> Option<Applied> {
        if self.jobs.is_busy() && !matches!(command, Command::Place(_)) {
            self.refuse(command);
            return None;
        }
        let before = self.document().contents().canvas();
        // Tools name places in the grid.
        match self.session.execute(&command.translated(before.frame.origin), &()) {
            Ok(applied) => {
                let changed = applied.stats.voxels_changed();
                self.voxels_changed += changed;
                self.note_changes(command, changed);
                self.follow_canvas(&before);
                self.tell_journal_error();
                Some(applied)
            }
            Err(error) => {
                self.tell(command, error);
                None
            }
        }
    }

    /// Continues an undo or redo that has stopped before a long step, or before one that the history cannot keep; in
    /// that case asks the person.
    fn continue_steps(&mut self, command: &Command, applied: Applied) {
        let history = self.document().history();
        let there = match command {
            Command::Undo { .. } => history.undo_count(),
            _ => history.redo_count(),
        };
        if let Some(rest) = command.after_steps(applied.steps)
            && applied.steps > 0
            && there > 0
        {
            self.run(&rest, Then::Stay);
        }
    }

    /// Counts the changes of a command: within a stroke for its end, else explains why there are none.
    fn note_changes(&mut self, command: &Command, changed: u64) {
        if let Command::Begin { .. } = command {
            return;
        }
        if let Some(tally) = &mut self.tally {
            return tally.count(command, changed, self.session.document());
        }
        if self.document().stroke_open() {
            return;
        }
        match changed {
            0 if is_explained(command) => {
                self.explain_idle(std::slice::from_ref(command), IdleTool::default());
            }
            0 => {}
            _ if matches!(command, Command::Paste { .. }) => {
                self.note_cut_off(goes_beyond(self.document(), command));
            }
            _ => {}
        }
    }

    /// Explains why commands have changed nothing.
    pub fn explain_idle(&mut self, tried: &[Command], tool: IdleTool) {
        let why = Trial::new(self.session.document_mut(), tool).explain(tried);
        self.outcomes.extend(why);
    }

    /// Begins a step at whose end voxels at the walls are noticed. `adds`: it may add some there.
    pub fn note_walls(&mut self, adds: bool) {
        self.walls.begin(adds, self.session.document().grid());
    }

    /// Reports that the walls have cut off added voxels, once until a tool is used within the grid again. `beyond`: it
    /// is known to have reached beyond the walls.
    pub fn note_cut_off(&mut self, beyond: bool) {
        if self.walls.is_cut_off_anew(beyond, self.session.document().grid()) {
            self.note("The grid ends there: everything outside it was left out");
        }
    }

    /// Reports why a command failed, or asks whether to do it anyway.
    fn tell(&mut self, command: &Command, error: SessionError) {
        if let SessionError::Command(CommandError::Irreversible {
            needed_mib, budget_mib, ..
        }) = error
        {
            let why = format!(
                "Undoing it would need {needed_mib} MiB, but memory.history_mib allows {budget_mib} MiB."
            );
            self.stroke_in_question = *command == Command::End;
            let unkept = Unkept { command: command.clone(), why };
            self.push(Outcome::Unkept(unkept));
            return;
        }
        let why = told(&error);
        tracing::warn!("{command}: {why}");
        self.error(why);
    }

    /// Reports once that the recording has ended, or that the journal or the history cannot be written. The work
    /// continues.
    fn tell_journal_error(&mut self) {
        if let Some(error) = self.session.take_journal_error() {
            self.error(format!("{error}; the recording ends here, but your work goes on"));
        }
        self.session.attend_journal();
        let messages = [self.session.take_journal_message(), self.session.take_history_message()];
        for message in messages.into_iter().flatten() {
            tracing::warn!("{message}");
            self.note(message);
        }
    }

    /// Refuses a command during long work, when nothing may change the sculpture.
    pub fn refuse(&mut self, command: &Command) {
        let verb = command.verb();
        self.note(format!("`{verb}` must wait until the current task has finished"));
    }

    /// Notes whether the sculpture has been replaced by one of another size, or has another box.
    fn follow_canvas(&mut self, before: &Canvas) {
        let after = self.document().contents().canvas();
        if after.frame.home != before.frame.home {
            self.replaced();
        } else {
            self.shift_vx += before.frame.origin - after.frame.origin;
        }
    }

    /// Returns how far the coordinates of the grid have moved since the last call, in voxels.
    pub fn take_shift(&mut self) -> IVec3 {
        std::mem::take(&mut self.shift_vx)
    }

    /// Notes that the sculpture has been replaced.
    fn replaced(&mut self) {
        (self.is_replaced, self.shift_vx) = (true, IVec3::ZERO);
        self.push(Outcome::Replaced);
    }

    /// Returns whether there is long work.
    pub fn is_busy(&self) -> bool {
        self.jobs.is_busy()
    }

    /// Returns the long work as the interface shows it.
    pub fn busy(&self) -> Option<Busy> {
        self.jobs.busy()
    }

    /// Lets the present job do what cannot be undone.
    pub fn set_job_irreversible(&mut self) {
        self.jobs.set_irreversible();
    }

    /// Starts long work. The former one must be over.
    fn start_job(&mut self, work: Work, command: &Command, then: Then) {
        self.start_work(move |report| work.run(report), command, then);
    }

    /// Runs `work`, the long part of `command`, on a thread. The former work must be over.
    pub fn start_work<W>(&mut self, work: W, command: &Command, then: Then)
    where
        W: FnOnce(&ProgressReport) -> Result<FinishedWork, SessionError> + Send + 'static,
    {
        self.jobs.start_work(work, command, then);
    }

    /// Runs work on a thread that does not change the sculpture, and reports its result unless it is empty. Refused
    /// during other work. Returns whether it began.
    pub fn start_side_work<W>(&mut self, work: W, sign: &'static str) -> bool
    where
        W: FnOnce(&ProgressReport) -> Result<String, Failure> + Send + 'static,
    {
        let begun = self.jobs.start_side_work(work, sign);
        begun.map_err(|why| self.error(why)).is_ok()
    }

    /// Runs work on a thread that restores a session to replace this one, with a notice. Refused during other work.
    pub fn start_recovery<W>(&mut self, work: W)
    where
        W: FnOnce(&ProgressReport) -> Result<(Session, Notice), Failure> + Send + 'static,
    {
        if let Err(why) = self.jobs.start_recovery(work) {
            self.error(why);
        }
    }

    /// Asks long work to stop where it can.
    pub fn cancel_job(&mut self) {
        self.jobs.cancel();
    }

    /// Leaves the program after long work: waits for a save, and cancels anything else.
    pub fn leave_after_job(&mut self) {
        self.jobs.leave_afterwards();
    }

    /// Returns whether long work has ended, so that its result can be applied.
    pub fn is_job_finished(&self) -> bool {
        self.jobs.is_finished()
    }

    /// Waits for long work, if there is any, and applies its result. Returns the command to follow.
    pub fn finish_job(&mut self) -> Option<Command> {
        let job = self.jobs.finish()?;
        let by_itself = self.autosave.take_under_way();
        if !by_itself {
            self.autosave.begin_anew();
        }
        let done = match job.result {
            Some(Ok(product)) => self.put_in_place(product),
            Some(Err(Failure::Cancelled)) => {
                self.note(format!("{}: cancelled", job.sign));
                job.then == Then::LeaveAnyway
            }
            Some(Err(failure)) => {
                self.tell_failure(failure, by_itself, &job.then);
                false
            }
            None => {
                // The panic's message is on stderr already.
                self.error(format!("{}: failed because of an internal error", job.sign));
                false
            }
        };
        // From here on an irreversible step needs another request.
        if self.jobs.take_irreversible() {
            self.execute(&Command::Irreversible(false));
        }
        match job.then {
            Then::Go(Next::Leave) | Then::LeaveAnyway if done => self.push(Outcome::Leave),
            Then::Go(Next::Run(command)) if done => return Some(command),
            Then::Go(Next::Recover(number)) if done => self.push(Outcome::Recover(number)),
            _ => {}
        }
        None
    }

    /// Reports the failure of long work. `by_itself`: it was an autosave; `then`: the step that was to follow.
    fn tell_failure(&mut self, failure: Failure, by_itself: bool, then: &Then) {
        match failure {
            Failure::Cancelled => {}
            Failure::ChangedOnDisk(path, _) if by_itself => {
                self.autosave.leave_alone(&path);
                self.error(format!(
                    "Not saved automatically: another program has changed {}; save it yourself to choose what to keep",
                    path.display()
                ));
            }
            Failure::InUse(path, error) => {
                tracing::warn!("{error}");
                if by_itself {
                    self.autosave.leave_alone(&path);
                }
                self.error(error);
            }
            Failure::ChangedOnDisk(path, found) => {
                tracing::warn!("{}: changed on disk, not overwritten", path.display());
                let next = if let Then::Go(next) = then { Some(next.clone()) } else { None };
                self.push(Outcome::ChangedOnDisk(ChangedOnDisk { path, found, next }));
            }
            Failure::Error(error) => {
                tracing::warn!("{error}");
                self.error(error);
            }
        }
    }

    /// Applies the result of long work. Returns true if that succeeded.
    fn put_in_place(&mut self, product: Product) -> bool {
        match product {
            Product::Change(done) => return self.complete(*done),
            Product::Note(text) => {
                if !text.is_empty() {
                    self.note(text);
                }
            }
            Product::Session(session, notice) => {
                self.go_on_with(*session);
                self.tell_journal_error();
                self.push(Outcome::Notice(notice));
            }
        }
        true
    }

    /// Applies the result of the long part of a command. Returns true if that succeeded.
    fn complete(&mut self, done: FinishedWork) -> bool {
        let command = done.command().clone();
        let before = self.document().contents().canvas();
        let applied = match self.session.complete(done) {
            Ok(applied) => applied,
            Err(error) => {
                self.tell(&command, error);
                return false;
            }
        };
        if let Command::Repair(_) = command {
            self.report_repairs(&applied);
            self.tell_journal_error();
            return true;
        }
        self.push(Outcome::FileUsed(command.clone()));
        match command {
            Command::Save { path, .. } if format::is_sculpture(&path) => {
                self.note(format!("Saved {}", path.display()));
            }
            Command::Save { path, .. } => self.note(format!("Exported {}", path.display())),
            Command::Undo { .. } | Command::Redo { .. } => self.follow_canvas(&before),
            _ => self.replaced(),
        }
        self.session.take_notes().into_iter().for_each(|note| self.note(note));
        self.tell_journal_error();
        true
    }

    /// Replaces the session and discards its journal: the contents are saved or unwanted.
    fn go_on_with(&mut self, mut session: Session) {
        self.drop_stroke_in_question();
        self.session.discard_journal();
        session.continue_recording(&mut self.session);
        let access = self.session.file_access();
        self.session = session;
        self.session.set_file_access(access);
        self.session.keep_meshes();
        self.replaced();
    }

    /// Reports the repairs that made a sculpture printable.
    fn report_repairs(&mut self, applied: &Applied) {
        let EditStats { voxels_added, voxels_removed, .. } = applied.stats;
        self.voxels_changed += applied.stats.voxels_changed();
        match (voxels_added, voxels_removed) {
            (0, 0) if self.document().selection().limit().is_some() => self.push(Outcome::Limited),
            (0, 0) => self.note("Nothing changed: there is nothing to mend"),
            (added, 0) => self.note(format!("{added} voxels added")),
            (_, removed) => self.note(format!("{removed} voxels removed")),
        }
    }

    /// Writes the sculpture's file if it has had unsaved changes for `every` (`None`: never). Returns when to ask
    /// again; `None` if there is nothing to save. `is_free`: no question is open.
    pub fn autosave(
        &mut self,
        every: Option<Duration>,
        now: Instant,
        is_free: bool,
    ) -> Option<Duration> {
        let in_stroke = self.tally.is_some() || self.document().stroke_open();
        let is_free = is_free && !in_stroke && !self.stroke_in_question && !self.is_busy();
        let save = match self.autosave.due(&self.session, every, now, is_free) {
            Due::Never => return None,
            Due::After(left) => return Some(left),
            Due::Now(save) => save,
        };
        match self.session.prepare(&save) {
            Ok(Some(work)) => {
                self.autosave.set_under_way();
                self.start_job(work, &save, Then::Stay);
            }
            Ok(None) => {}
            Err(error) => self.tell(&save, error),
        }
        every
    }
}
