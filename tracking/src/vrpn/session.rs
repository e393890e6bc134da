//! The client's half of one VRPN conversation: the server's ids, the held buttons, and the devices that have answered.
//! Takes frames and times, gives events and bytes to send; knows no sockets and no clocks.

use std::sync::Arc;

use glam::DQuat;

use crate::event::{Event, Severity};
use crate::pose::{HeadPose, Placement, Velocity, rotation_vector};
use crate::source::Counters;
use crate::vrpn::messages::{MAX_BUTTONS, Message, MessageError, MessageKind};
use crate::vrpn::sender_clock::SenderClock;
use crate::vrpn::wire::{
    Frame, IdTable, SENDER_DESCRIPTION, Stamp, TYPE_DESCRIPTION, UDP_DESCRIPTION, WireError,
    describe_name, described_name, write_frame,
};

/// A device whose reports are wanted.
#[derive(Debug)]
struct Device {
    name: String,
    label: Arc<str>,
    held: [bool; MAX_BUTTONS],
    found: bool,
    answered: bool,
}

/// The client's half of a conversation; persists through reconnections.
#[derive(Debug)]
pub struct Session {
    devices: Vec<Device>,
    senders: IdTable<Option<usize>>,
    kinds: IdTable<Option<MessageKind>>,
    clock: SenderClock,
    heard_s: f64,
    sequence: u32,
    /// Counters over all connections.
    pub counters: Counters,
}

impl Session {
    /// Creates it. `devices` are names on the server, each with the label for its events.
    pub fn new(devices: impl IntoIterator<Item = (String, Arc<str>)>) -> Self {
        let devices = devices
            .into_iter()
            .map(|(name, label)| Device {
                name,
                label,
                held: [false; MAX_BUTTONS],
                found: false,
                answered: false,
            })
            .collect();
        Self {
            devices,
            senders: IdTable::default(),
            kinds: IdTable::default(),
            clock: SenderClock::default(),
            heard_s: 0.0,
            sequence: 0,
            counters: Counters::default(),
        }
    }

    /// Returns the message to send after the cookies: the local UDP address and port, if any, the names of the devices,
    /// and the supported types.
    pub fn greeting(&mut self, udp: Option<(&str, u16)>, now_s: f64) -> Vec<u8> {
        self.heard_s = now_s;
        self.sequence = 0;
        let mut out = Vec::new();
        if let Some((host, port)) = udp {
            let payload: Vec<u8> = host.bytes().chain([0]).collect();
            self.write(&mut out, i32::from(port), UDP_DESCRIPTION, &payload);
        }
        for index in 0..self.devices.len() {
            let payload = describe_name(&self.devices[index].name);
            self.write(&mut out, index as i32, SENDER_DESCRIPTION, &payload);
        }
        for (id, kind) in MessageKind::ALL.iter().enumerate() {
            self.write(&mut out, id as i32, TYPE_DESCRIPTION, &describe_name(kind.name()));
        }
        out
    }

    /// Returns pings for every device, or only for those that have not answered yet. Empty if there are none.
    pub fn pings(&mut self, all: bool) -> Vec<u8> {
        let mut out = Vec::new();
        for index in 0..self.devices.len() {
            if all || !self.devices[index].answered {
                self.write(&mut out, index as i32, id_of(MessageKind::Ping), &[]);
            }
        }
        out
    }

    fn write(&mut self, out: &mut Vec<u8>, sender: i32, kind: i32, payload: &[u8]) {
        write_frame(out, Stamp::default(), sender, kind, self.sequence, payload);
        self.sequence = self.sequence.wrapping_add(1);
    }

    /// Returns the arrival time of the last message, on the host's clock.
    pub fn heard_s(&self) -> f64 {
        self.heard_s
    }

    /// Returns whether a device has ever answered a ping on this connection.
    pub fn has_answers(&self) -> bool {
        self.devices.iter().any(|device| device.answered)
    }

    /// Handles the end of a connection: releases held buttons, reports found devices as lost, forgets ids.
    pub fn forget(&mut self, time_s: f64, events: &mut Vec<Event>) {
        for device in &mut self.devices {
            for button in 0..MAX_BUTTONS {
                device.set_button(button, false, time_s, events);
            }
            if device.found {
                events.push(Event::Lost { source: device.label.clone(), time_s });
            }
            device.found = false;
            device.answered = false;
        }
        self.senders = IdTable::default();
        self.kinds = IdTable::default();
        self.clock = SenderClock::default();
    }

    /// Counts bytes that are not VRPN.
    pub fn reject(&mut self, error: WireError) {
        match error {
            WireError::Oversized(_) => self.counters.oversized += 1,
            WireError::Cookie | WireError::Short(_) | WireError::Truncated => {
                self.counters.malformed += 1;
            }
        }
    }

