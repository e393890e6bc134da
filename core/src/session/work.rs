//! The long part of commands: reading, writing, creating, rotating, resampling and repairing a sculpture. It needs no
//! session, so it can run on another thread while a window shows the present sculpture.
//!
//! [`Session::prepare`](super::Session::prepare) returns a [`Work`], [`Work::run`] runs it, and
//! [`Session::complete`](super::Session::complete) applies the result.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::SessionError;
use super::access::lock_to_save;
use super::histories;
use super::lock::FileLock;
use super::on_disk::FileIdentity;
use crate::command::{Command, NewSculpture};
use crate::document::{self, CommandError, Limits};
use crate::format::options::{ExportOptions, ImportOptions};
use crate::format::{self, Loaded, Texts};
use crate::mesh::{ContentsVersion, MeshCache};
use crate::persist::saved_history::{FoundHistory, HistoryToKeep, KeptSteps, SavedHistories};
use crate::progress::Progress;
use crate::resample::{self, Resolution};
use crate::sculpture::history::{Contents, State};
use crate::sculpture::orientation::Orientation;
use crate::tools::repair::{Repair, RepairPlan};

/// Work to run.
#[derive(Debug)]
pub struct Work {
    pub(super) command: Command,
    pub(super) task: Task,
}

#[derive(Debug)]
pub(super) enum Task {
    New {
        new: NewSculpture,
        limits: Limits,
    },
    Orient {
        orientation: Orientation,
        contents: Arc<Contents>,
        limits: Limits,
        state: State,
    },
    Resample {
        to: Resolution,
        contents: Arc<Contents>,
        limits: Limits,
        state: State,
    },
    Repair {
        repair: Repair,
        contents: Arc<Contents>,
        limits: Limits,
        state: State,
    },
    Open {
        path: PathBuf,
        /// Its content, if it is embedded: a .vsc file.
        embedded: Option<Arc<[u8]>>,
        import: ImportOptions,
        limits: Limits,
        /// The place where its undo history may be.
        histories: Option<Arc<SavedHistories>>,
    },
    Save {
        path: PathBuf,
        /// The identity of the file when the session last read or wrote it, if it did.
        known: Option<FileIdentity>,
        export: ExportOptions,
        contents: Arc<Contents>,
        /// The cache of the last mesh, if a mesh is written, and how the contents differ from it.
        meshes: Option<(Arc<MeshCache>, ContentsVersion)>,
        texts: Texts,
        limits: Limits,
        state: State,
        /// Whether the session holds its lock.
        is_held: bool,
        /// The undo history, if it is kept.
        steps: Option<KeptSteps>,
    },
}

/// The result of work.
#[derive(Debug)]
pub struct FinishedWork {
    pub(super) command: Command,
    pub(super) outcome: WorkOutcome,
    /// The duration of the work.
    pub(super) took: Duration,
}

#[derive(Debug)]
pub(super) enum WorkOutcome {
    New(Box<Contents>),
    /// `state`: of the document that they were computed from.
    Oriented {
        orientation: Orientation,
        contents: Box<Contents>,
        state: State,
    },
    /// `state`: of the document that they were computed from.
    Resampled {
        contents: Box<Contents>,
        state: State,
    },
    /// `state`: of the document that it was computed for.
    Repaired {
        repair: Repair,
        plan: RepairPlan,
        state: State,
    },
    Opened {
        path: PathBuf,
        loaded: Box<Loaded>,
        identity: Option<FileIdentity>,
        history: FoundHistory,
    },
    Saved {
        path: PathBuf,
        notes: Vec<String>,
        state: State,
        identity: Option<FileIdentity>,
        history: Option<HistoryToKeep>,
        lock: Option<FileLock>,
    },
}

impl Work {
    /// Runs the work. On failure or cancellation nothing has changed.
    pub fn run(self, progress: &dyn Progress) -> Result<FinishedWork, SessionError> {
        let began = Instant::now();
        let outcome = match self.task {
            Task::New { new, limits } => {
                WorkOutcome::New(Box::new(document::make_contents(&new, &limits)?))
            }
            Task::Orient { orientation, contents, limits, state } => {
                let contents =
                    document::orient_contents(&contents, orientation, &limits, progress)?;
                WorkOutcome::Oriented { orientation, contents: Box::new(contents), state }
            }
            Task::Resample { to, contents, limits, state } => {
                let resampled = resample::resampled(&contents, to, &limits, progress);
                let contents = resampled.map_err(CommandError::from)?;
                WorkOutcome::Resampled { contents: Box::new(contents), state }
            }
            Task::Repair { repair, contents, limits, state } => {
                let plan = document::plan_repair(&contents, &repair, &limits, progress)?;
                WorkOutcome::Repaired { repair, plan, state }
            }
            Task::Open { path, embedded: Some(file), limits, .. } => {
                let read = format::read_embedded(&file, &limits, progress);
                let failed = |error| SessionError::Open { path: path.clone(), error };
                let loaded = Box::new(read.map_err(failed)?);
                // The file at its path may differ from the embedded one.
                WorkOutcome::Opened { path, loaded, identity: None, history: FoundHistory::Nothing }
            }
            Task::Open { path, embedded: None, import, limits, histories } => {
                // Computed before reading: the session then does not know of a change made meanwhile.
                let identity = FileIdentity::of(&path);
                let loaded = Box::new(load(&path, &import, &limits, progress)?);
                let history =
                    histories::find(histories.as_deref(), identity, &loaded.contents, &limits);
                WorkOutcome::Opened { path, loaded, identity, history }
            }
            Task::Save {
                path,
                known,
                is_held,
                export,
                contents,
                meshes,
                texts,
                limits,
                state,
                steps,
            } => {
                let lock = lock_to_save(&path, is_held)?;
                if let Some(known) = known
                    && !known.may_be_replaced(&path)
                {
                    let found = FileIdentity::of(&path);
                    return Err(SessionError::ChangedOnDisk { path, found });
                }
                let saved = match meshes {
                    Some((cache, version)) => {
                        let (mesh, kept) = (&export.mesh, (&*cache, &version));
                        format::save_mesh_again(&path, &contents, mesh, &limits, kept, progress)
                            .map(|summary| vec![summary.to_string()])
                    }
                    None => format::save_with(&path, &contents, &export, texts, &limits, progress),
                };
                match saved {
                    Ok(notes) => {
                        let identity = FileIdentity::of(&path);
                        let history = histories::to_keep(steps, &path, identity, &contents);
                        WorkOutcome::Saved { path, notes, state, identity, history, lock }
                    }
                    Err(error) => return Err(SessionError::Save { path, error }),
                }
            }
        };
        Ok(FinishedWork { command: self.command, outcome, took: began.elapsed() })
    }
}

impl FinishedWork {
    /// Returns the command that was executed.
    pub fn command(&self) -> &Command {
        &self.command
    }
}

pub(super) fn load(
    path: &Path,
    import: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, SessionError> {
    format::load(path, import, limits, progress)
        .map_err(|error| SessionError::Open { path: path.to_path_buf(), error })
}
