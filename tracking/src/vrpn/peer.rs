//! The server's half of one VRPN conversation: the client's ids, its UDP port and the answers to its requests.
//! Takes frames, gives answers; knows no sockets and no clocks.

use glam::{DQuat, DVec3};

use crate::vrpn::messages::{Message, MessageKind};
use crate::vrpn::wire::{
    Frame, IdTable, SENDER_DESCRIPTION, Stamp, TYPE_DESCRIPTION, UDP_DESCRIPTION, describe_name,
    described_name, write_frame,
};

/// Most sensors of a device remembered for answers.
pub const MAX_KNOWN_SENSORS: usize = 64;

/// The state of a device that clients may request.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct DeviceState {
    pub name: String,
    /// Empty for a device without buttons.
    pub held: Vec<bool>,
    /// Sensors that have reported, at most [`MAX_KNOWN_SENSORS`].
    pub sensors: Vec<u32>,
}

/// Messages of one direction of one transport, with sequence numbers.
#[derive(Default, Debug)]
pub struct Writer {
    sequence: u32,
}

impl Writer {
    pub fn frame(
        &mut self,
        out: &mut Vec<u8>,
        stamp: Stamp,
        sender: i32,
        kind: i32,
        payload: &[u8],
    ) {
        write_frame(out, stamp, sender, kind, self.sequence, payload);
        self.sequence = self.sequence.wrapping_add(1);
    }

    pub fn message(&mut self, out: &mut Vec<u8>, stamp: Stamp, device: usize, message: &Message) {
        // Local ids are positions in the lists of the greeting.
        let kind = message.kind();
        let id = MessageKind::ALL.iter().position(|k| *k == kind).map_or(-1, |index| index as i32);
        self.frame(out, stamp, device as i32, id, &message.encode());
    }

    /// Writes the server's message after the cookies: its UDP address and port, if it has one, the names of its
    /// devices, the supported types, and the states of the buttons.
    pub fn greeting(
        &mut self,
        out: &mut Vec<u8>,
        udp: Option<(&str, u16)>,
        devices: &[DeviceState],
        stamp: Stamp,
    ) {
        if let Some((host, port)) = udp {
            let payload: Vec<u8> = host.bytes().chain([0]).collect();
            self.frame(out, stamp, i32::from(port), UDP_DESCRIPTION, &payload);
        }
        for (id, device) in devices.iter().enumerate() {
            self.frame(out, stamp, id as i32, SENDER_DESCRIPTION, &describe_name(&device.name));
        }
        for (id, kind) in MessageKind::ALL.iter().enumerate() {
            self.frame(out, stamp, id as i32, TYPE_DESCRIPTION, &describe_name(kind.name()));
        }
        for (id, device) in devices.iter().enumerate() {
            if !device.held.is_empty() {
                self.message(out, stamp, id, &Message::ButtonStates(device.held.clone()));
            }
        }
    }
}

/// The server's state for one client.
#[derive(Default, Debug)]
pub struct Peer {
    senders: IdTable<Option<usize>>,
    kinds: IdTable<Option<MessageKind>>,
    udp_port: Option<u16>,
    /// Messages dropped as broken.
    pub rejected: u64,
}

impl Peer {
    /// Returns the client's UDP port, once it has announced it.
    pub fn udp_port(&self) -> Option<u16> {
        self.udp_port
    }

    /// Handles one message. Returns the answers, each with the index of its device.
    pub fn receive(&mut self, frame: &Frame<'_>, devices: &[DeviceState]) -> Vec<(usize, Message)> {
        match frame.kind {
            SENDER_DESCRIPTION => self.describe(frame, |peer, name| {
                let device = devices.iter().position(|device| device.name == name);
                peer.senders.describe(frame.sender, device)
            }),
            TYPE_DESCRIPTION => self.describe(frame, |peer, name| {
                peer.kinds.describe(frame.sender, MessageKind::of_name(name))
            }),
            // The host in the payload is not trusted: datagrams go to the peer of the stream.
            UDP_DESCRIPTION => match u16::try_from(frame.sender) {
                Ok(port) if port >= 1024 => self.udp_port = Some(port),
                _ => self.rejected += 1,
            },
            _ => return self.answers(frame, devices),
        }
        Vec::new()
    }

    fn describe(&mut self, frame: &Frame<'_>, take: impl FnOnce(&mut Self, &str) -> bool) {
        let sound = described_name(frame.payload).is_some_and(|name| take(self, name));
        self.rejected += u64::from(!sound);
    }

