//! Owns how long work says how far it is: a [`Progress`] to be told, a bar on the terminal.

use std::sync::Mutex;

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
}

/// Nobody listens.
impl Progress for () {
    fn begin(&self, _: &str) {}
    fn advance(&self, _: f32) {}
    fn end(&self) {}
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
        f(&mut self.bar.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
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
