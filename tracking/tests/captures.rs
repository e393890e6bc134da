//! Every value of the captured sessions is decoded correctly.

use super::captured::*;
use glam::{DQuat, DVec3};
use std::sync::Arc;
use tracking::vrpn::Message;
use tracking::vrpn::messages::MessageKind;
use tracking::vrpn::session::Session;
use tracking::vrpn::wire::{Stamp, StreamReader, datagram_frames};
use tracking::{Counters, Event, Severity};

/// Checks the low-latency reports of the deterministic server.
fn check_reports(listener: &Listener) {
    let count = |kind| listener.of(kind).len();
    assert_eq!(
        (count(MessageKind::Pose), count(MessageKind::Velocity), count(MessageKind::Acceleration)),
        (80, 80, 80)
    );
    for (i, said) in listener.of(MessageKind::Pose).into_iter().enumerate() {
        let (k, s) = (i as u32 / 2, i as u32 % 2);
        assert_eq!((said.device.as_str(), said.stamp), ("Head0", stamp_of_tick(k)));
        let Message::Pose { sensor, position_m, quat } = said.message else { panic!() };
        assert_eq!(sensor, s);
        assert_close(position_m, position_of_tick(k, s));
        assert_same_quat(quat, quat_of_tick(k, s));
    }
    for (i, said) in listener.of(MessageKind::Velocity).into_iter().enumerate() {
        let (k, sensor) = (i as u32 / 2, i as u32 % 2);
        assert_eq!((said.device.as_str(), said.stamp), ("Head0", stamp_of_tick(k)));
        let linear = DVec3::new(0.1, 0.0, 0.01);
        let quat = DQuat::IDENTITY;
        assert_eq!(said.message, Message::Velocity { sensor, linear, quat, dt_s: 0.1 });
    }
    for (i, said) in listener.of(MessageKind::Acceleration).into_iter().enumerate() {
        let (k, sensor) = (i as u32 / 2, i as u32 % 2);
        assert_eq!((said.device.as_str(), said.stamp), ("Head0", stamp_of_tick(k)));
        let linear = DVec3::new(0.0, -9.8125, 0.0);
        let quat = DQuat::IDENTITY;
        assert_eq!(said.message, Message::Acceleration { sensor, linear, quat, dt_s: 0.1 });
    }
    let analogs = listener.of(MessageKind::Analog);
    assert_eq!(analogs.len(), 40);
    for (k, said) in analogs.into_iter().enumerate() {
        let k = k as u32;
        assert_eq!((said.device.as_str(), said.stamp), ("Wand0", stamp_of_tick(k)));
        assert_eq!(said.message, Message::Analog(analog_of_tick(k).to_vec()));
    }
}

/// Checks what the deterministic server sends by TCP in both modes.
fn check_reliable(listener: &Listener) {
    let changes = listener.of(MessageKind::ButtonChange);
    assert_eq!(changes.len(), 8);
    for (said, (button, pressed)) in changes.into_iter().zip(BUTTON_CHANGES) {
        assert_eq!((said.device.as_str(), said.stamp), ("Wand0", Stamp::default()));
        assert_eq!(said.message, Message::ButtonChange { button, pressed });
    }
    // States reflect the button changes before them.
    let mut held = vec![false; 4];
    for said in &listener.said {
        match &said.message {
            Message::ButtonChange { button, pressed } => held[*button as usize] = *pressed,
            Message::ButtonStates(states) => {
                assert_eq!((said.device.as_str(), states), ("Wand0", &held));
            }
            _ => {}
        }
    }
    let texts = listener.of(MessageKind::Text);
    let expected = [(7, 0, 0, "calibrated"), (8, 1, 2, "low battery")];
    assert_eq!(texts.len(), expected.len());
    for (said, (k, severity, level, text)) in texts.into_iter().zip(expected) {
        assert_eq!((said.device.as_str(), said.stamp), ("Head0", stamp_of_tick(k)));
        assert_eq!(said.message, Message::Text { severity, level, text: text.to_owned() });
    }
}

