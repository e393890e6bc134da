//! A session: a document, its files, its journal and perhaps a recording. Executes every [`Command`]: those for files
//! itself, the others through [`Document::apply`].
//!
//! Windows, headless jobs and scripts all use [`Session::execute`], so that every action of a user can be recorded and
//! replayed. Knows no screen.

mod access;
mod error;
mod files;
mod histories;
mod journal_keeper;
mod lock;
mod meshes;
mod on_disk;
mod pictures;
mod recording;
mod recover;
mod safekeeping;
#[cfg(test)]
mod tests;
mod work;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::command::{Command, CommandClass, NewSculpture};
use crate::document::{Applied, CommandError, Document, Limits};
use crate::format::options::{ExportForm, ImportOptions};
use crate::format::{self, Loaded, Texts};
use crate::persist::journal::JournalEntry;
use crate::progress::Progress;
use crate::sculpture::orientation::{Orientation, Up};
use access::Access;
pub use access::FileAccess;
pub use error::SessionError;
use files::SculptureFiles;
use histories::Histories;
use journal_keeper::{JournalKeeper, opened_entry, saved_entry};
pub use lock::Holder;
use meshes::KeptMeshes;
pub use on_disk::FileIdentity;
use on_disk::OnDisk;
use pictures::Pictures;
use recording::ScriptRecording;
pub use recover::{Recovered, RecoveryReport, Summary, recover, summary};
pub use work::{FinishedWork, Work};
use work::{Task, WorkOutcome, load};

/// A document with its file.
#[derive(Debug)]
pub struct Session {
    document: Document,
    /// The files of the sculptures that undo and redo can lead to.
    files: SculptureFiles,
    /// The identities of those files when they were read or written.
    on_disk: OnDisk,
    /// The record of who may write to those files.
    access: Access,
    /// The command that reproduces the sculpture at the session's start.
    beginning: Command,
    recording: Option<ScriptRecording>,
    /// The reason why the recording has ended.
    journal_error: Option<SessionError>,
    journal: Option<JournalKeeper>,
    /// The undo histories on disk.
    histories: Histories,
    /// Data kept from the mesh written last.
    meshes: Option<KeptMeshes>,
    pictures: Pictures,
    /// Files whose content commands have given.
    embedded: HashMap<PathBuf, Arc<[u8]>>,
    /// Notes for the user on what was left out when the last file was read.
    notes: Vec<String>,
}

impl Session {
    /// Creates a session with a new sculpture.
    pub fn new(new: &NewSculpture, limits: Limits) -> Result<Session, SessionError> {
        Ok(Session::with_document(Document::new(new, limits)?, Command::New(*new)))
    }

    /// Creates a session with the contents of a file.
    pub fn open(
        path: &Path,
        import: &ImportOptions,
        limits: Limits,
        progress: &dyn Progress,
    ) -> Result<Session, SessionError> {
        let identity = FileIdentity::of(path);
        let Loaded { contents, texts, assumed_up, notes, .. } =
            load(path, import, &limits, progress)?;
        let document = Document::from_contents(contents, limits);
        let beginning = Command::Open { path: path.to_path_buf(), import: *import };
        let mut session = Session::with_document(document, beginning);
        let state = session.document.state();
        session.files.opened(state, path.to_path_buf(), texts, assumed_up);
        session.on_disk.learn(path, identity);
        session.notes = notes;
        Ok(session)
    }

    fn with_document(document: Document, beginning: Command) -> Session {
        let mut files = SculptureFiles::default();
        files.made(document.state());
        Session {
            document,
            files,
            on_disk: OnDisk::default(),
            access: Access::default(),
            beginning,
            recording: None,
            journal_error: None,
            journal: None,
            histories: Histories::default(),
            meshes: None,
            pictures: Pictures::default(),
            embedded: HashMap::new(),
            notes: Vec::new(),
        }
    }

