//! The journals that this process writes, so that all of them can be synced when the process cannot continue, whoever
//! owns them: a panic hook knows no session.

use std::path::PathBuf;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Asks a journal's thread to answer once everything so far is on disk. Returns the journal's file; `None` if there is
/// none, or if the thread cannot be asked.
type Ask = Box<dyn Fn(SyncSender<()>) -> Option<PathBuf> + Send>;

static LIVE: Mutex<Vec<Live>> = Mutex::new(Vec::new());

/// A journal that is being written.
pub(super) struct Live {
    key: LiveKey,
    ask: Ask,
}

/// Identifies a journal that is being written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct LiveKey(u64);

impl Live {
    /// Adds a journal.
    pub fn add(ask: impl Fn(SyncSender<()>) -> Option<PathBuf> + Send + 'static) -> LiveKey {
        let mut live = LIVE.lock().unwrap_or_else(PoisonError::into_inner);
        let key = LiveKey(live.iter().map(|live| live.key.0 + 1).max().unwrap_or(0));
        live.push(Live { key, ask: Box::new(ask) });
        key
    }

    /// Removes a journal that is no longer written.
    pub fn remove(key: LiveKey) {
        LIVE.lock().unwrap_or_else(PoisonError::into_inner).retain(|live| live.key != key);
    }
}

/// Syncs everything done so far in every journal of this process, and waits at most `patience` in total. Returns the
/// files of those that finished in time. May be called while the process panics.
pub fn sync_all(patience: Duration) -> Vec<PathBuf> {
    // A thread that panics while it holds the lock cannot take it again.
    let Ok(live) = LIVE.try_lock() else { return Vec::new() };
    let asked: Vec<_> = live
        .iter()
        .filter_map(|live| {
            let (sender, receiver) = sync_channel(1);
            (live.ask)(sender).map(|path| (path, receiver))
        })
        .collect();
    drop(live);
    let end = Instant::now() + patience;
    let in_time = asked.into_iter().filter(|(_, receiver)| {
        receiver.recv_timeout(end.saturating_duration_since(Instant::now())).is_ok()
    });
    in_time.map(|(path, _)| path).collect()
}
