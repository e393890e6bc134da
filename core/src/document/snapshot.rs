//! All that makes up a document between two strokes, as values: to be kept elsewhere, and to begin a
//! document with that goes on exactly as this one would have.
//!
//! Taking a snapshot shares contents, steps and clipboard. Loaded pictures are not in it: they belong to
//! files, which the session knows.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use super::{CommandError, Document, Limits};
use crate::command::{Command, SelectOp};
use crate::sculpture::clip::Clip;
use crate::sculpture::history::{Contents, History, HistorySnapshot, State, StepStore};

/// A document between two strokes.
#[derive(Clone, Debug)]
pub struct DocumentSnapshot {
    /// Bits and colours.
    pub contents: Arc<Contents>,
    /// The steps that can be undone and redone.
    pub history: HistorySnapshot,
    /// The clipboard.
    pub clip: Option<Arc<Clip>>,
    /// The commands that set placement, selection, symmetry and everything else that is no undo step, from a document
    /// where nothing is set.
    pub settings: Vec<Command>,
    /// The uses of tools that an array repeats.
    pub last_uses: Vec<Command>,
    /// Identifies the state.
    pub state: State,
    /// Number of states identified so far.
    pub states: u64,
}

impl Document {
    /// A snapshot; none while a stroke is open.
    pub fn snapshot(&self) -> Option<DocumentSnapshot> {
        (!self.stroke_open()).then(|| DocumentSnapshot {
            contents: self.contents.clone(),
            history: self.history.snapshot(),
            clip: self.clip.clone(),
            settings: self.settings(),
            last_uses: self.last_uses.clone(),
            state: self.state,
            states: self.states,
        })
    }

    /// A document that goes on where the snapshot was taken, and gives `store` the steps that memory has no room
    /// for.
    ///
    /// # Errors
    /// If a setting is refused, as those of another document may be.
    pub fn restored(
        snapshot: DocumentSnapshot,
        limits: Limits,
        store: Option<Arc<dyn StepStore>>,
    ) -> Result<Document, CommandError> {
        let DocumentSnapshot { contents, history, clip, settings, last_uses, state, states } =
            snapshot;
        let mut document = Document::from_contents(Arc::unwrap_or_clone(contents), limits);
        for command in &settings {
            document.apply(command)?;
        }
        document.history = History::restored(history, limits.history_bytes, store);
        document.clip = clip;
        document.last_uses = last_uses;
        (document.state, document.settled, document.states) = (state, state, states);
        Ok(document)
    }

    /// Goes on with the steps that another document had around the same contents, in the state `was`, on top of its
    /// own; there must be none to redo. All their states become states of this document. Returns what has become of
    /// each sculpture.
    pub fn adopt_history(&mut self, mut kept: HistorySnapshot, was: State) -> HashMap<u64, u64> {
        let mut sculptures = HashMap::from([(was.sculpture, self.state.sculpture)]);
        let mut states = HashMap::from([(was, self.state)]);
        for step in kept.undo.iter_mut().rev().chain(kept.redo.iter_mut().rev()) {
            let step = Arc::make_mut(step);
            step.state = match states.entry(step.state) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(unknown) => {
                    let number = self.new_state();
                    let own = unknown.key().sculpture;
                    let sculpture = *sculptures.entry(own).or_insert(number);
                    *unknown.insert(State { sculpture, number })
                }
            };
        }
        self.history.put_all(kept);
        sculptures
    }

    fn settings(&self) -> Vec<Command> {
        let mut settings = vec![Command::Place(self.placement), Command::Symmetry(self.symmetry)];
        for selected in self.selection.boxes() {
            let op = if selected.adds { SelectOp::Add } else { SelectOp::Subtract };
            settings.extend([Command::Mark(selected.bounds), Command::Select(op)]);
        }
        settings.push(Command::Mark(self.selection.marker()));
        settings.push(Command::Limit(self.selection.limits()));
        settings.push(Command::Irreversible(self.irreversible));
        settings
    }
}
