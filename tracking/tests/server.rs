//! The server serves stock clients in both modes and survives bad ones.

use super::captured::*;
use super::waiting::until;
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::Duration;
use tracking::vrpn::messages::MessageKind;
use tracking::vrpn::server::{PublishError, ServerError};
use tracking::vrpn::wire::{COOKIE, StreamReader, UDP_DESCRIPTION, datagram_frames, write_frame};
use tracking::vrpn::{DeviceSpec, Message, Server, ServerOptions, Stamp};

fn device(name: &str, buttons: usize) -> DeviceSpec {
    DeviceSpec { name: name.to_owned(), buttons }
}

fn serve(max_clients: usize) -> Server {
    let listen = SocketAddr::from(([127, 0, 0, 1], 0));
    let devices = [device("Head0", 0), device("Wand0", 4)];
    Server::start(ServerOptions { listen, max_clients }, &devices).unwrap()
}

fn connect(server: &Server) -> TcpStream {
    let stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    stream
}

/// Reads the server's cookie.
fn greeted(stream: &mut TcpStream) {
    let mut cookie = [0; 24];
    stream.read_exact(&mut cookie).unwrap();
    assert_eq!(cookie, COOKIE);
}

/// Reads the stream until `is_so` holds.
fn hear(
    stream: &mut TcpStream,
    reader: &mut StreamReader,
    listener: &mut Listener,
    is_so: impl Fn(&Listener) -> bool,
) {
    let mut bytes = [0; 4096];
    while !is_so(listener) {
        let count = stream.read(&mut bytes).unwrap();
        assert_ne!(count, 0, "the server hung up");
        reader.push(&bytes[..count]);
        while let Some(frame) = reader.next_frame().unwrap() {
            listener.hear(&frame);
        }
    }
}

fn pose(k: u32) -> Message {
    Message::Pose { sensor: 0, position_m: position_of_tick(k, 0), quat: quat_of_tick(k, 0) }
}

/// The bytes that the stock client sent, with all its pings.
#[test]
fn a_stock_tcp_client_is_answered() {
    let server = serve(8);
    let mut stream = connect(&server);
    greeted(&mut stream);
    stream.write_all(&bytes("det_tcp.c2s.bin")).unwrap();
    let (mut reader, mut listener) = (StreamReader::default(), Listener::default());
    hear(&mut stream, &mut reader, &mut listener, |l| {
        l.of(MessageKind::Pong).len() == 10 && l.of(MessageKind::ButtonStates).len() == 6
    });
    let pongs =
        |name: &str| listener.of(MessageKind::Pong).iter().filter(|s| s.device == name).count();
    assert_eq!((pongs("Head0"), pongs("Wand0")), (5, 5));
    assert!(listener.system.is_empty(), "no UDP for a TCP client");

    server.publish("Head0", &[pose(3)], stamp_of_tick(3)).unwrap();
    let press = Message::ButtonChange { button: 1, pressed: true };
    server.publish("Wand0", std::slice::from_ref(&press), Stamp::default()).unwrap();
    hear(&mut stream, &mut reader, &mut listener, |l| !l.of(MessageKind::ButtonChange).is_empty());
    let poses = listener.of(MessageKind::Pose);
    assert_eq!((poses[0].message.clone(), poses[0].stamp), (pose(3), stamp_of_tick(3)));
    assert_eq!(listener.of(MessageKind::ButtonChange)[0].message, press);
    assert_eq!(server.counters().rejected, 0);
}

#[test]
fn questions_of_the_minimal_client_are_answered() {
    let server = serve(8);
    server.publish("Head0", &[pose(0)], Stamp::default()).unwrap();
    let mut stream = connect(&server);
    greeted(&mut stream);
    stream.write_all(&bytes("min_tcp.c2s.bin")).unwrap();
    let (mut reader, mut listener) = (StreamReader::default(), Listener::default());
    hear(&mut stream, &mut reader, &mut listener, |l| {
        !l.of(MessageKind::UnitToSensor).is_empty() && !l.of(MessageKind::ToRoom).is_empty()
    });
}

