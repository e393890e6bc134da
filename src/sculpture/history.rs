//! Owns undo and redo: for each step, what the changed bricks held before, within a budget
//! of bytes that drops the oldest steps.
//!
//! A step is reversed by swapping its values with the sculpture's, so that undo and redo are
//! one operation and both are exact to the byte. Empty and full bricks are kept as four-byte
//! indices: clearing a full 512^3 grid is one step of 1 MiB.

use std::collections::VecDeque;

use super::brick::Brick;
use super::grid::Grid;
use super::material::{Material, Page};

/// All that undo restores: existence bits and colours.
#[derive(Clone, PartialEq, Debug)]
pub struct Contents {
    pub grid: Grid,
    pub material: Material,
}

/// Earlier values of some bricks, each at most once.
#[derive(Default, Debug)]
pub struct BrickRecord {
    empty: Vec<u32>,
    full: Vec<u32>,
    mixed: Vec<u32>,
    mixed_bits: Vec<Brick>,
    pages: Vec<(u32, Option<Page>)>,
    page_bytes: usize,
}

impl BrickRecord {
    /// Keeps the bits of a brick. The caller sees to it that each brick comes once.
    #[inline]
    pub fn save_bits(&mut self, index: u32, bits: &Brick) {
        if bits.is_empty() {
            self.empty.push(index);
        } else if bits.is_full() {
            self.full.push(index);
        } else {
            self.mixed.push(index);
            self.mixed_bits.push(*bits);
        }
    }

    /// Keeps the colour page of a brick, or that it had none.
    pub fn save_page(&mut self, index: u32, page: Option<Page>) {
        self.page_bytes += page.as_ref().map_or(0, |p| p.len());
        self.pages.push((index, page));
    }

    pub fn is_empty(&self) -> bool {
        self.empty.is_empty()
            && self.full.is_empty()
            && self.mixed.is_empty()
            && self.pages.is_empty()
    }

    /// Bricks whose bits are kept.
    pub fn brick_count(&self) -> usize {
        self.empty.len() + self.full.len() + self.mixed.len()
    }

    fn heap_bytes(&self) -> usize {
        4 * (self.empty.capacity() + self.full.capacity() + self.mixed.capacity())
            + self.mixed_bits.capacity() * size_of::<Brick>()
            + self.pages.capacity() * size_of::<(u32, Option<Page>)>()
            + self.page_bytes
    }

    fn shrink(&mut self) {
        self.empty.shrink_to_fit();
        self.full.shrink_to_fit();
        self.mixed.shrink_to_fit();
        self.mixed_bits.shrink_to_fit();
        self.pages.shrink_to_fit();
    }

    /// Writes the kept values into `contents` and returns the values they replace.
    /// `touched` hears of every brick that may have changed.
    pub fn swap(self, contents: &mut Contents, mut touched: impl FnMut(u32)) -> BrickRecord {
        let mut reverse = BrickRecord::default();
        let mut put = |index: u32, bits: Brick| {
            reverse.save_bits(index, &contents.grid.bricks()[index as usize]);
            contents.grid.set_brick(index as usize, bits);
            touched(index);
        };
        self.empty.into_iter().for_each(|i| put(i, Brick::EMPTY));
        self.full.into_iter().for_each(|i| put(i, Brick::FULL));
        self.mixed.into_iter().zip(self.mixed_bits).for_each(|(i, bits)| put(i, bits));
        for (index, page) in self.pages {
            reverse.save_page(index, contents.material.swap_page(index as usize, page));
            touched(index);
        }
        reverse.shrink();
        reverse
    }
}

/// What one step changed.
#[derive(Debug)]
pub enum Change {
    /// Some bricks of the sculpture.
    Bricks(BrickRecord),
    /// The whole sculpture (a new or opened one took its place).
    Whole(Box<Contents>),
}

impl Change {
    fn heap_bytes(&self) -> usize {
        match self {
            Change::Bricks(record) => record.heap_bytes(),
            Change::Whole(old) => {
                size_of::<Contents>() + (old.grid.heap_bytes() + old.material.heap_bytes()) as usize
            }
        }
    }
}

/// A named, reversible change.
#[derive(Debug)]
pub struct Step {
    /// What the person did, as shown in the history list.
    pub label: String,
    pub change: Change,
}

impl Step {
    fn heap_bytes(&self) -> usize {
        size_of::<Step>() + self.label.capacity() + self.change.heap_bytes()
    }
}

/// The steps that can be undone and redone.
#[derive(Debug)]
pub struct History {
    undo: VecDeque<Step>,
    redo: Vec<Step>,
    bytes: usize,
    budget_bytes: usize,
    dropped: u64,
}

impl History {
    pub fn new(budget_bytes: usize) -> History {
        History { undo: VecDeque::new(), redo: Vec::new(), bytes: 0, budget_bytes, dropped: 0 }
    }

    /// Adds a finished step; what was undone before can no longer be redone.
    pub fn push(&mut self, mut step: Step) {
        if let Change::Bricks(record) = &mut step.change {
            record.shrink();
        }
        self.bytes -= self.redo.drain(..).map(|s| s.heap_bytes()).sum::<usize>();
        self.bytes += step.heap_bytes();
        self.undo.push_back(step);
        self.fit_budget();
    }

    /// Takes the step to undo next. Give its reverse to [`History::undone`].
    pub fn take_undo(&mut self) -> Option<Step> {
        let step = self.undo.pop_back()?;
        self.bytes -= step.heap_bytes();
        Some(step)
    }

    /// Takes the step to redo next. Give its reverse to [`History::redone`].
    pub fn take_redo(&mut self) -> Option<Step> {
        let step = self.redo.pop()?;
        self.bytes -= step.heap_bytes();
        Some(step)
    }

    pub fn undone(&mut self, reverse: Step) {
        self.bytes += reverse.heap_bytes();
        self.redo.push(reverse);
        self.fit_budget();
    }

    pub fn redone(&mut self, reverse: Step) {
        self.bytes += reverse.heap_bytes();
        self.undo.push_back(reverse);
        self.fit_budget();
    }

    pub fn undo_count(&self) -> usize {
        self.undo.len()
    }

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

    /// Bytes held by all steps.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Steps dropped so far because the budget was full.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    fn fit_budget(&mut self) {
        while self.bytes > self.budget_bytes {
            let Some(oldest) = self.undo.pop_front() else { break };
            self.bytes -= oldest.heap_bytes();
            self.dropped += 1;
        }
    }
}
