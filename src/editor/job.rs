//! Long work under way: the part of a command that needs no session (an undo that must compute what
//! it leads to among them) runs on a thread of its own,
//! while the window stays alive, shows how far it is and can cancel it.
//!
//! The sculpture stays where it is. A sculpture to be saved is shared with the thread. One that is opened or made is
//! built apart and put in place at the end. Until then the editor refuses to change anything. Work that changes
//! nothing, such as a final picture, runs likewise ([`Editor::start_side_work`]).

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::questions::{ChangedOnDisk, Next};
use super::{Editor, Outcome};
use crate::command::Command;
use crate::document::Applied;
use crate::notice::Notice;
use crate::progress::{Report, Stage};
use crate::remedy::told;
use crate::sculpture::edit::EditStats;
use crate::session::{Done, FileIdentity, Session, SessionError, Work};
use crate::tools::repair::Repair;

/// Work shorter than this goes without a sign, which would only flicker.
const PATIENCE: Duration = Duration::from_millis(150);
/// Between two looks how far it is.
pub const LOOK_EVERY: Duration = Duration::from_millis(30);

/// Long work, as the interface shows it.
#[derive(Clone, PartialEq, Debug)]
pub struct Busy {
    /// Such as "Saving".
    pub what: &'static str,
    pub stage: Stage,
    /// It takes long enough for a sign.
    pub shown: bool,
}

/// The long work of an editor: at most one.
#[derive(Default)]
pub(super) struct Jobs {
    job: Option<Job>,
    /// It may do what cannot be undone.
    irreversible: bool,
}

impl Jobs {
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    pub fn busy(&self) -> Option<Busy> {
        self.job.as_ref().map(Job::busy)
    }

    /// The job under way may do what cannot be undone.
    pub fn set_irreversible(&mut self) {
        self.irreversible = true;
    }
}

/// The result of long work.
#[derive(Debug)]
enum Product {
    /// The result of a command, to be put in place.
    Change(Box<Done>),
    /// Nothing changes; the person is told.
    Note(String),
    /// Another session, to go on with instead, and what the person is told.
    Session(Box<Session>, Notice),
}

/// Why nothing came of work.
#[derive(Debug)]
pub enum Failure {
    Cancelled,
    /// Another program has changed this file, which was not overwritten.
    ChangedOnDisk(PathBuf, Option<FileIdentity>),
    /// Another program has this file open; the reason, for the person.
    InUse(PathBuf, String),
    /// The reason, for the person.
    Error(String),
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Failure {
        match error {
            error if error.is_cancelled() => Failure::Cancelled,
            SessionError::ChangedOnDisk { path, found } => Failure::ChangedOnDisk(path, found),
            SessionError::InUse { ref path, .. } => Failure::InUse(path.clone(), told(&error)),
            error => Failure::Error(told(&error)),
        }
    }
}

/// Work on a thread.
struct Job {
    thread: JoinHandle<Result<Product, Failure>>,
    report: Arc<Report>,
    sign: &'static str,
    started: Instant,
    /// It is waited for when the program is left.
    is_save: bool,
    then: Then,
}

/// The step that follows when the work is done.
#[derive(Clone, PartialEq, Debug)]
pub enum Then {
    Stay,
    /// Do this if it succeeded; ask first if work would be lost.
    Go(Next),
    /// Leave, also if it was cancelled.
    LeaveAnyway,
}

impl Job {
    fn start<W>(work: W, sign: &'static str, is_save: bool, then: Then) -> Job
    where
        W: FnOnce(&Report) -> Result<Product, Failure> + Send + 'static,
    {
        let report = Arc::new(Report::default());
        let told = report.clone();
        Job {
            thread: std::thread::spawn(move || work(&told)),
            report,
            sign,
            started: Instant::now(),
            is_save,
            then,
        }
    }

    fn busy(&self) -> Busy {
        Busy {
            what: self.sign,
            stage: self.report.stage(),
            shown: self.started.elapsed() > PATIENCE,
        }
    }
}

impl Editor {
    /// Whether long work is under way.
    pub fn is_busy(&self) -> bool {
        self.jobs.is_busy()
    }

