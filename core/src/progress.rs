//! How long work reports its progress and learns that it is cancelled: the trait [`Progress`], and a
//! [`Report`] that another thread reads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Someone who wants to know how far a piece of work is. Calls must be cheap and rare enough
/// (some hundred a job); pieces of work follow one another and do not nest.
pub trait Progress: Sync {
    /// A piece of work begins.
    fn begin(&self, what: &str);
    /// The share that is done, 0 to 1.
    fn advance(&self, done: f32);
    /// The piece of work has ended.
    fn end(&self);
    /// Whether the work is wanted no more. Once true it stays so; whoever works looks now and
    /// then, gives up, and leaves everything as it was.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Nobody listens.
impl Progress for () {
    fn begin(&self, _: &str) {}
    fn advance(&self, _: f32) {}
    fn end(&self) {}
}

/// How far work on another thread is, for a window to show, and the way to stop it.
#[derive(Debug, Default)]
pub struct Report {
    stage: Mutex<Stage>,
    cancelled: AtomicBool,
}

/// A piece of work under way.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Stage {
    /// Such as "unpacking"; empty between two pieces.
    pub what: String,
    /// The share of it that is done, 0 to 1; none where that is not known.
    pub done: Option<f32>,
}

impl Report {
    /// The piece of work under way.
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
