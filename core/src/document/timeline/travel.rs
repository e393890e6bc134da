//! Undo and redo: reverses one step after the other on the contents, and reports which steps need computed contents.
//!
//! Takes the contents to change, and those computed elsewhere for a step. A refused step stays where it was, and
//! nothing has changed.

use super::Timeline;
use crate::command::Command;
use crate::document::CommandError;
use crate::document::edit_target::EditTarget;
use crate::document::orient;
use crate::sculpture::history::{Contents, Step, StepChange};
use crate::sculpture::orientation::Orientation;

/// The direction along the history.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::document) enum Direction {
    Undo,
    Redo,
}

impl Direction {
    /// Returns the verb of the command.
    pub fn verb(self) -> &'static str {
        match self {
            Direction::Undo => "undo",
            Direction::Redo => "redo",
        }
    }
}

impl Timeline {
    /// Returns the part of an undo or redo that is executed in one go. It ends before a step for which the history
    /// keeps no values, so that the sculpture must be reoriented; such a step is a part of its own. Other commands are
    /// returned whole.
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

    /// Returns the first step of an undo or redo whose contents must be computed, and the number of steps before it.
    pub fn next_computed(&self, command: &Command) -> Option<(u32, &Step, Orientation)> {
        let (steps, next): (_, &mut dyn Iterator<Item = &Step>) = match command {
            Command::Undo { steps } => (steps, &mut self.history.undo_steps()),
            Command::Redo { steps } => (steps, &mut self.history.redo_steps()),
            _ => return None,
        };
        next.zip(0..steps.unwrap_or(u32::MAX)).find_map(|(step, before)| match step.change {
            StepChange::Oriented { back, before: None } => Some((before, step, back)),
            _ => None,
        })
    }

    /// Moves by one step. Returns false if there is none. `oriented`: the contents after the step, if they were
    /// computed before.
    pub fn go(
        &mut self,
        direction: Direction,
        target: &mut EditTarget,
        oriented: Option<Contents>,
    ) -> Result<bool, CommandError> {
        let taken = match direction {
            Direction::Undo => self.history.take_undo(),
            Direction::Redo => self.history.take_redo(),
        };
        let Some(step) = taken.map_err(|error| target.no_memory(error))? else { return Ok(false) };
        let (step, refused) = self.reverse_if_kept(step, direction, target, oriented);
        match (direction, &refused) {
            (Direction::Undo, None) | (Direction::Redo, Some(_)) => self.history.undone(step),
            (Direction::Redo, None) | (Direction::Undo, Some(_)) => self.history.redone(step),
        }
        refused.map_or(Ok(true), Err)
    }

    /// Swaps a step's values with the sculpture's and returns the reverse step. If the values cannot be read back, or
    /// the history cannot keep the reverse step, nothing has changed and the step itself is returned. `oriented`: the
    /// contents after an orientation, if they were computed before.
    fn reverse_if_kept(
        &mut self,
        mut step: Step,
        direction: Direction,
        target: &mut EditTarget,
        oriented: Option<Contents>,
    ) -> (Step, Option<CommandError>) {
        if let StepChange::Stored(stored) = step.change {
            match stored.0.load(&target.contents, stored.is_only()) {
                Ok(change) => step.change = change,
                Err(reason) => {
                    let error = CommandError::NotReadBack { step: step.label.clone(), reason };
                    return (Step { change: StepChange::Stored(stored), ..step }, Some(error));
                }
            }
        }
        let bytes = match &step.change {
            StepChange::Bricks(record) => record.reverse_bytes(&target.contents),
            StepChange::Whole(_) => target.contents.kept_bytes(),
            StepChange::Oriented { before: Some(_), .. } | StepChange::Canvas { .. } => 0,
            StepChange::Oriented { back, before: None } => {
                orient::bytes_to_undo(&target.contents, *back)
            }
            // The change of a stored step has been loaded by now.
            StepChange::Surface(_) | StepChange::Several(_) | StepChange::Stored(_) => 0,
        };
        let label = format!("{} {}", direction.verb(), step.label);
        if let Err(error) = self.require_room(&label, bytes) {
            return (step, Some(error));
        }
        // Only the reversal shows what these steps take.
        let is_measured = matches!(step.change, StepChange::Canvas { .. } | StepChange::Several(_));
        let (reverse, refused) = self.reverse(step, target, oriented);
        if is_measured
            && refused.is_none()
            && let Err(error) = self.require_room(&label, reverse.change.heap_bytes())
        {
            let (step, _) = self.reverse(reverse, target, None);
            return (step, Some(error));
        }
        (reverse, refused)
    }

    fn reverse(
        &mut self,
        step: Step,
        target: &mut EditTarget,
        oriented: Option<Contents>,
    ) -> (Step, Option<CommandError>) {
        let Step { label, change, state } = step;
        match reversed(change, &label, target, oriented) {
            Ok(change) => {
                let state = std::mem::replace(&mut self.state, state);
                self.settled = self.state;
                (Step { label, change, state }, None)
            }
            Err(refused) => {
                let (change, error) = *refused;
                (Step { label, change, state }, Some(error))
            }
        }
    }
}

/// Reverses a change and returns the change that repeats it; if it is refused, returns the change itself. `label`: of
/// its step.
fn reversed(
    change: StepChange,
    label: &str,
    target: &mut EditTarget,
    oriented: Option<Contents>,
) -> Result<StepChange, Box<(StepChange, CommandError)>> {
    match change {
        StepChange::Stored(_) => {
            let reason = "it was not read".to_string();
            let error = CommandError::NotReadBack { step: label.to_string(), reason };
            Err(Box::new((change, error)))
        }
        StepChange::Bricks(record) => match target.try_swap_bricks(record) {
            Ok(record) => Ok(StepChange::Bricks(record)),
            Err(refused) => {
                let (record, error) = *refused;
                Err(Box::new((StepChange::Bricks(record), error)))
            }
        },
        StepChange::Whole(contents) => {
            Ok(StepChange::Whole(Box::new(target.swap_contents(*contents))))
        }
        StepChange::Surface(kind) => Ok(StepChange::Surface(target.swap_surface(kind))),
        StepChange::Canvas { back, before } => target.take_canvas_back(back, before),
        StepChange::Several(parts) => reversed_all(parts, label, target),
        // Repeating the orientation restores the present contents exactly.
        StepChange::Oriented { back, before: Some(before) } => {
            Ok(target.swap_oriented(*before, back, true))
        }
        StepChange::Oriented { back, before: None } => orient::lay(target, back, oriented)
            .map_err(|error| Box::new((StepChange::Oriented { back, before: None }, error))),
    }
}

/// Reverses changes, the last one first, as [`reversed`] does each. All of them are reversed, or none.
fn reversed_all(
    mut parts: Vec<StepChange>,
    label: &str,
    target: &mut EditTarget,
) -> Result<StepChange, Box<(StepChange, CommandError)>> {
    let mut reverse = Vec::with_capacity(parts.len());
    while let Some(part) = parts.pop() {
        match reversed(part, label, target, None) {
            Ok(change) => reverse.push(change),
            Err(refused) => {
                let (part, error) = *refused;
                parts.push(part);
                while let Some(change) = reverse.pop() {
                    // The sculpture was in this state before, so that only memory can be missing.
                    parts.push(
                        reversed(change, label, target, None).unwrap_or_else(|refused| refused.0),
                    );
                }
                return Err(Box::new((StepChange::Several(parts), error)));
            }
        }
    }
    Ok(StepChange::Several(reverse))
}
