//! Render modes: each combines a sampling (which finds the voxel of a pixel) and a shading (which computes its colour).

use serde::Deserialize;

/// The sampling and shading of the surface.
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

/// The way to find the voxel of each pixel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sampling {
    /// The exact ray caster.
    Cast,
    /// The approximate ray caster.
    Quickstep,
    Slicing,
    March,
    /// In the shader that also lights it; there is no index map.
    Within,
}

/// The way to compute the colour of each pixel.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shading {
    Software,
    /// Lit points.
    Points,
    /// By a shader that reads the index map.
    Device,
    /// In the shader that also samples.
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

    /// Returns the default mode of a device. On a GPU nothing goes through the CPU, which is too slow for a headset:
    /// the software shader takes 0.3 s for its two pictures. A software device shares the CPU, where the software
    /// shader is the fastest.
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

    /// Returns whether the mode reads the voxels' colours on the device.
    pub fn needs_colours(self) -> bool {
        matches!(self, RenderMode::GpuColour | RenderMode::MarchGpu)
    }

    /// Returns whether the mode can show the smooth surface: a point stands for a voxel and its box.
    pub fn can_be_smooth(self) -> bool {
        self.shading() != Shading::Points
    }

    /// Returns whether the picture never leaves the device.
    pub fn shades_on_device(self) -> bool {
        matches!(self.shading(), Shading::Device | Shading::Within)
    }

    /// Returns whether a picture without a screen needs Vulkan.
    pub fn needs_device(self) -> bool {
        !matches!(self, RenderMode::Ray | RenderMode::Quickstep)
    }

    /// Returns the mode for a sculpture that is too large for the device in this one.
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

    /// Returns the name in the interface.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_gpu_the_usual_mode_never_leaves_it() {
        let mode = RenderMode::usual(false);
        assert!(matches!(mode.sampling(), Sampling::March | Sampling::Within));
        assert!(matches!(mode.shading(), Shading::Device | Shading::Within));
        assert!(mode.needs_colours(), "and it shows colours");
        assert_eq!(RenderMode::usual(true), RenderMode::default());
    }
}
