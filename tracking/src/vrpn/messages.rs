//! Payloads of the VRPN messages of trackers, buttons, analogs and dials: bytes to values and back. Numbers that
//! are not finite, indices and counts beyond the limits, and payloads of a wrong length are errors.

use glam::{DQuat, DVec3};
use thiserror::Error;

/// Sensor numbers of a tracker are below this.
pub const MAX_SENSORS: u32 = 65_536;
/// Most buttons of a device.
pub const MAX_BUTTONS: usize = 256;
/// Most analog channels of a device.
pub const MAX_CHANNELS: usize = 128;
/// Most dials of a device.
pub const MAX_DIALS: u32 = 256;
/// Longest text, bytes.
pub const MAX_TEXT_BYTES: usize = 1023;
/// Bytes that the reference implementation always reserves for the text of a text message.
const TEXT_ROOM_BYTES: usize = 1024;

/// The reason why a payload is refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
pub enum MessageError {
    #[error("{0:?} with a payload of {1} bytes")]
    Length(MessageKind, usize),
    #[error("{0:?} with a number that is not finite")]
    NotFinite(MessageKind),
    #[error("{0:?} with an index or count that cannot be")]
    Index(MessageKind),
}

macro_rules! kinds {
    ($($kind:ident = $name:literal,)*) => {
        /// The supported message types.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum MessageKind {
            $(#[doc = concat!("`", $name, "`")] $kind,)*
        }

        impl MessageKind {
            pub const ALL: &[Self] = &[$(Self::$kind,)*];

            /// Returns the name by which peers agree on the id of a type.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)*
                }
            }
        }
    };
}

kinds! {
    Pose = "vrpn_Tracker Pos_Quat",
    Velocity = "vrpn_Tracker Velocity",
    Acceleration = "vrpn_Tracker Acceleration",
    ToRoom = "vrpn_Tracker To_Room",
    UnitToSensor = "vrpn_Tracker Unit_To_Sensor",
    RequestToRoom = "vrpn_Tracker Request_Tracker_To_Room",
    RequestUnitToSensor = "vrpn_Tracker Request_Unit_To_Sensor",
    Workspace = "vrpn_Tracker Workspace",
    RequestWorkspace = "vrpn_Tracker Request_Tracker_Workspace",
    SetUpdateRate = "vrpn_Tracker set_update_rate",
    ResetOrigin = "vrpn_Tracker Reset_Origin",
    ButtonChange = "vrpn_Button Change",
    ButtonStates = "vrpn_Button States",
    Analog = "vrpn_Analog Channel",
    Dial = "vrpn_Dial update",
    Text = "vrpn_Base text_message",
    Ping = "vrpn_Base ping_message",
    Pong = "vrpn_Base pong_message",
}

impl MessageKind {
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Returns whether messages of this kind are superseded a moment later: these use UDP if available.
    pub fn is_low_latency(self) -> bool {
        matches!(self, Self::Pose | Self::Velocity | Self::Acceleration | Self::Analog | Self::Dial)
    }
}

/// A payload with its meaning. Positions in metres; quaternions as sent, not normalised.
#[derive(Clone, PartialEq, Debug)]
pub enum Message {
    Pose {
        sensor: u32,
        position_m: DVec3,
        quat: DQuat,
    },
    /// Linear m/s; `quat` is the rotation in `dt_s` seconds.
    Velocity {
        sensor: u32,
        linear: DVec3,
        quat: DQuat,
        dt_s: f64,
    },
    /// Linear m/s2; `quat` is the change of rotation in `dt_s` seconds.
    Acceleration {
        sensor: u32,
        linear: DVec3,
        quat: DQuat,
        dt_s: f64,
    },
    ToRoom {
        position_m: DVec3,
        quat: DQuat,
    },
    UnitToSensor {
        sensor: u32,
        position_m: DVec3,
        quat: DQuat,
    },
    Workspace {
        min_m: DVec3,
        max_m: DVec3,
    },
    RequestToRoom,
    RequestUnitToSensor,
    RequestWorkspace,
    SetUpdateRate {
        rate_hz: f64,
    },
    ResetOrigin,
    ButtonChange {
        button: u32,
        pressed: bool,
    },
    ButtonStates(Vec<bool>),
    Analog(Vec<f64>),
    Dial {
        dial: u32,
        revolutions: f64,
    },
    /// Severity 0 normal, 1 warning, 2 error.
    Text {
        severity: u32,
        level: u32,
        text: String,
    },
    Ping,
    Pong,
}

