//! The undo steps of a document and the states that they lead to: the present state, the number of states identified so
//! far, and whether the history can keep another step.
//!
//! Takes finished changes as steps. [`travel`] moves along them, on the contents that it is given. Knows no editing
//! command and no stroke.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use super::CommandError;
use crate::sculpture::history::{
    Contents, History, HistorySnapshot, State, Step, StepChange, StepStore,
};

mod travel;

pub(super) use travel::Direction;

/// The undo steps of a document, and its position among them.
#[derive(Debug)]
pub(super) struct Timeline {
    history: History,
    /// The current state, and the state after the last step: they differ within a stroke.
    state: State,
    settled: State,
    /// Number of states identified so far.
    pub states: u64,
    /// Whether steps that the history cannot keep are allowed.
    pub irreversible: bool,
}

impl Timeline {
    /// Creates an empty timeline that keeps at most `budget_bytes` of steps.
    pub fn new(budget_bytes: usize) -> Timeline {
        Timeline {
            history: History::new(budget_bytes),
            state: State::default(),
            settled: State::default(),
            states: 0,
            irreversible: false,
        }
    }

    /// Continues with the steps of another timeline, in its state `state` after `states` states.
    pub fn restore(&mut self, history: History, state: State, states: u64) {
        self.history = history;
        (self.state, self.settled, self.states) = (state, state, states);
    }

    pub fn history(&self) -> &History {
        &self.history
    }

    pub fn state(&self) -> State {
        self.state
    }

    /// Moves steps for which memory has no room to a store from now on.
    pub fn use_store(&mut self, store: Arc<dyn StepStore>) {
        self.history.use_store(store);
    }

    /// Raises the budget of the steps to `budget_bytes`, if that is more than now.
    pub fn raise_budget(&mut self, budget_bytes: usize) {
        self.history.raise_budget(budget_bytes);
    }

    /// Returns an error if the history cannot keep a step and irreversible steps are not allowed.
    pub fn require_room(&self, label: &str, bytes: usize) -> Result<(), CommandError> {
        let bytes = bytes.saturating_add(label.len());
        if self.irreversible || self.history.can_keep(bytes) {
            self.history.make_room(bytes);
            return Ok(());
        }
        Err(CommandError::Irreversible {
            step: label.to_string(),
            needed_mib: bytes.div_ceil(1 << 20),
            budget_mib: self.history.budget_bytes() >> 20,
        })
    }

    fn new_state(&mut self) -> u64 {
        self.states += 1;
        self.states
    }

    /// Enters a new state after a change.
    pub fn enter_new_state(&mut self) {
        self.state.number = self.new_state();
    }

    /// Returns to the state after the last step: all changes since have been reverted.
    pub fn return_to_settled(&mut self) {
        self.state = self.settled;
    }

    /// Makes an undo step of the recorded edits that have led to the current state, if there are any.
    pub fn push_edits(&mut self, label: String, edits: Option<StepChange>) {
        if let Some(change) = edits {
            self.settle(label, change);
        }
    }

    /// Adds a step for a change of the whole sculpture.
    pub fn push_change(&mut self, label: String, change: StepChange) {
        self.enter_new_state();
        self.settle(label, change);
    }

    /// Adds a step for the replacement of the sculpture `old`.
    pub fn push_replacement(&mut self, label: String, old: Box<Contents>) {
        let number = self.new_state();
        self.state = State { sculpture: number, number };
        self.settle(label, StepChange::Whole(old));
    }

    fn settle(&mut self, label: String, change: StepChange) {
        let state = std::mem::replace(&mut self.settled, self.state);
        self.history.push(Step { label, change, state });
    }

    /// Puts the steps of another timeline, which was in the state `was`, on top of its own. All states of the other
    /// become states of this one. Returns the new number of each sculpture.
    pub fn adopt(&mut self, mut kept: HistorySnapshot, was: State) -> HashMap<u64, u64> {
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
}
