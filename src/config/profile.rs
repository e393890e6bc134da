//! Profiles: sets of settings for a way of working, applied over the defaults and below the user's
//! settings.

use std::path::Path;

use toml::Table;

use super::{Config, ConfigError};

/// A set of settings that comes with the program.
#[derive(Clone, Copy, PartialEq, Eq, Debug, clap::ValueEnum)]
pub enum Profile {
    /// A window whose view follows the head
    Desktop,
    /// A headset
    Hmd,
    /// The sculpture on a marker in the picture of a camera
    Ar,
}

impl Profile {
    pub const ALL: [Profile; 3] = [Profile::Desktop, Profile::Hmd, Profile::Ar];

    /// Returns the name of its file, for messages.
    pub const fn file(self) -> &'static str {
        match self {
            Profile::Desktop => "desktop.toml",
            Profile::Hmd => "hmd.toml",
            Profile::Ar => "ar.toml",
        }
    }

    pub const fn text(self) -> &'static str {
        match self {
            Profile::Desktop => include_str!("../../config/desktop.toml"),
            Profile::Hmd => include_str!("../../config/hmd.toml"),
            Profile::Ar => include_str!("../../config/ar.toml"),
        }
    }
}

/// Returns the settings of a profile, overridden by the user's (text and path of the file). Errors name the file at
/// fault.
pub(super) fn layered(profile: Profile, own: Option<(&str, &Path)>) -> Result<Config, ConfigError> {
    let below = Path::new(profile.file());
    let base = Config::parse(profile.text(), below)?;
    let Some((text, path)) = own else { return Ok(base) };
    // Alone first, so that messages point into the user's file.
    Config::parse(text, path)?;
    let parse_error =
        |error: toml::de::Error| ConfigError::Parse { path: path.into(), error: Box::new(error) };
    let mut table: Table = profile.text().parse().map_err(parse_error)?;
    merge(&mut table, text.parse().map_err(parse_error)?);
    let config: Config = table.try_into().map_err(parse_error)?;
    config.completed(path)
}

/// Merges sections and replaces keys, so that a table of bindings comes from one file alone.
fn merge(below: &mut Table, above: Table) {
    for (section, value) in above {
        match (below.get_mut(&section), value) {
            (Some(toml::Value::Table(below)), toml::Value::Table(above)) => below.extend(above),
            (_, value) => {
                below.insert(section, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_are_valid_and_differ_from_the_defaults() {
        for profile in Profile::ALL {
            let config = layered(profile, None).unwrap();
            assert_ne!(config, Config::default(), "{profile:?}");
        }
        assert!(layered(Profile::Ar, None).unwrap().ar.on);
        assert!(layered(Profile::Desktop, None).unwrap().tracking.on);
    }

    #[test]
    fn the_users_settings_override_the_profile() {
        let path = Path::new("my.toml");
        let own = |text| layered(Profile::Ar, Some((text, path)));
        let config = own("[ar]\nmarker = 7\n[window]\nscale = 2.0").unwrap();
        assert_eq!((config.ar.on, config.ar.marker, config.window.scale), (true, 7, 2.0));
        assert!(!own("[ar]\non = false").unwrap().ar.on);
        let error = own("[ar]\nmarker = 70").unwrap_err().to_string();
        assert!(error.contains("my.toml") && error.contains("ar.marker"), "{error}");
    }
}
