//! The complete state of a document between two strokes, as values: to store it, and to create a document that
//! continues exactly as this one would.
//!
//! Taking a snapshot shares contents, steps and clipboard. Loaded pictures are not part of it: they belong to files,
//! which the session knows.

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
    /// The commands that restore placement, selection, symmetry and all other state outside undo steps, in a document
    /// where nothing is set.
    pub settings: Vec<Command>,
    /// The uses of tools that an array repeats.
    pub last_uses: Vec<Command>,
    /// Identifies the state.
    pub state: State,
    /// Number of states identified so far.
    pub states: u64,
}

impl DocumentSnapshot {
    /// Takes a snapshot of a document without an open stroke.
    pub(super) fn of(document: &Document) -> DocumentSnapshot {
        DocumentSnapshot {
            contents: document.target.contents.clone(),
            history: document.timeline.history().snapshot(),
            clip: document.clip.clone(),
            settings: settings_of(document),
            last_uses: document.strokes.last_uses().to_vec(),
            state: document.timeline.state(),
            states: document.timeline.states,
        }
    }

    pub(super) fn into_document(
        self,
        limits: Limits,
        store: Option<Arc<dyn StepStore>>,
    ) -> Result<Document, CommandError> {
        let DocumentSnapshot { contents, history, clip, settings, last_uses, state, states } = self;
        let mut document = Document::from_contents(Arc::unwrap_or_clone(contents), limits);
        for command in &settings {
            document.apply(command)?;
        }
        let history = History::restored(history, limits.history_bytes, store);
        document.timeline.restore(history, state, states);
        document.clip = clip;
        document.strokes.set_last_uses(last_uses);
        Ok(document)
    }
}

fn settings_of(document: &Document) -> Vec<Command> {
    let (selection, origin) = (document.selection(), document.origin());
    let mut settings =
        vec![Command::Place(document.placement), Command::Symmetry(document.symmetry())];
    for selected in selection.boxes() {
        let op = if selected.adds { SelectOp::Add } else { SelectOp::Subtract };
        settings.extend([Command::Mark(selected.bounds.shifted(origin)), Command::Select(op)]);
    }
    settings.push(Command::Mark(selection.marker().shifted(origin)));
    settings.push(Command::Limit(selection.limits()));
    settings.push(Command::Irreversible(document.timeline.irreversible));
    settings
}
