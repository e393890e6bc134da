//! A session: a document, its file and the journal. Executes every [`Command`]: those that concern files
//! itself, the others through [`Document::apply`].
//!
//! Windows, headless jobs and scripts all use [`Session::execute`], so that everything a user does can be
//! recorded and replayed. Knows no screen.

mod files;
mod journal;
mod work;

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::command::{Command, NewSculpture};
use crate::document::{Applied, CommandError, Document, Limits};
use crate::format::options::ImportOptions;
use crate::format::{self, FormatError, Loaded};
use crate::progress::Progress;
use crate::sculpture::orientation::{Orientation, Up};
use files::Files;
use journal::Journal;
pub use work::{Done, Work};
use work::{Outcome, Task, load};

/// Why a command failed. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum SessionError {
    /// The document has refused the command.
    #[error(transparent)]
    Command(#[from] CommandError),
    /// A file cannot be read.
    #[error("cannot open {path}: {error}")]
    Open {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FormatError,
    },
    /// A file cannot be written.
    #[error("cannot save {path}: {error}")]
    Save {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FormatError,
    },
    /// The image for a texture cannot be read.
    #[error("cannot read the image {path}: {error}")]
    Picture {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FormatError,
    },
    /// The journal's file cannot be created or written.
    #[error("cannot record to {path}: {error}")]
    Journal {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: std::io::Error,
    },
    /// The journal's file already holds something.
    #[error(
        "cannot record to {path}: that file {holds}; choose another name, or move the file away"
    )]
    JournalTaken {
        /// The file.
        path: PathBuf,
        /// What the file holds.
        holds: &'static str,
    },
    /// The sculpture has already been changed.
    #[error("a recording must begin before the sculpture is changed")]
    JournalLate,
}

impl SessionError {
    /// Whether the work was cancelled.
    pub fn is_cancelled(&self) -> bool {
        use SessionError::{Open, Save};
        match self {
            Open { error, .. } | Save { error, .. } => matches!(error, FormatError::Cancelled),
            SessionError::Command(error) => matches!(error, CommandError::Cancelled),
            _ => false,
        }
    }
}

/// A document with its file.
#[derive(Debug)]
pub struct Session {
    document: Document,
    /// The files of the sculptures that undo and redo can lead to.
    files: Files,
    /// The command that reproduces the sculpture at the session's start.
    beginning: Command,
    journal: Option<Journal>,
    /// Why the journal has ended.
    journal_error: Option<SessionError>,
    /// What reading the last file left out, for the person to know.
    notes: Vec<String>,
}

impl Session {
    /// A session with a new sculpture.
    pub fn new(new: &NewSculpture, limits: Limits) -> Result<Session, SessionError> {
        Ok(Session::with_document(Document::new(new, limits)?, Command::New(*new)))
    }

    /// A session with the contents of a file.
    pub fn open(
        path: &Path,
        import: &ImportOptions,
        limits: Limits,
        progress: &dyn Progress,
    ) -> Result<Session, SessionError> {
        let Loaded { contents, texts, assumed_up, notes, .. } =
            load(path, import, &limits, progress)?;
        let document = Document::from_contents(contents, limits);
        let beginning = Command::Open { path: path.to_path_buf(), import: *import };
        let mut session = Session::with_document(document, beginning);
        let state = session.document.state();
        session.files.opened(state, path.to_path_buf(), texts, assumed_up);
        session.notes = notes;
        Ok(session)
    }

    fn with_document(document: Document, beginning: Command) -> Session {
        let mut files = Files::default();
        files.made(document.state());
        Session {
            document,
            files,
            beginning,
            journal: None,
            journal_error: None,
            notes: Vec::new(),
        }
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The document, for a renderer that drains its changes.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.document
    }

    /// The file that the sculpture was opened from or last saved to. It belongs to the sculpture: undo
    /// and redo past `new` and `open` restore the other's.
    pub fn path(&self) -> Option<&Path> {
        self.files.path(self.document.state())
    }

    /// The axis that was taken for the one that points up when the sculpture was read, while it is
    /// as it was read. None where the file says so itself.
    pub fn assumed_up(&self) -> Option<Up> {
        self.files.assumed_up(self.document.state())
    }

    /// Whether the sculpture has unsaved changes.
    pub fn modified(&self) -> bool {
        !self.files.is_saved(self.document.state())
    }

    /// Starts to record: writes every executed command to a script at `path`, after the one that
    /// reproduces the session's start. A file that is not empty is refused.
    pub fn record_to(&mut self, path: &Path) -> Result<(), SessionError> {
        if self.document.revision() > 0 {
            return Err(SessionError::JournalLate);
        }
        self.journal = Some(Journal::begin(path, &self.beginning)?);
        Ok(())
    }

    /// The script that is being recorded.
    pub fn recording(&self) -> Option<&Path> {
        self.journal.as_ref().map(Journal::path)
    }