    /// Starts long work; the last is over.
    pub(super) fn start_job(&mut self, work: Work, command: &Command, then: Then) {
        self.start_work(move |report| work.run(report), command, then);
    }

    /// Runs `work`, the long part of `command`, on a thread; the last is over.
    pub fn start_work<W>(&mut self, work: W, command: &Command, then: Then)
    where
        W: FnOnce(&Report) -> Result<Done, SessionError> + Send + 'static,
    {
        let sign = match command {
            Command::Open { .. } => "Opening",
            Command::Save { .. } => "Saving",
            Command::Orient(_) => "Rotating",
            Command::Repair(Repair::RemoveIslands { .. }) => "Removing islands",
            Command::Repair(Repair::FillCavities { .. }) => "Filling cavities",
            Command::Repair(Repair::Thicken { .. }) => "Thickening walls",
            Command::Repair(Repair::Drain { .. }) => "Drilling holes",
            Command::Undo { .. } => "Undoing",
            Command::Redo { .. } => "Redoing",
            _ => "Creating a new sculpture",
        };
        let is_save = matches!(command, Command::Save { .. });
        let work = move |report: &Report| Ok(Product::Change(Box::new(work(report)?)));
        self.jobs.job = Some(Job::start(work, sign, is_save, then));
    }

    /// Runs work that changes nothing of the sculpture on a thread, and tells what it returns unless it is empty. Refused while there
    /// is other work; returns whether it began.
    pub fn start_side_work<W>(&mut self, work: W, sign: &'static str) -> bool
    where
        W: FnOnce(&Report) -> Result<String, Failure> + Send + 'static,
    {
        if let Some(job) = &self.jobs.job {
            self.error(format!("{sign}: wait until this is done: {}", job.sign));
            return false;
        }
        let work = move |report: &Report| work(report).map(Product::Note);
        self.jobs.job = Some(Job::start(work, sign, false, Then::Stay));
        true
    }

    /// Runs work on a thread that brings back a session, to go on with instead of this one, with a notice. Refused while
    /// there is other work.
    pub fn start_recovery<W>(&mut self, work: W)
    where
        W: FnOnce(&Report) -> Result<(Session, Notice), Failure> + Send + 'static,
    {
        const SIGN: &str = "Recovering";
        if let Some(job) = &self.jobs.job {
            return self.error(format!("{SIGN}: wait until this is done: {}", job.sign));
        }
        let work = move |report: &Report| {
            let (session, notice) = work(report)?;
            Ok(Product::Session(Box::new(session), notice))
        };
        self.jobs.job = Some(Job::start(work, SIGN, false, Then::Stay));
    }

    /// Puts in place what came of long work, once it is done.
    pub fn follow_job(&mut self) {
        if self.jobs.job.as_ref().is_some_and(|job| job.thread.is_finished()) {
            self.finish_job();
        }
    }

    /// Waits for long work, if there is any, and puts in place what came of it.
    pub fn finish_job(&mut self) {
        let Some(job) = self.jobs.job.take() else { return };
        let result = job.thread.join();
        let by_itself = self.autosave.take_under_way();
        if !by_itself {
            self.autosave.begin_anew();
        }
        let done = match result {
            Ok(Ok(Product::Change(done))) => self.complete(*done),
            Ok(Ok(Product::Note(text))) => {
                if !text.is_empty() {
                    self.note(text);
                }
                true
            }
            Ok(Ok(Product::Session(session, notice))) => {
                self.go_on_with(*session);
                self.tell_journal_error();
                self.outcomes.push(Outcome::Notice(notice));
                true
            }
            Ok(Err(Failure::Cancelled)) => {
                self.note(format!("{}: cancelled", job.sign));
                job.then == Then::LeaveAnyway
            }
            Ok(Err(Failure::ChangedOnDisk(path, _))) if by_itself => {
                self.autosave.leave_alone(&path);
                self.error(format!(
                    "Not saved automatically: another program has changed {}; save it yourself to choose what to keep",
                    path.display()
                ));
                false
            }
            Ok(Err(Failure::InUse(path, error))) => {
                tracing::warn!("{error}");
                if by_itself {
                    self.autosave.leave_alone(&path);
                }
                self.error(error);
                false
            }
            Ok(Err(Failure::ChangedOnDisk(path, found))) => {
                tracing::warn!("{}: changed on disk, not overwritten", path.display());
                let next = if let Then::Go(next) = &job.then { Some(next.clone()) } else { None };
                self.outcomes.push(Outcome::ChangedOnDisk(ChangedOnDisk { path, found, next }));
                false
            }
            Ok(Err(Failure::Error(error))) => {
                tracing::warn!("{error}");
                self.error(error);
                false
            }
            Err(_) => {
                // The panic's message is on stderr already.
                self.error(format!("{}: failed because of an internal error", job.sign));
                false
            }
        };
        // From here on nothing is done that cannot be undone, unless someone asks for it again.
        if std::mem::take(&mut self.jobs.irreversible) {
            self.execute(&Command::Irreversible(false));
        }
        match job.then {
            Then::Go(Next::Leave) | Then::LeaveAnyway if done => {
                self.outcomes.push(Outcome::Leave);
            }
            Then::Go(Next::Run(command)) if done => self.run_unless_work_is_lost(command),
            Then::Go(Next::Recover(number)) if done => {
                self.outcomes.push(Outcome::Recover(number));
            }
            _ => {}
        }
    }

    /// Asks long work to stop where it can.
    pub fn cancel_job(&mut self) {
        if let Some(job) = &self.jobs.job {
            job.report.cancel();
        }
    }

    /// The program is to be left while work is under way: a save is waited for, anything else is
    /// given up.
    pub fn leave_after_job(&mut self) {
        let Some(job) = &mut self.jobs.job else { return };
        if job.is_save {
            job.then = Then::Go(Next::Leave);
        } else {
            job.then = Then::LeaveAnyway;
            job.report.cancel();
        }
    }

    /// Replaces the session and discards its journal: the contents are saved or not wanted.
    fn go_on_with(&mut self, mut session: Session) {
        self.drop_stroke_in_question();
        self.session.discard_journal();
        session.continue_recording(&mut self.session);
        let access = self.session.file_access();
        self.session = session;
        self.session.set_file_access(access);
        self.session.keep_meshes();
        self.sculpture_replaced();
    }

    /// Says what has become of a sculpture that was made fit for printing.
    fn tell_mended(&mut self, applied: &Applied) {
        let EditStats { voxels_added, voxels_removed, .. } = applied.stats;
        self.voxels_changed += applied.stats.voxels_changed();
        match (voxels_added, voxels_removed) {
            (0, 0) if self.document().selection().limit().is_some() => {
                self.outcomes.push(Outcome::Limited);
            }
            (0, 0) => self.note("Nothing changed: there is nothing to mend"),
            (added, 0) => self.note(format!("{added} voxels added")),
            (_, removed) => self.note(format!("{removed} voxels removed")),
        }
    }

    /// Puts in place what came of long work. True if that went well.
    fn complete(&mut self, done: Done) -> bool {
        let command = done.command().clone();
        let dims = self.document().grid().dims();
        let applied = match self.session.complete(done) {
            Ok(applied) => applied,
            Err(error) => {
                self.tell(&command, error);
                return false;
            }
        };
        if let Command::Repair(_) = command {
            self.tell_mended(&applied);
            self.tell_journal_error();
            return true;
        }
        self.outcomes.push(Outcome::FileUsed(command.clone()));
        match command {
            Command::Save { path, .. } if crate::format::is_sculpture(&path) => {
                self.note(format!("Saved {}", path.display()));
            }
            Command::Save { path, .. } => self.note(format!("Exported {}", path.display())),
            Command::Undo { .. } | Command::Redo { .. }
                if self.document().grid().dims() == dims => {}
            _ => self.sculpture_replaced(),
        }
        self.session.take_notes().into_iter().for_each(|note| self.note(note));
        self.tell_journal_error();
        true
    }
}
