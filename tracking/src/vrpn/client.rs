//! The connection to a VRPN server: connects in either mode, keeps the connection and reconnects. Takes an address
//! and device names, gives a [`Source`]. All waiting is on its own threads. The meaning of messages belongs to
//! the session.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use crate::event::{Event, Inbox};
use crate::source::{ANY_DATAGRAM_BYTES, Counters, HostClock, Source, SourceState};
use crate::vrpn::address::{DeviceAddress, Mode, ServerAddress};
use crate::vrpn::session::Session;
use crate::vrpn::wire::{COOKIE, MAX_DATAGRAM_BYTES, StreamReader, check_cookie, datagram_frames};

/// Timing of a client.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ClientTiming {
    /// First and longest pause between attempts; it doubles each time.
    pub retry_first: Duration,
    pub retry_longest: Duration,
    /// Interval of requests to a server to connect back (UDP mode).
    pub request_every: Duration,
    /// Time limit for a TCP connection and for the exchange of cookies.
    pub greeting_timeout: Duration,
    /// Interval of pings to a device that has not answered.
    pub ping_every: Duration,
    /// A server that is silent for this long is pinged again.
    pub silence_ping: Duration,
    /// A server that has answered before and is silent for this long counts as lost.
    pub silence_lost: Duration,
}

impl Default for ClientTiming {
    fn default() -> Self {
        Self {
            retry_first: Duration::from_millis(250),
            retry_longest: Duration::from_secs(4),
            request_every: Duration::from_secs(2),
            greeting_timeout: Duration::from_secs(3),
            ping_every: Duration::from_secs(1),
            silence_ping: Duration::from_secs(3),
            silence_lost: Duration::from_secs(10),
        }
    }
}

/// Longest read before the thread checks whether it should stop.
const TICK: Duration = Duration::from_millis(50);

struct SharedClient {
    server: ServerAddress,
    timing: ClientTiming,
    clock: HostClock,
    session: Mutex<Session>,
    inbox: Inbox,
    state: Mutex<SourceState>,
    stop: AtomicBool,
}

/// A connection to one server, for any number of its devices. Reports under the label
/// `device@server`, as [`DeviceAddress`] prints it. Dropping it ends the conversation.
pub struct Client {
    name: String,
    shared: Arc<SharedClient>,
    thread: JoinHandle<()>,
}

impl Client {
    /// Starts to look for the server, until the client is dropped. Fails only if no thread can be started; a missing
    /// server is no error.
    pub fn start(
        server: ServerAddress,
        devices: &[String],
        timing: ClientTiming,
        clock: HostClock,
    ) -> io::Result<Self> {
        let label = |device: &String| {
            DeviceAddress { device: device.clone(), server: server.clone() }.to_string()
        };
        let labels = devices.iter().map(|device| (device.clone(), label(device).into()));
        let shared = Arc::new(SharedClient {
            timing,
            clock,
            session: Mutex::new(Session::new(labels)),
            inbox: Inbox::default(),
            state: Mutex::new(SourceState::Seeking(format!("looking for {server}"))),
            stop: AtomicBool::new(false),
            server,
        });
        let on_thread = shared.clone();
        let thread =
            thread::Builder::new().name("vrpn-client".to_owned()).spawn(move || on_thread.run())?;
        Ok(Self { name: format!("VRPN {}", shared.server), shared, thread })
    }

    /// Returns one client for each server among `devices`.
    pub fn start_all(
        devices: &[DeviceAddress],
        timing: ClientTiming,
        clock: HostClock,
    ) -> io::Result<Vec<Self>> {
        let mut servers: Vec<(&ServerAddress, Vec<String>)> = Vec::new();
        for device in devices {
            let name = device.device.clone();
            match servers.iter_mut().find(|(server, _)| **server == device.server) {
                Some((_, names)) => names.push(name),
                None => servers.push((&device.server, vec![name])),
            }
        }
        servers
            .into_iter()
            .map(|(server, names)| Self::start(server.clone(), &names, timing, clock))
            .collect()
    }
}

impl Source for Client {
    fn name(&self) -> &str {
        &self.name
    }

    fn poll(&mut self, _now_s: f64, events: &mut Vec<Event>) {
        self.shared.inbox.take(events);
    }

    fn state(&self) -> SourceState {
        lock(&self.shared.state).clone()
    }

    fn counters(&self) -> Counters {
        let mut counters = lock(&self.shared.session).counters;
        counters.unread = self.shared.inbox.dropped();
        counters
    }
}

impl Drop for Client {
    /// Does not wait for the thread, which may be resolving a name; it ends by itself.
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        self.thread.thread().unpark();
    }
}

