//! The state shared by all threads of a server: its devices, its clients, and its counters.
//!
//! Knows no sockets and no conversation.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use crate::vrpn::link::ClientLink;
use crate::vrpn::peer::DeviceState;

/// Counts of events since the start.
#[derive(Default, Debug)]
pub(crate) struct AtomicCounters {
    pub(crate) accepted: AtomicU64,
    pub(crate) refused: AtomicU64,
    pub(crate) rejected: AtomicU64,
    pub(crate) missed: AtomicU64,
}

/// State shared by all threads of a server.
pub(crate) struct SharedServer {
    pub(crate) stop: AtomicBool,
    pub(crate) max_clients: usize,
    pub(crate) tally: AtomicCounters,
    pub(crate) state: Mutex<ServerState>,
}

pub(crate) struct ServerState {
    pub(crate) devices: Vec<DeviceState>,
    pub(crate) links: Vec<Arc<ClientLink>>,
    pub(crate) threads: Vec<JoinHandle<()>>,
}

impl SharedServer {
    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    pub(crate) fn state(&self) -> MutexGuard<'_, ServerState> {
        // The data is consistent at all times, so a poisoned lock is usable.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