    fn answers(&mut self, frame: &Frame<'_>, devices: &[DeviceState]) -> Vec<(usize, Message)> {
        let kind = self.kinds.get(frame.kind).copied().flatten();
        let device = self.senders.get(frame.sender).copied().flatten();
        let (Some(kind), Some(index)) = (kind, device) else { return Vec::new() };
        let Some(device) = devices.get(index) else { return Vec::new() };
        let Ok(question) = Message::decode(kind, frame.payload) else {
            self.rejected += 1;
            return Vec::new();
        };
        let mut answers = Vec::new();
        match question {
            Message::Ping => {
                answers.push((index, Message::Pong));
                if !device.held.is_empty() {
                    answers.push((index, Message::ButtonStates(device.held.clone())));
                }
            }
            // Served poses are in room axes already, and of the tracked object itself.
            Message::RequestToRoom => answers
                .push((index, Message::ToRoom { position_m: DVec3::ZERO, quat: DQuat::IDENTITY })),
            Message::RequestUnitToSensor => answers.extend(device.sensors.iter().map(|&sensor| {
                (
                    index,
                    Message::UnitToSensor {
                        sensor,
                        position_m: DVec3::ZERO,
                        quat: DQuat::IDENTITY,
                    },
                )
            })),
            _ => {}
        }
        answers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vrpn::wire::datagram_frames;

    fn devices() -> Vec<DeviceState> {
        vec![
            DeviceState { name: "Head0".into(), held: vec![], sensors: vec![0, 1] },
            DeviceState { name: "Wand0".into(), held: vec![false, true], sensors: vec![] },
        ]
    }

    fn ask(peer: &mut Peer, sender: i32, kind: i32, payload: &[u8]) -> Vec<(usize, Message)> {
        let frame = Frame { stamp: Stamp::default(), sender, kind, payload };
        peer.receive(&frame, &devices())
    }

    #[test]
    fn questions_are_answered_under_the_clients_own_ids() {
        let mut peer = Peer::default();
        ask(&mut peer, 40, SENDER_DESCRIPTION, &describe_name("Wand0"));
        ask(&mut peer, 41, SENDER_DESCRIPTION, &describe_name("Head0"));
        ask(&mut peer, 42, SENDER_DESCRIPTION, &describe_name("Other"));
        ask(&mut peer, 7, TYPE_DESCRIPTION, &describe_name(MessageKind::Ping.name()));
        ask(
            &mut peer,
            8,
            TYPE_DESCRIPTION,
            &describe_name(MessageKind::RequestUnitToSensor.name()),
        );
        assert_eq!(
            ask(&mut peer, 40, 7, &[]),
            [(1, Message::Pong), (1, Message::ButtonStates(vec![false, true]))]
        );
        assert_eq!(ask(&mut peer, 41, 7, &[]), [(0, Message::Pong)]);
        assert_eq!(ask(&mut peer, 41, 8, &[]).len(), 2);
        assert!(ask(&mut peer, 42, 7, &[]).is_empty() && ask(&mut peer, 99, 7, &[]).is_empty());
        assert_eq!(peer.rejected, 0);
        assert!(ask(&mut peer, 41, 7, &[1]).is_empty());
        assert_eq!(peer.rejected, 1);
    }

    #[test]
    fn low_ports_are_refused() {
        let mut peer = Peer::default();
        for port in [0, -1, 53, 1023, 65_536, i32::MIN] {
            ask(&mut peer, port, UDP_DESCRIPTION, b"127.0.0.1\0");
        }
        assert_eq!((peer.udp_port(), peer.rejected), (None, 6));
        ask(&mut peer, 1024, UDP_DESCRIPTION, b"10.0.0.9\0");
        assert_eq!(peer.udp_port(), Some(1024));
    }

    #[test]
    fn the_greeting_is_in_the_order_of_the_protocol() {
        let mut out = Vec::new();
        let stamp = Stamp { sec: 1, usec: 2 };
        Writer::default().greeting(&mut out, Some(("127.0.0.1", 5000)), &devices(), stamp);
        let kinds: Vec<i32> = datagram_frames(&out).map(|frame| frame.unwrap().kind).collect();
        let mut expected = vec![UDP_DESCRIPTION, SENDER_DESCRIPTION, SENDER_DESCRIPTION];
        expected.extend(MessageKind::ALL.iter().map(|_| TYPE_DESCRIPTION));
        let states = MessageKind::ALL.iter().position(|k| *k == MessageKind::ButtonStates).unwrap();
        expected.push(states as i32);
        assert_eq!(kinds, expected);
    }
}
