//! The source for opentrack's "UDP over network" output, which opentrack itself and many phone apps send. Takes
//! datagrams, gives poses; waits on a thread of its own.
//!
//! A datagram is six little-endian doubles: x, y, z in centimetres, then yaw, pitch, roll in degrees. They are
//! interpreted, before calibration, as: x right, y up, z towards the viewer, rotated by yaw about +y, then pitch about
//! the rotated x, then roll about the rotated z, each positive counter-clockwise seen against its axis. Senders differ
//! in their signs (opentrack's depend on its mapping settings), so each of the six can be inverted. The position is
//! relative to the head's centred position, which is the calibration's translation.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, SocketAddr, SocketAddrV4, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use glam::DVec3;

use crate::calibration::rotation_from_degrees;
use crate::event::{Event, Inbox};
use crate::pose::{HeadPose, Placement};
use crate::source::{ANY_DATAGRAM_BYTES, Counters, HostClock, Source, SourceState};

/// Bytes of a datagram.
pub const DATAGRAM_BYTES: usize = 48;

/// The interpretation of the six numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Signs {
    /// x, y, z, yaw, pitch, roll: true inverts the sign.
    pub inverted: [bool; 6],
}

/// The address to listen at, and the name for the poses.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct OpentrackOptions {
    pub listen: SocketAddr,
    /// [`HeadPose::source`] of the poses.
    pub label: String,
    pub signs: Signs,
}

impl Default for OpentrackOptions {
    /// Returns loopback and opentrack's port. A phone needs an address that it can reach.
    fn default() -> Self {
        Self {
            listen: SocketAddr::V4(SocketAddrV4::new(Ipv4Addr::LOCALHOST, 4242)),
            label: "opentrack".to_owned(),
            signs: Signs::default(),
        }
    }
}

/// The reason why a datagram is refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum DatagramError {
    #[error("a datagram does not have 48 bytes")]
    Length,
    #[error("a number is not finite or absurdly large")]
    NotFinite,
}

/// Decodes the placement in a datagram.
pub fn decode(datagram: &[u8], signs: Signs) -> Result<Placement, DatagramError> {
    if datagram.len() != DATAGRAM_BYTES {
        return Err(DatagramError::Length);
    }
    let mut numbers = [0.0; 6];
    for ((number, bytes), inverted) in
        numbers.iter_mut().zip(datagram.as_chunks::<8>().0).zip(signs.inverted)
    {
        let value = f64::from_le_bytes(*bytes);
        *number = if inverted { -value } else { value };
    }
    let [x, y, z, yaw, pitch, roll] = numbers;
    // Trackers that count turns go beyond 360 degrees; none goes beyond a hundred turns.
    if [yaw, pitch, roll].iter().any(|angle| !(-36_000.0..=36_000.0).contains(angle)) {
        return Err(DatagramError::NotFinite);
    }
    let position_m = DVec3::new(x, y, z) / 100.0;
    Placement::checked(position_m, rotation_from_degrees(yaw, pitch, roll))
        .ok_or(DatagramError::NotFinite)
}

#[derive(Default)]
struct SharedListener {
    inbox: Inbox,
    stop: AtomicBool,
    accepted: AtomicU64,
    malformed: AtomicU64,
    oversized: AtomicU64,
    not_finite: AtomicU64,
    failure: Mutex<Option<String>>,
}

/// Receives from opentrack on a UDP port. Dropping it closes the port.
pub struct Opentrack {
    name: String,
    address: SocketAddr,
    shared: Arc<SharedListener>,
    thread: Option<JoinHandle<()>>,
}

impl Opentrack {
    /// # Errors
    /// If the port cannot be opened.
    pub fn start(options: OpentrackOptions, clock: HostClock) -> io::Result<Self> {
        let socket = UdpSocket::bind(options.listen)?;
        socket.set_read_timeout(Some(Duration::from_millis(50)))?;
        let address = socket.local_addr()?;
        let shared = Arc::new(SharedListener::default());
        let on_thread = shared.clone();
        let thread = thread::Builder::new()
            .name("opentrack".to_owned())
            .spawn(move || on_thread.hear(&socket, &options, clock))?;
        let name = format!("opentrack at {address}");
        Ok(Self { name, address, shared, thread: Some(thread) })
    }

