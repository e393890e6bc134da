//! Owns long work under way: the part of a command that needs no session runs on a thread of its
//! own, while the window stays alive, shows how far it is and can cancel it.
//!
//! The sculpture stays where it is. What is saved is shared with the thread, what is opened or
//! made is made apart and put in place at the end; until then the workspace refuses to change
//! anything.

use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::workspace::Workspace;
use crate::command::Command;
use crate::progress::Report;
use crate::session::{Done, SessionError, Work};
use crate::ui::UiRequest;
use crate::ui::state::{Busy, Next};

/// Work shorter than this goes without a sign, which would only flicker.
const PATIENCE: Duration = Duration::from_millis(150);
/// Between two looks how far it is.
pub(super) const LOOK_EVERY: Duration = Duration::from_millis(30);

/// Work on a thread.
pub struct Job {
    thread: JoinHandle<Result<Done, SessionError>>,
    report: Arc<Report>,
    sign: &'static str,
    started: Instant,
    /// It is waited for when the program is left.
    is_save: bool,
    then: Then,
}

/// What follows when the work is done.
#[derive(Clone, PartialEq, Debug)]
pub enum Then {
    Stay,
    /// Do this if it succeeded; ask first if work would be lost.
    Go(Next),
    /// Leave, also if it was cancelled.
    LeaveAnyway,
}

