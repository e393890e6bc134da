//! A server's connection with one client: sends reports by UDP, or queues them for the thread that writes to TCP.
//!
//! Never waits for the client. Knows neither the server nor the meaning of reports.

use std::io::Write;
use std::net::{IpAddr, Shutdown, SocketAddr, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU16, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use crate::vrpn::messages::Message;
use crate::vrpn::peer::Writer;
use crate::vrpn::wire::{MAX_DATAGRAM_BYTES, Stamp};

/// With more bytes than this queued for a client, reports that later ones supersede are dropped.
const LATE_BYTES: usize = 64 * 1024;
/// With more bytes than this queued, the client is disconnected.
const LOST_BYTES: usize = 1024 * 1024;

/// One client.
pub(crate) struct ClientLink {
    pub(super) tcp: TcpStream,
    /// The client's UDP address of its request for the connection, if it made one.
    pub(super) asked_from: Option<SocketAddr>,
    pub(super) peer_ip: IpAddr,
    pub(super) udp: Option<UdpSocket>,
    /// 0 until the client announces its UDP port.
    pub(super) udp_port: AtomicU16,
    pub(super) udp_writer: Mutex<Writer>,
    pub(super) outbox: Mutex<Outbox>,
    pub(super) wake: Condvar,
    pub(super) closed: AtomicBool,
}

/// The bytes to write to a client, and the conversation that they continue.
#[derive(Default)]
pub(super) struct Outbox {
    pub(super) bytes: Vec<u8>,
    pub(super) writer: Writer,
}

impl ClientLink {
    pub(crate) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Relaxed)
    }

    pub(crate) fn close(&self) {
        self.closed.store(true, Ordering::Relaxed);
        // Fails only if the stream is down already.
        let _ = self.tcp.shutdown(Shutdown::Both);
        let _outbox = self.outbox();
        self.wake.notify_all();
    }

    pub(super) fn outbox(&self) -> MutexGuard<'_, Outbox> {
        self.outbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends low-latency messages by UDP, if the client has announced a port, and the rest by TCP. Counts the reports
    /// in `missed` for which the client is too slow.
    pub(crate) fn send(
        &self,
        device: usize,
        reports: &[Message],
        stamp: Stamp,
        missed: &AtomicU64,
    ) {
        let udp = self.udp.as_ref().zip(match self.udp_port.load(Ordering::Relaxed) {
            0 => None,
            port => Some(SocketAddr::new(self.peer_ip, port)),
        });
        let mut datagram = Vec::new();
        for report in reports {
            let fast = report.kind().is_low_latency();
            match udp {
                Some(target) if fast => {
                    self.add_to_datagram(&mut datagram, target, device, report, stamp)
                }
                _ => self.add_to_stream(device, report, stamp, fast, missed),
            }
        }
        if let Some(target) = udp {
            send_datagram(&mut datagram, target);
        }
    }

    fn add_to_datagram(
        &self,
        datagram: &mut Vec<u8>,
        target: (&UdpSocket, SocketAddr),
        device: usize,
        report: &Message,
        stamp: Stamp,
    ) {
        let mut writer = self.udp_writer.lock().unwrap_or_else(PoisonError::into_inner);
        let mut frame = Vec::new();
        writer.message(&mut frame, stamp, device, report);
        if datagram.len() + frame.len() > MAX_DATAGRAM_BYTES {
            send_datagram(datagram, target);
        }
        datagram.append(&mut frame);
    }

    pub(super) fn add_to_stream(
        &self,
        device: usize,
        report: &Message,
        stamp: Stamp,
        fast: bool,
        missed: &AtomicU64,
    ) {
        let mut outbox = self.outbox();
        let Outbox { bytes, writer } = &mut *outbox;
        if fast && bytes.len() > LATE_BYTES {
            missed.fetch_add(1, Ordering::Relaxed);
            return;
        }
        let is_lost = bytes.len() > LOST_BYTES;
        if !is_lost {
            writer.message(bytes, stamp, device, report);
        }
        drop(outbox);
        if is_lost {
            self.close();
        } else {
            self.wake.notify_one();
        }
    }

    /// Writes the contents of the outbox until the link is closed.
    pub(super) fn write_out(&self) {
        loop {
            let mut outbox = self.outbox();
            while outbox.bytes.is_empty() && !self.is_closed() {
                outbox = self.wake.wait(outbox).unwrap_or_else(PoisonError::into_inner);
            }
            if self.is_closed() {
                return;
            }
            let bytes = std::mem::take(&mut outbox.bytes);
            drop(outbox);
            if (&self.tcp).write_all(&bytes).is_err() {
                self.close();
            }
        }
    }
}

/// Sends and clears. A datagram that cannot be sent counts as lost by the network.
fn send_datagram(datagram: &mut Vec<u8>, (socket, to): (&UdpSocket, SocketAddr)) {
    if !datagram.is_empty() {
        let _ = socket.send_to(datagram, to);
        datagram.clear();
    }
}
