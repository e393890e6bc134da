//! The undo steps of a document: creating them, checking them against the history's budget, undo and
//! redo.

use super::{Applied, CommandError, Document};
use crate::command::Command;
use crate::sculpture::edit::EditStats;
use crate::sculpture::history::{Change, Contents, Step};
use crate::sculpture::orientation::Orientation;

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
            self.history.make_way(bytes);
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

    /// The part of an undo or redo that is carried out in one go: the steps before one for which the
    /// history keeps no values, so that the sculpture must be laid another way, or that step alone.
    /// Other commands are a whole.
    pub fn first_step(&self, command: &Command) -> Command {
        match (command, self.next_computed(command)) {
            (Command::Undo { .. }, Some((before, ..))) => {
                Command::Undo { steps: Some(before.max(1)) }
            }
            (Command::Redo { .. }, Some((before, ..))) => {
                Command::Redo { steps: Some(before.max(1)) }
            }
            _ => command.clone(),
        }
    }

    /// How the next step of an undo or redo lays the sculpture, if that must be computed. Refused where
    /// the command would be.
    pub fn next_orientation(&self, command: &Command) -> Result<Option<Orientation>, CommandError> {
        let Some((0, step, orientation)) = self.next_computed(command) else { return Ok(None) };
        let verb = command.verb();
        self.require_no_stroke(verb)?;
        let bytes = self.bytes_to_undo(orientation);
        self.require_room(&format!("{verb} {}", step.label), bytes)?;
        Ok(Some(orientation))
    }

    /// The first step of an undo or redo that must be computed, and how many come before it.
    fn next_computed(&self, command: &Command) -> Option<(u32, &Step, Orientation)> {
        let (steps, next): (_, &mut dyn Iterator<Item = &Step>) = match command {
            Command::Undo { steps } => (steps, &mut self.history.undo_steps()),
            Command::Redo { steps } => (steps, &mut self.history.redo_steps()),
            _ => return None,
        };
        next.zip(0..steps.unwrap_or(u32::MAX)).find_map(|(step, before)| match step.change {
            Change::Oriented { back, before: None } => Some((before, step, back)),
            _ => None,
        })
    }

    /// Carries out the next step of an undo or redo with the contents that were computed for it.
    pub fn travel_oriented(
        &mut self,
        command: &Command,
        contents: Contents,
    ) -> Result<Applied, CommandError> {
        let mut contents = Some(contents);
        match command {
            Command::Redo { .. } => {
                self.travel(Some(1), "redo", |document| document.redo_step(contents.take()))
            }
            _ => self.travel(Some(1), "undo", |document| document.undo_step(contents.take())),
        }
    }

    pub(super) fn travel(
        &mut self,
        steps: Option<u32>,
        verb: &'static str,
        mut step: impl FnMut(&mut Self) -> Result<bool, CommandError>,
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

    pub(super) fn undo_step(&mut self, oriented: Option<Contents>) -> Result<bool, CommandError> {
        let taken = self.history.take_undo().map_err(|error| self.no_memory(error))?;
        let Some(step) = taken else { return Ok(false) };
        let (step, refused) = self.reverse_if_kept(step, "undo", oriented);
        match refused {
            None => self.history.undone(step),
            Some(error) => {
                self.history.redone(step);
                return Err(error);
            }
        }
        Ok(true)
    }

    pub(super) fn redo_step(&mut self, oriented: Option<Contents>) -> Result<bool, CommandError> {
        let taken = self.history.take_redo().map_err(|error| self.no_memory(error))?;
        let Some(step) = taken else { return Ok(false) };
        let (step, refused) = self.reverse_if_kept(step, "redo", oriented);
        match refused {
            None => self.history.redone(step),
            Some(error) => {
                self.history.undone(step);
                return Err(error);
            }
        }
        Ok(true)
    }

    /// Swaps a step's values with the sculpture's and returns the reverse step. If they cannot be read back, or the
    /// history cannot keep that, nothing has changed and the step itself is returned. `oriented`: the contents that an
    /// orientation leads to, if they were computed before.
    fn reverse_if_kept(
        &mut self,
        mut step: Step,
        verb: &str,
        oriented: Option<Contents>,
    ) -> (Step, Option<CommandError>) {
        if let Change::Stored(stored) = step.change {
            match stored.0.load(&self.contents, stored.is_only()) {
                Ok(change) => step.change = change,
                Err(reason) => {
                    let error = CommandError::NotReadBack { step: step.label.clone(), reason };
                    return (Step { change: Change::Stored(stored), ..step }, Some(error));
                }
            }
        }
        let bytes = match &step.change {
            Change::Bricks(record) => record.reverse_bytes(&self.contents),
            Change::Whole(_) => self.contents.kept_bytes(),
            Change::Oriented { before: Some(_), .. } => 0,
            Change::Oriented { back, before: None } => self.bytes_to_undo(*back),
            // That of a stored step has been loaded.
            Change::Surface(_) | Change::Stored(_) => 0,
        };
        match self.require_room(&format!("{verb} {}", step.label), bytes) {
            Ok(()) => self.reverse(step, oriented),
            Err(error) => (step, Some(error)),
        }
    }

    fn reverse(&mut self, step: Step, oriented: Option<Contents>) -> (Step, Option<CommandError>) {
        let Step { label, change, state } = step;
        let change = match change {
            Change::Stored(_) => {
                let reason = "it was not read".to_string();
                let error = CommandError::NotReadBack { step: label.clone(), reason };
                return (Step { label, change, state }, Some(error));
            }
            Change::Bricks(record) => match self.try_swap_bricks(record) {
                Ok(record) => Change::Bricks(record),
                Err(refused) => {
                    let (record, error) = *refused;
                    return (Step { label, change: Change::Bricks(record), state }, Some(error));
                }
            },
            Change::Whole(contents) => match self.own_contents() {
                Ok(()) => Change::Whole(Box::new(self.swap_contents(*contents))),
                Err(error) => {
                    return (Step { label, change: Change::Whole(contents), state }, Some(error));
                }
            },
            Change::Surface(kind) => match self.own_contents() {
                Ok(()) => Change::Surface(self.swap_surface(kind)),
                Err(error) => return (Step { label, change, state }, Some(error)),
            },
            Change::Oriented { back, before } => {
                match self.reverse_orientation(back, before, oriented) {
                    Ok(change) => change,
                    Err(error) => {
                        let change = Change::Oriented { back, before: None };
                        return (Step { label, change, state }, Some(error));
                    }
                }
            }
        };
        let state = std::mem::replace(&mut self.state, state);
        self.settled = self.state;
        (Step { label, change, state }, None)
    }
}