impl Message {
    pub fn kind(&self) -> MessageKind {
        match self {
            Self::Pose { .. } => MessageKind::Pose,
            Self::Velocity { .. } => MessageKind::Velocity,
            Self::Acceleration { .. } => MessageKind::Acceleration,
            Self::ToRoom { .. } => MessageKind::ToRoom,
            Self::UnitToSensor { .. } => MessageKind::UnitToSensor,
            Self::Workspace { .. } => MessageKind::Workspace,
            Self::RequestToRoom => MessageKind::RequestToRoom,
            Self::RequestUnitToSensor => MessageKind::RequestUnitToSensor,
            Self::RequestWorkspace => MessageKind::RequestWorkspace,
            Self::SetUpdateRate { .. } => MessageKind::SetUpdateRate,
            Self::ResetOrigin => MessageKind::ResetOrigin,
            Self::ButtonChange { .. } => MessageKind::ButtonChange,
            Self::ButtonStates(_) => MessageKind::ButtonStates,
            Self::Analog(_) => MessageKind::Analog,
            Self::Dial { .. } => MessageKind::Dial,
            Self::Text { .. } => MessageKind::Text,
            Self::Ping => MessageKind::Ping,
            Self::Pong => MessageKind::Pong,
        }
    }

    /// Decodes a payload of `kind`.
    pub fn decode(kind: MessageKind, payload: &[u8]) -> Result<Self, MessageError> {
        let mut r = PayloadReader { kind, rest: payload, length: payload.len() };
        let message = match kind {
            MessageKind::Pose => {
                let sensor = r.sensor()?;
                Self::Pose { sensor, position_m: r.vec3()?, quat: r.quat()? }
            }
            MessageKind::UnitToSensor => {
                let sensor = r.sensor()?;
                Self::UnitToSensor { sensor, position_m: r.vec3()?, quat: r.quat()? }
            }
            MessageKind::Velocity => {
                let sensor = r.sensor()?;
                let (linear, quat) = (r.vec3()?, r.quat()?);
                Self::Velocity { sensor, linear, quat, dt_s: r.f64()? }
            }
            MessageKind::Acceleration => {
                let sensor = r.sensor()?;
                let (linear, quat) = (r.vec3()?, r.quat()?);
                Self::Acceleration { sensor, linear, quat, dt_s: r.f64()? }
            }
            MessageKind::ToRoom => Self::ToRoom { position_m: r.vec3()?, quat: r.quat()? },
            MessageKind::Workspace => Self::Workspace { min_m: r.vec3()?, max_m: r.vec3()? },
            MessageKind::SetUpdateRate => Self::SetUpdateRate { rate_hz: r.f64()? },
            MessageKind::ButtonChange => {
                let button = r.index(MAX_BUTTONS as u32)?;
                Self::ButtonChange { button, pressed: r.u32()? != 0 }
            }
            MessageKind::ButtonStates => {
                let count = r.index(MAX_BUTTONS as u32 + 1)?;
                Self::ButtonStates((0..count).map(|_| Ok(r.u32()? != 0)).collect::<Result<_, _>>()?)
            }
            MessageKind::Analog => {
                let count = r.f64()?;
                if count.fract() != 0.0 || !(0.0..=MAX_CHANNELS as f64).contains(&count) {
                    return Err(MessageError::Index(kind));
                }
                Self::Analog((0..count as usize).map(|_| r.f64()).collect::<Result<_, _>>()?)
            }
            MessageKind::Dial => {
                let revolutions = r.f64()?;
                Self::Dial { revolutions, dial: r.index(MAX_DIALS)? }
            }
            MessageKind::Text => {
                let (severity, level) = (r.u32()?, r.u32()?);
                Self::Text { severity, level, text: r.text()? }
            }
            MessageKind::RequestToRoom => Self::RequestToRoom,
            MessageKind::RequestUnitToSensor => Self::RequestUnitToSensor,
            MessageKind::RequestWorkspace => Self::RequestWorkspace,
            MessageKind::ResetOrigin => Self::ResetOrigin,
            MessageKind::Ping => Self::Ping,
            MessageKind::Pong => Self::Pong,
        };
        if r.rest.is_empty() { Ok(message) } else { Err(r.bad_length()) }
    }

