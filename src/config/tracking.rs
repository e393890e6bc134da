//! The settings of head tracking, of the screen before the head, and of the marker under the
//! sculpture.

use std::collections::BTreeMap;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::str::FromStr;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Deserializer, de};
use tracking::calibration::Calibration;
use tracking::fade::FadeOptions;
use tracking::filter::OneEuroOptions;
use tracking::opentrack::Signs;
use tracking::predict::PredictionOptions;
use tracking::vrpn::DeviceAddress;
use tracking::{BodyOptions, ChannelOptions, Placement, Smoothing};

use crate::fiducial::family;
use crate::input::Action;
use crate::input::action::Kind;
use crate::screen::headset::RoomOrigin;

/// Numbers of opentrack in the order in which they come.
const AXES: [&str; 6] = ["x", "y", "z", "yaw", "pitch", "roll"];

/// Who says where the head is.
#[derive(Clone, PartialEq, Debug, Default)]
pub enum SourceAddress {
    #[default]
    None,
    Vrpn(DeviceAddress),
    /// Where we listen for opentrack.
    Opentrack(SocketAddr),
    Script(PathBuf),
    /// A headset that is used only as a tracker, on the axes of this origin.
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
        String::deserialize(from)?.parse().map_err(de::Error::custom)
    }
}

