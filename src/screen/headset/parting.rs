//! Threads that call a runtime, and leaving them behind: a runtime that hangs in a call must not
//! hang the program.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

/// Longer than any call of a working runtime takes.
const PATIENCE: Duration = Duration::from_secs(2);

/// A thread that ends by itself soon after it was asked to.
pub(crate) struct Helper {
    name: &'static str,
    thread: Option<JoinHandle<()>>,
    /// Disconnects when the thread has ended.
    ended: Receiver<()>,
}

impl Helper {
    pub fn start(name: &'static str, work: impl FnOnce() + Send + 'static) -> io::Result<Helper> {
        let (alive, ended) = sync_channel::<()>(0);
        let work = move || {
            let _alive = alive;
            work();
        };
        let thread = Builder::new().name(name.to_string()).spawn(work)?;
        Ok(Helper { name, thread: Some(thread), ended })
    }

    /// Waits for its end, which has been requested. A thread that is blocked by the runtime is left
    /// behind with everything it owns, and ends if the runtime ever returns.
    pub fn part(&mut self) {
        let Some(thread) = self.thread.take() else { return };
        match self.ended.recv_timeout(PATIENCE) {
            Err(RecvTimeoutError::Timeout) | Ok(()) => {
                tracing::warn!(
                    "{}: the runtime does not answer; no longer waiting for it",
                    self.name
                );
            }
            Err(RecvTimeoutError::Disconnected) => {
                if thread.join().is_err() {
                    tracing::error!("{}: the thread has failed", self.name);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc::channel;

    #[test]
    fn a_thread_that_ends_is_waited_for() {
        let done = Arc::new(AtomicBool::new(false));
        let theirs = done.clone();
        let mut helper = Helper::start("test", move || {
            std::thread::sleep(Duration::from_millis(30));
            theirs.store(true, Ordering::Relaxed);
        })
        .unwrap();
        helper.part();
        assert!(done.load(Ordering::Relaxed));
        helper.part();
    }

    #[test]
    fn a_thread_that_hangs_is_left_behind() {
        let (let_go, held) = channel::<()>();
        let mut helper = Helper::start("test", move || {
            let _ = held.recv();
        })
        .unwrap();
        // It would wait forever.
        helper.part();
        drop(let_go);
    }
}
