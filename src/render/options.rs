//! Options of rendering: mode, field of view, and the finish of the shading.

use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer};

use super::RenderMode;
use crate::options::{InvalidOption, require_in};
use crate::shade::{Lighting, Smoothing};

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RenderOptions {
    /// `None`: the default mode of the device.
    #[serde(deserialize_with = "mode_or_auto")]
    pub mode: Option<RenderMode>,
    pub fov_deg: f32,
    /// The smooth surface between near voxels instead of their cubes: in the window at rest, on a GPU always.
    pub smooth_surface: bool,
    pub smooth_normals: Smoothing,
    pub smooth_colours: Smoothing,
    pub occlusion: bool,
    /// In the window: antialiasing while nothing moves.
    pub refine: bool,
    /// Antialiasing while something moves, and in the headset. `None`: if the device is a GPU.
    #[serde(deserialize_with = "switch_or_auto")]
    pub smooth_edges: Option<bool>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        RenderOptions {
            mode: None,
            fov_deg: 45.0,
            smooth_surface: true,
            smooth_normals: Smoothing::Off,
            smooth_colours: Smoothing::Off,
            occlusion: true,
            refine: true,
            smooth_edges: None,
        }
    }
}

fn mode_or_auto<'de, D: Deserializer<'de>>(from: D) -> Result<Option<RenderMode>, D::Error> {
    let text = String::deserialize(from)?;
    match text.as_str() {
        "auto" => Ok(None),
        _ => RenderMode::deserialize(text.into_deserializer()).map(Some),
    }
}

fn switch_or_auto<'de, D: Deserializer<'de>>(from: D) -> Result<Option<bool>, D::Error> {
    #[derive(Deserialize)]
    #[serde(rename_all = "lowercase")]
    enum Switch {
        Auto,
        On,
        Off,
    }
    Ok(match Switch::deserialize(from)? {
        Switch::Auto => None,
        Switch::On => Some(true),
        Switch::Off => Some(false),
    })
}

impl RenderOptions {
    pub fn check(&self) -> Result<(), InvalidOption> {
        require_in(1.0..=170.0, "fov_deg", self.fov_deg, "must be 1 to 170 degrees")
    }

    /// Returns the finish of the shading.
    pub fn finish(&self) -> Finish {
        Finish {
            smooth_normals: self.smooth_normals,
            smooth_colours: self.smooth_colours,
            occlusion: self.occlusion,
        }
    }
}

/// Refinements of the shading that do not depend on the lamps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Finish {
    pub smooth_normals: Smoothing,
    pub smooth_colours: Smoothing,
    pub occlusion: bool,
}

impl Default for Finish {
    fn default() -> Self {
        RenderOptions::default().finish()
    }
}

impl Finish {
    /// Returns `lighting` with this finish.
    pub fn of(self, lighting: Lighting) -> Lighting {
        let Finish { smooth_normals, smooth_colours, occlusion } = self;
        Lighting { smooth_normals, smooth_colours, occlusion, ..lighting }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_one_of_the_names_or_left_to_the_device() {
        let mode = |text: &str| toml::from_str::<RenderOptions>(text).map(|render| render.mode);
        assert_eq!(mode("").unwrap(), None);
        assert_eq!(mode("mode = \"auto\"").unwrap(), None);
        assert_eq!(mode("mode = \"gpu-colour\"").unwrap(), Some(RenderMode::GpuColour));
        let edges = |text: &str| toml::from_str::<RenderOptions>(text).map(|o| o.smooth_edges);
        let switch = |text: &str| edges(&format!("smooth_edges = \"{text}\"")).unwrap();
        assert_eq!(["auto", "on", "off"].map(switch), [None, Some(true), Some(false)]);
        assert_eq!(edges("").unwrap(), None);
        let error = mode("mode = \"automatic\"").unwrap_err().to_string();
        assert!(error.contains("automatic") && error.contains("slicing-points"), "{error}");
    }
}
