//! Owns the settings: TOML text in, a checked [`Config`] out. Errors name the file and the key.
//!
//! `config/default.toml` is the documentation of every key and equals [`Config::default`].

use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, de};
use thiserror::Error;

use crate::document::Limits;
use crate::gpu::{DeviceChoice, DeviceOptions, Validation};
use crate::sculpture::{ColourDepth, Rgb};
use crate::shade::{Light, LightFrame, LightSource, Lighting};

mod gamepad;
mod profile;
pub mod stereo;
mod tracking;
mod video;

pub use self::tracking::{ArSettings, ScreenSettings, SourceAddress, TrackingSettings};
pub use gamepad::GamepadSettings;
pub use profile::Profile;
pub use stereo::StereoSettings;
pub use video::VideoSettings;

/// The commented file of all defaults.
pub const DEFAULT_TOML: &str = include_str!("../config/default.toml");

/// Scales of text and buttons.
pub const SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.5..=4.0;

/// Why the settings cannot be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    #[error("cannot read the configuration {path}: {error}")]
    Read { path: PathBuf, error: std::io::Error },
    #[error("the configuration {path} is not usable: {error}")]
    Parse { path: PathBuf, error: Box<toml::de::Error> },
    #[error("the configuration {path}: {key} = {value}: {rule}")]
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

/// How the surface is sampled and shaded.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum RenderMode {
    /// GPU slices, software shader
    #[default]
    Slicing,
    /// Exact CPU ray caster, software shader
    Ray,
    /// Approximate CPU ray caster, software shader
    Quickstep,
}

impl RenderMode {
    pub const ALL: [RenderMode; 3] = [RenderMode::Slicing, RenderMode::Ray, RenderMode::Quickstep];

    /// Whether it draws with Vulkan even where nothing is shown.
    pub fn needs_device(self) -> bool {
        self == RenderMode::Slicing
    }

    /// What the interface calls it.
    pub fn label(self) -> &'static str {
        match self {
            RenderMode::Slicing => "GPU slicing + software shader",
            RenderMode::Ray => "CPU ray caster + software shader",
            RenderMode::Quickstep => "CPU Quickstep + software shader",
        }
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Render {
    pub mode: RenderMode,
    pub fov_deg: f32,
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LightSettings {
    /// Towards the light, in eye space.
    pub direction: [f32; 3],
    #[serde(deserialize_with = "rgb")]
    pub colour: Rgb,
    pub ambient: f32,
    pub specular: f32,
}

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gpu {
    pub device: String,
    pub validation: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    #[default]
    Dark,
    Light,
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

impl Default for Render {
    fn default() -> Self {
        Render { mode: RenderMode::Slicing, fov_deg: 45.0 }
    }
}

impl Default for LightSettings {
    fn default() -> Self {
        LightSettings {
            direction: [-0.4, 0.7, 0.6],
            colour: Rgb::new(255, 255, 255),
            ambient: 0.25,
            specular: 0.25,
        }
    }
}

impl Default for Window {
    fn default() -> Self {
        Window { size: [1280, 800], theme: Theme::Dark, guide: true, scale: 1.0 }
    }
}

impl LightSettings {
    /// What the shaders take.
    pub fn lighting(&self) -> Lighting {
        let LightSettings { direction, colour, ambient, specular } = *self;
        // The share is of linear light, which the shader takes as the square of a colour.
        let grey = (ambient.sqrt() * 255.0).round() as u8;
        let lamp = Light {
            frame: LightFrame::Eye,
            source: LightSource::Direction(direction.into()),
            colour,
            intensity: 1.0,
        };
        Lighting {
            lights: [Some(lamp), None, None, None],
            ambient: Rgb::new(grey, grey, grey),
            specular,
            ..Lighting::default()
        }
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
            std::fs::read_to_string(path)
                .map_err(|error| ConfigError::Read { path: path.into(), error })
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
        let direction = glam::Vec3::from(light.direction);
        demand(
            direction.is_finite() && direction.length_squared() > 1e-12,
            "light.direction",
            format!("{:?}", light.direction),
            "must be three finite numbers, not all zero",
        )?;
        let share = "must be 0 to 1";
        let unit = 0.0..=1.0;
        demand(unit.contains(&light.ambient), "light.ambient", light.ambient.to_string(), share)?;
        demand(
            unit.contains(&light.specular),
            "light.specular",
            light.specular.to_string(),
            share,
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
        for (key, value, range, rule) in gamepad.ranges().into_iter().chain(stereo.ranges()) {
            demand(range.contains(&value), key, value.to_string(), rule)?;
        }
        match tracking.fault().or_else(|| screen.fault()).or_else(|| ar.fault()) {
            Some((key, value, rule)) => demand(false, key, value, rule),
            None => Ok(()),
        }
    }

    /// The light of a picture.
    pub fn lighting(&self) -> Lighting {
        self.light.lighting()
    }

    /// The device to draw with.
    pub fn device_options(&self) -> DeviceOptions {
        let choice = DeviceChoice::parse(&self.gpu.device);
        let validation =
            if self.gpu.validation { Validation::Required } else { Validation::default() };
        DeviceOptions { choice, validation }.with_environment()
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

/// The file of a person's own settings.
pub fn personal_file() -> Option<PathBuf> {
    personal_folder().map(|folder| folder.join("config.toml"))
}

/// Where a person's own settings are kept, as the XDG base directory specification says.
pub fn personal_folder() -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    let base = set("XDG_CONFIG_HOME").or_else(|| set("HOME").map(|home| home.join(".config")))?;
    Some(base.join("virtual-sculpture"))
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
        let table: toml::Table = DEFAULT_TOML.parse().unwrap();
        let keys = |t: &toml::Table| t.values().map(|s| s.as_table().unwrap().len()).sum::<usize>();
        let debug = format!("{:?}", Config::default());
        let fields = debug.matches(": ").count() - table.len();
        assert_eq!(keys(&table), fields, "a key lacks in default.toml: {debug}");
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
            ("[light]\ndirection = [0.0, 0.0, 0.0]", "light.direction"),
            ("[light]\nambient = 2.0", "light.ambient"),
            ("[window]\nscale = 9.0", "window.scale"),
            ("[gamepad]\ndead_zone = 1.0", "gamepad.dead_zone"),
            ("[gamepad]\nmove_speed = nan", "gamepad.move_speed"),
            ("[gamepad]\nmode = \"fly\"", "fly"),
            ("[stereo]\nlayout = \"holo\"", "holo"),
            ("[stereo]\nconvergence_percent = 0.0", "stereo.convergence_percent"),
            ("[video]\nsource = \"https://phone/video\"", "https://"),
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