#[test]
fn deterministic_tcp() {
    let (listener, count) = stream("det_tcp.s2c.bin");
    assert_eq!(count, 338);
    check_reports(&listener);
    check_reliable(&listener);
    assert_eq!(listener.of(MessageKind::ButtonStates).len(), 6);
    assert_eq!(listener.of(MessageKind::Pong).len(), 15);
    assert!(listener.system.is_empty());
}

#[test]
fn deterministic_udp() {
    let (mut listener, count) = stream("det_udp.s2c.bin");
    assert_eq!(count, 59);
    assert_eq!(listener.system, [-3]);
    check_reliable(&listener);
    let datagrams = datagrams();
    assert_eq!(datagrams.len(), 40);
    for datagram in &datagrams {
        let frames: Result<Vec<_>, _> = datagram_frames(datagram).collect();
        let frames = frames.unwrap();
        assert_eq!(frames.len(), 7);
        frames.iter().for_each(|frame| listener.hear(frame));
    }
    check_reports(&listener);
    assert_eq!(bytes("det_udp.lob.bin"), b"127.0.0.1 34723\0");
}

#[test]
fn minimal_client() {
    let (listener, count) = stream("min_tcp.s2c.bin");
    assert_eq!(count, 322);
    check_reports(&listener);
    check_reliable(&listener);
    let quat = DQuat::IDENTITY;
    let position_m = DVec3::new(1.0, 2.0, 3.0);
    for said in listener.of(MessageKind::ToRoom) {
        assert_eq!(said.message, Message::ToRoom { position_m, quat });
    }
    assert!(!listener.of(MessageKind::ToRoom).is_empty());
    let units = listener.of(MessageKind::UnitToSensor);
    assert_eq!(units.len(), 2);
    for (sensor, said) in (0..).zip(units) {
        let position_m = DVec3::new(0.1 + f64::from(sensor), 0.2, 0.3);
        assert_eq!(said.message, Message::UnitToSensor { sensor, position_m, quat });
    }
    let workspaces = listener.of(MessageKind::Workspace);
    assert_eq!(workspaces.len(), 1);
    let (min_m, max_m) = (DVec3::new(-0.2, -0.2, -0.1), DVec3::splat(0.2));
    assert_eq!(workspaces[0].message, Message::Workspace { min_m, max_m });
}

#[test]
fn stock_server() {
    let (listener, count) = stream("stock_tcp.s2c.bin");
    assert_eq!(count, 407);
    let since = |stamp: Stamp| stamp.since_1970().unwrap().as_secs_f64();
    let mut spins: Vec<(f64, DQuat)> = Vec::new();
    let mut nulls = 0;
    for said in listener.of(MessageKind::Pose) {
        let Message::Pose { sensor, position_m, quat } = said.message else { panic!() };
        assert_eq!(position_m, DVec3::ZERO);
        if said.device == "Null0" {
            assert_eq!((sensor, quat), (nulls % 2, DQuat::IDENTITY));
            nulls += 1;
        } else {
            assert_eq!((said.device.as_str(), sensor), ("Spin0", 0));
            spins.push((since(said.stamp), quat));
        }
    }
    assert_eq!((nulls, spins.len()), (48, 49));
    for (i, pair) in spins.windows(2).enumerate() {
        // 36 degrees per second about +Y by the timestamps.
        let turned = DQuat::from_rotation_y(36f64.to_radians() * (pair[1].0 - pair[0].0));
        assert!((pair[1].1 - turned * pair[0].1).length() < 1e-6, "report {i}");
    }
    for said in listener.of(MessageKind::Velocity) {
        let Message::Velocity { linear, quat, dt_s, .. } = said.message else { panic!() };
        assert_eq!(linear, DVec3::ZERO);
        if said.device == "Null0" {
            assert_eq!((quat, dt_s), (DQuat::IDENTITY, 1.0));
        } else {
            assert_same_quat(quat, DQuat::from_rotation_y(162f64.to_radians()));
            assert!((dt_s - 4.5).abs() < 1e-6);
        }
    }
    for said in listener.of(MessageKind::Acceleration) {
        let Message::Acceleration { linear, quat, .. } = said.message else { panic!() };
        assert_eq!((linear, quat), (DVec3::ZERO, DQuat::IDENTITY));
    }
    let dials = listener.of(MessageKind::Dial);
    assert_eq!(dials.len(), 48);
    for (i, said) in dials.into_iter().enumerate() {
        assert_eq!(said.device, "Dial0");
        assert_eq!(said.message, Message::Dial { dial: i as u32 % 2, revolutions: 0.2 });
    }
    let changes = listener.of(MessageKind::ButtonChange);
    assert_eq!(changes.len(), 10);
    for (i, said) in changes.into_iter().enumerate() {
        let (button, pressed) = (i as u32 % 2, i / 2 % 2 == 0);
        assert_eq!(said.message, Message::ButtonChange { button, pressed });
    }
}