    /// Keeps the mesh of an export, within a share of the memory for meshes. The next mesh of the same kind then
    /// recomputes only what has changed.
    pub fn keep_meshes(&mut self) {
        self.meshes = Some(KeptMeshes::default());
    }

    /// Drops the kept mesh: another sculpture replaces the present one.
    fn forget_mesh(&self) {
        if let Some(meshes) = &self.meshes {
            meshes.clear();
        }
    }

    /// Returns the document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Returns the document mutably, for a renderer that drains its changes.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.document
    }

    /// Returns the file that the sculpture was opened from or last saved to. It belongs to the sculpture: undo and redo
    /// past `new` and `open` restore the file of the other sculpture.
    pub fn path(&self) -> Option<&Path> {
        self.files.path(self.document.state())
    }

    /// Returns the axis that was assumed to point up when the sculpture was read, as long as the sculpture is
    /// unchanged. `None` if the file states it.
    pub fn assumed_up(&self) -> Option<Up> {
        self.files.assumed_up(self.document.state())
    }

    /// Returns whether the sculpture has unsaved changes.
    pub fn modified(&self) -> bool {
        !self.files.is_saved(self.document.state())
    }

    /// Starts to record: writes every executed command to a script at `path`, after the command that reproduces the
    /// session's start. Refuses a file that is not empty.
    pub fn record_to(&mut self, path: &Path) -> Result<(), SessionError> {
        if self.document.revision() > 0 {
            return Err(SessionError::JournalLate);
        }
        let contents = self.document.contents();
        let texts = self.files.texts(self.document.state());
        self.recording = Some(ScriptRecording::begin(path, &self.beginning, contents, &texts)?);
        Ok(())
    }

    /// Returns the script that is being recorded.
    pub fn recording(&self) -> Option<&Path> {
        self.recording.as_ref().map(ScriptRecording::path)
    }

    /// Returns the notes on what was left out or reinterpreted when the last file was read, once.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Returns the reason why the recording has ended early, once. The sculpture is not affected.
    pub fn take_journal_error(&mut self) -> Option<SessionError> {
        self.journal_error.take()
    }

    /// Executes a command.
    pub fn execute(
        &mut self,
        command: &Command,
        progress: &dyn Progress,
    ) -> Result<Applied, SessionError> {
        let mut rest = command.clone();
        let mut done = Applied::default();
        loop {
            let step = self.document.first_step(&rest);
            match self.execute_step(&step, progress) {
                Ok(applied) => {
                    done = Applied { steps: done.steps + applied.steps, ..applied };
                    match rest.after_steps(applied.steps) {
                        Some(next) if step != rest && applied.steps > 0 => rest = next,
                        _ => return Ok(done),
                    }
                }
                Err(error) if done.steps == 0 => return Err(error),
                // Steps done so far stay done; the caller learns their number.
                Err(_) => return Ok(done),
            }
        }
    }

    fn execute_step(
        &mut self,
        command: &Command,
        progress: &dyn Progress,
    ) -> Result<Applied, SessionError> {
        if let Some(work) = self.prepare(command)? {
            return self.complete(work.run(progress)?);
        }
        if let Command::Embed { path, file } = command {
            // The journal holds the results, by content.
            self.embedded.insert(path.clone(), file.clone());
            self.note(command, Applied::default());
            return Ok(Applied::default());
        }
        let began = Instant::now();
        let sculpture = self.document.state().sculpture;
        self.pictures.forget_at_stroke(command, &mut self.document);
        self.learn_pictures(command)?;
        let applied = self.document.apply(command)?;
        if self.document.state().sculpture != sculpture {
            self.follow_file();
        }
        self.note(command, applied);
        self.keep_command(command, applied, began.elapsed());
        Ok(applied)
    }

    /// Reads the images that a command needs, unless they are loaded.
    fn learn_pictures(&mut self, command: &Command) -> Result<(), SessionError> {
        for path in Pictures::needed(command, &self.document) {
            if !self.document.has_picture(&path) {
                let embedded = self.embedded.get(&path);
                let file = Pictures::read(&path, embedded, &mut self.document)?;
                self.record_picture(&path, &file);
                let file = self.pictures.keep(&path, file);
                self.keep(JournalEntry::Picture { path, file }, Duration::ZERO);
            }
        }
        Ok(())
    }

    /// Returns the long part of a command, to run separately. `None` for commands without one, which
    /// [`Session::execute`] executes at once. For an undo or redo, it is the long part of the next step alone: see
    /// [`Document::first_step`].
    pub fn prepare(&mut self, command: &Command) -> Result<Option<Work>, SessionError> {
        let limits = *self.document.limits();
        if command.class() == CommandClass::Replace {
            self.document.require_no_stroke(command.verb())?;
            self.document.require_room_for_whole(command.verb())?;
        }
        if let Command::Save { path, .. } = command {
            self.access.require_may_write(path)?;
        }
        let task = match command.clone() {
            Command::Orient(orientation) if orientation != Orientation::UPRIGHT => {
                self.document.require_can_orient(orientation)?;
                let contents = self.document.share_contents();
                Task::Orient { orientation, contents, limits, state: self.document.state() }
            }
            Command::Undo { .. } | Command::Redo { .. } => {
                let Some(orientation) = self.document.next_orientation(command)? else {
                    return Ok(None);
                };
                let contents = self.document.share_contents();
                Task::Orient { orientation, contents, limits, state: self.document.state() }
            }
            Command::Repair(repair) => {
                repair.check(self.document.grid().voxel_size()).map_err(CommandError::from)?;
                let contents = self.document.share_contents();
                Task::Repair { repair, contents, limits, state: self.document.state() }
            }
            Command::Resample(to) => {
                self.document.require_can_resample()?;
                let contents = self.document.share_contents();
                Task::Resample { to, contents, limits, state: self.document.state() }
            }
            Command::New(new) => Task::New { new, limits },
            Command::Open { path, import } => {
                let embedded = self.embedded.get(&path).cloned();
                let histories = self.histories.saved().cloned();
                Task::Open { path, embedded, import, limits, histories }
            }
            Command::Save { path, export } => Task::Save {
                meshes: match &mut self.meshes {
                    Some(kept) if format::is_mesh(&path) && export.form == ExportForm::Auto => {
                        Some(kept.next_version(&mut self.document))
                    }
                    _ => None,
                },
                known: self.on_disk.known(&path),
                is_held: self.access.holds(&path),
                path,
                export,
                limits,
                contents: self.document.share_contents(),
                texts: self.files.texts(self.document.state()),
                state: self.document.state(),
                steps: self.histories.steps_to_keep(&self.document, &self.files),
            },
            _ => return Ok(None),
        };
        Ok(Some(Work { command: command.clone(), task }))
    }

    /// Completes a command with the result of its long part.
    pub fn complete(&mut self, done: FinishedWork) -> Result<Applied, SessionError> {
        let FinishedWork { command, outcome, took } = done;
        let began = Instant::now();
        let mut applied = Applied::default();
        let mut entry = None;
        match outcome {
            WorkOutcome::New(contents) => {
                self.forget_mesh();
                self.document.replace(*contents, "new")?;
                self.files.made(self.document.state());
            }
            WorkOutcome::Oriented { orientation, contents, state }
                if state == self.document.state() =>
            {
                if matches!(command, Command::Orient(_)) {
                    self.document.put_oriented(*contents, orientation, &command)?;
                } else {
                    applied = self.document.travel_oriented(&command, *contents)?;
                }
            }
            WorkOutcome::Repaired { repair, plan, state } if state == self.document.state() => {
                applied = self.document.put_repaired(&plan, &repair, &command)?;
            }
            WorkOutcome::Resampled { contents, state } if state == self.document.state() => {
                self.forget_mesh();
                applied = self.document.put_resampled(*contents, &command)?;
            }
            // The document was changed meanwhile.
            WorkOutcome::Oriented { .. }
            | WorkOutcome::Repaired { .. }
            | WorkOutcome::Resampled { .. } => applied = self.document.apply(&command)?,
            WorkOutcome::Opened { path, loaded, identity, history } => {
                self.forget_mesh();
                self.on_disk.learn(&path, identity);
                self.access.opened(&path);
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                let Loaded { contents, texts, assumed_up, notes, .. } = *loaded;
                self.document.replace(contents, &format!("open {name}"))?;
                self.notes = notes;
                entry = Some(opened_entry(&self.document, &path, &texts, assumed_up));
                self.files.opened(self.document.state(), path, texts, assumed_up);
                self.go_on_with(history);
            }
            // Volumes are for other programs and may not hold the whole sculpture.
            WorkOutcome::Saved { path, notes, state, identity, history, lock } => {
                self.on_disk.learn(&path, identity);
                self.notes = notes;
                self.histories.keep(history);
                if format::is_sculpture(&path) {
                    entry = Some(saved_entry(&path, state));
                    if state.sculpture == self.document.state().sculpture {
                        self.access.adopt(&path, lock);
                    }
                    self.files.saved(state, path);
                }
            }
        }
        self.keep_reachable_files();
        self.follow_file();
        self.note(&command, applied);
        let took = took + began.elapsed();
        match (entry, &command) {
            (Some(entry), _) => self.keep(entry, took),
            // A volume or mesh for other programs.
            (None, Command::Save { .. }) => {}
            (None, _) => self.keep_command(&command, applied, took),
        }
        Ok(applied)
    }

    /// Adds an executed command to the journal.
    fn keep_command(&mut self, command: &Command, applied: Applied, took: Duration) {
        if let Some((journal, parts)) = self.journal_and_parts() {
            journal.keep_command(command, applied, took, parts);
        }
    }

    fn keep_reachable_files(&mut self) {
        self.files.keep_only(self.document.history().states().chain([self.document.state()]));
    }

    /// Writes an executed command to the recording. If that fails, the command still succeeds and the recording ends:
    /// with a gap, its replay would differ.
    fn note(&mut self, command: &Command, applied: Applied) {
        if self.recording.is_none() {
            return;
        }
        let texts = match command {
            Command::Open { .. } => self.files.texts(self.document.state()),
            _ => Texts::default(),
        };
        let history = self.document.history();
        let left = [history.undo_count(), history.redo_count()];
        if self.recording.as_mut().is_some_and(|r| r.needs_checkpoint(command, left)) {
            return self.record_checkpoint();
        }
        let contents = self.document.share_contents();
        self.record(|recording| match command {
            Command::Open { path, .. } => recording.write_opened(path, &contents, &texts),
            command => recording.write(command, applied),
        });
    }

    /// Continues the recording of another session from the present state of this one.
    pub fn continue_recording(&mut self, of: &mut Session) {
        if let Some(mut recording) = of.recording.take() {
            recording.fall_behind();
            self.recording = Some(recording);
            self.record_checkpoint();
        }
    }

    /// Writes the whole state of the session to the recording. Within a stroke, this waits for its end.
    fn record_checkpoint(&mut self) {
        let Some(snapshot) = self.document.snapshot() else { return };
        let texts = self.files.texts(self.document.state());
        let name = self.path().unwrap_or(Path::new("sculpture.vsc")).to_path_buf();
        self.record(|recording| recording.write_checkpoint(&name, &snapshot, &texts));
    }

    /// Writes the bytes of an image to the recording, unless it holds them already.
    fn record_picture(&mut self, path: &Path, file: &[u8]) {
        self.record(|recording| recording.write_picture(path, file));
    }

    fn record(&mut self, write: impl FnOnce(&mut ScriptRecording) -> Result<(), SessionError>) {
        let Some(recording) = &mut self.recording else { return };
        if let Err(error) = write(recording) {
            tracing::warn!("{error}");
            self.recording = None;
            self.journal_error = Some(error);
        }
    }
}
