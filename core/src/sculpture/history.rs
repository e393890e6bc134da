//! Undo and redo: for each step the earlier values of the changed bricks, within a budget of bytes. Steps that exceed
//! the budget go to a store, if there is one, those furthest from the present first. Without a store, or if it is full,
//! they are dropped.
//!
//! A step is reversed by swapping its values with the sculpture's, so that undo and redo are the same operation and
//! both are exact to the byte. Knows no command and no document.

use std::collections::VecDeque;
use std::sync::Arc;

mod step;
mod store;

pub use super::contents::{Contents, SurfaceKind};
use super::memory::NoMemory;
use step::STUB_BYTES;
pub use step::{HistorySnapshot, State, Step, StepChange, StoredChange, StoredStep};
pub use store::StepStore;

/// Steps up to this size stay in memory: their placeholders would take as much memory.
const SMALL_BYTES: usize = 3 * STUB_BYTES;

/// The two lists of steps.
#[derive(Clone, Copy, PartialEq, Eq)]
enum HistoryStack {
    Undo,
    Redo,
}

impl HistoryStack {
    fn other(self) -> HistoryStack {
        match self {
            HistoryStack::Undo => HistoryStack::Redo,
            HistoryStack::Redo => HistoryStack::Undo,
        }
    }
}

/// The steps that can be undone and redone.
#[derive(Debug)]
pub struct History {
    /// Oldest first.
    undo: VecDeque<Arc<Step>>,
    /// The last to be redone first.
    redo: VecDeque<Arc<Step>>,
    bytes: usize,
    budget_bytes: usize,
    dropped: u64,
    /// Takes the steps that exceed the budget.
    store: Option<Arc<dyn StepStore>>,
}

impl History {
    /// Returns an empty history that keeps at most `budget_bytes`.
    pub fn new(budget_bytes: usize) -> History {
        let (undo, redo) = (VecDeque::new(), VecDeque::new());
        History { undo, redo, bytes: 0, budget_bytes, dropped: 0, store: None }
    }

    /// Returns a history with the steps of a snapshot, as many as fit into `budget_bytes` and the store.
    pub fn restored(
        snapshot: HistorySnapshot,
        budget_bytes: usize,
        store: Option<Arc<dyn StepStore>>,
    ) -> History {
        let mut history = History { store, ..History::new(budget_bytes) };
        history.put_all(snapshot);
        history
    }

    /// Puts the steps of a snapshot on top of the existing ones.
    pub(crate) fn put_all(&mut self, snapshot: HistorySnapshot) {
        snapshot.redo.into_iter().for_each(|step| self.put(step, HistoryStack::Redo));
        snapshot.undo.into_iter().for_each(|step| self.put(step, HistoryStack::Undo));
    }

    /// From now on, gives steps to a store instead of dropping them.
    pub(crate) fn use_store(&mut self, store: Arc<dyn StepStore>) {
        self.store = Some(store);
    }

    /// Returns the present steps.
    pub fn snapshot(&self) -> HistorySnapshot {
        HistorySnapshot {
            undo: self.undo.iter().cloned().collect(),
            redo: self.redo.iter().cloned().collect(),
        }
    }

    /// Adds a finished step and clears the redo list.
    pub fn push(&mut self, step: Step) {
        self.bytes -= self.redo.drain(..).map(|s| s.heap_bytes()).sum::<usize>();
        self.put(Arc::new(step), HistoryStack::Undo);
    }

    /// Returns whether the budget or the store can hold a step whose label and change take `bytes`.
    pub fn can_keep(&self, bytes: usize) -> bool {
        let stored = self.store.as_ref().map_or(0, |store| store.room_bytes());
        let bytes = bytes.saturating_add(size_of::<Step>());
        bytes <= self.budget_bytes || bytes as u64 <= stored
    }

    /// Waits, before a step of `bytes` is made, until earlier steps have left the memory that it needs.
    pub(crate) fn make_room(&self, bytes: usize) {
        if let Some(store) = self.store.as_ref().filter(|_| bytes > self.budget_bytes / 4) {
            store.make_room(bytes);
        }
    }

    /// Takes the step to undo next. The caller gives its reverse to [`History::undone`], or the step itself back to
    /// [`History::redone`].
    ///
    /// # Errors
    /// If a snapshot shares the step and the system lacks the memory for a copy; it stays where it was.
    pub fn take_undo(&mut self) -> Result<Option<Step>, NoMemory> {
        self.take(HistoryStack::Undo)
    }

    /// Takes the step to redo next. The caller gives its reverse to [`History::redone`], or the step itself back to
    /// [`History::undone`].
    ///
    /// # Errors
    /// As [`History::take_undo`].
    pub(crate) fn take_redo(&mut self) -> Result<Option<Step>, NoMemory> {
        self.take(HistoryStack::Redo)
    }

    fn take(&mut self, from: HistoryStack) -> Result<Option<Step>, NoMemory> {
        let Some(step) = self.stack(from).pop_back() else { return Ok(None) };
        let bytes = step.heap_bytes();
        let step = match Arc::try_unwrap(step) {
            Ok(step) => step,
            Err(shared) => match shared.copied() {
                Ok(step) => step,
                Err(error) => {
                    self.stack(from).push_back(shared);
                    return Err(error);
                }
            },
        };
        self.bytes -= bytes;
        Ok(Some(step))
    }

