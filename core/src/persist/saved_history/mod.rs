//! The undo history of saved files: one file each in a state folder, so that undo and redo continue after a sculpture
//! has been closed and reopened, and recipients of the sculpture do not get its past.
//!
//! A history is found by the SHA-256 of the sculpture's file, and holds the hash of the contents for which it was kept;
//! it is used only if those match. A separate thread packs and writes. The total size of all histories is bounded; the
//! most recent ones stay. `file` defines the contents of such a file, `dir` is the folder. Knows no session.

mod dir;
mod file;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use dir::HistoryDir;
pub use dir::{FoundHistory, SavedHistoryOptions};
pub use file::{HistoryToKeep, KeptSteps, SavedHistory};

use crate::format::store::explained;
use crate::sculpture::history::Contents;
use crate::sculpture::{Digest, Limits};

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
    /// Creates it; nothing is written yet.
    pub fn new(options: SavedHistoryOptions) -> SavedHistories {
        SavedHistories { options, writing: Mutex::default(), messages: Arc::default() }
    }

    /// Returns the options.
    pub fn options(&self) -> &SavedHistoryOptions {
        &self.options
    }

    /// Writes a history on a thread, without waiting. A pending write for the same file is abandoned, since the file
    /// has changed. A pending write for another file is completed first.
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

    /// Returns the history of the file with this hash, read from it as `contents`. Waits for pending writes. Steps are
    /// restored as far as [`Limits::history_bytes`] has room for them.
    pub fn find(&self, file_hash: Digest, contents: &Contents, limits: &Limits) -> FoundHistory {
        self.wait();
        HistoryDir::new(&self.options).find(file_hash, contents, limits)
    }

    /// Waits until the given histories are written, or have failed.
    pub fn wait(&self) {
        if let Some(writing) = self.writing().take() {
            // A failed thread has nothing more to report.
            let _ = writing.thread.join();
        }
    }

    /// Adds a message for the user.
    pub fn tell(&self, text: String) {
        tell(&self.messages, text);
    }

    /// Returns the next message for the user, each once: that a history could not be written, or not be used.
    pub(crate) fn take_message(&self) -> Option<String> {
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