#[test]
fn stock_clients_send_the_captured_messages() {
    for (name, count, pings) in [
        ("det_tcp.c2s.bin", 37, 10),
        ("det_udp.c2s.bin", 38, 10),
        ("stock_tcp.c2s.bin", 52, 20),
        ("min_tcp.c2s.bin", 9, 1),
    ] {
        let (listener, messages) = stream(name);
        assert_eq!((messages, listener.of(MessageKind::Ping).len()), (count, pings), "{name}");
    }
}

/// The same session packet by packet, as captured on the wire.
#[test]
fn packet_capture_holds_the_same_datagrams() {
    let all = bytes("det_udp.pcap");
    let u32_at = |at: usize| u32::from_le_bytes(all[at..at + 4].try_into().unwrap());
    assert_eq!((u32_at(0), u32_at(20)), (0xa1b2_c3d4, 1), "microseconds, Ethernet");
    let (mut at, mut requests, mut reports) = (24, Vec::new(), Vec::new());
    while at < all.len() {
        let packet = &all[at + 16..at + 16 + u32_at(at + 8) as usize];
        at += 16 + packet.len();
        let ip = &packet[14..];
        let header = usize::from(ip[0] & 15) * 4;
        if ip[9] == 17 {
            let udp = &ip[header..];
            let length = usize::from(u16::from_be_bytes([udp[4], udp[5]]));
            let payload = udp[8..length].to_vec();
            if payload.starts_with(b"127.") {
                requests.push(payload)
            } else {
                reports.push(payload)
            }
        }
    }
    assert!(!requests.is_empty());
    assert!(requests.iter().all(|request| *request == bytes("det_udp.lob.bin")));
    assert_eq!(reports, datagrams());
}

fn session() -> Session {
    let label = |name: &str| (name.to_owned(), Arc::from(format!("{name}@server")));
    Session::new([label("Head0"), label("Wand0")])
}

/// Plays a stream and datagrams through a session, the k-th tick arriving at k/10 s.
fn events_of(name: &str, udp: &[Vec<u8>]) -> (Vec<Event>, Counters) {
    let (mut session, mut events) = (session(), Vec::new());
    let mut reader = StreamReader::default();
    reader.push(&bytes(name)[24..]);
    while let Some(frame) = reader.next_frame().unwrap() {
        let arrival_s = match frame.stamp.since_1970() {
            Some(sent) if frame.stamp.sec < 1_000_000_100 => sent.as_secs_f64() - 1.0e9,
            _ => 0.0,
        };
        session.receive(&frame, arrival_s, &mut events);
    }
    for datagram in udp {
        for frame in datagram_frames(datagram) {
            let frame = frame.unwrap();
            let arrival_s = frame.stamp.since_1970().unwrap().as_secs_f64() - 1.0e9;
            session.receive(&frame, arrival_s, &mut events);
        }
    }
    (events, session.counters)
}

