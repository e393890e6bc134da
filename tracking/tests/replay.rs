//! The client understands the reference implementation: captured streams replayed by a fake server, connections
//! that break, and servers that violate the protocol.

use super::captured::*;
use super::waiting::{Heard, lost, poses, until};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::time::Duration;
use tracking::vrpn::Mode;
use tracking::vrpn::wire::{COOKIE, StreamReader, UDP_DESCRIPTION};
use tracking::{Event, Source, SourceState};

/// Checks the events of one captured session of the deterministic server.
fn check_session(events: &[Event]) {
    let (mut count, mut analogs) = (0, 0);
    for event in events {
        match event {
            Event::Pose(pose) => {
                let (k, sensor) = (count / 2, count % 2);
                assert_eq!(pose.sensor, sensor);
                assert_close(pose.placement.position_m, position_of_tick(k, sensor));
                assert_same_quat(pose.placement.orientation, quat_of_tick(k, sensor));
                count += 1;
            }
            Event::Analog { channel, value, .. } => {
                assert_eq!(*value, analog_of_tick(analogs / 3)[*channel as usize]);
                analogs += 1;
            }
            _ => {}
        }
    }
    assert_eq!((count, analogs), (80, 120));
    assert_eq!(super::waiting::buttons(events), BUTTON_CHANGES);
    assert_eq!(lost(events), 2);
}

/// Reads and checks the client's cookie.
fn greeted(stream: &mut TcpStream) {
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut cookie = [0; 24];
    stream.read_exact(&mut cookie).unwrap();
    assert_eq!(cookie, COOKIE);
}

#[test]
fn captured_tcp_session_twice() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut heard = Heard::start(Mode::Tcp, listener.local_addr().unwrap().port());
    let session = bytes("det_tcp.s2c.bin");
    for round in 1..=2 {
        let (mut stream, _) = listener.accept().unwrap();
        // In odd pieces, so that messages are split anywhere.
        for piece in session.chunks(777) {
            stream.write_all(piece).unwrap();
        }
        greeted(&mut stream);
        heard.until("all poses", |events| poses(events) == 80);
        stream.shutdown(std::net::Shutdown::Both).unwrap();
        drop(stream);
        heard.until("the loss of both devices", |events| lost(events) == 2);
        check_session(&heard.events);
        heard.events.clear();
        assert_eq!(heard.client.counters().connections, round);
    }
    assert_eq!(heard.client.counters().rejected(), 0);
}

#[test]
fn captured_udp_session_twice() {
    let requests = UdpSocket::bind("127.0.0.1:0").unwrap();
    requests.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut heard = Heard::start(Mode::Udp, requests.local_addr().unwrap().port());
    let session = bytes("det_udp.s2c.bin");
    for round in 1..=2 {
        let (mut stream, mut reader) = connect_back(&requests);
        stream.write_all(&session).unwrap();
        let port = udp_port(&mut stream, &mut reader);
        // All of the stream's 59 messages but the UDP description have been handled.
        until("the stream's end", || {
            let counters = heard.client.counters();
            counters.accepted + counters.ignored >= if round == 1 { 59 } else { 59 + 280 + 59 }
        });
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        for datagram in datagrams() {
            assert_eq!(socket.send_to(&datagram, ("127.0.0.1", port)).unwrap(), datagram.len());
        }
        heard.until("all poses", |events| poses(events) == 80);
        drop(stream);
        heard.until("the loss of both devices", |events| lost(events) == 2);
        check_session(&heard.events);
        heard.events.clear();
    }
    let counters = heard.client.counters();
    assert_eq!((counters.rejected(), counters.connections), (0, 2));
}

/// Waits for a request that can be answered (older ones come from closed listeners), and connects.
fn connect_back(requests: &UdpSocket) -> (TcpStream, StreamReader) {
    loop {
        let mut bytes = [0; 100];
        let (count, _) = requests.recv_from(&mut bytes).unwrap();
        let text = std::str::from_utf8(&bytes[..count]).unwrap();
        let text = text.strip_suffix('\0').expect("a request ends with NUL");
        let (host, port) = text.split_once(' ').unwrap();
        assert_eq!(host, "127.0.0.1");
        if let Ok(mut stream) = TcpStream::connect((host, port.parse().unwrap())) {
            greeted(&mut stream);
            return (stream, StreamReader::default());
        }
    }
}