/// The default mode as the stock client uses it: poses by UDP, buttons by TCP.
#[test]
fn a_stock_udp_client_is_connected_to_and_served_by_udp() {
    let server = serve(8);
    let listening = TcpListener::bind("127.0.0.1:0").unwrap();
    let request = format!("127.0.0.1 {}\0", listening.local_addr().unwrap().port());
    let asking = UdpSocket::bind("127.0.0.1:0").unwrap();
    for _ in 0..3 {
        asking.send_to(request.as_bytes(), server.address()).unwrap();
    }
    let (mut stream, _) = listening.accept().unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    greeted(&mut stream);
    // The captured stream, with its UDP description (the first message) replaced by the test's own.
    let hears = UdpSocket::bind("127.0.0.1:0").unwrap();
    hears.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let captured = bytes("det_udp.c2s.bin");
    let mut said = COOKIE.to_vec();
    let port = i32::from(hears.local_addr().unwrap().port());
    write_frame(&mut said, Stamp::default(), port, UDP_DESCRIPTION, 0, b"127.0.0.1\0");
    let (first, taken) = tracking::vrpn::wire::split_frame(&captured[24..]).unwrap().unwrap();
    assert_eq!(first.kind, UDP_DESCRIPTION);
    said.extend_from_slice(&captured[24 + taken..]);
    stream.write_all(&said).unwrap();

    let (mut reader, mut listener) = (StreamReader::default(), Listener::default());
    hear(&mut stream, &mut reader, &mut listener, |l| l.of(MessageKind::Pong).len() == 10);
    assert_eq!(listener.system, [UDP_DESCRIPTION]);
    assert_eq!(server.clients(), 1, "asked three times, connected once");

    let reports: Vec<Message> = (0..TICKS).map(pose).collect();
    server.publish("Head0", &reports, stamp_of_tick(1)).unwrap();
    let release = Message::ButtonChange { button: 0, pressed: true };
    server.publish("Wand0", &[release], Stamp::default()).unwrap();
    let mut datagram = [0; 2000];
    while listener.of(MessageKind::Pose).len() < TICKS as usize {
        let count = hears.recv(&mut datagram).unwrap();
        assert!(count <= 1472);
        datagram_frames(&datagram[..count]).for_each(|frame| listener.hear(&frame.unwrap()));
    }
    for (k, said) in (0..).zip(listener.of(MessageKind::Pose)) {
        assert_eq!(said.message, pose(k));
    }
    let by_udp = listener.said.len();
    hear(&mut stream, &mut reader, &mut listener, |l| !l.of(MessageKind::ButtonChange).is_empty());
    assert_eq!(listener.said.len(), by_udp + 1, "no pose came by TCP");
}

#[test]
fn bad_clients_are_sent_away_and_good_ones_go_on() {
    let server = serve(8);
    let mut good = connect(&server);
    good.write_all(&bytes("min_tcp.c2s.bin")).unwrap();
    greeted(&mut good);
    until("the good client", || server.clients() == 1);

    let is_hung_up = |stream: &mut TcpStream| {
        let mut bytes = [0; 4096];
        loop {
            match stream.read(&mut bytes) {
                Ok(0) => return,
                Ok(_) => {}
                Err(error) if error.kind() == ErrorKind::ConnectionReset => return,
                Err(error) => panic!("{error}"),
            }
        }
    };
    let mut http = connect(&server);
    http.write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    is_hung_up(&mut http);
    let mut huge = connect(&server);
    huge.write_all(&bytes("min_tcp.c2s.bin")).unwrap();
    huge.write_all(&[0xff; 48]).unwrap();
    is_hung_up(&mut huge);
    let requests = UdpSocket::bind("127.0.0.1:0").unwrap();
    let bad = [&b"127.0.0.1 22\0"[..], b"\xff\xfe\xfd", b"x", &[b'9'; 1400]];
    for request in bad {
        requests.send_to(request, server.address()).unwrap();
    }
    until("all to be counted", || server.counters().rejected == 2 + bad.len() as u64);

    let (mut reader, mut listener) = (StreamReader::default(), Listener::default());
    server.publish("Head0", &[pose(9)], stamp_of_tick(9)).unwrap();
    hear(&mut good, &mut reader, &mut listener, |l| !l.of(MessageKind::Pose).is_empty());
    assert_eq!(listener.of(MessageKind::Pose)[0].message, pose(9));
}

