//! The reports that a back end's thread has received and the program has not yet taken, and the signal that stops the
//! thread.

use std::io::{PipeReader, PipeWriter};
use std::os::fd::BorrowedFd;
use std::sync::{Arc, Mutex, PoisonError};

use rustix::event::{PollFd, PollFlags, poll};

use super::PenReport;

/// Most waiting reports: seconds of a fast tablet. Older ones are dropped.
const MOST: usize = 8192;

#[derive(Default)]
struct Waiting {
    reports: Vec<PenReport>,
    names: Option<Vec<String>>,
}

/// Shared between thread and program.
#[derive(Clone, Default)]
pub struct Inbox(Arc<Mutex<Waiting>>);

impl Inbox {
    fn with<T>(&self, change: impl FnOnce(&mut Waiting) -> T) -> T {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn push(&self, report: PenReport) {
        self.with(|waiting| {
            if waiting.reports.len() == MOST {
                waiting.reports.drain(..MOST / 2);
            }
            waiting.reports.push(report);
        });
    }

    pub fn name(&self, names: Vec<String>) {
        self.with(|waiting| waiting.names = Some(names));
    }

    pub fn take(&self) -> Vec<PenReport> {
        self.with(|waiting| std::mem::take(&mut waiting.reports))
    }

    pub fn take_names(&self) -> Option<Vec<String>> {
        self.with(|waiting| waiting.names.take())
    }

    pub fn is_empty(&self) -> bool {
        self.with(|waiting| waiting.reports.is_empty() && waiting.names.is_none())
    }
}

/// The reason for the end of a wait.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Waited {
    Readable,
    Stopped,
}

/// Ends a thread when it is dropped.
pub struct StopSignal(#[allow(dead_code, reason = "closing it is the signal")] PipeWriter);

impl StopSignal {
    pub fn new() -> std::io::Result<(StopSignal, PipeReader)> {
        let (reader, writer) = std::io::pipe()?;
        Ok((StopSignal(writer), reader))
    }
}

/// Waits until there is something to read, or until the thread should end.
pub fn wait(fd: BorrowedFd<'_>, stop: &PipeReader) -> std::io::Result<Waited> {
    loop {
        let mut fds = [PollFd::new(&fd, PollFlags::IN), PollFd::new(stop, PollFlags::IN)];
        match poll(&mut fds, None) {
            Ok(_) if !fds[1].revents().is_empty() => return Ok(Waited::Stopped),
            Ok(_) if !fds[0].revents().is_empty() => return Ok(Waited::Readable),
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}