/// The client's first message announces its UDP port.
fn udp_port(stream: &mut TcpStream, reader: &mut StreamReader) -> u16 {
    let mut bytes = [0; 4096];
    loop {
        let count = stream.read(&mut bytes).unwrap();
        assert_ne!(count, 0);
        reader.push(&bytes[..count]);
        if let Some(frame) = reader.next_frame().unwrap() {
            assert_eq!((frame.kind, frame.payload), (UDP_DESCRIPTION, &b"127.0.0.1\0"[..]));
            return u16::try_from(frame.sender).unwrap();
        }
    }
}

#[test]
fn bad_datagrams_do_no_harm() {
    let requests = UdpSocket::bind("127.0.0.1:0").unwrap();
    requests.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let mut heard = Heard::start(Mode::Udp, requests.local_addr().unwrap().port());
    let (mut stream, mut reader) = connect_back(&requests);
    stream.write_all(&bytes("det_udp.s2c.bin")).unwrap();
    let port = udp_port(&mut stream, &mut reader);
    until("the stream's end", || heard.client.counters().accepted >= 40);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let send = |bytes: &[u8]| socket.send_to(bytes, ("127.0.0.1", port)).unwrap();
    let good = &datagrams()[0];

    send(&[0; 2000]);
    until("oversized", || heard.client.counters().oversized == 1);
    send(&good[..good.len() - 1]);
    until("torn", || heard.client.counters().malformed == 1);
    let mut not_finite = good.clone();
    not_finite[32..40].copy_from_slice(&f64::NAN.to_be_bytes());
    send(&not_finite);
    until("not a number", || heard.client.counters().not_finite == 1);
    if let Ok(stranger) = UdpSocket::bind("127.0.0.2:0") {
        stranger.send_to(good, ("127.0.0.1", port)).unwrap();
        until("a stranger", || heard.client.counters().strangers == 1);
    }
    heard.poll();
    heard.events.clear();
    send(good);
    heard.until("a good datagram", |events| poses(events) == 2);
    assert_eq!(heard.client.state(), SourceState::Running);
}

#[test]
fn servers_that_break_the_rules_are_left_and_sought_again() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut heard = Heard::start(Mode::Tcp, listener.local_addr().unwrap().port());

    // Not VRPN at all.
    let (mut stream, _) = listener.accept().unwrap();
    stream.write_all(b"HTTP/1.1 400 Bad Request\r\n\r\n").unwrap();
    until("the cookie to be refused", || heard.client.counters().malformed == 1);

    // Disconnects at once.
    drop(listener.accept().unwrap());

    // A message that claims to have 4 GB, after good ones.
    let (mut stream, _) = listener.accept().unwrap();
    let session = bytes("det_tcp.s2c.bin");
    stream.write_all(&session).unwrap();
    stream.write_all(&[0xff; 64]).unwrap();
    until("the length to be refused", || heard.client.counters().oversized == 1);
    heard.until("the loss", |events| lost(events) == 2);
    check_session(&heard.events);
    heard.events.clear();

    // And a good server.
    let (mut stream, _) = listener.accept().unwrap();
    stream.write_all(&session).unwrap();
    heard.until("all poses", |events| poses(events) == 80);
    assert_eq!(heard.client.counters().connections, 2);
}

/// A server whose cable is pulled: it has answered, then nothing arrives, and TCP does not notice.
#[test]
fn a_silent_server_is_taken_for_lost() {
    use tracking::HostClock;
    use tracking::vrpn::{Client, ClientTiming, ServerAddress};
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let server = ServerAddress { mode: Mode::Tcp, host: "127.0.0.1".to_owned(), port };
    let timing = ClientTiming {
        ping_every: Duration::from_millis(50),
        silence_ping: Duration::from_millis(100),
        silence_lost: Duration::from_millis(400),
        retry_first: Duration::from_millis(20),
        ..Default::default()
    };
    let clock = HostClock::starting_now();
    let client = Client::start(server, &["Head0".to_owned()], timing, clock).unwrap();
    let mut heard = Heard { client, events: Vec::new() };
    let (mut stream, _) = listener.accept().unwrap();
    stream.write_all(&bytes("det_tcp.s2c.bin")).unwrap();
    heard.until("the loss", |events| lost(events) == 1);
    drop(stream);
    let (mut stream, _) = listener.accept().unwrap();
    stream.write_all(&COOKIE).unwrap();
    until("the second connection", || heard.client.counters().connections == 2);
}
