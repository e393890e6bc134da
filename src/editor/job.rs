//! Long work: the part of a command that needs no session (or an undo that must compute its result) runs on a thread of
//! its own. Meanwhile the window stays alive, shows the progress and can cancel it.
//!
//! The sculpture stays in place. A sculpture being saved is shared with the thread. One that is opened or made is built
//! apart and put in place at the end. Until then the editor refuses changes. Work that changes nothing, such as a final
//! picture, runs likewise ([`Jobs::start_side_work`]). Takes work and gives its result; puts nothing in place.

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::questions::Next;
use crate::command::Command;
use crate::notice::Notice;
use crate::progress::{ProgressReport, Stage};
use crate::remedy::told;
use crate::session::{FileIdentity, FinishedWork, Session, SessionError};
use crate::tools::repair::Repair;

/// Shorter work has no sign, which would only flicker.
const PATIENCE: Duration = Duration::from_millis(150);
/// Time between two looks at the progress.
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

/// The result of long work.
#[derive(Debug)]
pub(super) enum Product {
    /// The result of a command, to be applied.
    Change(Box<FinishedWork>),
    /// Nothing changes, but the person is told.
    Note(String),
    /// Another session to replace the present one, and a message to the person.
    Session(Box<Session>, Notice),
}

/// The failure of work.
#[derive(Debug)]
pub enum Failure {
    Cancelled,
    /// Another program has changed this file, which was not overwritten.
    ChangedOnDisk(PathBuf, Option<FileIdentity>),
    /// Another program has this file open; the reason, for the person.
    InUse(PathBuf, String),
    /// A reason for the person.
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
struct RunningJob {
    thread: JoinHandle<Result<Product, Failure>>,
    report: Arc<ProgressReport>,
    sign: &'static str,
    started: Instant,
    /// Leaving the program waits for it.
    is_save: bool,
    then: Then,
}

/// The step after the work.
#[derive(Clone, PartialEq, Debug)]
pub enum Then {
    Stay,
    /// Do this if it succeeded, after asking if work would be lost.
    Go(Next),
    /// Leave even if it was cancelled.
    LeaveAnyway,
}

impl RunningJob {
    fn start<W>(work: W, sign: &'static str, is_save: bool, then: Then) -> RunningJob
    where
        W: FnOnce(&ProgressReport) -> Result<Product, Failure> + Send + 'static,
    {
        let report = Arc::new(ProgressReport::default());
        let told = report.clone();
        RunningJob {
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

/// Long work that has ended.
pub(super) struct Ended {
    /// `None` if it failed because of an internal error.
    pub result: Option<Result<Product, Failure>>,
    /// Such as "Saving".
    pub sign: &'static str,
    pub then: Then,
}

/// The long work of an editor: at most one job.
#[derive(Default)]
pub(super) struct Jobs {
    job: Option<RunningJob>,
    /// It may do what cannot be undone.
    irreversible: bool,
}

impl Jobs {
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    pub fn busy(&self) -> Option<Busy> {
        self.job.as_ref().map(RunningJob::busy)
    }

    /// Lets the present job do what cannot be undone.
    pub fn set_irreversible(&mut self) {
        self.irreversible = true;
    }

    /// Returns whether the job that has just ended might do what cannot be undone.
    pub fn take_irreversible(&mut self) -> bool {
        std::mem::take(&mut self.irreversible)
    }

    /// Runs `work`, the long part of `command`, on a thread. The former work must be over.
    pub fn start_work<W>(&mut self, work: W, command: &Command, then: Then)
    where
        W: FnOnce(&ProgressReport) -> Result<FinishedWork, SessionError> + Send + 'static,
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
        let work = move |report: &ProgressReport| Ok(Product::Change(Box::new(work(report)?)));
        self.job = Some(RunningJob::start(work, sign, is_save, then));
    }

    /// Runs work on a thread that does not change the sculpture. Refused during other work, with the reason for the
    /// person.
    pub fn start_side_work<W>(&mut self, work: W, sign: &'static str) -> Result<(), String>
    where
        W: FnOnce(&ProgressReport) -> Result<String, Failure> + Send + 'static,
    {
        self.require_idle(sign)?;
        let work = move |report: &ProgressReport| work(report).map(Product::Note);
        self.job = Some(RunningJob::start(work, sign, false, Then::Stay));
        Ok(())
    }

    /// Runs work on a thread that restores a session, with a notice. Refused during other work, with the reason for the
    /// person.
    pub fn start_recovery<W>(&mut self, work: W) -> Result<(), String>
    where
        W: FnOnce(&ProgressReport) -> Result<(Session, Notice), Failure> + Send + 'static,
    {
        const SIGN: &str = "Recovering";
        self.require_idle(SIGN)?;
        let work = move |report: &ProgressReport| {
            let (session, notice) = work(report)?;
            Ok(Product::Session(Box::new(session), notice))
        };
        self.job = Some(RunningJob::start(work, SIGN, false, Then::Stay));
        Ok(())
    }

    fn require_idle(&self, sign: &str) -> Result<(), String> {
        match &self.job {
            Some(job) => Err(format!("{sign}: wait until this is done: {}", job.sign)),
            None => Ok(()),
        }
    }

    /// Returns whether work has ended, so that its result can be applied.
    pub fn is_finished(&self) -> bool {
        self.job.as_ref().is_some_and(|job| job.thread.is_finished())
    }

    /// Waits for long work, if there is any, and returns its outcome.
    pub fn finish(&mut self) -> Option<Ended> {
        let RunningJob { thread, sign, then, .. } = self.job.take()?;
        Some(Ended { result: thread.join().ok(), sign, then })
    }

    /// Asks long work to stop where it can.
    pub fn cancel(&self) {
        if let Some(job) = &self.job {
            job.report.cancel();
        }
    }

    /// Leaves the program after long work: waits for a save, and cancels anything else.
    pub fn leave_afterwards(&mut self) {
        let Some(job) = &mut self.job else { return };
        if job.is_save {
            job.then = Then::Go(Next::Leave);
        } else {
            job.then = Then::LeaveAnyway;
            job.report.cancel();
        }
    }
}
