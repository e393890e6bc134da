//! The undo history of saved files: a file for each in a folder for state, so that undo and redo go on after a
//! sculpture has been closed and opened again, and nobody who is given the sculpture gets its past.
//!
//! A history is found by the SHA-256 of the sculpture's file, and holds the hash of the contents that it was kept
//! with: it fits those or is left out. A thread of its own packs and writes; the bytes of all histories together are
//! bounded, those written last stay. `file` is what such a file holds, `dir` the folder. Knows no session.

mod dir;
mod file;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use dir::HistoryDir;
pub use dir::{Found, SavedHistoryOptions};
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
    /// Nothing is written yet.
    pub fn new(options: SavedHistoryOptions) -> SavedHistories {
        SavedHistories { options, writing: Mutex::default(), messages: Arc::default() }
    }

    /// Returns how they are kept.
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

    /// Returns the history of the file with this hash, read from it as `contents`. Waits for what is being written.
    /// Steps come back as far as [`Limits::history_bytes`] has room for them.
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
