//! The memory budget of a mesh, counted before allocation, and the progress of its work.
//!
//! Many threads make a mesh; they share these counts. Knows neither grids nor files.

use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use super::MeshError;
use crate::progress::Progress;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::Limits;

/// The memory that a mesh may take: as much as the limits for the grid and the colours together.
pub(crate) struct Budget {
    bytes: u64,
    taken: AtomicU64,
}

impl Budget {
    pub fn new(limits: &Limits) -> Budget {
        let bytes = limits.grid_bytes.saturating_add(limits.colour_bytes);
        Budget { bytes, taken: AtomicU64::new(0) }
    }

    /// Returns the total budget in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Counts bytes before allocation. Returns whether they are within the budget.
    pub fn take(&self, bytes: u64) -> bool {
        let before = self.taken.fetch_add(bytes, Ordering::Relaxed);
        before.saturating_add(bytes) <= self.bytes
    }

    /// Returns an error if the counted bytes exceed the budget.
    pub fn check(&self) -> Result<(), MeshError> {
        self.check_for(self.taken.load(Ordering::Relaxed))
    }

    /// Returns an error if `needed` bytes exceed the budget.
    pub(crate) fn check_for(&self, needed: u64) -> Result<(), MeshError> {
        let checked = self.check_work("the mesh needs at least", needed);
        checked.map_err(|over| over.advise("export a smaller part of the sculpture").into())
    }

    /// An error if there is no room for work (the beginning of the message, with its verb) that needs so many bytes.
    pub(crate) fn check_work(
        &self,
        what: impl Into<Cow<'static, str>>,
        needed: u64,
    ) -> Result<(), OverBudget> {
        OverBudget::check(what, needed, MemoryBudget::GridsAndColours, self.bytes)
    }
}

/// Reports how many pieces of a stage of work are done, from any thread.
pub(super) struct StagePieces<'a> {
    progress: &'a dyn Progress,
    /// The fractions of the work that are done before and after the stage.
    shares: [f32; 2],
    all: usize,
    done: Mutex<usize>,
}

impl StagePieces<'_> {
    pub fn new(progress: &dyn Progress, shares: [f32; 2], all: usize) -> StagePieces<'_> {
        StagePieces { progress, shares, all: all.max(1), done: Mutex::new(0) }
    }

    pub fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }

    /// Reports that one more piece is done.
    pub fn one(&self) {
        // Locked meanwhile, so that shares are reported in ascending order.
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        let [from, to] = self.shares;
        self.progress.advance(from + (to - from) * (*done as f32 / self.all as f32).min(1.0));
    }
}
