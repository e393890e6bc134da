//! The undo histories of a session on disk: steps for which memory has no room, and the histories of saved files, kept
//! when a file is saved and found when it is opened.
//!
//! Steps of a saved history are put on top of the session's own, so that an undone `open` lies below them. Knows no
//! session.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::files::SculptureFiles;
use super::on_disk::FileIdentity;
use crate::document::{Document, Limits};
use crate::persist::SculptureFile;
use crate::persist::saved_history::{
    FoundHistory, HistoryToKeep, KeptSteps, SavedHistories, SavedHistory, SavedHistoryOptions,
};
use crate::persist::spill::Spill;
use crate::sculpture::Digest;
use crate::sculpture::history::{Contents, StepStore};

/// The undo histories of a session on disk; none by default.
#[derive(Debug, Default)]
pub(super) struct Histories {
    /// The store for undo steps for which memory has no room.
    spill: Option<Arc<Spill>>,
    /// The undo histories of saved files.
    saved: Option<Arc<SavedHistories>>,
}

impl Histories {
    /// Creates the histories of a session that moves undo steps for which memory has no room to a folder, if the limits
    /// allow that.
    pub(crate) fn with_steps_in(folder: &Path, limits: &Limits) -> std::io::Result<Histories> {
        let mut histories = Histories::default();
        histories.keep_steps_in(folder, limits)?;
        Ok(histories)
    }

    /// Moves undo steps for which memory has no room to a folder, if the limits allow that: [`Histories::step_store`].
    pub(crate) fn keep_steps_in(&mut self, folder: &Path, limits: &Limits) -> std::io::Result<()> {
        self.spill = match limits.history_disk_bytes {
            0 => None,
            bytes => Some(Arc::new(Spill::new(folder, bytes, limits.history_bytes / 4)?)),
        };
        Ok(())
    }

    /// Returns the store for steps for which memory has no room.
    pub fn step_store(&self) -> Option<Arc<dyn StepStore>> {
        self.spill.clone().map(|spill| spill as Arc<dyn StepStore>)
    }

    /// Keeps the histories of the files that are saved from now on.
    pub(crate) fn keep_saved(&mut self, options: SavedHistoryOptions) {
        self.saved = Some(Arc::new(SavedHistories::new(options)));
    }

    /// Returns the histories of saved files, if they are kept.
    pub fn saved(&self) -> Option<&Arc<SavedHistories>> {
        self.saved.as_ref()
    }

    /// Returns the messages for the user, each once.
    pub(crate) fn take_message(&self) -> Option<String> {
        let of_saved = self.saved.as_ref().and_then(|saved| saved.take_message());
        of_saved.or_else(|| self.spill.as_ref()?.take_message())
    }

    /// Returns the steps to keep with a save; none within a stroke.
    pub(crate) fn steps_to_keep(
        &self,
        document: &Document,
        files: &SculptureFiles,
    ) -> Option<KeptSteps> {
        self.saved.as_ref()?;
        Some(KeptSteps::of(document.snapshot()?, files.all()))
    }

    /// Writes the history of a file that has been saved.
    pub fn keep(&self, history: Option<HistoryToKeep>) {
        if let (Some(saved), Some(history)) = (&self.saved, history) {
            saved.keep(history);
        }
    }

    /// Adds the history of the file that has just been opened to the document's. Returns whether there is one.
    pub(crate) fn adopt(
        &self,
        found: FoundHistory,
        document: &mut Document,
        files: &mut SculptureFiles,
    ) -> bool {
        let SavedHistory { history, state, files: texts } = match found {
            FoundHistory::Nothing => return false,
            FoundHistory::Unusable(why) => {
                if let Some(saved) = &self.saved {
                    let path = files.path(document.state()).map(|path| path.display().to_string());
                    let name = path.unwrap_or_default();
                    saved.tell(format!(
                        "the undo history of {name} is left out: {why}; the sculpture itself is whole"
                    ));
                }
                return false;
            }
            FoundHistory::History(history) => history,
        };
        let sculptures: HashMap<u64, u64> = document.adopt_history(history, state);
        for file in texts {
            if let Some(&sculpture) = sculptures.get(&file.sculpture) {
                files.add(SculptureFile { sculpture, ..file });
            }
        }
        true
    }
}

/// Finds the history kept for a file that was read as `contents`.
pub(super) fn find(
    histories: Option<&SavedHistories>,
    identity: Option<FileIdentity>,
    contents: &Contents,
    limits: &Limits,
) -> FoundHistory {
    match (histories, identity) {
        (Some(histories), Some(identity)) => histories.find(identity.hash, contents, limits),
        _ => FoundHistory::Nothing,
    }
}

/// Returns the history to keep for a file that has been saved.
pub(super) fn to_keep(
    steps: Option<KeptSteps>,
    path: &Path,
    identity: Option<FileIdentity>,
    contents: &Contents,
) -> Option<HistoryToKeep> {
    let (steps, file_hash) = (steps?, identity?.hash);
    // Without steps, nothing is written and the hash is not needed.
    let contents_hash = if steps.is_empty() { file_hash } else { Digest::of(contents) };
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    Some(HistoryToKeep { path, file_hash, contents_hash, steps })
}
