//! Undo and redo: for each step the earlier values of the changed bricks, within a budget of bytes;
//! the oldest steps are dropped to stay within it.
//!
//! A step is reversed by swapping its values with the sculpture's, so that undo and redo are the same
//! operation and both are exact to the byte. Knows no command and no document.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, local_index};
use super::colour::Rgb;
use super::grid::Grid;
use super::material::Material;
use super::orientation::Orientation;
use super::record::BrickRecord;

/// All that undo restores: existence bits and colours.
#[derive(Clone, PartialEq, Debug)]
pub struct Contents {
    /// Which voxels exist.
    pub grid: Grid,
    /// Their colours.
    pub material: Material,
}

impl Contents {
    /// Colour of the voxel at `v`, which must lie inside the grid, whether it exists or not.
    pub fn rgb(&self, v: UVec3) -> Rgb {
        let [x, y, z] = (v % BRICK_EDGE_VX).to_array();
        self.material.rgb(self.grid.brick_index(v / BRICK_EDGE_VX), local_index(x, y, z))
    }

    /// Colour of the voxel at `v`; none where none exists.
    pub fn colour(&self, v: IVec3) -> Option<Rgb> {
        self.grid.get(v).then(|| self.rgb(v.as_uvec3()))
    }
}

/// What one step changed.
#[derive(Clone, PartialEq, Debug)]
pub enum Change {
    /// Some bricks of the sculpture.
    Bricks(BrickRecord),
    /// The whole sculpture, replaced by a new or opened one.
    Whole(Box<Contents>),
    /// The whole sculpture was laid another way, and `back` leads back. `before` is kept only where
    /// that would not restore every byte.
    Oriented {
        /// The inverse of what was done.
        back: Orientation,
        /// The sculpture as it was.
        before: Option<Box<Contents>>,
    },
}

impl Contents {
    /// Bytes of a step that keeps all of it.
    pub fn kept_bytes(&self) -> usize {
        size_of::<Contents>() + (self.grid.heap_bytes() + self.material.heap_bytes()) as usize
    }
}

impl Change {
    fn heap_bytes(&self) -> usize {
        match self {
            Change::Bricks(record) => record.heap_bytes(),
            Change::Whole(old) => old.kept_bytes(),
            Change::Oriented { before, .. } => before.as_ref().map_or(0, |old| old.kept_bytes()),
        }
    }
}

/// Identifies a state of a document. Undo and redo restore the identifier with the state, so that
/// whatever belongs to a state, such as its file, can be looked up by it.
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
    /// What was done, as the history list shows it.
    pub label: String,
    /// The values to swap with the sculpture's.
    pub change: Change,
    /// The state that reversing it leads to.
    pub state: State,
}

impl Step {
    /// Bytes that the step takes of the history's budget.
    pub fn heap_bytes(&self) -> usize {
        size_of::<Step>() + self.label.len() + self.change.heap_bytes()
    }
}

/// The two lists of steps.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stack {
    Undo,
    Redo,
}

/// The steps that can be undone and redone, as they were at one moment. Steps are shared, so taking one
/// copies no values; a step that is undone while it is shared is copied then.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct HistorySnapshot {
    /// Oldest first.
    pub undo: Vec<Arc<Step>>,
    /// Last to be redone first.
    pub redo: Vec<Arc<Step>>,
}