    /// Puts the reverse of an undone step on the redo stack.
    pub fn undone(&mut self, reverse: Step) {
        self.put(Arc::new(reverse), HistoryStack::Redo);
    }

    /// Puts the reverse of a redone step on the undo stack.
    pub fn redone(&mut self, reverse: Step) {
        self.put(Arc::new(reverse), HistoryStack::Undo);
    }

    /// Returns the number of steps that can be undone.
    pub fn undo_count(&self) -> usize {
        self.undo.len()
    }

    /// Returns the number of steps that can be redone.
    pub fn redo_count(&self) -> usize {
        self.redo.len()
    }

    /// Returns the labels of the steps that can be undone, oldest first.
    pub fn undo_labels(&self) -> impl Iterator<Item = &str> {
        self.undo.iter().map(|s| s.label.as_str())
    }

    /// Returns the labels of the steps that can be redone, the next one first.
    pub fn redo_labels(&self) -> impl Iterator<Item = &str> {
        self.redo.iter().rev().map(|s| s.label.as_str())
    }

    /// Returns the steps that can be undone, the next one first.
    pub fn undo_steps(&self) -> impl Iterator<Item = &Step> {
        self.undo.iter().rev().map(Arc::as_ref)
    }

    /// Returns the steps that can be redone, the next one first.
    pub(crate) fn redo_steps(&self) -> impl Iterator<Item = &Step> {
        self.redo.iter().rev().map(Arc::as_ref)
    }

    /// Returns the states that undo and redo can lead to.
    pub fn states(&self) -> impl Iterator<Item = State> {
        self.undo.iter().chain(&self.redo).map(|s| s.state)
    }

    /// Returns the bytes held by all steps.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Returns the budget of the steps in bytes.
    pub fn budget_bytes(&self) -> usize {
        self.budget_bytes
    }

    /// Raises the budget to `budget_bytes`, if that is more than now.
    pub(crate) fn raise_budget(&mut self, budget_bytes: usize) {
        self.budget_bytes = self.budget_bytes.max(budget_bytes);
    }

    /// Returns the number of steps dropped so far because the budget was full.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Returns the most bytes of steps that are not in a store. A quarter of the budget is for those on their way
    /// there.
    fn memory_bytes(&self) -> usize {
        self.budget_bytes - self.store.as_ref().map_or(0, |_| self.budget_bytes / 4)
    }

    /// Adds a step to the top of a stack. Then gives steps that exceed the memory to the store, and drops those that it
    /// does not take. Without a store, drops a step larger than the whole budget and all steps below it: callers check
    /// [`History::can_keep`] first.
    fn put(&mut self, mut step: Arc<Step>, to: HistoryStack) {
        if step.heap_bytes() > self.budget_bytes && !self.store_step(&mut step) {
            // The steps below it can only be reached through it.
            let dropped: Vec<_> = self.stack(to).drain(..).collect();
            self.dropped += 1 + dropped.len() as u64;
            self.bytes -= dropped.iter().map(|s| s.heap_bytes()).sum::<usize>();
            return;
        }
        self.bytes += step.heap_bytes();
        self.stack(to).push_back(step);
        loop {
            let stored = self.bytes > self.memory_bytes() && self.store_furthest(to);
            if !stored && (self.bytes <= self.budget_bytes || !self.drop_furthest(to)) {
                break;
            }
        }
    }

    /// Replaces a step by a placeholder, if the store takes the step.
    fn store_step(&self, step: &mut Arc<Step>) -> bool {
        let Some(store) = &self.store else { return false };
        let Ok(stored) = store.keep(step.clone()) else { return false };
        let (label, state) = (step.label.clone(), step.state);
        *step = Arc::new(Step { label, change: StepChange::Stored(stored), state });
        true
    }

    fn stack(&mut self, which: HistoryStack) -> &mut VecDeque<Arc<Step>> {
        match which {
            HistoryStack::Undo => &mut self.undo,
            HistoryStack::Redo => &mut self.redo,
        }
    }

    /// Gives the store the step furthest from the present that it can take; the top of `newest` comes last. Returns
    /// false if it takes none.
    fn store_furthest(&mut self, newest: HistoryStack) -> bool {
        if self.store.is_none() {
            return false;
        }
        let Some(top) = self.stack(newest).len().checked_sub(1) else { return false };
        let places = (0..top).map(|at| (newest, at));
        let others = (0..self.stack(newest.other()).len()).map(|at| (newest.other(), at));
        for (stack, at) in places.chain(others).chain([(newest, top)]) {
            let mut step = self.stack(stack)[at].clone();
            let before = step.heap_bytes();
            // Small steps, such as those that are recomputed, take less memory than their placeholders.
            if matches!(step.change, StepChange::Stored(_)) || before <= SMALL_BYTES {
                continue;
            }
            let stored = self.store_step(&mut step);
            if stored {
                self.bytes = self.bytes - before + step.heap_bytes();
                self.stack(stack)[at] = step;
            }
            return stored;
        }
        false
    }

    /// Drops the step furthest from the present; the top of `newest` comes last. Returns false if there is none.
    fn drop_furthest(&mut self, newest: HistoryStack) -> bool {
        let from = match self.stack(newest).len() {
            0 | 1 if !self.stack(newest.other()).is_empty() => newest.other(),
            _ => newest,
        };
        let Some(furthest) = self.stack(from).pop_front() else { return false };
        self.bytes -= furthest.heap_bytes();
        self.dropped += 1;
        true
    }
}

#[cfg(test)]
mod tests;
