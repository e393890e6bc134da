//! The undo history of saved files in a session: kept when a file is saved, found when it is opened.
//!
//! Steps come on top of those that the session has: an `open` that was undone as such is then below them.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::Session;
use super::on_disk::FileIdentity;
use crate::document::{DocumentSnapshot, Limits};
use crate::persist::SculptureFile;
use crate::persist::saved_history::{
    Found, HistoryToKeep, KeptSteps, SavedHistories, SavedHistory, SavedHistoryOptions,
};
use crate::sculpture::Digest;
use crate::sculpture::history::{Contents, StepStore};

impl Session {
    /// Keeps the undo histories of the files that are saved from now on, and goes on with those of the files that are
    /// opened. If the session began with a file, with that of this file, too: to be called before a journal or a
    /// recording begins, and after [`Session::keep_history_in`].
    pub fn keep_saved_histories(&mut self, options: SavedHistoryOptions) {
        let histories = Arc::new(SavedHistories::new(options));
        self.histories = Some(histories.clone());
        let history = self.document.history();
        let is_untouched = history.undo_count() + history.redo_count() == 0 && !self.modified();
        let identity = self.path().and_then(|path| self.on_disk.known(path));
        if is_untouched && identity.is_some() {
            let (contents, limits) = (self.document.contents(), self.document.limits());
            let found = find(Some(&histories), identity, contents, limits);
            self.go_on_with(found);
        }
    }

    /// All steps with what they have led to, and where those of them lie that memory has no room for; none within a
    /// stroke.
    pub fn steps(&self) -> Option<(DocumentSnapshot, Option<Arc<dyn StepStore>>)> {
        let store = self.spill.clone().map(|spill| spill as Arc<dyn StepStore>);
        Some((self.document.snapshot()?, store))
    }

    /// How the histories of saved files are kept, if they are.
    pub fn saved_history_options(&self) -> Option<&SavedHistoryOptions> {
        self.histories.as_deref().map(SavedHistories::options)
    }

    /// Waits until the history of the file that was saved last is written.
    pub fn wait_for_saved_history(&self) {
        if let Some(histories) = &self.histories {
            histories.wait();
        }
    }

    /// The steps that a save is to keep. Within a stroke there are none.
    pub(super) fn steps_to_keep(&self) -> Option<KeptSteps> {
        self.histories.as_ref()?;
        Some(KeptSteps::of(self.document.snapshot()?, self.files.all()))
    }

    /// Writes the history of a file that has been saved.
    pub(super) fn keep_saved_history(&self, history: Option<HistoryToKeep>) {
        if let (Some(histories), Some(history)) = (&self.histories, history) {
            histories.keep(history);
        }
    }

    /// Goes on with the history of the file that has just been opened.
    pub(super) fn go_on_with(&mut self, found: Found) {
        let SavedHistory { history, state, files } = match found {
            Found::Nothing => return,
            Found::Unusable(why) => {
                if let Some(histories) = &self.histories {
                    let path = self.path().map(|path| path.display().to_string());
                    let name = path.unwrap_or_default();
                    histories.tell(format!(
                        "the undo history of {name} is left out: {why}; the sculpture itself is whole"
                    ));
                }
                return;
            }
            Found::History(history) => history,
        };
        let sculptures: HashMap<u64, u64> = self.document.adopt_history(history, state);
        for file in files {
            if let Some(&sculpture) = sculptures.get(&file.sculpture) {
                self.files.add(SculptureFile { sculpture, ..file });
            }
        }
        // Neither a journal nor a recording can repeat it: they go on from what is now.
        if let Some(recording) = &mut self.recording {
            recording.fall_behind();
        }
        if let Some(journal) = &mut self.journal {
            journal.note_gap();
        }
    }
}

/// Finds the history that is kept for a file that was read as `contents`.
pub(super) fn find(
    histories: Option<&SavedHistories>,
    identity: Option<FileIdentity>,
    contents: &Contents,
    limits: &Limits,
) -> Found {
    match (histories, identity) {
        (Some(histories), Some(identity)) => histories.find(identity.hash, contents, limits),
        _ => Found::Nothing,
    }
}

/// The history to keep for a file that has been saved.
pub(super) fn to_keep(
    steps: Option<KeptSteps>,
    path: &Path,
    identity: Option<FileIdentity>,
    contents: &Contents,
) -> Option<HistoryToKeep> {
    let (steps, file_hash) = (steps?, identity?.hash);
    // Without steps nothing is written, and the hash is not needed.
    let contents_hash = if steps.is_empty() { file_hash } else { Digest::of(contents) };
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    Some(HistoryToKeep { path, file_hash, contents_hash, steps })
}
