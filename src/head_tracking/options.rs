//! Options of head tracking: the source of poses, filters, calibration and controls, and the physical
//! screen in front of the head.

use std::collections::BTreeMap;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::str::FromStr;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Deserializer};
use tracking::calibration::Calibration;
use tracking::fade::FadeOptions;
use tracking::filter::OneEuroOptions;
use tracking::opentrack::Signs;
use tracking::predict::PredictionOptions;
use tracking::vrpn::DeviceAddress;
use tracking::{BodyOptions, ChannelOptions, Placement, Smoothing};

use crate::input::Action;
use crate::input::action::TriggerKind;
use crate::options::{self, InvalidOption, require, require_in};
use crate::screen::headset::RoomOrigin;

/// The axes of opentrack in the order of its packets.
const AXES: [&str; 6] = ["x", "y", "z", "yaw", "pitch", "roll"];

/// The source of the head poses.
#[derive(Clone, PartialEq, Debug, Default)]
pub enum SourceAddress {
    #[default]
    None,
    Vrpn(DeviceAddress),
    /// The address to listen at for opentrack.
    Opentrack(SocketAddr),
    Script(PathBuf),
    /// A headset used only as a tracker, in the space of this origin.
    Openxr(RoomOrigin),
}

impl FromStr for SourceAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if matches!(text, "" | "none") {
            return Ok(SourceAddress::None);
        }
        match text {
            "openxr" => return Ok(SourceAddress::Openxr(RoomOrigin::Stage)),
            "openxr:local" => return Ok(SourceAddress::Openxr(RoomOrigin::Local)),
            _ => {}
        }
        if let Some(file) = text.strip_prefix("script:").filter(|file| !file.is_empty()) {
            return Ok(SourceAddress::Script(file.into()));
        }
        if let Some(place) = text.strip_prefix("opentrack:") {
            let port = place.parse().map(|port: u16| (Ipv4Addr::LOCALHOST, port).into());
            return port.or_else(|_| place.parse()).map(SourceAddress::Opentrack).map_err(|_| {
                format!("\"{text}\" is not valid: opentrack: is followed by a port, or by address:port to listen at")
            });
        }
        text.parse().map(SourceAddress::Vrpn).map_err(|_| {
            format!(
                "\"{text}\" is not a source of poses; use Device@host, Device@tcp://host, \
                 opentrack:PORT, openxr, openxr:local, script:FILE or none"
            )
        })
    }
}

impl<'de> Deserialize<'de> for SourceAddress {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        options::from_text(from)
    }
}

