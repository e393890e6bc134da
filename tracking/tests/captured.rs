//! The captured sessions of the reference implementation: their bytes, split into messages, and the formulas that
//! their values obey (see data/README.md).

use glam::{DQuat, DVec3};
use std::collections::HashMap;
use tracking::vrpn::Message;
use tracking::vrpn::messages::MessageKind;
use tracking::vrpn::wire::{
    COOKIE, Frame, SENDER_DESCRIPTION, Stamp, StreamReader, TYPE_DESCRIPTION, check_cookie,
    described_name,
};

pub fn bytes(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The datagrams of the UDP session.
pub fn datagrams() -> Vec<Vec<u8>> {
    let all = bytes("det_udp.udp_s2c.bin");
    let mut rest = &all[..];
    let mut found = Vec::new();
    while let Some((length, tail)) = rest.split_first_chunk::<2>() {
        let (datagram, tail) = tail.split_at(usize::from(u16::from_be_bytes(*length)));
        found.push(datagram.to_vec());
        rest = tail;
    }
    found
}

/// A message with the names of its ids.
#[derive(Clone, PartialEq, Debug)]
pub struct Said {
    pub stamp: Stamp,
    pub device: String,
    pub message: Message,
}

/// The messages of a peer, by the names that it describes. Panics on anything invalid.
#[derive(Default)]
pub struct Listener {
    senders: HashMap<i32, String>,
    kinds: HashMap<i32, String>,
    pub said: Vec<Said>,
    pub system: Vec<i32>,
}

impl Listener {
    pub fn hear(&mut self, frame: &Frame<'_>) {
        match frame.kind {
            SENDER_DESCRIPTION => {
                let name = described_name(frame.payload).unwrap().to_owned();
                self.senders.insert(frame.sender, name);
            }
            TYPE_DESCRIPTION => {
                let name = described_name(frame.payload).unwrap().to_owned();
                self.kinds.insert(frame.sender, name);
            }
            kind if kind < 0 => self.system.push(kind),
            kind => {
                let kind = MessageKind::of_name(&self.kinds[&kind]).unwrap();
                self.said.push(Said {
                    stamp: frame.stamp,
                    device: self.senders[&frame.sender].clone(),
                    message: Message::decode(kind, frame.payload).unwrap(),
                });
            }
        }
    }

    pub fn of(&self, kind: MessageKind) -> Vec<&Said> {
        self.said.iter().filter(|said| said.message.kind() == kind).collect()
    }
}

/// Reads a captured stream, checking its cookie and that it ends on a boundary.
pub fn stream(name: &str) -> (Listener, usize) {
    let all = bytes(name);
    let (cookie, rest) = all.split_first_chunk::<24>().unwrap();
    assert_eq!(*cookie, COOKIE);
    check_cookie(cookie).unwrap();
    let mut listener = Listener::default();
    let (mut reader, mut count, mut length) = (StreamReader::default(), 0, 0);
    for chunk in rest.chunks(1000) {
        reader.push(chunk);
        while let Some(frame) = reader.next_frame().unwrap() {
            length += 24 + frame.payload.len().next_multiple_of(8);
            count += 1;
            listener.hear(&frame);
        }
    }
    assert_eq!(length, rest.len(), "{name} ends on a message boundary");
    (listener, count)
}

pub fn stamp_of_tick(k: u32) -> Stamp {
    Stamp { sec: 1_000_000_000 + k / 10, usec: k % 10 * 100_000 }
}

pub fn position_of_tick(k: u32, sensor: u32) -> DVec3 {
    let k = f64::from(k);
    DVec3::new(0.01 * k, 1.5 + f64::from(sensor), -0.5 + 0.001 * k)
}

pub fn quat_of_tick(k: u32, sensor: u32) -> DQuat {
    let axis = if sensor == 0 { DVec3::Y } else { DVec3::Z };
    DQuat::from_axis_angle(axis, f64::from(k).to_radians())
}

pub fn analog_of_tick(k: u32) -> [f64; 3] {
    [f64::from(k) / 64.0, -1.0, if k % 2 == 1 { 0.5 } else { 0.25 }]
}

/// Button, pressed, in order.
pub const BUTTON_CHANGES: [(u32, bool); 8] =
    [(0, true), (1, true), (2, true), (3, true), (0, false), (1, false), (2, false), (3, false)];

pub const TICKS: u32 = 40;

pub fn assert_close(a: DVec3, b: DVec3) {
    assert!(a.distance(b) < 1e-12, "{a} is not {b}");
}

pub fn assert_same_quat(a: DQuat, b: DQuat) {
    let distance = (a - b).length();
    assert!(distance < 1e-12, "{a} is not {b}");
}
