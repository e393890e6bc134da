//! How long work reports its progress and learns that it is cancelled: the trait [`Progress`], and a
//! [`Report`] that another thread reads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Receives the progress of work. Calls must be cheap and are rare (some hundred per job); pieces of
/// work follow one another and do not nest.
pub trait Progress: Sync {
    /// A piece of work begins.
    fn begin(&self, what: &str);
    /// The share that is done, 0 to 1.
    fn advance(&self, done: f32);
    /// The piece of work has ended.
    fn end(&self);
    /// Whether the work is cancelled. Once true it stays so; work polls it, stops, and leaves everything
    /// as it was.
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
pub struct Report {
    stage: Mutex<Stage>,
    cancelled: AtomicBool,
}

/// A piece of work in progress.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Stage {
    /// Such as "unpacking"; empty between two pieces.
    pub what: String,
    /// The share of it that is done, 0 to 1; none where that is not known.
    pub done: Option<f32>,
}

impl Report {
    /// The piece of work in progress.
    pub fn stage(&self) -> Stage {
        self.lock().clone()
    }

    /// Asks the work to stop where it can.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Stage> {
        // A stage is whole at any time, whoever died with the lock.
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Report {
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
