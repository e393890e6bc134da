//! A progress bar on stderr for jobs on a terminal; draws nothing where stderr is no terminal.

use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressStyle};

use crate::progress::Progress;

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