    /// Handles one message that arrived at `arrival_s` and appends its events.
    pub fn receive(&mut self, frame: &Frame<'_>, arrival_s: f64, events: &mut Vec<Event>) {
        self.heard_s = arrival_s;
        if frame.kind < 0 {
            self.describe(frame);
            return;
        }
        let (Some(kind), Some(device)) =
            (self.kinds.get(frame.kind).copied(), self.senders.get(frame.sender).copied())
        else {
            self.counters.undescribed += 1;
            return;
        };
        let (Some(kind), Some(device)) = (kind, device) else {
            self.counters.ignored += 1;
            return;
        };
        match Message::decode(kind, frame.payload) {
            Ok(message) => {
                self.counters.accepted += 1;
                // The others may carry the time of the last change.
                let time_s = if kind.is_low_latency() {
                    self.clock.host_time_s(frame.stamp.since_1970(), arrival_s)
                } else {
                    arrival_s
                };
                let device = &mut self.devices[device];
                if !device.found {
                    device.found = true;
                    events.push(Event::Found { source: device.label.clone(), time_s });
                }
                if !device.say(message, frame.stamp, time_s, events) {
                    self.counters.accepted -= 1;
                    self.counters.not_finite += 1;
                }
            }
            Err(MessageError::NotFinite(_)) => self.counters.not_finite += 1,
            Err(MessageError::Length(..) | MessageError::Index(_)) => self.counters.malformed += 1,
        }
    }

    fn describe(&mut self, frame: &Frame<'_>) {
        let sound = match frame.kind {
            SENDER_DESCRIPTION => described_name(frame.payload).is_some_and(|name| {
                let device = self.devices.iter().position(|device| device.name == name);
                self.senders.describe(frame.sender, device)
            }),
            TYPE_DESCRIPTION => described_name(frame.payload)
                .is_some_and(|name| self.kinds.describe(frame.sender, MessageKind::of_name(name))),
            // A client sends nothing by UDP, requests for logging are ignored, and the rest belongs to later
            // versions.
            _ => {
                self.counters.ignored += 1;
                return;
            }
        };
        if sound {
            self.counters.accepted += 1;
        } else {
            self.counters.malformed += 1;
        }
    }
}

/// Returns the local id of a type.
fn id_of(kind: MessageKind) -> i32 {
    MessageKind::ALL.iter().position(|k| *k == kind).map_or(-1, |index| index as i32)
}

impl Device {
    fn set_button(&mut self, button: usize, pressed: bool, time_s: f64, events: &mut Vec<Event>) {
        if let Some(held) = self.held.get_mut(button)
            && *held != pressed
        {
            *held = pressed;
            let source = self.label.clone();
            events.push(Event::Button { source, button: button as u32, pressed, time_s });
        }
    }

    /// Appends the events of the message. Returns false if its numbers are finite but impossible.
    fn say(
        &mut self,
        message: Message,
        stamp: Stamp,
        time_s: f64,
        events: &mut Vec<Event>,
    ) -> bool {
        let source = self.label.clone();
        match message {
            Message::Pose { sensor, position_m, quat } => {
                let Some(placement) = Placement::checked(position_m, quat) else { return false };
                events.push(Event::Pose(HeadPose {
                    placement,
                    time_s,
                    sender_time: stamp.since_1970(),
                    source,
                    sensor,
                    confidence: 1.0,
                    velocity: None,
                }));
            }
            Message::Velocity { sensor, linear, quat, dt_s } => {
                let Some(angular) = angular_velocity(quat, dt_s) else { return false };
                let Some(velocity) = Velocity::checked(linear, angular) else { return false };
                events.push(Event::Velocity { source, sensor, velocity, time_s });
            }
            Message::Acceleration { sensor, linear, .. } => {
                events.push(Event::Acceleration { source, sensor, linear_m_s2: linear, time_s });
            }
            Message::ButtonChange { button, pressed } => {
                self.set_button(button as usize, pressed, time_s, events);
            }
            Message::ButtonStates(states) => {
                for (button, pressed) in states.into_iter().enumerate() {
                    self.set_button(button, pressed, time_s, events);
                }
            }
            Message::Analog(values) => {
                events.extend(values.into_iter().enumerate().map(|(channel, value)| {
                    let (source, channel) = (source.clone(), channel as u32);
                    Event::Analog { source, channel, value, time_s }
                }));
            }
            Message::Dial { dial, revolutions } => {
                events.push(Event::Dial { source, dial, revolutions, time_s });
            }
            Message::Text { severity, level, text } => {
                let severity = match severity {
                    0 => Severity::Normal,
                    1 => Severity::Warning,
                    _ => Severity::Error,
                };
                events.push(Event::Text { source, severity, level, text, time_s });
            }
            Message::Pong => self.answered = true,
            // Replies to requests that are never sent, and requests that a server does not send.
            Message::ToRoom { .. }
            | Message::UnitToSensor { .. }
            | Message::Workspace { .. }
            | Message::RequestToRoom
            | Message::RequestUnitToSensor
            | Message::RequestWorkspace
            | Message::SetUpdateRate { .. }
            | Message::ResetOrigin
            | Message::Ping => {}
        }
        true
    }
}

/// Returns the axis times radians per second of a rotation in `dt_s`; `None` if either is zero.
fn angular_velocity(turn: DQuat, dt_s: f64) -> Option<glam::DVec3> {
    let turn = Placement::checked(glam::DVec3::ZERO, turn)?.orientation;
    (dt_s > 0.0).then(|| rotation_vector(turn) / dt_s)
}