#[test]
fn a_client_that_does_not_read_is_cut_off_without_delay_to_others() {
    let server = serve(8);
    let mut lazy = connect(&server);
    lazy.write_all(&bytes("min_tcp.c2s.bin")).unwrap();
    until("the lazy client", || server.clients() == 1);
    // Poses are dropped for it; texts must arrive, so it is disconnected for those that pile up.
    let text = Message::Text { severity: 0, level: 0, text: "x".repeat(1000) };
    let mut sent = 0;
    until("the cut", || {
        for k in 0..200 {
            server.publish("Head0", &[pose(k), text.clone()], Stamp::default()).unwrap();
            sent += 1;
        }
        server.clients() == 0
    });
    assert!(server.counters().missed > 0, "{:?} after {sent}", server.counters());
}

#[test]
fn no_more_clients_than_allowed() {
    let server = serve(2);
    let clients: Vec<TcpStream> = (0..2)
        .map(|_| {
            let mut stream = connect(&server);
            stream.write_all(&COOKIE).unwrap();
            greeted(&mut stream);
            stream
        })
        .collect();
    until("two clients", || server.clients() == 2);
    let mut third = connect(&server);
    assert_eq!(third.read(&mut [0; 1]).unwrap_or(0), 0, "hung up");
    until("the count", || server.counters().clients_refused == 1);
    drop(clients);
    until("room again", || server.clients() == 0);
    let mut fourth = connect(&server);
    fourth.write_all(&COOKIE).unwrap();
    greeted(&mut fourth);
}

#[test]
fn only_sound_reports_are_sent() {
    let server = serve(1);
    let publish = |name: &str, message| server.publish(name, &[message], Stamp::default());
    let nan = Message::Analog(vec![f64::NAN]);
    assert_eq!(publish("Nobody", Message::Pong), Err(PublishError::NoDevice("Nobody".into())));
    assert_eq!(publish("Head0", nan), Err(PublishError::Unsendable("Head0".into())));
    let change = |button| Message::ButtonChange { button, pressed: true };
    assert_eq!(publish("Wand0", change(4)), Err(PublishError::NoButton("Wand0".into())));
    assert_eq!(publish("Head0", change(0)), Err(PublishError::NoButton("Head0".into())));
    assert_eq!(publish("Wand0", change(3)), Ok(()));
}

#[test]
fn listens_on_loopback_and_refuses_bad_devices() {
    assert!(ServerOptions::default().listen.ip().is_loopback());
    assert_eq!(ServerOptions::default().listen.port(), 3883);
    let listen = SocketAddr::from(([127, 0, 0, 1], 0));
    let options = ServerOptions { listen, max_clients: 1 };
    for devices in [
        vec![device("", 0)],
        vec![device("A", 0), device("A", 0)],
        vec![device("A", 257)],
        vec![device(&"a".repeat(96), 0)],
    ] {
        assert!(matches!(Server::start(options, &devices), Err(ServerError::Device(_))));
    }
    let server = Server::start(options, &[]).unwrap();
    let taken = ServerOptions { listen: server.address(), max_clients: 1 };
    assert!(matches!(Server::start(taken, &[]), Err(ServerError::Listen(..))));
}
