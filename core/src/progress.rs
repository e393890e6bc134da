//! Progress reports and cancellation of long work: the trait [`Progress`], and a [`ProgressReport`] that another thread
//! reads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Receives the progress of work. Calls must be cheap and are rare (some hundred per job). Pieces of work follow one
/// another and do not nest.
pub trait Progress: Sync {
    /// Begins a piece of work.
    fn begin(&self, what: &str);
    /// Reports the share that is done, 0 to 1.
    fn advance(&self, done: f32);
    /// Ends the piece of work.
    fn end(&self);
    /// Returns whether the work is cancelled. Once true it stays so; work polls it, stops, and leaves everything as it
    /// was.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Ignores progress.
impl Progress for () {
    fn begin(&self, _: &str) {}
    fn advance(&self, _: f32) {}
    fn end(&self) {}
}

/// The progress of work on another thread, for display, and its cancellation.
#[derive(Debug, Default)]
pub struct ProgressReport {
    stage: Mutex<Stage>,
    cancelled: AtomicBool,
}

/// A piece of work in progress.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Stage {
    /// A name such as "unpacking"; empty between two pieces.
    pub what: String,
    /// The share of it that is done, 0 to 1; `None` if unknown.
    pub done: Option<f32>,
}

impl ProgressReport {
    /// Returns the piece of work in progress.
    pub fn stage(&self) -> Stage {
        self.lock().clone()
    }

    /// Asks the work to stop at the next opportunity.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Stage> {
        // A stage is consistent at any time, even if a thread died with the lock.
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for ProgressReport {
    fn begin(&self, what: &str) {
        *self.lock() = Stage { what: what.to_string(), done: None };
    }

    fn advance(&self, done: f32) {
        self.lock().done = Some(done.clamp(0.0, 1.0));
    }

    fn end(&self) {
        *self.lock() = Stage::default();
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}
