//! The settings: reads TOML text into the options types of all rooms, checks them, and reports the file and the key in
//! errors.
//!
//! The rooms own their options with defaults and checks; this room only adds the names of the sections. It stands on
//! top: only the program, its command line and its jobs import it. `config/default.toml` documents every key and equals
//! [`Config::default`].

use std::path::{Path, PathBuf};

use serde::Deserialize;
use thiserror::Error;

use crate::command::NewSculpture;
use crate::document::Limits;
use crate::fiducial::ArOptions;
use crate::folders;
use crate::format::{FormatError, load_matcap, store};
use crate::gpu::{DeviceOptions, GpuOptions};
use crate::head_tracking::{ScreenOptions, TrackingOptions};
use crate::input::pad::GamepadOptions;
use crate::input::pen::PenOptions;
use crate::options::InvalidOption;
use crate::picture::PictureOptions;
use crate::render::light::MatcapFile;
use crate::render::{LightOptions, RenderOptions, StereoOptions};
use crate::screen::headset::HeadsetOptions;
use crate::shade::Lighting;
use crate::ui::{UiOptions, ViewOptions, WindowOptions};
use crate::video::VideoOptions;

mod model;
mod profile;

pub use model::{
    AutosaveSettings, JournalSettings, MemoryOptions, NewOptions, SavedHistorySettings,
};
pub use profile::Profile;

/// The commented file of all defaults.
pub const DEFAULT_TOML: &str = include_str!("../config/default.toml");

/// The reason why the settings cannot be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    #[error("cannot read the settings {path}: {error}")]
    Read { path: PathBuf, error: std::io::Error },
    #[error("the settings {path} cannot be used: {error}")]
    Parse { path: PathBuf, error: Box<toml::de::Error> },
    #[error("the settings {path}: {key} = {value}: {rule}")]
    Value { path: PathBuf, key: String, value: String, rule: &'static str },
    #[error("the settings {path}: light.matcap = {}: {error}", file.display())]
    Matcap { path: PathBuf, file: PathBuf, error: Box<FormatError> },
}

/// All settings, one field per section.
#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    pub memory: MemoryOptions,
    pub journal: JournalSettings,
    pub saved_history: SavedHistorySettings,
    pub autosave: AutosaveSettings,
    pub new: NewOptions,
    pub render: RenderOptions,
    pub light: LightOptions,
    pub gpu: GpuOptions,
    pub window: WindowOptions,
    pub view: ViewOptions,
    pub stereo: StereoOptions,
    pub video: VideoOptions,
    pub gamepad: GamepadOptions,
    pub pen: PenOptions,
    pub tracking: TrackingOptions,
    pub screen: ScreenOptions,
    pub ar: ArOptions,
    pub headset: HeadsetOptions,
}

impl Config {
    /// Reads the named file; without a name, the user's own file if it exists, or else the defaults.
    pub fn load(path: Option<&Path>) -> Result<Config, ConfigError> {
        Config::load_over(None, path)
    }

    /// Reads the settings over those of a profile.
    pub fn load_over(profile: Option<Profile>, path: Option<&Path>) -> Result<Config, ConfigError> {
        let own = folders::personal_file();
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
        config.completed(path)
    }

    /// Checks all values and reads the files that they name.
    fn completed(mut self, path: &Path) -> Result<Config, ConfigError> {
        self.check(path)?;
        if let Some(file) = self.light.matcap.path().map(PathBuf::from) {
            let image = load_matcap(&file);
            let image = image.map_err(|error| {
                let (path, file) = (path.into(), file.clone());
                ConfigError::Matcap { path, file, error: Box::new(error) }
            })?;
            self.light.matcap = MatcapFile::new(file, image);
        }
        Ok(self)
    }

