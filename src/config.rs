//! Owns the settings: TOML text in, a checked [`Config`] out. Errors name the file and the key.
//!
//! `config/default.toml` is the documentation of every key and equals [`Config::default`].

use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize, de};
use thiserror::Error;

use crate::command::NewSculpture;
use crate::document::Limits;
use crate::format::store;
use crate::gpu::{DeviceChoice, DeviceOptions, Validation};
use crate::sculpture::{ColourDepth, Rgb};
use crate::shade::Lighting;

mod folders;
mod gamepad;
mod headset;
pub mod light;
mod profile;
pub mod render;
pub mod stereo;
mod tracking;
mod video;

pub use self::tracking::{ArSettings, ScreenSettings, SourceAddress, TrackingSettings};
pub use folders::{cache_folder, personal_file, personal_folder, state_folder};
pub use gamepad::GamepadSettings;
pub use headset::HeadsetSettings;
pub use light::LightSettings;
pub use profile::Profile;
pub use render::{Finish, Render, RenderMode, Sampling, Shading};
pub use stereo::StereoSettings;
pub use video::VideoSettings;

/// The commented file of all defaults.
pub const DEFAULT_TOML: &str = include_str!("../config/default.toml");

/// Scales of text and buttons.
pub const SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.5..=4.0;

/// Why the settings cannot be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    #[error("cannot read the settings {path}: {error}")]
    Read { path: PathBuf, error: std::io::Error },
    #[error("the settings {path} cannot be used: {error}")]
    Parse { path: PathBuf, error: Box<toml::de::Error> },
    #[error("the settings {path}: {key} = {value}: {rule}")]
    Value { path: PathBuf, key: &'static str, value: String, rule: &'static str },
}

