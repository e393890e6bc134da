//! Owns how long work says how far it is and hears that it is to stop: a [`Progress`] to be told, a
//! bar on the terminal, and a [`Report`] that another thread reads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};

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

/// A bar on stderr, drawn only where stderr is a terminal.
#[derive(Default)]
pub struct Bar {
    quiet: bool,
    bar: Mutex<Option<ProgressBar>>,
}

impl Bar {
    pub fn new(quiet: bool) -> Bar {
        Bar { quiet, bar: Mutex::new(None) }
    }

    fn with(&self, f: impl FnOnce(&mut Option<ProgressBar>)) {
        // A poisoned lock only means that another thread died while drawing.
        f(&mut self.bar.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

const STEPS: f32 = 1000.0;

impl Progress for Bar {
    fn begin(&self, what: &str) {
        if self.quiet {
            return;
        }
        let bar = ProgressBar::new(STEPS as u64).with_message(what.to_string());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}% {eta}") {
            bar.set_style(style);
        }
        self.with(|slot| *slot = Some(bar));
    }

    fn advance(&self, done: f32) {
        self.with(|slot| {
            if let Some(bar) = slot {
                bar.set_position((done.clamp(0.0, 1.0) * STEPS) as u64);
            }
        });
    }

    fn end(&self) {
        self.with(|slot| {
            if let Some(bar) = slot.take() {
                bar.finish_and_clear();
            }
        });
    }
}