impl SourceAddress {
    /// The name under which its poses come ([`tracking::HeadPose::source`]).
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
pub struct TrackingSettings {
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

impl Default for TrackingSettings {
    fn default() -> Self {
        let (position, turn) = (OneEuroOptions::POSITION, OneEuroOptions::ORIENTATION);
        TrackingSettings {
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

/// A key with a value that cannot be, and what it may be.
pub(super) type Fault = (&'static str, String, &'static str);

impl TrackingSettings {
    /// The calibration that the settings give; a file may replace all but the place of the eyes.
    pub fn calibration(&self) -> Calibration {
        let given = Calibration::from_values(
            self.translation_m.into(),
            self.yaw_pitch_roll_deg,
            self.scale,
        );
        Calibration { sensor_from_eyes: self.eyes(), ..given.unwrap_or_default() }
    }

    /// The point between the eyes on the sensor's axes.
    pub fn eyes(&self) -> Placement {
        Placement { position_m: self.eyes_m.into(), orientation: DQuat::IDENTITY }
    }

    pub fn signs(&self) -> Signs {
        Signs { inverted: AXES.map(|axis| self.invert.iter().any(|given| given == axis)) }
    }

    /// The head as the tracker is to follow it.
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

    /// The device whose buttons and analogs are heard, if it is not the tracker itself.
    pub fn controls(&self) -> Option<DeviceAddress> {
        self.controls.parse().ok()
    }

    /// Buttons and channels with what they do.
    pub fn bound(table: &BTreeMap<String, String>) -> impl Iterator<Item = (u32, Action)> {
        table.iter().filter_map(|(number, name)| Some((number.parse().ok()?, Action::named(name)?)))
    }

    pub(super) fn fault(&self) -> Option<Fault> {
        let hz = |value: f64| (0.01..=1000.0).contains(&value);
        let growth = |value: f64| (0.0..=1e4).contains(&value);
        let ms = |value: f64| (0.0..=60_000.0).contains(&value);
        let near = |place: [f64; 3], most: f64| place.iter().all(|v| v.abs() <= most);
        let cutoff = "must be 0.01 to 1000 Hz";
        let beta = "must be 0 to 10000";
        let time = "must be 0 to 60000 ms";
        let number = |value: f64| value.to_string();
        let checks = [
            ("tracking.sensor", self.sensor < 65536, self.sensor.to_string(), "must be 0 to 65535"),
            (
                "tracking.position_cutoff_hz",
                hz(self.position_cutoff_hz),
                number(self.position_cutoff_hz),
                cutoff,
            ),
            (
                "tracking.position_beta",
                growth(self.position_beta),
                number(self.position_beta),
                beta,
            ),
            (
                "tracking.turn_cutoff_hz",
                hz(self.turn_cutoff_hz),
                number(self.turn_cutoff_hz),
                cutoff,
            ),
            ("tracking.turn_beta", growth(self.turn_beta), number(self.turn_beta), beta),
            (
                "tracking.prediction_ms",
                (0.0..=100.0).contains(&self.prediction_ms),
                number(self.prediction_ms),
                "must be 0 to 100 ms",
            ),
            (
                "tracking.lost_after_ms",
                (10.0..=60_000.0).contains(&self.lost_after_ms),
                number(self.lost_after_ms),
                "must be 10 to 60000 ms",
            ),
            ("tracking.hold_ms", ms(self.hold_ms), number(self.hold_ms), time),
            ("tracking.leave_ms", ms(self.leave_ms), number(self.leave_ms), time),
            ("tracking.return_ms", ms(self.return_ms), number(self.return_ms), time),
            (
                "tracking.translation_m",
                near(self.translation_m, 1e3),
                format!("{:?}", self.translation_m),
                "must be three numbers within 1000 m",
            ),
            (
                "tracking.yaw_pitch_roll_deg",
                near(self.yaw_pitch_roll_deg, 360.0),
                format!("{:?}", self.yaw_pitch_roll_deg),
                "must be three angles from -360 to 360 degrees",
            ),
            (
                "tracking.scale",
                (0.01..=100.0).contains(&self.scale),
                number(self.scale),
                "must be 0.01 to 100",
            ),
            (
                "tracking.eyes_m",
                near(self.eyes_m, 1.0),
                format!("{:?}", self.eyes_m),
                "must be three numbers within 1 m",
            ),
            (
                "tracking.tip_m",
                near(self.tip_m, 2.0),
                format!("{:?}", self.tip_m),
                "must be three numbers within 2 m",
            ),
            (
                "tracking.invert",
                self.invert.iter().all(|axis| AXES.contains(&axis.as_str())),
                format!("{:?}", self.invert),
                "must be a list of x, y, z, yaw, pitch, roll",
            ),
            (
                "tracking.controls",
                self.controls.is_empty() || self.controls().is_some(),
                format!("{:?}", self.controls),
                "must be a VRPN device such as Button0@host, or empty",
            ),
        ];
        let fault = checks.into_iter().find(|(_, sound, ..)| !sound);
        fault.map(|(key, _, value, rule)| (key, value, rule)).or_else(|| self.binding_fault())
    }

    fn binding_fault(&self) -> Option<Fault> {
        let fault = |key, number: &str, name: &str, rule| {
            Some((key, format!("{{ {number} = \"{name}\" }}"), rule))
        };
        let tables = [
            (
                "tracking.buttons",
                &self.buttons,
                256,
                "must be actions of a key, such as `undo` or `apply`",
            ),
            ("tracking.analogs", &self.analogs, 128, "must be actions of a key or of the wheel"),
        ];
        for (key, table, count, rule) in tables {
            for (number, name) in table {
                let kind = Action::named(name).map(|action| action.help().kind);
                let fits = match kind {
                    Some(Kind::Tap | Kind::Hold) => true,
                    Some(Kind::Wheel) => key == "tracking.analogs",
                    Some(Kind::Drag) | None => false,
                };
                if !fits || !number.parse().is_ok_and(|number: u32| number < count) {
                    return fault(key, number, name, rule);
                }
            }
        }
        None
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScreenSettings {
    /// Width and height; zeros where they are to be guessed.
    pub size_m: [f32; 2],
    /// Where the eyes are while nothing tracks them.
    pub rest_m: [f64; 3],
}

impl Default for ScreenSettings {
    fn default() -> Self {
        ScreenSettings { size_m: [0.0; 2], rest_m: [0.0, 0.0, 0.6] }
    }
}

impl ScreenSettings {
    pub(super) fn fault(&self) -> Option<Fault> {
        let sized = self.size_m.iter().all(|side| (0.02..=20.0).contains(side));
        if !sized && self.size_m != [0.0; 2] {
            let rule = "must be two lengths from 0.02 to 20 m, or zeros for an estimate";
            return Some(("screen.size_m", format!("{:?}", self.size_m), rule));
        }
        let [x, y, z] = self.rest_m;
        let sound = x.abs() <= 20.0 && y.abs() <= 20.0 && (0.1..=20.0).contains(&z);
        let rule = "must be right, up and towards the viewer: within 20 m, the last at least 0.1";
        (!sound).then(|| ("screen.rest_m", format!("{:?}", self.rest_m), rule))
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArSettings {
    /// Whether the sculpture stands on the marker from the start.
    pub on: bool,
    pub marker: u32,
    pub marker_mm: f64,
    pub voxel_mm: f32,
    pub camera_fov_deg: f64,
}

impl Default for ArSettings {
    fn default() -> Self {
        ArSettings { on: false, marker: 0, marker_mm: 80.0, voxel_mm: 0.4, camera_fov_deg: 45.0 }
    }
}

impl ArSettings {
    pub(super) fn fault(&self) -> Option<Fault> {
        let checks = [
            ("ar.marker", self.marker < family::COUNT, self.marker.to_string(), "must be 0 to 29"),
            (
                "ar.marker_mm",
                (5.0..=5000.0).contains(&self.marker_mm),
                self.marker_mm.to_string(),
                "must be 5 to 5000 mm",
            ),
            (
                "ar.voxel_mm",
                (0.001..=1000.0).contains(&self.voxel_mm),
                self.voxel_mm.to_string(),
                "must be 0.001 to 1000 mm",
            ),
            (
                "ar.camera_fov_deg",
                (5.0..=150.0).contains(&self.camera_fov_deg),
                self.camera_fov_deg.to_string(),
                "must be 5 to 150 degrees",
            ),
        ];
        let fault = checks.into_iter().find(|(_, sound, ..)| !sound);
        fault.map(|(key, _, value, rule)| (key, value, rule))
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

    #[test]
    fn faults_name_their_keys() {
        let parse = |toml: &str| {
            let path = std::path::Path::new("my.toml");
            super::super::Config::parse(toml, path).unwrap_err().to_string()
        };
        for (toml, key) in [
            ("[tracking]\nsource = \"Head0\"", "Head0"),
            ("[tracking]\nprediction_ms = nan", "tracking.prediction_ms"),
            ("[tracking]\nscale = 0.0", "tracking.scale"),
            ("[tracking]\ninvert = [\"w\"]", "tracking.invert"),
            ("[tracking]\nbuttons = { 0 = \"fly\" }", "tracking.buttons = { 0 = \"fly\" }"),
            ("[tracking]\nbuttons = { 0 = \"zoom\" }", "tracking.buttons"),
            ("[tracking]\nbuttons = { a = \"undo\" }", "tracking.buttons"),
            ("[tracking]\nanalogs = { 0 = \"move-tool\" }", "tracking.analogs"),
            ("[tracking]\ncontrols = \"Button0\"", "tracking.controls"),
            ("[screen]\nsize_m = [0.5, 0.0]", "screen.size_m"),
            ("[screen]\nrest_m = [0.0, 0.0, 0.0]", "screen.rest_m"),
            ("[ar]\nmarker = 30", "ar.marker"),
            ("[ar]\nvoxel_mm = nan", "ar.voxel_mm"),
        ] {
            let error = parse(toml);
            assert!(error.contains(key) && error.contains("my.toml"), "{toml}: {error}");
        }
    }
}
