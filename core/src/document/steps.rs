//! The undo steps of a document: creating them, checking them against the history's budget, undo and
//! redo.

use super::{Applied, CommandError, Document};
use crate::sculpture::edit::EditStats;
use crate::sculpture::history::{Change, Step};

impl Document {
    /// Makes an undo step of the recorded changes, if there are any.
    pub(super) fn finish_stroke(&mut self, label: String) {
        let record = self.recorder.finish();
        if !record.is_empty() {
            let state = std::mem::replace(&mut self.settled, self.state);
            self.history.push(Step { label, change: Change::Bricks(record), state });
        }
    }

    pub(super) fn new_state(&mut self) -> u64 {
        self.states += 1;
        self.states
    }

    /// Reverts the recorded changes.
    pub(super) fn take_back(&mut self) {
        let record = self.recorder.finish();
        self.swap_bricks(record);
        self.state = self.settled;
    }

    /// An error if the history cannot keep a step and that is not allowed.
    pub(super) fn require_room(&self, label: &str, bytes: usize) -> Result<(), CommandError> {
        let bytes = bytes.saturating_add(label.len());
        if self.irreversible || self.history.can_keep(bytes) {
            return Ok(());
        }
        Err(CommandError::Irreversible {
            step: label.to_string(),
            needed_mib: bytes.div_ceil(1 << 20),
            budget_mib: self.history.budget_bytes() >> 20,
        })
    }

    /// An error if the history cannot keep the whole sculpture, to replace it, and that is not allowed.
    pub fn require_room_for_whole(&self, label: &str) -> Result<(), CommandError> {
        self.require_room(label, self.contents.kept_bytes())
    }

    pub(super) fn travel(
        &mut self,
        steps: Option<u32>,
        verb: &'static str,
        step: impl Fn(&mut Self) -> Result<bool, CommandError>,
    ) -> Result<Applied, CommandError> {
        self.require_no_stroke(verb)?;
        let mut done = 0;
        while steps.is_none_or(|limit| done < limit) {
            match step(self) {
                Ok(true) => done += 1,
                Ok(false) => break,
                Err(error) if done == 0 => return Err(error),
                // Earlier steps stay undone; the caller learns of the rest.
                Err(_) => break,
            }
        }
        self.last_uses.clear();
        Ok(Applied { stats: EditStats::default(), steps: done })
    }

    pub(super) fn undo_step(&mut self) -> Result<bool, CommandError> {
        let Some(step) = self.history.take_undo() else { return Ok(false) };
        let (step, refused) = self.reverse_if_kept(step, "undo");
        match refused {
            None => self.history.undone(step),
            Some(error) => {
                self.history.redone(step);
                return Err(error);
            }
        }
        Ok(true)
    }

    pub(super) fn redo_step(&mut self) -> Result<bool, CommandError> {
        let Some(step) = self.history.take_redo() else { return Ok(false) };
        let (step, refused) = self.reverse_if_kept(step, "redo");
        match refused {
            None => self.history.redone(step),
            Some(error) => {
                self.history.undone(step);
                return Err(error);
            }
        }
        Ok(true)
    }

    /// Swaps a step's values with the sculpture's and returns the reverse step. If the history cannot
    /// keep that, nothing has changed and the step itself is returned.
    fn reverse_if_kept(&mut self, step: Step, verb: &str) -> (Step, Option<CommandError>) {
        let bytes = match &step.change {
            Change::Bricks(record) => record.reverse_bytes(&self.contents),
            Change::Whole(_) => self.contents.kept_bytes(),
            Change::Oriented { before: Some(_), .. } => 0,
            Change::Oriented { back, before: None } => self.bytes_to_undo(*back),
        };
        match self.require_room(&format!("{verb} {}", step.label), bytes) {
            Ok(()) => self.reverse(step),
            Err(error) => (step, Some(error)),
        }
    }

    fn reverse(&mut self, step: Step) -> (Step, Option<CommandError>) {
        let Step { label, change, state } = step;
        let change = match change {
            Change::Bricks(record) => Change::Bricks(self.swap_bricks(record)),
            Change::Whole(contents) => Change::Whole(Box::new(self.swap_contents(*contents))),
            Change::Oriented { back, before } => match self.reverse_orientation(back, before) {
                Ok(change) => change,
                Err(error) => {
                    let change = Change::Oriented { back, before: None };
                    return (Step { label, change, state }, Some(error));
                }
            },
        };
        let state = std::mem::replace(&mut self.state, state);
        self.settled = self.state;
        (Step { label, change, state }, None)
    }
}