/// Locks. The data behind these locks is always consistent, so a poisoned lock is usable.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An open connection to the server.
struct ServerConnection {
    tcp: TcpStream,
    /// The local end of the low-latency channel, in UDP mode.
    udp: Option<UdpSocket>,
}

impl SharedClient {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn set_state(&self, state: SourceState) {
        *lock(&self.state) = state;
    }

    fn run(&self) {
        let mut pause = self.timing.retry_first;
        while !self.stopped() {
            let begun = Instant::now();
            let opened = match self.server.mode {
                Mode::Tcp => self.open_tcp(),
                Mode::Udp => self.open_udp(),
            };
            let reason = match opened.and_then(|link| self.converse(&link)) {
                Ok(()) => "the server closed the connection".to_owned(),
                Err(error) => error.to_string(),
            };
            let was_running = *lock(&self.state) == SourceState::Running;
            if was_running {
                tracing::warn!(server = %self.server, reason, "lost the VRPN server");
                if begun.elapsed() > self.timing.retry_longest {
                    pause = self.timing.retry_first;
                }
            }
            // Set before the events, so that a reader of the loss finds the state changed.
            self.set_state(SourceState::Seeking(reason));
            let mut events = Vec::new();
            lock(&self.session).forget(self.clock.now_s(), &mut events);
            self.inbox.put(&mut events);
            self.wait(pause);
            pause = (pause * 2).min(self.timing.retry_longest);
        }
        self.set_state(SourceState::Ended("closed".to_owned()));
    }

    /// Sleeps, but ends early if the client is dropped.
    fn wait(&self, pause: Duration) {
        let until = Instant::now() + pause;
        while !self.stopped() && Instant::now() < until {
            thread::park_timeout(until.saturating_duration_since(Instant::now()));
        }
    }

    fn resolve(&self) -> io::Result<Vec<SocketAddr>> {
        let found: Vec<_> =
            (self.server.host.as_str(), self.server.port).to_socket_addrs()?.collect();
        if found.is_empty() { Err(ErrorKind::AddrNotAvailable.into()) } else { Ok(found) }
    }

    fn open_tcp(&self) -> io::Result<ServerConnection> {
        let mut failure = io::Error::from(ErrorKind::AddrNotAvailable);
        for address in self.resolve()? {
            match TcpStream::connect_timeout(&address, self.timing.greeting_timeout) {
                // If no server listens at an ephemeral port, TCP can connect to itself.
                Ok(tcp) if tcp.local_addr()? == tcp.peer_addr()? => {}
                Ok(tcp) => return Ok(ServerConnection { tcp, udp: None }),
                Err(error) => failure = error,
            }
        }
        Err(failure)
    }

    /// Asks the server to connect back, repeatedly until it does.
    fn open_udp(&self) -> io::Result<ServerConnection> {
        let server = self.resolve()?.into_iter().find(SocketAddr::is_ipv4).ok_or_else(|| {
            io::Error::new(ErrorKind::AddrNotAvailable, "the UDP mode of VRPN needs IPv4")
        })?;
        let asking = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        asking.connect(server)?;
        let our_ip = asking.local_addr()?.ip();
        let listener = TcpListener::bind((our_ip, 0))?;
        listener.set_nonblocking(true)?;
        let request = format!("{our_ip} {}\0", listener.local_addr()?.port());
        let mut asked: Option<Instant> = None;
        while !self.stopped() {
            if asked.is_none_or(|at| at.elapsed() >= self.timing.request_every) {
                // Refused while there is no server: keep asking.
                if let Err(error) = asking.send(request.as_bytes()) {
                    self.set_state(SourceState::Seeking(error.to_string()));
                }
                asked = Some(Instant::now());
            }
            match listener.accept() {
                Ok((tcp, from)) if from.ip() == server.ip() => {
                    tcp.set_nonblocking(false)?;
                    let udp = UdpSocket::bind((our_ip, 0))?;
                    return Ok(ServerConnection { tcp, udp: Some(udp) });
                }
                Ok(_) => lock(&self.session).counters.strangers += 1,
                Err(error) if is_pause(&error) => thread::park_timeout(TICK / 10),
                Err(error) => return Err(error),
            }
        }
        Err(ErrorKind::Interrupted.into())
    }

