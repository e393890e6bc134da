//! This crate's client and server understand each other, in both modes, over real sockets on loopback.

use super::captured::*;
use super::waiting::{Heard, buttons, lost, poses, until};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tracking::vrpn::{DeviceSpec, Message, Mode, Server, ServerOptions, Stamp, pose_reports};
use tracking::{
    BodyOptions, ChannelOptions, Event, HeadPose, Placement, Source, SourceState, Tracker, Velocity,
};

/// Port 0 chooses a free one. A fixed one may be in use by a socket of another test.
fn serve(port: u16) -> Server {
    let listen = SocketAddr::from(([127, 0, 0, 1], port));
    let device = |name: &str, buttons| DeviceSpec { name: name.to_owned(), buttons };
    let devices = [device("Wand0", 4), device("Other", 1), device("Head0", 0)];
    let mut server = None;
    until("a port", || {
        server = Server::start(ServerOptions { listen, ..Default::default() }, &devices).ok();
        server.is_some()
    });
    server.unwrap()
}

fn pose_of_tick(k: u32, sensor: u32) -> HeadPose {
    HeadPose {
        placement: Placement {
            position_m: position_of_tick(k, sensor),
            orientation: quat_of_tick(k, sensor),
        },
        time_s: 0.0,
        sender_time: None,
        source: "ours".into(),
        sensor,
        confidence: 1.0,
        velocity: Some(Velocity {
            linear_m_s: glam::DVec3::new(0.1, 0.0, 0.01),
            angular_rad_s: glam::DVec3::new(0.0, 20.0, f64::from(k)),
        }),
    }
}

fn publish_tick(server: &Server, k: u32) {
    let stamp = stamp_of_tick(k);
    for sensor in 0..2 {
        server.publish("Head0", &pose_reports(&pose_of_tick(k, sensor)), stamp).unwrap();
    }
    let analog = Message::Analog(analog_of_tick(k).to_vec());
    let dial = Message::Dial { dial: k % 3, revolutions: 0.2 };
    server.publish("Wand0", &[analog, dial], stamp).unwrap();
    server.publish("Other", &[Message::Analog(vec![9.0])], stamp).unwrap();
}

/// The tick of an event, from its values, which are checked against each other.
fn check_stream_event(event: &Event) {
    match event {
        Event::Pose(pose) => {
            let sent = pose.sender_time.unwrap();
            let k = ((sent.as_secs() - 1_000_000_000) * 10 + u64::from(sent.subsec_millis()) / 100)
                as u32;
            assert_close(pose.placement.position_m, position_of_tick(k, pose.sensor));
            assert_same_quat(pose.placement.orientation, quat_of_tick(k, pose.sensor));
            assert!(pose.source.starts_with("Head0@"));
        }
        Event::Velocity { velocity, .. } => {
            assert_close(velocity.linear_m_s, glam::DVec3::new(0.1, 0.0, 0.01));
            let k = velocity.angular_rad_s.z.round();
            let expected = glam::DVec3::new(0.0, 20.0, k);
            assert!(velocity.angular_rad_s.distance(expected) < 1e-9);
        }
        Event::Analog { source, channel, value, .. } => {
            assert!(source.starts_with("Wand0@"), "only what was asked for");
            assert!((0..TICKS).any(|k| analog_of_tick(k)[*channel as usize] == *value));
        }
        Event::Dial { dial, revolutions, .. } => assert!(*dial < 3 && *revolutions == 0.2),
        _ => {}
    }
}

fn everything_arrives(mode: Mode) {
    let server = serve(0);
    let mut heard = Heard::start(mode, server.address().port());
    until("a client", || server.clients() == 1);
    heard.until("both devices to answer", |events| {
        events.iter().filter(|event| matches!(event, Event::Found { .. })).count() == 2
    });
    assert_eq!(heard.client.state(), SourceState::Running);

    let mut k = 0;
    until("a hundred poses", || {
        publish_tick(&server, k % TICKS);
        k += 1;
        heard.poll();
        poses(&heard.events) >= 100
    });
    for (button, pressed) in BUTTON_CHANGES {
        let change = Message::ButtonChange { button, pressed };
        server.publish("Wand0", &[change], Stamp::default()).unwrap();
    }
    let text = Message::Text { severity: 1, level: 2, text: "low battery".to_owned() };
    server.publish("Head0", &[text], Stamp::default()).unwrap();
    heard.until("the text", |events| events.iter().any(|e| matches!(e, Event::Text { .. })));
    heard.events.iter().for_each(check_stream_event);
    assert_eq!(heard.buttons(), BUTTON_CHANGES);
    for is_one in [
        (|e| matches!(e, Event::Velocity { .. })) as fn(&Event) -> bool,
        |e| matches!(e, Event::Analog { .. }),
        |e| matches!(e, Event::Dial { .. }),
    ] {
        assert!(heard.count(is_one) > 0);
    }
    let counters = heard.client.counters();
    assert_eq!((counters.rejected(), counters.connections), (0, 1));
    assert_eq!(server.counters().rejected, 0);
    drop(heard);
    until("the client to leave", || server.clients() == 0);
}

