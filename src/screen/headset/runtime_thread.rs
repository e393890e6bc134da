//! Threads that call an OpenXR runtime. A runtime that blocks forever in a call must not block the program, so a wait
//! for such a thread has a timeout, after which it is detached.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

/// Longest wait for a thread to end: longer than any call of a working runtime takes.
const JOIN_TIMEOUT: Duration = Duration::from_secs(2);

/// A thread that ends by itself soon after a request, unless the runtime blocks it.
pub(crate) struct RuntimeThread {
    name: &'static str,
    thread: Option<JoinHandle<()>>,
    /// Disconnects when the thread has ended.
    ended: Receiver<()>,
}

impl RuntimeThread {
    pub fn start(
        name: &'static str,
        work: impl FnOnce() + Send + 'static,
    ) -> io::Result<RuntimeThread> {
        let (alive, ended) = sync_channel::<()>(0);
        let work = move || {
            let _alive = alive;
            work();
        };
        let thread = Builder::new().name(name.to_string()).spawn(work)?;
        Ok(RuntimeThread { name, thread: Some(thread), ended })
    }

    /// Waits for the requested end of the thread. A thread that is still blocked in the runtime after [`JOIN_TIMEOUT`]
    /// is detached with everything it owns, and ends if the runtime ever returns.
    pub fn join_or_detach(&mut self) {
        let Some(thread) = self.thread.take() else { return };
        match self.ended.recv_timeout(JOIN_TIMEOUT) {
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
    fn a_thread_that_ends_is_joined() {
        let done = Arc::new(AtomicBool::new(false));
        let done_in_thread = done.clone();
        let mut thread = RuntimeThread::start("test", move || {
            std::thread::sleep(Duration::from_millis(30));
            done_in_thread.store(true, Ordering::Relaxed);
        })
        .unwrap();
        thread.join_or_detach();
        assert!(done.load(Ordering::Relaxed));
        thread.join_or_detach();
    }

    #[test]
    fn a_thread_that_hangs_is_detached() {
        let (unblock, blocked) = channel::<()>();
        let mut thread = RuntimeThread::start("test", move || {
            let _ = blocked.recv();
        })
        .unwrap();
        // A plain join would wait forever.
        thread.join_or_detach();
        drop(unblock);
    }
}