    /// Runs the conversation until the server leaves or violates the protocol, or the client is dropped.
    fn converse(&self, link: &ServerConnection) -> io::Result<()> {
        link.tcp.set_nodelay(true)?;
        link.tcp.set_read_timeout(Some(TICK))?;
        link.tcp.set_write_timeout(Some(self.timing.greeting_timeout))?;
        (&link.tcp).write_all(&COOKIE)?;
        self.read_cookie(&link.tcp)?;

        let udp_address = match &link.udp {
            Some(udp) => {
                udp.set_read_timeout(Some(TICK))?;
                let address = udp.local_addr()?;
                Some((address.ip().to_string(), address.port()))
            }
            None => None,
        };
        let greeting = lock(&self.session).greeting(
            udp_address.as_ref().map(|(ip, port)| (ip.as_str(), *port)),
            self.clock.now_s(),
        );
        (&link.tcp).write_all(&greeting)?;
        lock(&self.session).counters.connections += 1;
        self.set_state(SourceState::Running);
        tracing::info!(server = %self.server, "connected to the VRPN server");

        let over = AtomicBool::new(false);
        let server_ip = link.tcp.peer_addr()?.ip();
        thread::scope(|scope| {
            if let Some(udp) = &link.udp {
                scope.spawn(|| self.hear_datagrams(udp, server_ip, &over));
            }
            let result = self.hear_stream(&link.tcp);
            over.store(true, Ordering::Relaxed);
            result
        })
    }

    fn read_cookie(&self, mut tcp: &TcpStream) -> io::Result<()> {
        let until = Instant::now() + self.timing.greeting_timeout;
        let mut cookie = [0; COOKIE.len()];
        let mut filled = 0;
        while filled < cookie.len() {
            match tcp.read(&mut cookie[filled..]) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => filled += count,
                Err(error) if is_pause(&error) => {
                    if self.stopped() || Instant::now() >= until {
                        return Err(ErrorKind::TimedOut.into());
                    }
                }
                Err(error) => return Err(error),
            }
        }
        check_cookie(&cookie).map_err(|error| {
            lock(&self.session).reject(error);
            io::Error::new(ErrorKind::InvalidData, error)
        })
    }

    fn hear_stream(&self, mut tcp: &TcpStream) -> io::Result<()> {
        let mut reader = StreamReader::default();
        let mut bytes = [0; 16 * 1024];
        let mut events = Vec::new();
        let mut pinged: Option<Instant> = None;
        while !self.stopped() {
            match tcp.read(&mut bytes) {
                Ok(0) => return Ok(()),
                Ok(count) => {
                    reader.push(&bytes[..count]);
                    let now_s = self.clock.now_s();
                    let mut session = lock(&self.session);
                    loop {
                        match reader.next_frame() {
                            Ok(Some(frame)) => session.receive(&frame, now_s, &mut events),
                            Ok(None) => break,
                            Err(error) => {
                                session.reject(error);
                                self.inbox.put(&mut events);
                                return Err(io::Error::new(ErrorKind::InvalidData, error));
                            }
                        }
                    }
                    self.inbox.put(&mut events);
                }
                Err(error) if is_pause(&error) => {}
                Err(error) => return Err(error),
            }
            if pinged.is_none_or(|at| at.elapsed() >= self.timing.ping_every) {
                pinged = Some(Instant::now());
                let pings = self.pings_due()?;
                tcp.write_all(&pings)?;
            }
        }
        Ok(())
    }

    /// Pings devices that have not answered, and all if the server has fallen silent. A server that has answered
    /// before and stays silent counts as lost: TCP alone may not notice for hours.
    fn pings_due(&self) -> io::Result<Vec<u8>> {
        let mut session = lock(&self.session);
        let silence_s = self.clock.now_s() - session.heard_s();
        if session.has_answers() && silence_s > self.timing.silence_lost.as_secs_f64() {
            return Err(io::Error::new(ErrorKind::TimedOut, "the server does not answer"));
        }
        Ok(session.pings(silence_s > self.timing.silence_ping.as_secs_f64()))
    }

    fn hear_datagrams(&self, udp: &UdpSocket, server_ip: IpAddr, over: &AtomicBool) {
        let mut bytes = vec![0; ANY_DATAGRAM_BYTES];
        let mut events = Vec::new();
        while !over.load(Ordering::Relaxed) {
            let (count, from) = match udp.recv_from(&mut bytes) {
                Ok(received) => received,
                Err(error) if is_pause(&error) => continue,
                // Such as a closed port: the stream determines whether the server is there.
                Err(_) => {
                    thread::park_timeout(TICK);
                    continue;
                }
            };
            let now_s = self.clock.now_s();
            let mut session = lock(&self.session);
            if from.ip() != server_ip {
                session.counters.strangers += 1;
            } else if count > MAX_DATAGRAM_BYTES {
                session.counters.oversized += 1;
            } else {
                for frame in datagram_frames(&bytes[..count]) {
                    match frame {
                        Ok(frame) => session.receive(&frame, now_s, &mut events),
                        Err(error) => session.reject(error),
                    }
                }
                self.inbox.put(&mut events);
            }
        }
    }
}

/// Returns whether there is nothing to read yet.
fn is_pause(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