impl HistorySnapshot {
    /// Drops the steps furthest from the current state until the rest takes at most `bytes`. Returns how
    /// many steps were dropped of each list.
    pub fn shorten(&mut self, bytes: usize) -> [usize; 2] {
        let mut left = bytes;
        [&mut self.undo, &mut self.redo].map(|steps| {
            let fits = |step: &&Arc<Step>| {
                let rest = left.checked_sub(step.heap_bytes());
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

/// The steps that can be undone and redone.
#[derive(Debug)]
pub struct History {
    /// Oldest first.
    undo: VecDeque<Arc<Step>>,
    /// Last to be redone first.
    redo: VecDeque<Arc<Step>>,
    bytes: usize,
    budget_bytes: usize,
    dropped: u64,
}

impl History {
    /// An empty history that keeps at most `budget_bytes`.
    pub fn new(budget_bytes: usize) -> History {
        History { undo: VecDeque::new(), redo: VecDeque::new(), bytes: 0, budget_bytes, dropped: 0 }
    }

    /// A history with the steps of a snapshot, as many as fit into `budget_bytes`.
    pub fn restored(snapshot: HistorySnapshot, budget_bytes: usize) -> History {
        let mut history = History::new(budget_bytes);
        snapshot.redo.into_iter().for_each(|step| history.put(step, Stack::Redo));
        snapshot.undo.into_iter().for_each(|step| history.put(step, Stack::Undo));
        history
    }

    /// The steps as they are now.
    pub fn snapshot(&self) -> HistorySnapshot {
        HistorySnapshot {
            undo: self.undo.iter().cloned().collect(),
            redo: self.redo.iter().cloned().collect(),
        }
    }

    /// Adds a finished step and clears the redo list.
    pub fn push(&mut self, step: Step) {
        self.bytes -= self.redo.drain(..).map(|s| s.heap_bytes()).sum::<usize>();
        self.put(Arc::new(step), Stack::Undo);
    }

    /// Whether a step fits into the budget whose label and change take `bytes`.
    pub fn can_keep(&self, bytes: usize) -> bool {
        bytes.saturating_add(size_of::<Step>()) <= self.budget_bytes
    }

    /// Takes the step to undo next. Give its reverse to [`History::undone`], or the step itself
    /// back to [`History::redone`].
    pub fn take_undo(&mut self) -> Option<Step> {
        let step = self.undo.pop_back()?;
        self.bytes -= step.heap_bytes();
        Some(Arc::unwrap_or_clone(step))
    }

    /// Takes the step to redo next. Give its reverse to [`History::redone`], or the step itself
    /// back to [`History::undone`].
    pub fn take_redo(&mut self) -> Option<Step> {
        let step = self.redo.pop_back()?;
        self.bytes -= step.heap_bytes();
        Some(Arc::unwrap_or_clone(step))
    }

    /// Puts the reverse of an undone step on the redo stack.
    pub fn undone(&mut self, reverse: Step) {
        self.put(Arc::new(reverse), Stack::Redo);
    }

    /// Puts the reverse of a redone step on the undo stack.
    pub fn redone(&mut self, reverse: Step) {
        self.put(Arc::new(reverse), Stack::Undo);
    }

    /// Number of steps that can be undone.
    pub fn undo_count(&self) -> usize {
        self.undo.len()
    }

    /// Number of steps that can be redone.
    pub fn redo_count(&self) -> usize {
        self.redo.len()
    }

    /// Labels of the steps that can be undone, oldest first.
    pub fn undo_labels(&self) -> impl Iterator<Item = &str> {
        self.undo.iter().map(|s| s.label.as_str())
    }

    /// Labels of the steps that can be redone, the next one first.
    pub fn redo_labels(&self) -> impl Iterator<Item = &str> {
        self.redo.iter().rev().map(|s| s.label.as_str())
    }

    /// The steps that can be undone, the next one first.
    pub fn undo_steps(&self) -> impl Iterator<Item = &Step> {
        self.undo.iter().rev().map(Arc::as_ref)
    }

    /// The steps that can be redone, the next one first.
    pub fn redo_steps(&self) -> impl Iterator<Item = &Step> {
        self.redo.iter().rev().map(Arc::as_ref)
    }

    /// The states that undo and redo can lead to.
    pub fn states(&self) -> impl Iterator<Item = State> {
        self.undo.iter().chain(&self.redo).map(|s| s.state)
    }

    /// Bytes held by all steps.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Most bytes that the steps may take.
    pub fn budget_bytes(&self) -> usize {
        self.budget_bytes
    }

    /// Lets the steps take up to `budget_bytes`, if that is more than they may take now.
    pub fn raise_budget(&mut self, budget_bytes: usize) {
        self.budget_bytes = self.budget_bytes.max(budget_bytes);
    }

    /// Steps dropped so far because the budget was full.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Adds a step to the top of a stack and drops what exceeds the budget. A step larger than the
    /// whole budget is dropped with all below it: callers ask [`History::can_keep`] first.
    fn put(&mut self, step: Arc<Step>, to: Stack) {
        let (stack, other) = match to {
            Stack::Undo => (&mut self.undo, &mut self.redo),
            Stack::Redo => (&mut self.redo, &mut self.undo),
        };
        let bytes = step.heap_bytes();
        if bytes > self.budget_bytes {
            // The steps below it can only be reached through it.
            self.dropped += 1 + stack.len() as u64;
            self.bytes -= stack.drain(..).map(|s| s.heap_bytes()).sum::<usize>();
            return;
        }
        self.bytes += bytes;
        stack.push_back(step);
        while self.bytes > self.budget_bytes {
            // The steps furthest from the current state go first; the one just added fits alone.
            let furthest = if stack.len() > 1 { stack.pop_front() } else { other.pop_front() };
            let Some(furthest) = furthest else { break };
            self.bytes -= furthest.heap_bytes();
            self.dropped += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick_set::BrickMask;
    use crate::sculpture::grid::WordKinds;
    use crate::sculpture::{Brick, ColourDepth, Rgb};

    /// A step that keeps some mixed bricks, or a whole sculpture.
    fn step(name: usize, bricks: u8) -> Step {
        let label = format!("step {name}");
        if bricks.is_multiple_of(16) {
            let grid = Grid::new(UVec3::splat(8 + u32::from(bricks)), Vec3::ONE, 1 << 30).unwrap();
            let material = Material::for_grid(&grid, ColourDepth::None, Rgb::default());
            let change = Change::Whole(Box::new(Contents { grid, material }));
            return Step { label, change, state: State::default() };
        }
        let mut record = BrickRecord::default();
        let bits = Brick::below([1, 2, 3]);
        let bricks = BrickMask { word: 3, mask: u64::MAX >> (64 - u32::from(bricks).min(64)) };
        bricks.indices().for_each(|_| record.keep_mixed(&bits));
        record.keep_word(bricks.word, WordKinds { mixed: bricks.mask, ..WordKinds::default() });
        if bricks.mask & 1 != 0 {
            record.keep_page(0, Some(vec![7; 512].into_boxed_slice()));
        }
        Step { label, change: Change::Bricks(record), state: State::default() }
    }

    fn recount(history: &History) -> usize {
        history.undo.iter().chain(&history.redo).map(|step| step.heap_bytes()).sum()
    }

    proptest! {
        /// What is undone comes back by another number of bytes, as full bricks turn to mixed.
        #[test]
        fn bytes_are_counted_and_within_the_budget(
            budget in 0usize..60_000,
            moves in prop::collection::vec((0u8..4, 0u8..80), 0..80),
        ) {
            let mut history = History::new(budget);
            // Names of the steps that must be there, had the budget no end.
            let (mut undo, mut redo): (Vec<usize>, Vec<usize>) = Default::default();
            for (name, (kind, bricks)) in moves.into_iter().enumerate() {
                let named = |label: &str| label["step ".len()..].parse::<usize>().unwrap();
                let bytes = match kind {
                    0 | 1 => {
                        let step = step(name, bricks);
                        let bytes = step.heap_bytes();
                        history.push(step);
                        undo.push(name);
                        redo.clear();
                        bytes
                    }
                    2 => match history.take_undo() {
                        None => continue,
                        Some(taken) => {
                            let name = named(&taken.label);
                            prop_assert_eq!(undo.pop(), Some(name));
                            let reverse = step(name, bricks);
                            let bytes = reverse.heap_bytes();
                            history.undone(reverse);
                            redo.push(name);
                            bytes
                        }
                    },
                    _ => match history.take_redo() {
                        None => continue,
                        Some(taken) => {
                            let name = named(&taken.label);
                            prop_assert_eq!(redo.pop(), Some(name));
                            let reverse = step(name, bricks);
                            let bytes = reverse.heap_bytes();
                            history.redone(reverse);
                            undo.push(name);
                            bytes
                        }
                    },
                };
                prop_assert_eq!(history.bytes(), recount(&history));
                prop_assert!(history.bytes() <= budget);
                if bytes > budget {
                    if kind == 2 { redo.clear() } else { undo.clear() }
                }
                // What is left are the newest of each, in order.
                let left: Vec<usize> = history.undo_labels().map(named).collect();
                prop_assert!(undo.ends_with(&left), "{:?} {:?}", undo, left);
                let left: Vec<usize> = history.redo_labels().map(named).collect();
                let next_first: Vec<usize> = redo.iter().rev().copied().collect();
                prop_assert!(next_first.starts_with(&left), "{:?} {:?}", redo, left);
                undo.drain(..undo.len() - history.undo_count());
                redo.drain(..redo.len() - history.redo_count());
            }
        }
    }
}
