//! Owns a working session: the document, the file it belongs to, and the journal. It carries out
//! every [`Command`]: those that concern files itself, the rest through [`Document::apply`].
//!
//! Windows, headless jobs and scripts all work through [`Session::execute`], so that whatever a
//! person can do can be recorded and replayed. Knows no screen.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::command::{Command, NewSculpture};
use crate::config::Config;
use crate::document::{Applied, CommandError, Document, Limits};
use crate::format::Texts;
use crate::format::options::ImportOptions;
use crate::format::{self, FormatError, Loaded};
use crate::progress::Progress;

/// Why a command could not be carried out. The sculpture is as it was before.
#[derive(Debug, Error)]
pub enum SessionError {
    #[error(transparent)]
    Command(#[from] CommandError),
    #[error("cannot open {path}: {error}")]
    Open { path: PathBuf, error: FormatError },
    #[error("cannot save {path}: {error}")]
    Save { path: PathBuf, error: FormatError },
    #[error("cannot read the picture {path}: {error}")]
    Picture { path: PathBuf, error: FormatError },
    #[error("cannot write the journal {path}: {error}")]
    Journal { path: PathBuf, error: std::io::Error },
}

/// A document with its file.
#[derive(Debug)]
pub struct Session {
    document: Document,
    path: Option<PathBuf>,
    /// Texts of the file, which go along when it is saved.
    texts: Texts,
    /// Revision of the document when it was last opened or saved.
    saved_revision: u64,
    journal: Option<Journal>,
}

impl Session {
    /// Begins with the block of stone that the configuration asks for.
    pub fn new(config: &Config) -> Result<Session, SessionError> {
        let new = NewSculpture {
            dims: config.new.dims.into(),
            voxel_size: glam::Vec3::ONE,
            colour_depth: config.new.colour_bits,
            base: config.new.base,
            solid: true,
        };
        Ok(Session::with_document(Document::new(&new, config.limits())?))
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
        session.path = Some(path.to_path_buf());
        session.texts = texts;
        Ok(session)
    }

    fn with_document(document: Document) -> Session {
        Session {
            saved_revision: document.revision(),
            document,
            path: None,
            texts: Texts::default(),
            journal: None,
        }
    }

    pub fn document(&self) -> &Document {
        &self.document
    }

    /// For the renderer, which takes the dirty bricks.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.document
    }

    /// The file that the sculpture was opened from or last saved to.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Whether something would be lost if the session ended now.
    pub fn modified(&self) -> bool {
        self.document.revision() != self.saved_revision
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
        let applied = match command {
            Command::Open { path, import } => {
                let loaded = load(path, import, self.document.limits(), progress)?;
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
                self.document.replace(loaded.contents, &format!("open {name}"))?;
                self.texts = loaded.texts;
                self.path = Some(path.clone());
                self.saved_revision = self.document.revision();
                Applied::default()
            }
            Command::Save { path, form } => {
                let (contents, texts) = (self.document.contents(), self.texts.clone());
                format::save_with_texts(path, contents, *form, texts, progress)
                    .map_err(|error| SessionError::Save { path: path.clone(), error })?;
                self.path = Some(path.clone());
                self.saved_revision = self.document.revision();
                Applied::default()
            }
            Command::New(_) => {
                let applied = self.document.apply(command)?;
                self.path = None;
                self.texts = Texts::default();
                applied
            }
            Command::Texture { picture, .. } => {
                if !self.document.has_picture(picture) {
                    let texture = format::load_picture(picture)
                        .map_err(|error| SessionError::Picture { path: picture.clone(), error })?;
                    self.document.learn_picture(picture, texture);
                }
                self.document.apply(command)?
            }
            _ => self.document.apply(command)?,
        };
        if let Some(journal) = &mut self.journal {
            journal.write(command)?;
        }
        Ok(applied)
    }
}

fn load(
    path: &Path,
    import: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, SessionError> {
    format::load(path, import, limits, progress)
        .map_err(|error| SessionError::Open { path: path.to_path_buf(), error })
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
