//! The tests that took longest, to be printed at the end: where the time of a run goes.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The number of tests that are listed.
const LISTED: usize = 20;

static TIMES: Mutex<Vec<(Duration, &'static str)>> = Mutex::new(Vec::new());

/// Runs a test and notes its time.
pub fn timed<T>(name: &'static str, test: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let outcome = test();
    TIMES.lock().unwrap_or_else(PoisonError::into_inner).push((start.elapsed(), name));
    outcome
}

/// Prints the slowest tests, if more have run than are listed.
pub fn print() {
    let mut times = TIMES.lock().unwrap_or_else(PoisonError::into_inner);
    if times.len() <= LISTED {
        return;
    }
    times.sort_by(|a, b| b.cmp(a));
    println!("slowest tests, in seconds:");
    for (time, name) in times.iter().take(LISTED) {
        println!("{:8.1}  {name}", time.as_secs_f64());
    }
    println!();
}
