//! How commands are carried out: at once or on a thread, with the questions before work is lost, and
//! with what is said when one fails.

use super::job::Then;
use super::questions::{ChangedOnDisk, Next, Unkept};
use super::{Editor, Outcome};
use crate::command::Command;
use crate::document::{Applied, CommandError};
use crate::format;
use crate::format::options::ExportOptions;
use crate::remedy::told;
use crate::session::SessionError;

impl Editor {
    /// Writes the sculpture to its file; asks for a name if it has none of the program's own.
    pub fn save(&mut self, next: Option<Next>) {
        match self.session.path().map(|p| p.to_path_buf()) {
            Some(_) if self.session.is_read_only() => {
                self.note("The file was opened read-only: choose another name");
                self.outcomes.push(Outcome::NameNeeded(next));
            }
            Some(path) if format::is_sculpture(&path) => {
                let then = next.map_or(Then::Stay, Then::Go);
                self.run_then(Command::Save { path, export: ExportOptions::default() }, then);
            }
            _ => self.outcomes.push(Outcome::NameNeeded(next)),
        }
    }

    /// Saves to a file that another program has changed, since the person wants that.
    pub fn overwrite(&mut self, file: ChangedOnDisk) {
        let ChangedOnDisk { path, found, next } = file;
        self.session.accept_change_on_disk(&path, found);
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
        let idle = !self.jobs.is_busy() && !self.stroke_in_question;
        if replaces && self.session.modified() && idle {
            self.outcomes.push(Outcome::Unsaved(Next::Run(command)));
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
        // A step of an undo that takes long is a job of its own.
        let leg = self.session.document().first_leg(&command);
        match self.session.prepare(&leg) {
            Ok(Some(_)) if self.jobs.is_busy() => self.refuse(&command),
            Ok(Some(work)) => {
                let rest = command.after_steps(1).filter(|_| leg != command);
                self.start_job(work, &leg, rest.map_or(then, |rest| Then::Go(Next::Run(rest))));
            }
            Ok(None) => {
                if let Some(applied) = self.carry_out(&leg) {
                    self.continue_steps(&command, applied);
                }
            }
            Err(error) => self.tell(&command, error),
        }
    }

    /// Carries out what the history cannot keep, since the person wants it.
    pub fn run_irreversibly(&mut self, command: Command) {
        if self.jobs.is_busy() {
            return self.refuse(&command);
        }
        self.execute(&Command::Irreversible(true));
        if command == Command::End {
            self.stroke_in_question = false;
            self.execute(&command);
        } else {
            self.run(command);
        }
        if self.jobs.is_busy() {
            // Its result is put in place when the job is done.
            self.jobs.set_irreversible();
        } else {
            self.execute(&Command::Irreversible(false));
        }
    }

    /// Takes back a stroke that cannot be undone and that the person has not chosen to keep.
    pub fn drop_stroke_in_question(&mut self) {
        if self.stroke_in_question {
            self.stroke_in_question = false;
            self.execute(&Command::Cancel);
        }
    }

    /// Carries out a command that takes no time; says what went wrong. True if it was done.
    pub fn execute(&mut self, command: &Command) -> bool {
        let applied = self.carry_out(command);
        if let Some(applied) = applied {
            self.continue_steps(command, applied);
        }
        applied.is_some()
    }

    fn carry_out(&mut self, command: &Command) -> Option<Applied> {
        if self.jobs.is_busy() && !matches!(command, Command::Place(_)) {
            self.refuse(command);
            return None;
        }
        let dims = self.session.document().grid().dims();
        match self.session.execute(command, &()) {
            Ok(applied) => {
                let changed = applied.stats.voxels_changed();
                self.voxels_changed += changed;
                self.note_changes(command, changed);
                if self.session.document().grid().dims() != dims {
                    self.sculpture_replaced();
                }
                self.tell_journal_error();
                Some(applied)
            }
            Err(error) => {
                self.tell(command, error);
                None
            }
        }
    }

    /// Goes on with an undo or redo that has stopped before a step that takes long, or that the history
    /// cannot keep; then the person is asked.
    fn continue_steps(&mut self, command: &Command, applied: Applied) {
        let history = self.session.document().history();
        let there = match command {
            Command::Undo { .. } => history.undo_count(),
            _ => history.redo_count(),
        };
        if let Some(rest) = command.after_steps(applied.steps)
            && applied.steps > 0
            && there > 0
        {
            self.run(rest);
        }
    }

    /// Says why a command was not carried out, or asks whether it is wanted all the same.
    pub(super) fn tell(&mut self, command: &Command, error: SessionError) {
        if let SessionError::Command(CommandError::Irreversible {
            needed_mib, budget_mib, ..
        }) = error
        {
            let why = format!(
                "Undoing it would need {needed_mib} MiB, but memory.history_mib allows {budget_mib} MiB."
            );
            self.stroke_in_question = *command == Command::End;
            let unkept = Unkept { command: command.clone(), why };
            self.outcomes.push(Outcome::Unkept(unkept));
            return;
        }
        let why = told(&error);
        tracing::warn!("{command}: {why}");
        self.error(why);
    }

    /// Says once that the recording has ended, or that the journal or the history cannot be written; the work goes on.
    pub(super) fn tell_journal_error(&mut self) {
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

    /// While long work is under way nothing changes the sculpture.
    fn refuse(&mut self, command: &Command) {
        let verb = command.verb();
        self.note(format!("`{verb}` must wait until the current task has finished"));
    }

    /// Another sculpture is there: the tool begins anew, and so do views of it.
    pub(super) fn sculpture_replaced(&mut self) {
        (self.drawing, self.unfinished) = (None, None);
        self.held_way.clear();
        self.tool.reset_pose(self.session.document().grid().dims());
        self.forget_anchor();
        self.outcomes.push(Outcome::Replaced);
    }
}
