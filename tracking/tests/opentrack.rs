//! opentrack's datagrams arrive over a real socket, and bad ones are counted.

use super::waiting::until;
use std::net::{SocketAddr, UdpSocket};
use tracking::opentrack::{Opentrack, OpentrackOptions};
use tracking::{Event, HostClock, Source, SourceState};

#[test]
fn datagrams_become_poses_and_bad_ones_are_counted() {
    assert!(OpentrackOptions::default().listen.ip().is_loopback());
    let listen = SocketAddr::from(([127, 0, 0, 1], 0));
    let options = OpentrackOptions { listen, ..Default::default() };
    let clock = HostClock::starting_now();
    let mut source = Opentrack::start(options, clock).unwrap();
    assert!(matches!(source.state(), SourceState::Seeking(_)));
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let send = |numbers: &[f64]| {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        socket.send_to(&bytes, source.address()).unwrap();
    };
    send(&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    send(&[0.0; 5]);
    send(&[0.0; 200]);
    // The longest possible one: on Windows it is an error if it does not fit into the buffer.
    send(&[0.0; 65_507 / 8]);
    for i in 0..10 {
        send(&[f64::from(i), 2.0, 60.0, 0.0, 0.0, 0.0]);
    }
    let mut events = Vec::new();
    until("ten poses", || {
        source.poll(0.0, &mut events);
        events.len() == 10
    });
    for (i, event) in (0..).zip(&events) {
        let Event::Pose(pose) = event else { panic!("{event:?}") };
        let expected = glam::DVec3::new(f64::from(i), 2.0, 60.0) / 100.0;
        assert_eq!((&*pose.source, pose.placement.position_m), ("opentrack", expected));
        assert!(pose.time_s <= clock.now_s());
    }
    let counters = source.counters();
    assert_eq!((counters.not_finite, counters.malformed, counters.oversized), (1, 1, 2));
    assert_eq!((counters.accepted, source.state()), (10, SourceState::Running));

    // Dropping the source frees the port.
    let listen = source.address();
    drop(source);
    let options = OpentrackOptions { listen, ..Default::default() };
    assert!(
        Opentrack::start(options.clone(), clock).is_ok_and(|source| source.address() == listen)
    );
}