    fn check(&self, path: &Path) -> Result<(), ConfigError> {
        let sections = [
            ("memory", self.memory.check()),
            ("journal", self.journal.check()),
            ("saved_history", self.saved_history.check()),
            ("autosave", self.autosave.check()),
            ("new", self.new.check()),
            ("render", self.render.check()),
            ("window", self.window.check()),
            ("gamepad", self.gamepad.check()),
            ("pen", self.pen.check()),
            ("stereo", self.stereo.check()),
            ("light", self.light.check()),
            ("headset", self.headset.check()),
            ("tracking", self.tracking.check()),
            ("screen", self.screen.check()),
            ("ar", self.ar.check()),
        ];
        for (section, checked) in sections {
            checked.map_err(|InvalidOption { key, value, rule }| ConfigError::Value {
                path: path.into(),
                key: format!("{section}.{key}"),
                value,
                rule,
            })?;
        }
        Ok(())
    }

    /// Returns the lighting of a picture.
    pub fn lighting(&self) -> Lighting {
        self.render.finish().of(self.light.lighting())
    }

    /// Returns the device to render with. `pipeline_cache`: the folder of compiled pipelines.
    pub fn device_options(&self, pipeline_cache: Option<PathBuf>) -> DeviceOptions {
        self.gpu.device_options(pipeline_cache)
    }

    /// Returns the options of pictures without a screen, made on `device`.
    pub fn picture_options(&self, device: &DeviceOptions) -> PictureOptions {
        let (lighting, device) = (self.lighting(), device.clone());
        PictureOptions { stereo: self.stereo, lighting, device }
    }

    /// Returns the initial options of the interface.
    pub fn ui_options(&self) -> UiOptions<'_> {
        UiOptions {
            window: &self.window,
            view: &self.view,
            autosave_min: self.autosave.minutes,
            new: self.new_sculpture(),
            render: &self.render,
            light: &self.light,
            stereo: &self.stereo,
            video: &self.video,
            headset: &self.headset,
            pen: self.pen.curve(),
        }
    }

    /// Returns the initial block of a session.
    pub fn new_sculpture(&self) -> NewSculpture {
        self.new.sculpture()
    }

    /// Returns the memory limits of a document.
    pub fn limits(&self) -> Limits {
        self.memory.limits()
    }
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
        // Every key missing from the file would show here: remove lines one by one and the result must still parse, add
        // all and nothing is unknown.
        fn keys(value: &toml::Value) -> usize {
            match value {
                toml::Value::Table(table) => table.values().map(|v| 1 + keys(v)).sum(),
                toml::Value::Array(values) => values.iter().map(keys).sum(),
                _ => 0,
            }
        }
        let table: toml::Table = DEFAULT_TOML.parse().unwrap();
        let debug = format!("{:?}", Config::default());
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
        assert_eq!(config.window, WindowOptions::default());
    }

    #[test]
    fn errors_name_file_and_key() {
        let cases = [
            ("[memory]\nhistry_mib = 7", "histry_mib"),
            ("[memory]\ngrid_mib = 0", "memory.grid_mib = 0"),
            ("[journal]\nmax_mib = 0", "journal.max_mib = 0"),
            ("[saved_history]\nmax_mib = 0", "saved_history.max_mib = 0"),
            ("[autosave]\nminutes = 1441", "autosave.minutes = 1441"),
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
            ("[light]\nexposure = 9.0", "light.exposure"),
            ("[light]\nsky = \"blue\"", "`blue` is not a colour"),
            ("[light]\ntone = \"loud\"", "loud"),
            ("[light]\nlook = \"gold\"", "gold"),
            ("[light]\nsun_deg = 90.0", "light.sun_deg"),
            ("[light]\nmatcap = \"/nowhere/ball.png\"", "light.matcap = /nowhere/ball.png"),
            ("[window]\nscale = 9.0", "window.scale"),
            ("[gamepad]\ndead_zone = 1.0", "gamepad.dead_zone"),
            ("[pen]\ncurve = 0.0", "pen.curve"),
            ("[pen]\nfull_at = nan", "pen.full_at"),
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
    fn errors_of_tracking_and_ar_name_file_and_key() {
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
            let error = parse(toml).unwrap_err().to_string();
            assert!(error.contains(key) && error.contains("my.toml"), "{toml}: {error}");
        }
    }

    #[test]
    fn a_missing_named_file_is_an_error() {
        let error = Config::load(Some(Path::new("/nonexistent/x.toml"))).unwrap_err();
        assert!(error.to_string().contains("/nonexistent/x.toml"));
    }
}
