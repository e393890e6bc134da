//! The server's sockets: accepts clients of both modes and runs, for each client, a thread that reads and one that
//! writes. Does not know the meaning of reports.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::source::ANY_DATAGRAM_BYTES;
use crate::vrpn::link::{ClientLink, Outbox};
use crate::vrpn::peer::Peer;
use crate::vrpn::server_state::SharedServer;
use crate::vrpn::wire::{
    COOKIE, Frame, MAX_DATAGRAM_BYTES, Stamp, StreamReader, WireError, check_cookie,
    datagram_frames,
};

const TICK: Duration = Duration::from_millis(50);
const ACCEPT_EVERY: Duration = Duration::from_millis(20);
const GREETING_TIMEOUT: Duration = Duration::from_secs(3);
const CONNECT_BACK_TIMEOUT: Duration = Duration::from_secs(1);

/// Accepts clients that connect by TCP.
pub(crate) fn accept_streams(shared: &Arc<SharedServer>, listener: &TcpListener) {
    while !shared.stopped() {
        match listener.accept() {
            Ok(_) if shared.stopped() => return,
            Ok((tcp, _)) => take_client(shared, tcp, None),
            // None is waiting, or it disconnected at once.
            Err(_) => thread::sleep(ACCEPT_EVERY),
        }
    }
}

/// Connects back to clients that request it by UDP. Only to the address of the request, so that no client can direct
/// the server at others.
pub(crate) fn answer_requests(shared: &Arc<SharedServer>, requests: &UdpSocket) {
    let mut bytes = vec![0; ANY_DATAGRAM_BYTES];
    while !shared.stopped() {
        let Ok((count, from)) = requests.recv_from(&mut bytes) else { continue };
        // A client of a closing server asks again at once.
        if shared.stopped() {
            return;
        }
        let Some(port) = requested_port(&bytes[..count]) else {
            shared.tally.rejected.fetch_add(1, Ordering::Relaxed);
            continue;
        };
        let asked_from = SocketAddr::new(from.ip(), port);
        // A client repeats its request until it is answered.
        let is_known = shared
            .state()
            .links
            .iter()
            .any(|link| link.asked_from == Some(asked_from) && !link.is_closed());
        if is_known {
            continue;
        }
        if let Ok(tcp) = TcpStream::connect_timeout(&asked_from, CONNECT_BACK_TIMEOUT) {
            take_client(shared, tcp, Some(asked_from));
        }
    }
}

/// Returns the port of a request "host port", with a NUL at its end.
pub(crate) fn requested_port(request: &[u8]) -> Option<u16> {
    let text = std::str::from_utf8(request.strip_suffix(b"\0").unwrap_or(request)).ok()?;
    let (host, port) = text.split_once(' ')?;
    let host_is_sound =
        !host.is_empty() && host.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'.');
    if !host_is_sound || !port.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    port.parse().ok().filter(|port| *port >= 1024)
}

/// Starts the threads of a client, unless there are too many.
fn take_client(shared: &Arc<SharedServer>, tcp: TcpStream, asked_from: Option<SocketAddr>) {
    let mut state = shared.state();
    state.threads.retain(|thread| !thread.is_finished());
    state.links.retain(|link| !link.is_closed());
    // Two threads per client after the handshake, one before.
    if state.threads.len() >= 2 * shared.max_clients || state.links.len() >= shared.max_clients {
        shared.tally.refused.fetch_add(1, Ordering::Relaxed);
        return;
    }
    let on_thread = shared.clone();
    let hearing = thread::Builder::new().name("vrpn-hear".to_owned()).spawn(move || {
        if let Err(error) = serve_client(&on_thread, tcp, asked_from) {
            tracing::debug!(%error, "a VRPN client is gone");
        }
    });
    match hearing {
        Ok(thread) => state.threads.push(thread),
        Err(error) => tracing::warn!(%error, "no thread for a VRPN client"),
    }
}

/// Does the handshake with a client and reads from it until it disconnects.
fn serve_client(
    shared: &Arc<SharedServer>,
    tcp: TcpStream,
    asked_from: Option<SocketAddr>,
) -> io::Result<()> {
    tcp.set_nonblocking(false)?;
    tcp.set_nodelay(true)?;
    tcp.set_read_timeout(Some(TICK))?;
    tcp.set_write_timeout(Some(GREETING_TIMEOUT))?;
    (&tcp).write_all(&COOKIE)?;
    exchange_cookie(shared, &tcp)?;

    let udp = match asked_from {
        Some(_) => {
            let udp = UdpSocket::bind((tcp.local_addr()?.ip(), 0))?;
            udp.set_nonblocking(true)?;
            Some(udp)
        }
        None => None,
    };
    let link = Arc::new(ClientLink {
        peer_ip: tcp.peer_addr()?.ip(),
        tcp,
        asked_from,
        udp,
        udp_port: AtomicU16::new(0),
        udp_writer: Mutex::default(),
        outbox: Mutex::default(),
        wake: Condvar::new(),
        closed: AtomicBool::new(false),
    });
    greet(shared, &link)?;
    let result = hear(shared, &link);
    link.close();
    result
}

