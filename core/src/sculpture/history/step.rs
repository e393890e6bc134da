//! The parts of a history: the change of a step, steps, the placeholders of stored ones, and a snapshot of all steps.
//!
//! Knows no store and no limit of memory.

use std::fmt::Debug;
use std::sync::Arc;

use crate::sculpture::canvas_frame::Canvas;
use crate::sculpture::contents::{Contents, SurfaceKind};
use crate::sculpture::memory::NoMemory;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::record::BrickRecord;

/// Bytes that a step takes of the budget while a store keeps its values.
pub(super) const STUB_BYTES: usize = 256;

/// The change made by one step.
#[derive(Clone, PartialEq, Debug)]
pub enum StepChange {
    /// Some bricks of the sculpture.
    Bricks(BrickRecord),
    /// The whole sculpture, replaced by a new or opened one.
    Whole(Box<Contents>),
    /// The whole sculpture was reoriented, and `back` reverses that. `before` is kept only if `back` would not restore
    /// every byte.
    Oriented {
        /// The inverse of the orientation that was applied.
        back: Orientation,
        /// The sculpture as it was.
        before: Option<Box<Contents>>,
    },
    /// The kind of surface before the change.
    Surface(SurfaceKind),
    /// The box of the sculpture was moved, and `back` reverses that. `before` is kept only if something was cut off.
    Canvas {
        /// The box as it was.
        back: Canvas,
        /// The sculpture as it was.
        before: Option<Box<Contents>>,
    },
    /// Some of the above, in the order in which they were made: edits with the growth that they needed.
    Several(Vec<StepChange>),
    /// One of the above, kept by a [`super::StepStore`].
    Stored(StoredChange),
}

impl StepChange {
    /// Returns the bytes that the change takes of the history's budget.
    pub(crate) fn heap_bytes(&self) -> usize {
        match self {
            StepChange::Bricks(record) => record.heap_bytes(),
            StepChange::Whole(old) => old.kept_bytes(),
            StepChange::Oriented { before, .. } | StepChange::Canvas { before, .. } => {
                before.as_ref().map_or(0, |old| old.kept_bytes())
            }
            StepChange::Surface(_) => 0,
            StepChange::Several(parts) => {
                parts.iter().map(|part| size_of::<StepChange>() + part.heap_bytes()).sum()
            }
            StepChange::Stored(_) => STUB_BYTES,
        }
    }

    fn copied(&self) -> Result<StepChange, NoMemory> {
        Ok(match self {
            StepChange::Bricks(record) => {
                let no_memory = |_| NoMemory { bytes: record.heap_bytes() as u64 };
                StepChange::Bricks(record.copied().map_err(no_memory)?)
            }
            StepChange::Several(parts) => {
                StepChange::Several(parts.iter().map(StepChange::copied).collect::<Result<_, _>>()?)
            }
            StepChange::Whole(_)
            | StepChange::Oriented { .. }
            | StepChange::Canvas { .. }
            | StepChange::Surface(_)
            | StepChange::Stored(_) => self.clone(),
        })
    }
}

/// Identifies a state of a document. Undo and redo restore the identifier with the state, so that anything that belongs
/// to a state, such as its file, can be looked up by it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct State {
    /// Differs for each sculpture that was created or opened.
    pub sculpture: u64,
    /// Differs after each change.
    pub number: u64,
}

/// A named, reversible change.
#[derive(Clone, PartialEq, Debug)]
pub struct Step {
    /// Name of the change, as the history list shows it.
    pub label: String,
    /// The values to swap with the sculpture's.
    pub change: StepChange,
    /// The state after reversing the step.
    pub state: State,
}

impl Step {
    /// Returns a copy, unless the system lacks the memory for it.
    pub fn copied(&self) -> Result<Step, NoMemory> {
        let change = self.change.copied()?;
        Ok(Step { label: self.label.clone(), change, state: self.state })
    }

    /// Returns the bytes that the step takes of the history's budget.
    pub fn heap_bytes(&self) -> usize {
        size_of::<Step>() + self.label.len() + self.change.heap_bytes()
    }

    /// Returns the bytes that the step takes with all its values in memory.
    pub(crate) fn whole_bytes(&self) -> usize {
        match &self.change {
            StepChange::Stored(stored) => stored.0.whole_bytes(),
            _ => self.heap_bytes(),
        }
    }
}

/// A step in a store. Its space there is free again once the last owner is gone.
pub trait StoredStep: Debug + Send + Sync {
    /// Returns the change, to be reversed from `contents`, equal to the stored one to the byte. `is_last`: it will not
    /// be needed again. After an error the step remains stored.
    ///
    /// # Errors
    /// If it cannot be read or is damaged; the text is part of a sentence.
    fn load(&self, contents: &Contents, is_last: bool) -> Result<StepChange, String>;
    /// Returns the step as `format::history` writes it.
    ///
    /// # Errors
    /// As [`StoredStep::load`].
    fn packed(&self) -> Result<Vec<u8>, String>;
    /// Returns the bytes that the step takes in memory.
    fn whole_bytes(&self) -> usize;
}

/// The placeholder of a step in a store. Equal only to itself.
#[derive(Clone, Debug)]
pub struct StoredChange(pub Arc<dyn StoredStep>);

impl StoredChange {
    /// Returns whether no snapshot shares it.
    pub(crate) fn is_only(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }
}

impl PartialEq for StoredChange {
    fn eq(&self, other: &StoredChange) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// The steps that can be undone and redone at one moment. Steps are shared, so taking a snapshot copies no values; a
/// step that is undone while it is shared is copied then.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct HistorySnapshot {
    /// Oldest first.
    pub undo: Vec<Arc<Step>>,
    /// The last to be redone first.
    pub redo: Vec<Arc<Step>>,
}

impl HistorySnapshot {
    /// Drops the steps furthest from the current state until the rest takes at most `bytes`. Returns how many steps
    /// were dropped from each list.
    pub(crate) fn shorten(&mut self, bytes: usize) -> [usize; 2] {
        let mut left = bytes;
        [&mut self.undo, &mut self.redo].map(|steps| {
            let fits = |step: &&Arc<Step>| {
                let rest = left.checked_sub(step.whole_bytes());
                left = rest.unwrap_or(0);
                rest.is_some()
            };
            let kept = steps.iter().rev().take_while(fits).count();
            let dropped = steps.len() - kept;
            steps.drain(..dropped);
            dropped
        })
    }
}