impl SourceAddress {
    /// Returns the source name of its poses ([`tracking::HeadPose::source`]).
    pub fn label(&self) -> String {
        match self {
            SourceAddress::None => "none".to_owned(),
            SourceAddress::Vrpn(device) => device.to_string(),
            SourceAddress::Opentrack(_) => "opentrack".to_owned(),
            SourceAddress::Script(path) => path.display().to_string(),
            SourceAddress::Openxr(_) => "openxr".to_owned(),
        }
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrackingOptions {
    /// Whether the view follows the head from the start.
    pub on: bool,
    pub source: SourceAddress,
    pub sensor: u32,
    pub position_cutoff_hz: f64,
    pub position_beta: f64,
    pub turn_cutoff_hz: f64,
    pub turn_beta: f64,
    pub prediction_ms: f64,
    pub lost_after_ms: f64,
    pub hold_ms: f64,
    pub leave_ms: f64,
    pub return_ms: f64,
    pub calibration: String,
    pub translation_m: [f64; 3],
    pub yaw_pitch_roll_deg: [f64; 3],
    pub scale: f64,
    pub eyes_m: [f64; 3],
    pub tip_m: [f64; 3],
    pub invert: Vec<String>,
    pub controls: String,
    pub buttons: BTreeMap<String, String>,
    pub analogs: BTreeMap<String, String>,
}

impl Default for TrackingOptions {
    fn default() -> Self {
        let (position, turn) = (OneEuroOptions::POSITION, OneEuroOptions::ORIENTATION);
        TrackingOptions {
            on: false,
            source: SourceAddress::None,
            sensor: 0,
            position_cutoff_hz: position.min_cutoff_hz,
            position_beta: position.beta,
            turn_cutoff_hz: turn.min_cutoff_hz,
            turn_beta: turn.beta,
            prediction_ms: 20.0,
            lost_after_ms: 300.0,
            hold_ms: 500.0,
            leave_ms: 1500.0,
            return_ms: 500.0,
            calibration: String::new(),
            translation_m: [0.0; 3],
            yaw_pitch_roll_deg: [0.0; 3],
            scale: 1.0,
            eyes_m: [0.0; 3],
            tip_m: [0.0; 3],
            invert: Vec::new(),
            controls: String::new(),
            buttons: BTreeMap::new(),
            analogs: BTreeMap::new(),
        }
    }
}

impl TrackingOptions {
    /// Returns the calibration of these options. A calibration file replaces everything except the eye position.
    pub fn calibration(&self) -> Calibration {
        let given = Calibration::from_values(
            self.translation_m.into(),
            self.yaw_pitch_roll_deg,
            self.scale,
        );
        Calibration { sensor_from_eyes: self.eyes(), ..given.unwrap_or_default() }
    }

    /// Returns the point between the eyes in the space of the sensor.
    pub fn eyes(&self) -> Placement {
        Placement { position_m: self.eyes_m.into(), orientation: DQuat::IDENTITY }
    }

    pub fn signs(&self) -> Signs {
        Signs { inverted: AXES.map(|axis| self.invert.iter().any(|given| given == axis)) }
    }

    /// Returns the options of the tracked head.
    pub fn body(&self, rest_m: DVec3, calibration: Calibration) -> BodyOptions {
        let channel = ChannelOptions {
            calibration,
            smoothing: Some(Smoothing {
                position: OneEuroOptions {
                    min_cutoff_hz: self.position_cutoff_hz,
                    beta: self.position_beta,
                    ..OneEuroOptions::POSITION
                },
                orientation: OneEuroOptions {
                    min_cutoff_hz: self.turn_cutoff_hz,
                    beta: self.turn_beta,
                    ..OneEuroOptions::ORIENTATION
                },
            }),
            prediction: PredictionOptions::default(),
            lost_after_s: self.lost_after_ms * 1e-3,
            ..ChannelOptions::new(&self.source.label(), self.sensor)
        };
        BodyOptions {
            rest: Placement { position_m: rest_m, orientation: DQuat::IDENTITY },
            fade: FadeOptions {
                hold_s: self.hold_ms * 1e-3,
                leave_s: self.leave_ms * 1e-3,
                return_s: self.return_ms * 1e-3,
            },
            channels: vec![channel],
        }
    }

    /// Returns the device with the buttons and analogs, if it is not the tracker itself.
    pub fn controls(&self) -> Option<DeviceAddress> {
        self.controls.parse().ok()
    }

    /// Returns the buttons or channels with their actions.
    pub fn bound(table: &BTreeMap<String, String>) -> impl Iterator<Item = (u32, Action)> {
        table.iter().filter_map(|(number, name)| Some((number.parse().ok()?, Action::named(name)?)))
    }

    pub fn check(&self) -> Result<(), InvalidOption> {
        let hz = |key, value| require_in(0.01..=1000.0, key, value, "must be 0.01 to 1000 Hz");
        let beta = |key, value| require_in(0.0..=1e4, key, value, "must be 0 to 10000");
        let ms = |key, value| require_in(0.0..=60_000.0, key, value, "must be 0 to 60000 ms");
        let each_within = |key, values: [f64; 3], limit: f64, rule| {
            let is_valid = values.iter().all(|value| value.abs() <= limit);
            require(is_valid, key, format_args!("{values:?}"), rule)
        };
        require_in(0..=65535, "sensor", self.sensor, "must be 0 to 65535")?;
        hz("position_cutoff_hz", self.position_cutoff_hz)?;
        beta("position_beta", self.position_beta)?;
        hz("turn_cutoff_hz", self.turn_cutoff_hz)?;
        beta("turn_beta", self.turn_beta)?;
        require_in(0.0..=100.0, "prediction_ms", self.prediction_ms, "must be 0 to 100 ms")?;
        let rule = "must be 10 to 60000 ms";
        require_in(10.0..=60_000.0, "lost_after_ms", self.lost_after_ms, rule)?;
        ms("hold_ms", self.hold_ms)?;
        ms("leave_ms", self.leave_ms)?;
        ms("return_ms", self.return_ms)?;
        let rule = "must be three numbers within 1000 m";
        each_within("translation_m", self.translation_m, 1e3, rule)?;
        let rule = "must be three angles from -360 to 360 degrees";
        each_within("yaw_pitch_roll_deg", self.yaw_pitch_roll_deg, 360.0, rule)?;
        require_in(0.01..=100.0, "scale", self.scale, "must be 0.01 to 100")?;
        each_within("eyes_m", self.eyes_m, 1.0, "must be three numbers within 1 m")?;
        each_within("tip_m", self.tip_m, 2.0, "must be three numbers within 2 m")?;
        require(
            self.invert.iter().all(|axis| AXES.contains(&axis.as_str())),
            "invert",
            format_args!("{:?}", self.invert),
            "must be a list of x, y, z, yaw, pitch, roll",
        )?;
        require(
            self.controls.is_empty() || self.controls().is_some(),
            "controls",
            format_args!("{:?}", self.controls),
            "must be a VRPN device such as Button0@host, or empty",
        )?;
        let rule = "must be actions of a key, such as `undo` or `apply`";
        check_bindings("buttons", &self.buttons, 256, false, rule)?;
        let rule = "must be actions of a key or of the wheel";
        check_bindings("analogs", &self.analogs, 128, true, rule)
    }
}

/// Checks that every entry binds one of `count` numbers to an action of a key, or, if `wheel_allowed`, of the wheel.
fn check_bindings(
    key: &'static str,
    table: &BTreeMap<String, String>,
    count: u32,
    wheel_allowed: bool,
    rule: &'static str,
) -> Result<(), InvalidOption> {
    for (number, name) in table {
        let has_kind = match Action::named(name).map(|action| action.help().kind) {
            Some(TriggerKind::Tap | TriggerKind::Hold) => true,
            Some(TriggerKind::Wheel) => wheel_allowed,
            Some(TriggerKind::Drag) | None => false,
        };
        let is_valid = has_kind && number.parse().is_ok_and(|number: u32| number < count);
        require(is_valid, key, format_args!("{{ {number} = \"{name}\" }}"), rule)?;
    }
    Ok(())
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScreenOptions {
    /// Width and height; zeros for an estimate.
    pub size_m: [f32; 2],
    /// The position of the eyes while they are not tracked.
    pub rest_m: [f64; 3],
}

impl Default for ScreenOptions {
    fn default() -> Self {
        ScreenOptions { size_m: [0.0; 2], rest_m: [0.0, 0.0, 0.6] }
    }
}

impl ScreenOptions {
    pub fn check(&self) -> Result<(), InvalidOption> {
        let is_sized = self.size_m.iter().all(|side| (0.02..=20.0).contains(side));
        require(
            is_sized || self.size_m == [0.0; 2],
            "size_m",
            format_args!("{:?}", self.size_m),
            "must be two lengths from 0.02 to 20 m, or zeros for an estimate",
        )?;
        let [x, y, z] = self.rest_m;
        require(
            x.abs() <= 20.0 && y.abs() <= 20.0 && (0.1..=20.0).contains(&z),
            "rest_m",
            format_args!("{:?}", self.rest_m),
            "must be right, up and towards the viewer: within 20 m, the last at least 0.1",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_read() {
        let source = |text: &str| text.parse::<SourceAddress>();
        assert_eq!(source("none"), Ok(SourceAddress::None));
        assert_eq!(source("script:head.txt"), Ok(SourceAddress::Script("head.txt".into())));
        let listen = |text: &str| SourceAddress::Opentrack(text.parse().unwrap());
        assert_eq!(source("opentrack:4242"), Ok(listen("127.0.0.1:4242")));
        assert_eq!(source("opentrack:0.0.0.0:5000"), Ok(listen("0.0.0.0:5000")));
        assert_eq!(source("openxr"), Ok(SourceAddress::Openxr(RoomOrigin::Stage)));
        assert_eq!(source("openxr:local"), Ok(SourceAddress::Openxr(RoomOrigin::Local)));
        assert!(matches!(source("Head0@tcp://10.0.0.7"), Ok(SourceAddress::Vrpn(_))));
        for bad in ["opentrack:", "opentrack:99999", "Head0", "@host", "script:", "openxr:x"] {
            assert!(source(bad).unwrap_err().contains(bad), "{bad}");
        }
    }
}
