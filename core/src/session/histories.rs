//! The undo histories of a session on the disk: the steps that memory has no room for, and the histories of saved
//! files, kept when a file is saved and found when it is opened.
//!
//! Steps of a saved history come on top of those that the session has: an `open` that was undone as such is then below
//! them. Knows no session.

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

/// The undo histories of a session on the disk; none unless they are asked for.
#[derive(Debug, Default)]
pub(super) struct Histories {
    /// Where the undo steps go that memory has no room for.
    spill: Option<Arc<Spill>>,
    /// The undo histories of saved files.
    saved: Option<Arc<SavedHistories>>,
}

impl Histories {
    /// Those of a session that puts undo steps that memory has no room for in a folder, if the limits allow that.
    pub(crate) fn with_steps_in(folder: &Path, limits: &Limits) -> std::io::Result<Histories> {
        let mut histories = Histories::default();
        histories.keep_steps_in(folder, limits)?;
        Ok(histories)
    }

    /// Puts undo steps that memory has no room for in a folder, if the limits allow that: [`Histories::step_store`].
    pub(crate) fn keep_steps_in(&mut self, folder: &Path, limits: &Limits) -> std::io::Result<()> {
        self.spill = match limits.history_disk_bytes {
            0 => None,
            bytes => Some(Arc::new(Spill::new(folder, bytes, limits.history_bytes / 4)?)),
        };
        Ok(())
    }

    /// Where the steps lie that memory has no room for.
    pub fn step_store(&self) -> Option<Arc<dyn StepStore>> {
        self.spill.clone().map(|spill| spill as Arc<dyn StepStore>)
    }

    /// Keeps the histories of the files that are saved from now on.
    pub(crate) fn keep_saved(&mut self, options: SavedHistoryOptions) {
        self.saved = Some(Arc::new(SavedHistories::new(options)));
    }

    /// The histories of saved files, if they are kept.
    pub fn saved(&self) -> Option<&Arc<SavedHistories>> {
        self.saved.as_ref()
    }

    /// Returns the message for the user, each once.
    pub(crate) fn take_message(&self) -> Option<String> {
        let of_saved = self.saved.as_ref().and_then(|saved| saved.take_message());
        of_saved.or_else(|| self.spill.as_ref()?.take_message())
    }

    /// The steps that a save is to keep. Within a stroke there are none.
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

    /// Adds the history of the file that has just been opened to that of the document. Whether there is one.
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

/// Finds the history that is kept for a file that was read as `contents`.
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