#[test]
fn everything_arrives_by_tcp() {
    everything_arrives(Mode::Tcp);
}

#[test]
fn everything_arrives_in_the_default_mode() {
    everything_arrives(Mode::Udp);
}

fn finds_again(mode: Mode) {
    let server = serve(0);
    let port = server.address().port();
    let mut heard = Heard::start(mode, port);
    until("a client", || server.clients() == 1);
    let press = Message::ButtonChange { button: 2, pressed: true };
    server.publish("Wand0", &[press], Stamp::default()).unwrap();
    heard.until("the button", |events| buttons(events) == [(2, true)]);
    // A client that connects later receives the button states.
    let mut late = Heard::start(mode, port);
    late.until("the button's state", |events| buttons(events) == [(2, true)]);
    drop(late);

    drop(server);
    heard.until("the loss", |events| lost(events) > 0);
    assert_eq!(heard.buttons(), [(2, true), (2, false)], "a lost button is released");
    assert!(matches!(heard.client.state(), SourceState::Seeking(_)));
    heard.events.clear();

    let server = serve(port);
    until("the client to be back", || server.clients() == 1);
    until("poses again", || {
        publish_tick(&server, 7);
        heard.poll();
        poses(&heard.events) > 0
    });
    heard.events.iter().for_each(check_stream_event);
    assert_eq!(heard.client.counters().connections, 2);
}

#[test]
fn finds_again_by_tcp() {
    finds_again(Mode::Tcp);
}

#[test]
fn finds_again_in_the_default_mode() {
    finds_again(Mode::Udp);
}

#[test]
fn a_client_may_come_before_the_server() {
    for mode in [Mode::Tcp, Mode::Udp] {
        let port = serve(0).address().port();
        let mut heard = Heard::start(mode, port);
        assert!(matches!(heard.client.state(), SourceState::Seeking(_)));
        let server = serve(port);
        until("a client", || server.clients() == 1);
        heard.until("devices", |events| events.iter().any(|e| matches!(e, Event::Found { .. })));
    }
}

/// The whole chain: server, network, client, tracker with its filter and fade.
#[test]
fn a_tracker_follows_a_served_head() {
    let server = serve(0);
    let heard = Heard::start(Mode::Tcp, server.address().port());
    let label = format!("Head0@tcp://127.0.0.1:{}", server.address().port());
    let mut tracker = Tracker::new(BodyOptions {
        rest: Placement::IDENTITY,
        fade: tracking::fade::FadeOptions { hold_s: 0.0, leave_s: 0.0, return_s: 0.0 },
        channels: vec![ChannelOptions::new(&label, 1)],
    });
    tracker.add_source(Box::new(heard.client));
    until("a client", || server.clients() == 1);
    let mut events = Vec::new();
    let mut now_s = 0.0;
    until("the head", || {
        let mut still = pose_of_tick(20, 1);
        still.velocity = None;
        server.publish("Head0", &pose_reports(&still), Stamp::default()).unwrap();
        tracker.update(now_s, &mut events);
        if let Some(pose) = tracker.latest() {
            now_s = pose.time_s;
        }
        let there = tracker.predicted(now_s).placement;
        there.position_m.distance(position_of_tick(20, 1)) < 1e-9
            && there.orientation.dot(quat_of_tick(20, 1)).abs() > 1.0 - 1e-12
    });
    assert!(events.iter().any(|event| matches!(event, Event::Found { .. })));
}

#[test]
fn several_clients_of_both_modes_at_once() {
    let server = serve(0);
    let port = server.address().port();
    let mut all: Vec<Heard> =
        [Mode::Tcp, Mode::Udp, Mode::Tcp, Mode::Udp].map(|mode| Heard::start(mode, port)).into();
    until("four clients", || server.clients() == 4);
    let done = Arc::new(AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut k = 0;
            while !done.load(Ordering::Relaxed) {
                publish_tick(&server, k % TICKS);
                k += 1;
                std::thread::sleep(std::time::Duration::from_millis(5));
            }
        });
        for heard in &mut all {
            heard.until("poses", |events| poses(events) >= 20);
        }
        done.store(true, Ordering::Relaxed);
    });
    for heard in &all {
        heard.events.iter().for_each(check_stream_event);
        assert_eq!(heard.client.counters().rejected(), 0);
    }
}