    /// Encodes the payload. Texts are truncated to [`MAX_TEXT_BYTES`]; the caller must avoid numbers that
    /// [`Self::decode`] would refuse (see [`Self::is_sendable`]).
    pub fn encode(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(72);
        match self {
            Self::Pose { sensor, position_m, quat } => {
                write_u32s(&mut out, &[*sensor, *sensor]);
                write_placement(&mut out, *position_m, *quat);
            }
            Self::UnitToSensor { sensor, position_m, quat } => {
                write_u32s(&mut out, &[*sensor, 0]);
                write_placement(&mut out, *position_m, *quat);
            }
            Self::Velocity { sensor, linear, quat, dt_s }
            | Self::Acceleration { sensor, linear, quat, dt_s } => {
                write_u32s(&mut out, &[*sensor, *sensor]);
                write_placement(&mut out, *linear, *quat);
                write_f64s(&mut out, &[*dt_s]);
            }
            Self::ToRoom { position_m, quat } => write_placement(&mut out, *position_m, *quat),
            Self::Workspace { min_m, max_m } => {
                write_f64s(&mut out, &min_m.to_array());
                write_f64s(&mut out, &max_m.to_array());
            }
            Self::SetUpdateRate { rate_hz } => write_f64s(&mut out, &[*rate_hz]),
            Self::ButtonChange { button, pressed } => {
                write_u32s(&mut out, &[*button, u32::from(*pressed)]);
            }
            Self::ButtonStates(states) => {
                write_u32s(&mut out, &[states.len() as u32]);
                for pressed in states {
                    write_u32s(&mut out, &[u32::from(*pressed)]);
                }
            }
            Self::Analog(values) => {
                write_f64s(&mut out, &[values.len() as f64]);
                write_f64s(&mut out, values);
            }
            Self::Dial { dial, revolutions } => {
                write_f64s(&mut out, &[*revolutions]);
                write_u32s(&mut out, &[*dial]);
            }
            Self::Text { severity, level, text } => {
                write_u32s(&mut out, &[*severity, *level]);
                out.extend(text.bytes().take_while(|byte| *byte != 0).take(MAX_TEXT_BYTES));
                out.resize(8 + TEXT_ROOM_BYTES, 0);
            }
            Self::RequestToRoom
            | Self::RequestUnitToSensor
            | Self::RequestWorkspace
            | Self::ResetOrigin
            | Self::Ping
            | Self::Pong => {}
        }
        out
    }

    /// Returns whether a peer with the same limits would accept it.
    pub fn is_sendable(&self) -> bool {
        Self::decode(self.kind(), &self.encode()).is_ok()
    }
}

fn write_u32s(out: &mut Vec<u8>, values: &[u32]) {
    out.extend(values.iter().flat_map(|value| value.to_be_bytes()));
}

fn write_f64s(out: &mut Vec<u8>, values: &[f64]) {
    out.extend(values.iter().flat_map(|value| value.to_be_bytes()));
}

fn write_placement(out: &mut Vec<u8>, position: DVec3, quat: DQuat) {
    write_f64s(out, &position.to_array());
    write_f64s(out, &quat.to_array());
}

/// Reads a payload from its start; every read is checked.
struct PayloadReader<'a> {
    kind: MessageKind,
    rest: &'a [u8],
    length: usize,
}

impl PayloadReader<'_> {
    fn bad_length(&self) -> MessageError {
        MessageError::Length(self.kind, self.length)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], MessageError> {
        let (bytes, rest) = self.rest.split_first_chunk::<N>().ok_or(self.bad_length())?;
        self.rest = rest;
        Ok(*bytes)
    }

    fn u32(&mut self) -> Result<u32, MessageError> {
        Ok(u32::from_be_bytes(self.take()?))
    }

    /// Reads an index from the wire's i32, so that negative values exceed every limit.
    fn index(&mut self, limit: u32) -> Result<u32, MessageError> {
        let index = self.u32()?;
        if index < limit { Ok(index) } else { Err(MessageError::Index(self.kind)) }
    }

    /// Returns a sensor number and the unused word after it.
    fn sensor(&mut self) -> Result<u32, MessageError> {
        let sensor = self.index(MAX_SENSORS)?;
        self.u32()?;
        Ok(sensor)
    }

    fn f64(&mut self) -> Result<f64, MessageError> {
        let value = f64::from_be_bytes(self.take()?);
        if value.is_finite() { Ok(value) } else { Err(MessageError::NotFinite(self.kind)) }
    }

    fn vec3(&mut self) -> Result<DVec3, MessageError> {
        Ok(DVec3::new(self.f64()?, self.f64()?, self.f64()?))
    }

    fn quat(&mut self) -> Result<DQuat, MessageError> {
        Ok(DQuat::from_xyzw(self.f64()?, self.f64()?, self.f64()?, self.f64()?))
    }

    /// Returns a C string in the remaining bytes; bytes after its NUL are ignored.
    fn text(&mut self) -> Result<String, MessageError> {
        let bytes = std::mem::take(&mut self.rest);
        let end = bytes.iter().position(|byte| *byte == 0).ok_or(self.bad_length())?;
        if end > MAX_TEXT_BYTES {
            return Err(self.bad_length());
        }
        Ok(String::from_utf8_lossy(&bytes[..end]).into_owned())
    }
}

#[cfg(test)]
#[path = "messages_tests.rs"]
mod tests;
