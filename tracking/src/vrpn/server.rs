//! A small VRPN server: its devices, its clients, and the sending of reports. Takes messages with their timestamps;
//! sends them to every client, in the mode that each requested. Listens on loopback by default.
//!
//! Publishing never waits: reports that a slow client has not received are dropped if a later one supersedes them, and
//! a client that falls behind with the rest is disconnected.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, TcpListener, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use thiserror::Error;

use crate::vrpn::address::DEFAULT_PORT;
use crate::vrpn::messages::{MAX_BUTTONS, Message};
use crate::vrpn::peer::{DeviceState, MAX_KNOWN_SENSORS};
use crate::vrpn::server_link::{accept_streams, answer_requests};
use crate::vrpn::server_state::{AtomicCounters, ServerState, SharedServer};
use crate::vrpn::wire::{MAX_NAME_BYTES, Stamp};

/// Address and limits.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ServerOptions {
    /// For both TCP and UDP. Port 0 chooses a free one.
    pub listen: SocketAddr,
    pub max_clients: usize,
}

impl Default for ServerOptions {
    /// Returns loopback and VRPN's port.
    fn default() -> Self {
        let listen = SocketAddr::V4(SocketAddrV4::new(Ipv4Addr::LOCALHOST, DEFAULT_PORT));
        Self { listen, max_clients: 32 }
    }
}

/// A device to serve. It may report poses, analogs and dials whatever its number of buttons.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeviceSpec {
    pub name: String,
    pub buttons: usize,
}

/// The reason why a server does not start.
#[derive(Debug, Error)]
pub enum ServerError {
    #[error("cannot listen at {0}: {1}")]
    Listen(SocketAddr, io::Error),
    #[error("cannot start a thread: {0}")]
    Thread(io::Error),
    #[error("\"{0}\" is not a valid device name, is given twice, or has too many buttons")]
    Device(String),
}

/// The reason why a report is not sent.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub enum PublishError {
    #[error("there is no device \"{0}\"")]
    NoDevice(String),
    #[error("\"{0}\" has no such button")]
    NoButton(String),
    #[error("a report of \"{0}\" has a number that is not finite or an index beyond the limits")]
    Unsendable(String),
}

/// Counters of a server since its start.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ServerCounters {
    pub clients_accepted: u64,
    pub clients_refused: u64,
    /// Broken requests, cookies and messages.
    pub rejected: u64,
    /// Reports that a slow client missed.
    pub missed: u64,
}

/// A running server. Dropping it ends all conversations and frees the port.
pub struct Server {
    shared: Arc<SharedServer>,
    address: SocketAddr,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    pub fn start(options: ServerOptions, devices: &[DeviceSpec]) -> Result<Self, ServerError> {
        for (index, device) in devices.iter().enumerate() {
            let name = &device.name;
            if !(1..=MAX_NAME_BYTES).contains(&name.len())
                || name.contains('\0')
                || device.buttons > MAX_BUTTONS
                || devices[..index].iter().any(|other| other.name == *name)
            {
                return Err(ServerError::Device(name.clone()));
            }
        }
        let (listener, requests) =
            bind_both(options.listen).map_err(|e| ServerError::Listen(options.listen, e))?;
        let address = listener.local_addr().map_err(|e| ServerError::Listen(options.listen, e))?;
        let shared = Arc::new(SharedServer {
            stop: AtomicBool::new(false),
            max_clients: options.max_clients,
            tally: AtomicCounters::default(),
            state: Mutex::new(ServerState {
                devices: devices
                    .iter()
                    .map(|device| DeviceState {
                        name: device.name.clone(),
                        held: vec![false; device.buttons],
                        sensors: Vec::new(),
                    })
                    .collect(),
                links: Vec::new(),
                threads: Vec::new(),
            }),
        });
        let mut server = Self { shared: shared.clone(), address, threads: Vec::new() };
        let on_thread = shared.clone();
        server.spawn("vrpn-accept", move || accept_streams(&on_thread, &listener))?;
        server.spawn("vrpn-request", move || answer_requests(&shared, &requests))?;
        tracing::info!(%address, "VRPN server");
        Ok(server)
    }

    fn spawn(
        &mut self,
        name: &str,
        work: impl FnOnce() + Send + 'static,
    ) -> Result<(), ServerError> {
        let thread = thread::Builder::new().name(name.to_owned()).spawn(work);
        self.threads.push(thread.map_err(ServerError::Thread)?);
        Ok(())
    }

    /// Returns the address that it listens at, by TCP and UDP.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns the number of connected clients that have completed the handshake.
    pub fn clients(&self) -> usize {
        self.shared.state().links.iter().filter(|link| !link.is_closed()).count()
    }

    pub fn counters(&self) -> ServerCounters {
        let tally = &self.shared.tally;
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        ServerCounters {
            clients_accepted: count(&tally.accepted),
            clients_refused: count(&tally.refused),
            rejected: count(&tally.rejected),
            missed: count(&tally.missed),
        }
    }

    /// Sends reports of one device, made at `stamp`, to every client. All or nothing: after an error none was sent.
    /// Accepts only reports ([`Message`]s that a server sends without a request).
    pub fn publish(
        &self,
        device: &str,
        reports: &[Message],
        stamp: Stamp,
    ) -> Result<(), PublishError> {
        let mut state = self.shared.state();
        let ServerState { devices, links, .. } = &mut *state;
        let Some((index, known)) =
            devices.iter_mut().enumerate().find(|(_, known)| known.name == device)
        else {
            return Err(PublishError::NoDevice(device.to_owned()));
        };
        for report in reports {
            let buttons = match report {
                Message::ButtonChange { button, .. } => *button as usize + 1,
                Message::ButtonStates(states) => states.len(),
                _ => 0,
            };
            if buttons > known.held.len() {
                return Err(PublishError::NoButton(device.to_owned()));
            }
            if !report.is_sendable() {
                return Err(PublishError::Unsendable(device.to_owned()));
            }
        }
        for report in reports {
            remember(known, report);
        }
        for link in links.iter().filter(|link| !link.is_closed()) {
            link.send(index, reports, stamp, &self.shared.tally.missed);
        }
        Ok(())
    }
}

/// Keeps the state for requests of later clients.
fn remember(device: &mut DeviceState, report: &Message) {
    match report {
        Message::ButtonChange { button, pressed } => device.held[*button as usize] = *pressed,
        Message::ButtonStates(states) => device.held[..states.len()].copy_from_slice(states),
        Message::Pose { sensor, .. }
            if device.sensors.len() < MAX_KNOWN_SENSORS && !device.sensors.contains(sensor) =>
        {
            device.sensors.push(*sensor);
        }
        _ => {}
    }
}

/// Opens TCP and UDP at the same port. For port 0, looks for one that is free for both.
fn bind_both(listen: SocketAddr) -> io::Result<(TcpListener, UdpSocket)> {
    let attempts = if listen.port() == 0 { 32 } else { 1 };
    let mut failure = io::Error::from(io::ErrorKind::AddrInUse);
    for _ in 0..attempts {
        let listener = TcpListener::bind(listen)?;
        match UdpSocket::bind(listener.local_addr()?) {
            Ok(requests) => {
                listener.set_nonblocking(true)?;
                requests.set_read_timeout(Some(Duration::from_millis(100)))?;
                return Ok((listener, requests));
            }
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A panic there has been reported by its thread.
            let _ = thread.join();
        }
        let mut state = self.shared.state();
        let (links, threads) = (state.links.split_off(0), state.threads.split_off(0));
        drop(state);
        for link in links {
            link.close();
        }
        for thread in threads {
            let _ = thread.join();
        }
    }
}