    /// Returns the address that it listens at.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl SharedListener {
    fn hear(&self, socket: &UdpSocket, options: &OpentrackOptions, clock: HostClock) {
        let source: Arc<str> = options.label.as_str().into();
        let mut bytes = vec![0; ANY_DATAGRAM_BYTES];
        let mut events = Vec::new();
        while !self.stop.load(Ordering::Relaxed) {
            let count = match socket.recv(&mut bytes) {
                Ok(count) => count,
                Err(error) => match error.kind() {
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {
                        continue;
                    }
                    _ => {
                        let mut failure =
                            self.failure.lock().unwrap_or_else(PoisonError::into_inner);
                        *failure = Some(error.to_string());
                        return;
                    }
                },
            };
            let counter = match decode(&bytes[..count], options.signs) {
                Ok(placement) => {
                    events.push(Event::Pose(HeadPose {
                        placement,
                        time_s: clock.now_s(),
                        sender_time: None,
                        source: source.clone(),
                        sensor: 0,
                        confidence: 1.0,
                        velocity: None,
                    }));
                    self.inbox.put(&mut events);
                    &self.accepted
                }
                Err(DatagramError::NotFinite) => &self.not_finite,
                Err(DatagramError::Length) if count > DATAGRAM_BYTES => &self.oversized,
                Err(DatagramError::Length) => &self.malformed,
            };
            counter.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl Source for Opentrack {
    fn name(&self) -> &str {
        &self.name
    }

    fn poll(&mut self, _now_s: f64, events: &mut Vec<Event>) {
        self.shared.inbox.take(events);
    }

    fn state(&self) -> SourceState {
        let failure = self.shared.failure.lock().unwrap_or_else(PoisonError::into_inner);
        match &*failure {
            Some(reason) => SourceState::Ended(reason.clone()),
            None if self.shared.accepted.load(Ordering::Relaxed) == 0 => {
                SourceState::Seeking("nothing received yet".to_owned())
            }
            None => SourceState::Running,
        }
    }

    fn counters(&self) -> Counters {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Counters {
            accepted: count(&self.shared.accepted),
            malformed: count(&self.shared.malformed),
            oversized: count(&self.shared.oversized),
            not_finite: count(&self.shared.not_finite),
            unread: self.shared.inbox.dropped(),
            ..Default::default()
        }
    }
}

impl Drop for Opentrack {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic there has been reported by its thread.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn datagram(numbers: [f64; 6]) -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    #[test]
    fn units_axes_and_signs() {
        let bytes = datagram([10.0, -20.0, 50.0, 90.0, 0.0, 0.0]);
        let placement = decode(&bytes, Signs::default()).unwrap();
        assert!(placement.position_m.distance(DVec3::new(0.1, -0.2, 0.5)) < 1e-12);
        // Yaw 90: a gaze ahead (-z) turns to the left (-x).
        assert!((placement.orientation * DVec3::NEG_Z).distance(DVec3::NEG_X) < 1e-12);
        let mut signs = Signs::default();
        signs.inverted[0] = true;
        signs.inverted[3] = true;
        let turned = decode(&bytes, signs).unwrap();
        assert!((turned.position_m.x + 0.1).abs() < 1e-12);
        assert!((turned.orientation * DVec3::NEG_Z).distance(DVec3::X) < 1e-12);
        let up = decode(&datagram([0.0, 0.0, 0.0, 0.0, 90.0, 0.0]), Signs::default()).unwrap();
        assert!((up.orientation * DVec3::NEG_Z).distance(DVec3::Y) < 1e-12);
        let all = decode(&datagram([0.0, 0.0, 0.0, 30.0, 20.0, 10.0]), Signs::default()).unwrap();
        let expected = DQuat::from_rotation_y(30f64.to_radians())
            * DQuat::from_rotation_x(20f64.to_radians())
            * DQuat::from_rotation_z(10f64.to_radians());
        assert!(all.orientation.dot(expected).abs() > 1.0 - 1e-12);
    }

    #[test]
    fn broken_datagrams_are_refused() {
        let good = datagram([0.0; 6]);
        assert!(decode(&good, Signs::default()).is_ok());
        for length in [0, 1, 47, 49, 96] {
            let mut bytes = good.clone();
            bytes.resize(length, 0);
            assert_eq!(decode(&bytes, Signs::default()), Err(DatagramError::Length));
        }
        for place in 0..6 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
                let mut numbers = [0.0; 6];
                numbers[place] = bad;
                let decoded = decode(&datagram(numbers), Signs::default());
                assert_eq!(decoded, Err(DatagramError::NotFinite));
            }
        }
    }
}
