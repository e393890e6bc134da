//! Owns a working session: the document, the file it belongs to, and the journal. It carries out
//! every [`Command`]: those that concern files itself, the rest through [`Document::apply`].
//!
//! Windows, headless jobs and scripts all work through [`Session::execute`], so that whatever a
//! person can do can be recorded and replayed. Knows no screen.

mod files;
mod work;

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::command::{Command, NewSculpture};
use crate::document::{Applied, CommandError, Document, Limits};
use crate::format::options::ImportOptions;
use crate::format::{self, FormatError, Loaded};
use crate::progress::Progress;
use files::Files;
pub use work::{Done, Work};
use work::{Outcome, Task, load};

/// Why a command could not be carried out. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum SessionError {
    #[error(transparent)]
    Command(#[from] CommandError),
    #[error("cannot open {path}: {error}")]
    Open { path: PathBuf, error: FormatError },
    #[error("cannot save {path}: {error}")]
    Save { path: PathBuf, error: FormatError },
    #[error("cannot read the image {path}: {error}")]
    Picture { path: PathBuf, error: FormatError },
    #[error("cannot write the journal {path}: {error}")]
    Journal { path: PathBuf, error: std::io::Error },
}

impl SessionError {
    /// Whether nothing went wrong, but the work was cancelled.
    pub fn is_cancelled(&self) -> bool {
        use SessionError::{Open, Save};
        matches!(self, Open { error, .. } | Save { error, .. } if matches!(error, FormatError::Cancelled))
    }
}

/// A document with its file.
#[derive(Debug)]
pub struct Session {
    document: Document,
    /// The files of the sculptures that undo and redo can lead to.
    files: Files,
    journal: Option<Journal>,
}

impl Session {
    /// Begins with a new sculpture.
    pub fn new(new: &NewSculpture, limits: Limits) -> Result<Session, SessionError> {
        Ok(Session::with_document(Document::new(new, limits)?))
    }

    /// Begins with the contents of a file.
    pub fn open(
        path: &Path,
        import: &ImportOptions,
        limits: Limits,
        progress: &dyn Progress,
    ) -> Result<Session, SessionError> {
        let Loaded { contents, texts, .. } = load(path, import, &limits, progress)?;
        let mut session = Session::with_document(Document::from_contents(contents, limits));
        session.files.opened(session.document.state(), path.to_path_buf(), texts);
        Ok(session)
    }

    fn with_document(document: Document) -> Session {
        let mut files = Files::default();
        files.made(document.state());
        Session { document, files, journal: None }
    }

    pub fn document(&self) -> &Document {
        &self.document
    }

    /// For the renderer, which takes the dirty bricks.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.document
    }

    /// The file that the sculpture was opened from or last saved to. It goes with the sculpture:
    /// undo and redo past `new` and `open` bring back that of the other.
    pub fn path(&self) -> Option<&Path> {
        self.files.path(self.document.state())
    }

    /// Whether something would be lost if the session ended now.
    pub fn modified(&self) -> bool {
        !self.files.is_saved(self.document.state())
    }

    /// From now on writes every command that was carried out to a script at `path`.
    pub fn record_to(&mut self, path: &Path) -> Result<(), SessionError> {
        self.journal = Some(Journal::create(path)?);
        Ok(())
    }

    /// Carries out a command.
    pub fn execute(
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
        self.note(command)?;
        Ok(applied)
    }

    /// Reads the pictures that a command needs, unless they are known.
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

    /// The long part of a command, to be done on its own; none for commands that take no time,
    /// which [`Session::execute`] carries out.
    pub fn prepare(&self, command: &Command) -> Result<Option<Work>, SessionError> {
        let limits = *self.document.limits();
        if matches!(command, Command::New(_) | Command::Open { .. }) {
            self.document.require_no_stroke(command.verb())?;
        }
        let task = match command.clone() {
            Command::New(new) => Task::New { new, limits },
            Command::Open { path, import } => Task::Open { path, import, limits },
            Command::Save { path, form } => Task::Save {
                path,
                form,
                contents: self.document.share_contents(),
                texts: self.files.texts(self.document.state()),
                state: self.document.state(),
            },
            _ => return Ok(None),
        };
        Ok(Some(Work { command: command.clone(), task }))
    }

    /// Puts in place what came of the long part of a command.
    pub fn complete(&mut self, done: Done) -> Result<Applied, SessionError> {
        let Done { command, outcome } = done;
        match outcome {
            Outcome::New(contents) => {
                self.document.replace(*contents, "new")?;
                self.files.made(self.document.state());
            }
            Outcome::Opened { path, loaded } => {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                self.document.replace(loaded.contents, &format!("open {name}"))?;
                self.files.opened(self.document.state(), path, loaded.texts);
            }
            Outcome::Saved { path, state } => self.files.saved(state, path),
        }
        self.files.keep_only(self.document.history().states().chain([self.document.state()]));
        self.note(&command)?;
        Ok(Applied::default())
    }

    /// Writes what was carried out to the journal.
    fn note(&mut self, command: &Command) -> Result<(), SessionError> {
        match &mut self.journal {
            Some(journal) => journal.write(command),
            None => Ok(()),
        }
    }
}

/// A script that grows with every command, flushed at once so that a crash loses nothing.
#[derive(Debug)]
struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    fn create(path: &Path) -> Result<Journal, SessionError> {
        let failed = |error| SessionError::Journal { path: path.to_path_buf(), error };
        let mut file = File::create(path).map_err(failed)?;
        writeln!(file, "# Recorded by Virtual Sculpture; replay with `virtual-sculpture run`")
            .map_err(failed)?;
        Ok(Journal { path: path.to_path_buf(), file })
    }

    fn write(&mut self, command: &Command) -> Result<(), SessionError> {
        writeln!(self.file, "{command}")
            .map_err(|error| SessionError::Journal { path: self.path.clone(), error })
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