/// Queues the greeting and adds the link to those that receive reports, atomically.
fn greet(shared: &SharedServer, link: &Arc<ClientLink>) -> io::Result<()> {
    let udp_address = match &link.udp {
        Some(udp) => {
            let address = udp.local_addr()?;
            Some((address.ip().to_string(), address.port()))
        }
        None => None,
    };
    let mut state = shared.state();
    let mut outbox = link.outbox();
    let Outbox { bytes, writer } = &mut *outbox;
    let udp_address = udp_address.as_ref().map(|(ip, port)| (ip.as_str(), *port));
    writer.greeting(bytes, udp_address, &state.devices, wall_clock());
    drop(outbox);
    let writing = link.clone();
    let thread =
        thread::Builder::new().name("vrpn-write".to_owned()).spawn(move || writing.write_out())?;
    state.threads.push(thread);
    state.links.push(link.clone());
    shared.tally.accepted.fetch_add(1, Ordering::Relaxed);
    Ok(())
}

fn wall_clock() -> Stamp {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(Stamp::default(), Stamp::from)
}

fn exchange_cookie(shared: &SharedServer, mut tcp: &TcpStream) -> io::Result<()> {
    let until = Instant::now() + GREETING_TIMEOUT;
    let mut cookie = [0; COOKIE.len()];
    let mut filled = 0;
    while filled < cookie.len() {
        match tcp.read(&mut cookie[filled..]) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => filled += count,
            Err(error) if is_pause(&error) && !shared.stopped() && Instant::now() < until => {}
            Err(error) => return Err(error),
        }
    }
    check_cookie(&cookie).map_err(|error| reject(shared, error))
}

fn reject(shared: &SharedServer, error: WireError) -> io::Error {
    shared.tally.rejected.fetch_add(1, Ordering::Relaxed);
    io::Error::new(ErrorKind::InvalidData, error)
}

fn hear(shared: &SharedServer, link: &ClientLink) -> io::Result<()> {
    let mut reader = StreamReader::default();
    let mut peer = Peer::default();
    let (mut bytes, mut datagram) = ([0; 4096], vec![0; ANY_DATAGRAM_BYTES]);
    while !shared.stopped() && !link.is_closed() {
        match (&link.tcp).read(&mut bytes) {
            Ok(0) => return Ok(()),
            Ok(count) => reader.push(&bytes[..count]),
            Err(error) if is_pause(&error) => {}
            Err(error) => return Err(error),
        }
        while let Some(frame) = reader.next_frame().map_err(|error| reject(shared, error))? {
            answer(shared, link, &mut peer, &frame);
        }
        if let Some(udp) = &link.udp {
            link.udp_port.store(peer.udp_port().unwrap_or(0), Ordering::Relaxed);
            hear_datagrams(shared, link, &mut peer, udp, &mut datagram);
        }
    }
    Ok(())
}

/// Handles datagrams: a client may send urgent messages by UDP.
fn hear_datagrams(
    shared: &SharedServer,
    link: &ClientLink,
    peer: &mut Peer,
    udp: &UdpSocket,
    bytes: &mut [u8],
) {
    while let Ok((count, from)) = udp.recv_from(bytes) {
        if from.ip() != link.peer_ip || count > MAX_DATAGRAM_BYTES {
            shared.tally.rejected.fetch_add(1, Ordering::Relaxed);
            continue;
        }
        for frame in datagram_frames(&bytes[..count]) {
            match frame {
                Ok(frame) => answer(shared, link, peer, &frame),
                Err(_) => {
                    shared.tally.rejected.fetch_add(1, Ordering::Relaxed);
                }
            }
        }
    }
}

fn answer(shared: &SharedServer, link: &ClientLink, peer: &mut Peer, frame: &Frame<'_>) {
    let before = peer.rejected;
    // Held until the answers are queued, so that changes cannot overtake button states.
    let state = shared.state();
    for (device, message) in peer.receive(frame, &state.devices) {
        link.add_to_stream(device, &message, wall_clock(), false, &shared.tally.missed);
    }
    shared.tally.rejected.fetch_add(peer.rejected - before, Ordering::Relaxed);
}

/// Returns whether there is nothing to read yet.
fn is_pause(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use super::requested_port;

    #[test]
    fn requests_are_read_strictly() {
        assert_eq!(requested_port(b"127.0.0.1 34723\0"), Some(34_723));
        assert_eq!(requested_port(b"lab.example 1024"), Some(1024));
        for bad in [
            &b"127.0.0.1 1023\0"[..],
            b"127.0.0.1 65536\0",
            b"127.0.0.1 +3000\0",
            b"127.0.0.1  3000\0",
            b"127.0.0.1\0",
            b" 3000\0",
            b"; reboot 3000\0",
            b"\xff\xff 3000\0",
            b"",
        ] {
            assert_eq!(requested_port(bad), None, "{bad:?}");
        }
    }
}