#[test]
fn sessions_give_typed_events() {
    for (name, udp) in [
        ("det_tcp.s2c.bin", Vec::new()),
        ("det_udp.s2c.bin", datagrams()),
        ("min_tcp.s2c.bin", Vec::new()),
    ] {
        let (events, counters) = events_of(name, &udp);
        assert_eq!(counters.rejected(), 0, "{name}");
        let (mut poses, mut motions, mut analogs, mut buttons, mut texts) =
            (0, 0, 0, Vec::new(), Vec::new());
        let mut found = Vec::new();
        for event in events {
            match event {
                Event::Pose(pose) => {
                    let (k, sensor) = (poses / 2, poses % 2);
                    assert_eq!((&*pose.source, pose.sensor), ("Head0@server", sensor));
                    assert_close(pose.placement.position_m, position_of_tick(k, sensor));
                    assert_same_quat(pose.placement.orientation, quat_of_tick(k, sensor));
                    assert!((pose.time_s - f64::from(k) / 10.0).abs() < 1e-6);
                    assert_eq!(pose.sender_time, stamp_of_tick(k).since_1970());
                    poses += 1;
                }
                Event::Velocity { velocity, sensor, .. } => {
                    assert_eq!(sensor, motions % 2);
                    assert_eq!(velocity.linear_m_s, DVec3::new(0.1, 0.0, 0.01));
                    assert_eq!(velocity.angular_rad_s, DVec3::ZERO);
                    motions += 1;
                }
                Event::Analog { channel, value, .. } => {
                    assert_eq!(channel, analogs % 3);
                    assert_eq!(value, analog_of_tick(analogs / 3)[channel as usize]);
                    analogs += 1;
                }
                Event::Button { button, pressed, .. } => buttons.push((button, pressed)),
                Event::Text { severity, level, text, .. } => texts.push((severity, level, text)),
                Event::Found { source, .. } => found.push(source.to_string()),
                Event::Acceleration { linear_m_s2, .. } => {
                    assert_eq!(linear_m_s2, DVec3::new(0.0, -9.8125, 0.0));
                }
                Event::Dial { .. } | Event::Lost { .. } => panic!("{name}: {event:?}"),
            }
        }
        assert_eq!((poses, motions, analogs), (80, 80, 120), "{name}");
        assert_eq!(buttons, BUTTON_CHANGES);
        assert_eq!(
            texts,
            [
                (Severity::Normal, 0, "calibrated".to_owned()),
                (Severity::Warning, 2, "low battery".to_owned())
            ]
        );
        found.sort();
        assert_eq!(found, ["Head0@server", "Wand0@server"]);
    }
}

#[test]
fn reports_before_their_description_are_dropped_and_counted() {
    let (mut session, mut events) = (session(), Vec::new());
    for datagram in datagrams() {
        for frame in datagram_frames(&datagram) {
            session.receive(&frame.unwrap(), 0.0, &mut events);
        }
    }
    assert!(events.is_empty());
    assert_eq!(session.counters.undescribed, 280);
}

#[test]
fn a_drop_releases_and_forgets() {
    let (mut session, mut events) = (session(), Vec::new());
    let mut reader = StreamReader::default();
    reader.push(&bytes("det_tcp.s2c.bin")[24..]);
    let mut changes = 0;
    while let Some(frame) = reader.next_frame().unwrap() {
        session.receive(&frame, 0.0, &mut events);
        changes = events.iter().filter(|event| matches!(event, Event::Button { .. })).count();
        if changes == 3 {
            break;
        }
    }
    assert_eq!(changes, 3);
    events.clear();
    session.forget(5.0, &mut events);
    let released: Vec<u32> = events
        .iter()
        .filter_map(|event| match event {
            Event::Button { button, pressed: false, time_s: 5.0, .. } => Some(*button),
            _ => None,
        })
        .collect();
    assert_eq!(released, [0, 1, 2]);
    assert_eq!(events.iter().filter(|event| matches!(event, Event::Lost { .. })).count(), 2);
    events.clear();
    session.forget(6.0, &mut events);
    assert!(events.is_empty());
    let undescribed = session.counters.undescribed;
    while let Some(frame) = reader.next_frame().unwrap() {
        session.receive(&frame, 0.0, &mut events);
    }
    assert!(events.is_empty() && session.counters.undescribed > undescribed);
}
