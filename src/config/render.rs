//! The settings of rendering: by which passes, and how finely.

use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer};

use crate::shade::{Lighting, Smoothing};

/// How the surface is sampled and shaded.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum RenderMode {
    /// One shader samples and lights, in one colour
    Gpu,
    /// One shader samples and lights, in the voxels' colours
    GpuColour,
    /// GPU slices, software shader
    #[default]
    Slicing,
    /// GPU slices, lit points
    SlicingPoints,
    /// Exact CPU ray caster, software shader
    Ray,
    /// Exact CPU ray caster, lit points
    RayPoints,
    /// GPU ray march, software shader
    March,
    /// GPU ray march, GPU shader
    MarchGpu,
    /// Approximate CPU ray caster, software shader
    Quickstep,
}

/// Who finds the voxel of each pixel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sampling {
    /// The exact ray caster.
    Cast,
    /// The approximate ray caster.
    Quickstep,
    Slicing,
    March,
    /// The shader that lights it, too; there is no index map.
    Within,
}

/// Who gives each pixel its colour.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shading {
    Software,
    /// Points, lit by the pipeline.
    Points,
    /// A shader that reads the index map.
    Device,
    /// The shader that samples.
    Within,
}

impl RenderMode {
    pub const ALL: [RenderMode; 9] = [
        RenderMode::Slicing,
        RenderMode::SlicingPoints,
        RenderMode::March,
        RenderMode::MarchGpu,
        RenderMode::Gpu,
        RenderMode::GpuColour,
        RenderMode::Ray,
        RenderMode::RayPoints,
        RenderMode::Quickstep,
    ];

    /// The mode for a device where the person has chosen none. A GPU finds and lights the surface by
    /// itself: what goes to the CPU and back is too slow for a headset, whose two pictures the
    /// software shader takes 0.3 s for. A software device shares the CPU, where the software shader
    /// is the fastest.
    pub fn usual(software: bool) -> RenderMode {
        if software { RenderMode::Slicing } else { RenderMode::MarchGpu }
    }

    pub fn sampling(self) -> Sampling {
        match self {
            RenderMode::Gpu | RenderMode::GpuColour => Sampling::Within,
            RenderMode::Slicing | RenderMode::SlicingPoints => Sampling::Slicing,
            RenderMode::Ray | RenderMode::RayPoints => Sampling::Cast,
            RenderMode::March | RenderMode::MarchGpu => Sampling::March,
            RenderMode::Quickstep => Sampling::Quickstep,
        }
    }

    pub fn shading(self) -> Shading {
        match self {
            RenderMode::Gpu | RenderMode::GpuColour => Shading::Within,
            RenderMode::SlicingPoints | RenderMode::RayPoints => Shading::Points,
            RenderMode::MarchGpu => Shading::Device,
            RenderMode::Slicing | RenderMode::Ray | RenderMode::March | RenderMode::Quickstep => {
                Shading::Software
            }
        }
    }

    /// Whether the device needs the voxels' colours.
    pub fn needs_colours(self) -> bool {
        matches!(self, RenderMode::GpuColour | RenderMode::MarchGpu)
    }

    /// Whether it draws with Vulkan even where nothing is shown.
    pub fn needs_device(self) -> bool {
        !matches!(self, RenderMode::Ray | RenderMode::Quickstep)
    }

    /// The next best for a sculpture that is too large for the device in this mode.
    pub fn fallback(self) -> Option<RenderMode> {
        match self {
            RenderMode::GpuColour => Some(RenderMode::Gpu),
            RenderMode::MarchGpu => Some(RenderMode::March),
            RenderMode::SlicingPoints => Some(RenderMode::RayPoints),
            RenderMode::Gpu | RenderMode::Slicing | RenderMode::March | RenderMode::RayPoints => {
                Some(RenderMode::Ray)
            }
            RenderMode::Ray | RenderMode::Quickstep => None,
        }
    }

    /// What the interface calls it.
    pub fn label(self) -> &'static str {
        match self {
            RenderMode::Gpu => "GPU only, one colour",
            RenderMode::GpuColour => "GPU only, in colour",
            RenderMode::Slicing => "GPU slicing + software shader",
            RenderMode::SlicingPoints => "GPU slicing + points",
            RenderMode::Ray => "CPU ray caster + software shader",
            RenderMode::RayPoints => "CPU ray caster + points",
            RenderMode::March => "GPU ray march + software shader",
            RenderMode::MarchGpu => "GPU ray march + GPU shader",
            RenderMode::Quickstep => "CPU Quickstep + software shader",
        }
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Render {
    /// None: as suits the device.
    #[serde(deserialize_with = "mode_or_auto")]
    pub mode: Option<RenderMode>,
    pub fov_deg: f32,
    pub smooth_normals: Smoothing,
    pub smooth_colours: Smoothing,
    pub occlusion: bool,
}

impl Default for Render {
    fn default() -> Self {
        Render {
            mode: None,
            fov_deg: 45.0,
            smooth_normals: Smoothing::Off,
            smooth_colours: Smoothing::Off,
            occlusion: false,
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

impl Render {
    /// How fine the shading is.
    pub fn finish(&self) -> Finish {
        Finish {
            smooth_normals: self.smooth_normals,
            smooth_colours: self.smooth_colours,
            occlusion: self.occlusion,
        }
    }
}

/// What can be done for the look of a surface, besides lighting it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Finish {
    pub smooth_normals: Smoothing,
    pub smooth_colours: Smoothing,
    pub occlusion: bool,
}

impl Finish {
    /// `lighting` with this finish.
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
        let mode = |text: &str| toml::from_str::<Render>(text).map(|render| render.mode);
        assert_eq!(mode("").unwrap(), None);
        assert_eq!(mode("mode = \"auto\"").unwrap(), None);
        assert_eq!(mode("mode = \"gpu-colour\"").unwrap(), Some(RenderMode::GpuColour));
        let error = mode("mode = \"automatic\"").unwrap_err().to_string();
        assert!(error.contains("automatic") && error.contains("slicing-points"), "{error}");
    }

    #[test]
    fn on_a_gpu_the_usual_mode_never_leaves_it() {
        let mode = RenderMode::usual(false);
        assert!(matches!(mode.sampling(), Sampling::March | Sampling::Within));
        assert!(matches!(mode.shading(), Shading::Device | Shading::Within));
        assert!(mode.needs_colours(), "and it shows colours");
        assert_eq!(RenderMode::usual(true), RenderMode::default());
    }
}
