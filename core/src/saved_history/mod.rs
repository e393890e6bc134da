//! The undo history of saved files: a file for each in a folder for state, so that undo and redo go on after a
//! sculpture has been closed and opened again, and nobody who is given the sculpture gets its past.
//!
//! A history is found by the SHA-256 of the sculpture's file, and holds the hash of the contents that it was kept
//! with: it fits those or is left out. A thread of its own packs and writes; the bytes of all histories together are
//! bounded, those written last stay. `file` is what such a file holds, `dir` the folder. Knows no session.

mod dir;
mod file;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use dir::HistoryDir;
pub use file::SavedHistory;

use crate::document::DocumentSnapshot;
use crate::format::store::explained;
use crate::journal::SculptureFile;
use crate::journal::files::{Disk, Files};
use crate::sculpture::history::{Contents, HistorySnapshot, State};
use crate::sculpture::{Digest, Limits};

/// Where and how the histories of saved files are kept.
#[derive(Clone, Debug)]
pub struct SavedHistoryOptions {
    /// The folder of the files.
    pub folder: PathBuf,
    /// The file layer.
    pub files: Arc<dyn Files>,
    /// Most bytes of all histories together. A single one takes at most half of it.
    pub max_bytes: u64,
}

impl SavedHistoryOptions {
    /// Histories in a folder of the disk, with at most so many bytes.
    pub fn new(folder: &Path, max_bytes: u64) -> SavedHistoryOptions {
        SavedHistoryOptions { folder: folder.to_path_buf(), files: Arc::new(Disk), max_bytes }
    }
}

/// A history to keep, of a document as it was when it was saved.
#[derive(Clone, Debug)]
pub struct HistoryToKeep {
    /// The file of the sculpture, absolute.
    pub path: PathBuf,
    /// The hash of that file's bytes.
    pub file_hash: Digest,
    /// The hash of the contents.
    pub contents_hash: Digest,
    /// Steps and state. Its contents are not needed.
    pub steps: KeptSteps,
}

/// The steps of a document, and the state from which they lead.
#[derive(Clone, Debug)]
pub struct KeptSteps {
    history: HistorySnapshot,
    state: State,
    files: Vec<SculptureFile>,
}

impl KeptSteps {
    /// Those of a document; `files`: of all sculptures that undo and redo lead to.
    pub fn of(document: DocumentSnapshot, files: Vec<SculptureFile>) -> KeptSteps {
        KeptSteps { history: document.history, state: document.state, files }
    }

    /// Whether there is anything to undo or redo.
    pub fn is_empty(&self) -> bool {
        self.history.undo.is_empty() && self.history.redo.is_empty()
    }
}

/// The result of a search for the history of a file.
#[derive(Debug)]
pub enum Found {
    /// None is kept.
    Nothing,
    /// The steps that can be undone and redone.
    History(SavedHistory),
    /// There is one that cannot be used: why, as a part of a sentence.
    Unusable(String),
}

/// Keeps the histories of the files that a session saves, and finds those of the files that it opens.
#[derive(Debug)]
pub struct SavedHistories {
    options: SavedHistoryOptions,
    writing: Mutex<Option<Writing>>,
    messages: Arc<Mutex<VecDeque<String>>>,
}

#[derive(Debug)]
struct Writing {
    /// The file whose history it is.
    path: PathBuf,
    thread: JoinHandle<()>,
    is_given_up: Arc<AtomicBool>,
}

impl SavedHistories {
    /// Nothing is written yet.
    pub fn new(options: SavedHistoryOptions) -> SavedHistories {
        SavedHistories { options, writing: Mutex::default(), messages: Arc::default() }
    }

    /// How they are kept.
    pub fn options(&self) -> &SavedHistoryOptions {
        &self.options
    }

    /// Writes a history on a thread; does not wait. One of the same file that is still being written is given up for it:
    /// the file does not hold that any more. One of another file is written first.
    pub fn keep(&self, history: HistoryToKeep) {
        let mut writing = self.writing();
        let former = writing.take();
        if let Some(former) = former.as_ref().filter(|former| former.path == history.path) {
            former.is_given_up.store(true, Ordering::Relaxed);
        }
        let dir = HistoryDir::new(&self.options);
        let is_given_up = Arc::new(AtomicBool::new(false));
        let (given_up, messages) = (is_given_up.clone(), self.messages.clone());
        let path = history.path.clone();
        let work = move || {
            if let Some(former) = former {
                // Problems of that write have already been reported.
                let _ = former.thread.join();
            }
            let name = history.path.display().to_string();
            if let Err(error) = dir.keep(history, &given_up) {
                let error = explained(error);
                tell(&messages, format!("the undo history of {name} is not kept: {error}"));
            }
        };
        match std::thread::Builder::new().name("saved history".to_string()).spawn(work) {
            Ok(thread) => *writing = Some(Writing { path, thread, is_given_up }),
            Err(error) => self.tell(format!("the undo history is not kept: {error}")),
        }
    }

    /// The history of the file with this hash, read from it as `contents`. Waits for what is being written. Steps come
    /// back as far as [`Limits::history_bytes`] has room for them.
    pub fn find(&self, file_hash: Digest, contents: &Contents, limits: &Limits) -> Found {
        self.wait();
        HistoryDir::new(&self.options).find(file_hash, contents, limits)
    }

    /// Waits until what was given is written, or has failed.
    pub fn wait(&self) {
        if let Some(writing) = self.writing().take() {
            // A thread that has failed has nothing more to say.
            let _ = writing.thread.join();
        }
    }

    /// Adds something that the person should know.
    pub fn tell(&self, text: String) {
        tell(&self.messages, text);
    }

    /// Returns the next message for the user, each once: that a history could not be written, or not be used.
    pub fn take_message(&self) -> Option<String> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).pop_front()
    }

    fn writing(&self) -> MutexGuard<'_, Option<Writing>> {
        self.writing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn tell(messages: &Mutex<VecDeque<String>>, text: String) {
    tracing::warn!("{text}");
    messages.lock().unwrap_or_else(PoisonError::into_inner).push_back(text);
}

impl Drop for SavedHistories {
    fn drop(&mut self) {
        self.wait();
    }
}