/// All settings.
#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    pub memory: Memory,
    pub new: New,
    pub render: Render,
    pub light: LightSettings,
    pub gpu: Gpu,
    pub window: Window,
    pub stereo: StereoSettings,
    pub video: VideoSettings,
    pub gamepad: GamepadSettings,
    pub tracking: TrackingSettings,
    pub screen: ScreenSettings,
    pub ar: ArSettings,
    pub headset: HeadsetSettings,
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Memory {
    pub grid_mib: u64,
    pub colour_mib: u64,
    pub history_mib: u64,
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct New {
    pub dims: [u32; 3],
    #[serde(deserialize_with = "colour_bits")]
    pub colour_bits: ColourDepth,
    #[serde(deserialize_with = "rgb")]
    pub base: Rgb,
}

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gpu {
    pub device: String,
    pub validation: bool,
    /// The folder of compiled pipelines; no setting, but given by whoever runs the program.
    #[serde(skip)]
    pub pipeline_cache: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    #[default]
    Dark,
    Light,
}

impl Theme {
    pub fn other(self) -> Theme {
        match self {
            Theme::Dark => Theme::Light,
            Theme::Light => Theme::Dark,
        }
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Window {
    pub size: [u32; 2],
    pub theme: Theme,
    pub guide: bool,
    pub scale: f32,
}

impl Default for Memory {
    fn default() -> Self {
        Memory { grid_mib: 1024, colour_mib: 4096, history_mib: 1024 }
    }
}

impl Default for New {
    fn default() -> Self {
        New {
            dims: [256; 3],
            colour_bits: ColourDepth::Bits24,
            base: crate::command_text::DEFAULT_BASE,
        }
    }
}

impl Default for Window {
    fn default() -> Self {
        Window { size: [1280, 800], theme: Theme::Dark, guide: true, scale: 1.0 }
    }
}

impl Config {
    /// Reads the named file; without a name the person's own file if there is one, else the
    /// defaults.
    pub fn load(path: Option<&Path>) -> Result<Config, ConfigError> {
        Config::load_over(None, path)
    }

    /// The same over the settings of a profile.
    pub fn load_over(profile: Option<Profile>, path: Option<&Path>) -> Result<Config, ConfigError> {
        let own = personal_file();
        let path = match (path, &own) {
            (Some(path), _) => Some(path),
            (None, Some(own)) if own.exists() => Some(own.as_path()),
            _ => None,
        };
        let read = |path: &Path| {
            store::read_text(path).map_err(|error| ConfigError::Read { path: path.into(), error })
        };
        let text = path.map(read).transpose()?;
        match (profile, text.as_deref().zip(path)) {
            (Some(profile), own) => profile::layered(profile, own),
            (None, Some((text, path))) => Config::parse(text, path),
            (None, None) => Ok(Config::default()),
        }
    }

    /// Reads and checks TOML text; `path` is for messages only.
    pub fn parse(text: &str, path: &Path) -> Result<Config, ConfigError> {
        let config: Config = toml::from_str(text)
            .map_err(|error| ConfigError::Parse { path: path.into(), error: Box::new(error) })?;
        config.check(path)?;
        Ok(config)
    }

    fn check(&self, path: &Path) -> Result<(), ConfigError> {
        let demand = |ok: bool, key, value: String, rule| match ok {
            true => Ok(()),
            false => Err(ConfigError::Value { path: path.into(), key, value, rule }),
        };
        let Config { memory, new, render, light, window, stereo, gamepad, .. } = self;
        let (tracking, screen, ar) = (&self.tracking, &self.screen, &self.ar);
        let mib = |value: u64| (1..=1 << 24).contains(&value);
        let rule = "must be 1 to 16777216 MiB";
        demand(mib(memory.grid_mib), "memory.grid_mib", memory.grid_mib.to_string(), rule)?;
        demand(mib(memory.colour_mib), "memory.colour_mib", memory.colour_mib.to_string(), rule)?;
        demand(
            mib(memory.history_mib),
            "memory.history_mib",
            memory.history_mib.to_string(),
            rule,
        )?;
        let grid = crate::sculpture::Grid::check(
            new.dims.into(),
            glam::Vec3::ONE,
            self.limits().grid_bytes,
        );
        demand(
            grid.is_ok(),
            "new.dims",
            format!("{:?}", new.dims),
            "must be 1 to 4096 voxels per axis within memory.grid_mib",
        )?;
        demand(
            (1.0..=170.0).contains(&render.fov_deg),
            "render.fov_deg",
            render.fov_deg.to_string(),
            "must be 1 to 170 degrees",
        )?;
        demand(
            window.size.iter().all(|s| (320..=16384).contains(s)),
            "window.size",
            format!("{:?}", window.size),
            "must be 320 to 16384 points each",
        )?;
        demand(
            SCALE_RANGE.contains(&window.scale),
            "window.scale",
            window.scale.to_string(),
            "must be 0.5 to 4",
        )?;
        let ranges = gamepad.ranges().into_iter().chain(stereo.ranges()).chain(light.ranges());
        let ranges = ranges.chain(self.headset.ranges());
        for (key, value, range, rule) in ranges {
            demand(range.contains(&value), key, value.to_string(), rule)?;
        }
        match tracking.fault().or_else(|| screen.fault()).or_else(|| ar.fault()) {
            Some((key, value, rule)) => demand(false, key, value, rule),
            None => Ok(()),
        }
    }

    /// The light of a picture.
    pub fn lighting(&self) -> Lighting {
        self.render.finish().of(self.light.lighting())
    }

    /// The device to draw with.
    pub fn device_options(&self) -> DeviceOptions {
        let choice = DeviceChoice::parse(&self.gpu.device);
        let validation =
            if self.gpu.validation { Validation::Required } else { Validation::default() };
        let pipeline_cache = self.gpu.pipeline_cache.clone();
        DeviceOptions { choice, validation, pipeline_cache }.with_environment()
    }

    /// The block of stone that a session begins with.
    pub fn new_sculpture(&self) -> NewSculpture {
        NewSculpture {
            dims: self.new.dims.into(),
            voxel_size: glam::Vec3::ONE,
            colour_depth: self.new.colour_bits,
            base: self.new.base,
            solid: true,
        }
    }

    /// The memory limits of a document.
    pub fn limits(&self) -> Limits {
        Limits {
            grid_bytes: self.memory.grid_mib << 20,
            colour_bytes: self.memory.colour_mib << 20,
            history_bytes: (self.memory.history_mib << 20) as usize,
        }
    }
}

fn colour_bits<'de, D: Deserializer<'de>>(from: D) -> Result<ColourDepth, D::Error> {
    let bits = u32::deserialize(from)?;
    ColourDepth::from_bits(bits)
        .ok_or_else(|| de::Error::custom(format!("{bits} must be 0, 8, 16 or 24")))
}

fn rgb<'de, D: Deserializer<'de>>(from: D) -> Result<Rgb, D::Error> {
    String::deserialize(from)?.parse().map_err(de::Error::custom)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Config, ConfigError> {
        Config::parse(text, Path::new("my.toml"))
    }

    #[test]
    fn the_commented_file_is_the_default_and_names_every_key() {
        assert_eq!(parse(DEFAULT_TOML).unwrap(), Config::default());
        // Every key missing from the file would show here: remove lines one by one and the
        // result must still parse, add all and nothing is unknown.
        fn keys(value: &toml::Value) -> usize {
            match value {
                toml::Value::Table(table) => table.values().map(|v| 1 + keys(v)).sum(),
                toml::Value::Array(values) => values.iter().map(keys).sum(),
                _ => 0,
            }
        }
        let table: toml::Table = DEFAULT_TOML.parse().unwrap();
        // Which folder the compiled pipelines are in is no setting.
        let debug = format!("{:?}", Config::default()).replace("pipeline_cache: None", "");
        let fields = debug.matches(": ").count();
        assert_eq!(keys(&table.into()), fields, "a key lacks in default.toml: {debug}");
    }

    #[test]
    fn the_profile_of_the_headset_is_usable() {
        let config = parse(include_str!("../config/hmd.toml")).unwrap();
        assert!(config.headset.enabled);
    }

    #[test]
    fn a_partial_file_keeps_the_other_defaults() {
        let config = parse("[memory]\nhistory_mib = 7").unwrap();
        assert_eq!(config.limits().history_bytes, 7 << 20);
        assert_eq!(config.window, Window::default());
    }

    #[test]
    fn errors_name_file_and_key() {
        let cases = [
            ("[memory]\nhistry_mib = 7", "histry_mib"),
            ("[memory]\ngrid_mib = 0", "memory.grid_mib = 0"),
            ("[new]\ncolour_bits = 12", "12 must be 0, 8, 16 or 24"),
            ("[new]\nbase = \"red\"", "`red` is not a colour"),
            ("[new]\ndims = [0, 1, 1]", "new.dims"),
            ("[render]\nfov_deg = nan", "render.fov_deg"),
            ("[[light.lamps]]\nplace = [0.0, 0.0, 0.0]", "light.lamps.place"),
            ("[[light.lamps]]\nplace = [nan, 1.0, 0.0]", "light.lamps.place"),
            ("[[light.lamps]]\nintensity = 9.0", "light.lamps.intensity"),
            ("[[light.lamps]]\nframe = \"hat\"", "hat"),
            ("[light]\nlamps = [{}, {}, {}, {}, {}]", "light.lamps = 5"),
            ("[render]\nsmooth_normals = \"much\"", "much"),
            ("[light]\nambient = 2.0", "light.ambient"),
            ("[window]\nscale = 9.0", "window.scale"),
            ("[gamepad]\ndead_zone = 1.0", "gamepad.dead_zone"),
            ("[gamepad]\nmove_speed = nan", "gamepad.move_speed"),
            ("[gamepad]\nmode = \"fly\"", "fly"),
            ("[stereo]\nlayout = \"holo\"", "holo"),
            ("[stereo]\nconvergence_percent = 0.0", "stereo.convergence_percent"),
            ("[video]\nsource = \"https://phone/video\"", "https://"),
            ("[headset]\nsize_m = 0.0", "headset.size_m"),
            ("[headset]\nhand = \"third\"", "third"),
            ("[window", "my.toml"),
        ];
        for (text, needle) in cases {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(needle) && error.contains("my.toml"), "{text}: {error}");
        }
    }

    #[test]
    fn a_missing_named_file_is_an_error() {
        let error = Config::load(Some(Path::new("/nonexistent/x.toml"))).unwrap_err();
        assert!(error.to_string().contains("/nonexistent/x.toml"));
    }
}