    /// What reading the last file left out or took otherwise, returned once.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Why the recording has ended early, returned once. The sculpture is not affected.
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
            let leg = self.document.first_leg(&rest);
            match self.execute_leg(&leg, progress) {
                Ok(applied) => {
                    done = Applied { steps: done.steps + applied.steps, ..applied };
                    match rest.after_steps(applied.steps) {
                        Some(next) if leg != rest && applied.steps > 0 => rest = next,
                        _ => return Ok(done),
                    }
                }
                Err(error) if done.steps == 0 => return Err(error),
                // Earlier steps stay undone; the caller learns of the rest.
                Err(_) => return Ok(done),
            }
        }
    }

    fn execute_leg(
        &mut self,
        command: &Command,
        progress: &dyn Progress,
    ) -> Result<Applied, SessionError> {
        if let Some(work) = self.prepare(command)? {
            return self.complete(work.run(progress)?);
        }
        if matches!(command, Command::Begin { .. }) {
            // Read again with every stroke: the file may have been changed by then.
            self.document.forget_pictures();
        }
        self.learn_pictures(command)?;
        let applied = self.document.apply(command)?;
        self.note(command, applied);
        Ok(applied)
    }

    /// Reads the images that a command needs, unless they are loaded.
    fn learn_pictures(&mut self, command: &Command) -> Result<(), SessionError> {
        let needed: Vec<PathBuf> = match command {
            Command::Texture { picture, .. } => vec![picture.clone()],
            Command::Array { .. } => {
                self.document.pictures_to_repeat().map(Path::to_path_buf).collect()
            }
            _ => return Ok(()),
        };
        for path in needed {
            if !self.document.has_picture(&path) {
                let texture = format::load_picture(&path)
                    .map_err(|error| SessionError::Picture { path: path.clone(), error })?;
                self.document.learn_picture(&path, texture);
            }
        }
        Ok(())
    }

    /// The long part of a command, to run separately. None for commands without one, which
    /// [`Session::execute`] executes at once. Of an undo or redo it is that of the next step alone:
    /// see [`Document::first_leg`].
    pub fn prepare(&self, command: &Command) -> Result<Option<Work>, SessionError> {
        let limits = *self.document.limits();
        if matches!(command, Command::New(_) | Command::Open { .. }) {
            self.document.require_no_stroke(command.verb())?;
            self.document.require_room_for_whole(command.verb())?;
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
            Command::Mend(mend) => {
                mend.check(self.document.grid().voxel_size()).map_err(CommandError::from)?;
                let contents = self.document.share_contents();
                Task::Mend { mend, contents, limits, state: self.document.state() }
            }
            Command::New(new) => Task::New { new, limits },
            Command::Open { path, import } => Task::Open { path, import, limits },
            Command::Save { path, export } => Task::Save {
                path,
                export,
                limits,
                contents: self.document.share_contents(),
                texts: self.files.texts(self.document.state()),
                state: self.document.state(),
            },
            _ => return Ok(None),
        };
        Ok(Some(Work { command: command.clone(), task }))
    }

    /// Completes a command with the result of its long part.
    pub fn complete(&mut self, done: Done) -> Result<Applied, SessionError> {
        let Done { command, outcome } = done;
        let mut applied = Applied::default();
        match outcome {
            Outcome::New(contents) => {
                self.document.replace(*contents, "new")?;
                self.files.made(self.document.state());
            }
            Outcome::Oriented { orientation, contents, state }
                if state == self.document.state() =>
            {
                if matches!(command, Command::Orient(_)) {
                    self.document.put_oriented(*contents, orientation, &command)?;
                } else {
                    applied = self.document.travel_oriented(&command, *contents)?;
                }
            }
            Outcome::Mended { mend, plan, state } if state == self.document.state() => {
                applied = self.document.put_mended(&plan, &mend, &command)?;
            }
            // It was changed meanwhile.
            Outcome::Oriented { .. } | Outcome::Mended { .. } => {
                applied = self.document.apply(&command)?
            }
            Outcome::Opened { path, loaded } => {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                let Loaded { contents, texts, assumed_up, notes, .. } = *loaded;
                self.document.replace(contents, &format!("open {name}"))?;
                self.notes = notes;
                self.files.opened(self.document.state(), path, texts, assumed_up);
            }
            // Volumes are for other programs: what they cannot hold would be lost.
            Outcome::Saved { path, notes, state } => {
                self.notes = notes;
                if format::is_sculpture(&path) {
                    self.files.saved(state, path);
                }
            }
        }
        self.files.keep_only(self.document.history().states().chain([self.document.state()]));
        self.note(&command, applied);
        Ok(applied)
    }

    /// Writes an executed command to the journal. If that fails, the command still succeeds, and the
    /// journal ends: with a gap it would replay something else.
    fn note(&mut self, command: &Command, applied: Applied) {
        let Some(journal) = &mut self.journal else { return };
        if let Err(error) = journal.write(command, applied) {
            tracing::warn!("{error}");
            self.journal = None;
            self.journal_error = Some(error);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::{ColourDepth, Rgb};

    #[test]
    fn a_picture_is_read_anew_with_every_stroke() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("colour.png");
        let write = |rgb: [u8; 3]| {
            image::RgbImage::from_pixel(2, 2, image::Rgb(rgb)).save(&path).unwrap();
        };
        let new = NewSculpture {
            dims: glam::UVec3::splat(16),
            voxel_size: glam::Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb([128; 3]),
            solid: true,
        };
        let mut session = Session::new(&new, Limits::default()).unwrap();
        let paint = format!("texture \"{}\" cuboid at=8,8,8 half=4", path.display());
        for rgb in [[200, 10, 20], [30, 220, 40]] {
            write(rgb);
            for line in ["begin", &paint, "end"] {
                session.execute(&line.parse().unwrap(), &()).unwrap();
            }
            let contents = session.document().contents();
            assert_eq!(contents.rgb(glam::UVec3::splat(8)).0, rgb);
        }
        // An empty stroke forgets the picture, but not that it was used.
        for line in ["begin", "end", "array count=1 step=4,0,0"] {
            session.execute(&line.parse().unwrap(), &()).unwrap();
        }
        assert_eq!(session.document().contents().rgb(glam::UVec3::splat(11)).0, [30, 220, 40]);
        std::fs::remove_file(&path).unwrap();
        session.execute(&Command::Begin { label: String::new() }, &()).unwrap();
        let error = session.execute(&paint.parse().unwrap(), &()).unwrap_err();
        assert!(error.to_string().contains("colour.png"), "{error}");
    }
}