impl Job {
    /// Starts `work`, the long part of `command`.
    fn start<W>(work: W, command: &Command, then: Then) -> Job
    where
        W: FnOnce(&Report) -> Result<Done, SessionError> + Send + 'static,
    {
        let sign = match command {
            Command::Open { .. } => "Opening",
            Command::Save { .. } => "Saving",
            _ => "Creating a new sculpture",
        };
        let report = Arc::new(Report::default());
        let told = report.clone();
        Job {
            thread: std::thread::spawn(move || work(&told)),
            report,
            sign,
            started: Instant::now(),
            is_save: matches!(command, Command::Save { .. }),
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

impl Workspace {
    /// Starts long work; the last is over.
    pub(super) fn start_job(&mut self, work: Work, command: &Command, then: Then) {
        let job = Job::start(move |report| work.run(report), command, then);
        self.ui.busy = Some(job.busy());
        self.job = Some(job);
    }

    /// Looks how far long work is, and puts in place what came of it once it is done.
    pub(super) fn follow_job(&mut self) {
        match &self.job {
            Some(job) if job.thread.is_finished() => self.finish_job(),
            Some(job) => self.ui.busy = Some(job.busy()),
            None => {}
        }
    }

    /// Waits for long work, if there is any, and puts in place what came of it.
    pub fn finish_job(&mut self) {
        let Some(job) = self.job.take() else { return };
        self.ui.busy = None;
        let result = job.thread.join();
        let done = match result {
            Ok(Ok(done)) => self.complete(done),
            Ok(Err(error)) if error.is_cancelled() => {
                self.ui.toasts.note(format!("{}: cancelled", job.sign));
                job.then == Then::LeaveAnyway
            }
            Ok(Err(error)) => {
                tracing::warn!("{error}");
                self.ui.toasts.error(error.to_string());
                false
            }
            Err(_) => {
                // The panic's message is on stderr already.
                self.ui.toasts.error(format!("{}: failed because of an internal error", job.sign));
                false
            }
        };
        // From here on nothing is done that cannot be undone, unless someone asks for it again.
        if std::mem::take(&mut self.irreversible_job) {
            self.execute(&Command::Irreversible(false));
        }
        match job.then {
            Then::Go(Next::Leave) | Then::LeaveAnyway if done => self.ask_to_leave(),
            Then::Go(Next::Run(command)) if done => self.carry_out(UiRequest::Run(command)),
            _ => {}
        }
    }

    /// Asks long work to stop where it can.
    pub(super) fn cancel_job(&mut self) {
        if let Some(job) = &self.job {
            job.report.cancel();
        }
    }

    /// The program is to be left while work is under way: a save is waited for, anything else is
    /// given up.
    pub(super) fn leave_after_job(&mut self) {
        let Some(job) = &mut self.job else { return };
        if job.is_save {
            job.then = Then::Go(Next::Leave);
        } else {
            job.then = Then::LeaveAnyway;
            job.report.cancel();
        }
    }

    /// Puts in place what came of long work. True if that went well.
    fn complete(&mut self, done: Done) -> bool {
        let command = done.command().clone();
        if let Err(error) = self.session.complete(done) {
            tracing::warn!("{command}: {error}");
            self.ui.toasts.error(error.to_string());
            return false;
        }
        self.note_file(&command);
        match command {
            Command::Save { path, .. } if crate::format::is_sculpture(&path) => {
                self.ui.toasts.note(format!("Saved {}", path.display()));
            }
            Command::Save { path, .. } => {
                self.ui.toasts.note(format!("Exported {}", path.display()));
            }
            _ => self.sculpture_replaced(),
        }
        self.tell_journal_error();
        true
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Sender, channel};

    use super::*;
    use crate::config::Config;
    use crate::input::Bindings;
    use crate::progress::Progress;
    use crate::session::Session;
    use crate::ui::toasts::Tone;

    fn workspace() -> Workspace {
        let mut config = Config::default();
        config.new.dims = [24, 16, 8];
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        Workspace::new(session, &config, Bindings::presets().unwrap())
    }

    /// Starts a command whose work waits for a word before it begins.
    fn start_slowly(workspace: &mut Workspace, command: &str) -> Sender<()> {
        let command: Command = command.parse().unwrap();
        let work = workspace.session.prepare(&command).unwrap().unwrap();
        let (go, wait) = channel();
        let slow = move |report: &Report| {
            report.begin("thinking");
            report.advance(0.25);
            wait.recv().unwrap();
            work.run(report)
        };
        workspace.job = Some(Job::start(slow, &command, Then::Stay));
        while workspace.job.as_ref().unwrap().report.stage().done.is_none() {
            std::thread::yield_now();
        }
        workspace.follow_job();
        go
    }

    fn tones(workspace: &Workspace) -> Vec<Tone> {
        workspace.ui.toasts.texts().map(|(tone, _)| tone).collect()
    }

    #[test]
    fn while_it_runs_it_is_shown_and_nothing_changes() {
        let mut workspace = workspace();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vsc");
        workspace.execute(&"subtract cuboid at=4,4,4 half=2".parse().unwrap());
        let before = workspace.session.document().contents().clone();
        let go = start_slowly(&mut workspace, &format!("save {path:?}"));
        let busy = workspace.ui.busy.clone().unwrap();
        assert_eq!((busy.what, busy.stage.done), ("Saving", Some(0.25)));
        assert_eq!(busy.stage.what, "thinking");
        assert!(workspace.ui.is_modal());
        for refused in ["clear", "undo", "subtract cuboid at=9,9,4 half=3", "begin"] {
            assert!(!workspace.execute(&refused.parse().unwrap()), "{refused}");
        }
        workspace.run("new dims=8,8,8".parse().unwrap());
        assert!(workspace.execute(&"place scale=2".parse().unwrap()), "the view may move");
        assert_eq!(*workspace.session.document().contents(), before);
        assert!(workspace.session.modified());
        go.send(()).unwrap();
        workspace.finish_job();
        assert!(workspace.ui.busy.is_none() && !workspace.session.modified());
        let saved = crate::format::load(&path, &Default::default(), &Default::default(), &());
        assert_eq!(saved.unwrap().contents.grid, before.grid);
        assert!(workspace.execute(&"clear".parse().unwrap()), "work goes on");
    }

    #[test]
    fn what_is_cancelled_leaves_file_and_sculpture_as_they_were() {
        let mut workspace = workspace();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvm");
        for line in [format!("save {path:?}"), format!("open {path:?}")] {
            if line.starts_with("open") {
                workspace.session.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
            }
            workspace.execute(&"subtract cuboid at=4,4,4 half=2".parse().unwrap());
            let (before, there) = (workspace.session.document().revision(), path.exists());
            let go = start_slowly(&mut workspace, &line);
            workspace.cancel_job();
            go.send(()).unwrap();
            workspace.finish_job();
            assert_eq!(workspace.session.document().revision(), before, "{line}");
            assert_eq!(path.exists(), there, "{line}");
            assert_eq!(tones(&workspace).last(), Some(&Tone::Note));
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), usize::from(there));
        }
    }

    #[test]
    fn leaving_waits_for_a_save_and_gives_up_an_opening() {
        let mut workspace = workspace();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vsc");
        workspace.execute(&"clear".parse().unwrap());
        let go = start_slowly(&mut workspace, &format!("save {path:?}"));
        workspace.ask_to_leave();
        workspace.follow_job();
        assert!(!workspace.is_leaving() && workspace.job.is_some());
        go.send(()).unwrap();
        workspace.finish_job();
        assert!(workspace.is_leaving() && path.exists());

        let mut workspace = self::workspace();
        let go = start_slowly(&mut workspace, &format!("open {path:?}"));
        workspace.ask_to_leave();
        go.send(()).unwrap();
        workspace.finish_job();
        assert!(workspace.is_leaving());
        assert!(workspace.session.document().grid().opaque_count() > 0, "it was not opened");
    }

    #[test]
    fn a_failure_is_an_error_on_screen_and_keeps_the_program() {
        let mut workspace = workspace();
        workspace.execute(&"clear".parse().unwrap());
        let go = start_slowly(&mut workspace, "save \"/nonexistent/a.pvm\"");
        workspace.ask_to_leave();
        go.send(()).unwrap();
        workspace.finish_job();
        assert!(!workspace.is_leaving() && workspace.session.modified());
        assert_eq!(tones(&workspace), [Tone::Error]);
    }
}
