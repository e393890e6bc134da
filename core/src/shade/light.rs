//! The description of lights and materials. `illumination` has the formula.

use glam::Vec3;

use super::look::{Look, Matcap};
use super::normal::NORMAL_REACH_VX;
use super::occlusion::OCCLUSION_REACH_VX;
use super::tone::ToneMapping;
use crate::sculpture::Rgb;

/// The most lights in a picture.
pub const MAX_LIGHTS: usize = 4;

/// The coordinates in which a light is fixed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LightFrame {
    /// The world's: the light stays in place while the eye moves.
    World,
    /// The eye's: the light moves with it, as a headlamp.
    Eye,
}

/// Where light comes from, in the coordinates of a [`LightFrame`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum LightSource {
    /// From far away; the vector points towards the light.
    Direction(Vec3),
    /// From a point, without attenuation.
    Position(Vec3),
}

/// One light.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Light {
    /// The coordinates that `source` is in.
    pub frame: LightFrame,
    /// Its direction or position.
    pub source: LightSource,
    /// Its colour, in sRGB.
    pub colour: Rgb,
    /// Factor on the linear colour.
    pub intensity: f32,
}

/// The shadow of the first distant light.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Shadow {
    /// The angular diameter of the sun's disc. The larger, the softer the mean of samples.
    pub sun_deg: f32,
    /// The index of the sample in an antialiased picture.
    pub sample: u32,
}

/// All lights of a picture, and how the surface reflects them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lighting {
    /// The lights; `None` is an unused slot.
    pub lights: [Option<Light>; MAX_LIGHTS],
    /// The look of the surface: its material.
    pub look: Look,
    /// Used by [`Look::Matcap`].
    pub matcap: Matcap,
    /// Factor on the light of sky and ground.
    pub ambient: f32,
    /// Ambient light from above, in sRGB.
    pub sky: Rgb,
    /// Ambient light from below, in sRGB.
    pub ground: Rgb,
    /// The direction of the sky, in the world.
    pub up: Vec3,
    /// Factor on all light, as a power of two.
    pub exposure_ev: f32,
    /// Maps the light of the surface to that of the picture.
    pub tone: ToneMapping,
    /// Share of light in the highlight, 0 to 1. Applies to true colours, as does the shininess.
    pub specular: f32,
    /// Exponent of the highlight: the larger, the smaller and sharper. At most [`MAX_SHININESS`].
    pub shininess: u32,
    /// Whether ambient light is occluded by voxels nearby ([`super::occlusion`]).
    pub occlusion: bool,
    /// Whether the first distant light casts shadows ([`super::shadow`]).
    pub shadow: Option<Shadow>,
    /// The neighbourhood for averaging normals, by the software shader (`smooth`).
    pub smooth_normals: Smoothing,
    /// The neighbourhood for averaging colours, likewise.
    pub smooth_colours: Smoothing,
}

/// The largest exponent of a highlight; larger ones are clamped to it. The device's shaders use the same number of
/// bits.
pub const MAX_SHININESS: u32 = 1024;

/// The neighbourhood of an interpolation filter of the software shader.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Smoothing {
    /// No filter.
    #[default]
    Off,
    /// 3x3.
    Near,
    /// 5x5.
    Wide,
}

impl Smoothing {
    /// All values, from none to widest.
    pub const ALL: [Smoothing; 3] = [Smoothing::Off, Smoothing::Near, Smoothing::Wide];

    /// Returns the number of neighbours to each side.
    pub fn reach(self) -> i32 {
        match self {
            Smoothing::Off => 0,
            Smoothing::Near => 1,
            Smoothing::Wide => 2,
        }
    }
}

impl Lighting {
    /// Returns the distance, on each axis, of the farthest voxels that affect the shade of a pixel, from its visible
    /// voxel. `None` if other voxels matter, too: those that cast shadows, or that neighbouring pixels show.
    pub fn reach_vx(&self) -> Option<u32> {
        match [self.smooth_normals, self.smooth_colours] {
            _ if self.shadow.is_some() => None,
            [Smoothing::Off, Smoothing::Off] if self.occlusion => Some(OCCLUSION_REACH_VX),
            [Smoothing::Off, Smoothing::Off] => Some(NORMAL_REACH_VX),
            _ => None,
        }
    }
}

impl Lighting {
    /// Returns this lighting in one of the samples of an antialiased picture.
    pub fn of_sample(self, sample: u32) -> Lighting {
        let shadow = self.shadow.map(|shadow| Shadow { sample, ..shadow });
        Lighting { shadow, ..self }
    }
}

impl Default for Lighting {
    /// Returns one white lamp above the left shoulder, and the same ambient light from all directions.
    fn default() -> Self {
        let lamp = Light {
            frame: LightFrame::Eye,
            source: LightSource::Direction(Vec3::new(-0.5, 0.7, 1.0)),
            colour: Rgb::new(255, 255, 255),
            intensity: 1.0,
        };
        Lighting {
            lights: [Some(lamp), None, None, None],
            look: Look::Colours,
            matcap: Matcap::built_in(),
            ambient: 1.0,
            sky: Rgb::new(80, 80, 88),
            ground: Rgb::new(80, 80, 88),
            up: Vec3::Y,
            exposure_ev: 0.0,
            tone: ToneMapping::Off,
            specular: 0.25,
            shininess: 32,
            occlusion: false,
            shadow: None,
            smooth_normals: Smoothing::Off,
            smooth_colours: Smoothing::Off,
        }
    }
}
