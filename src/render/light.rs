//! Options of lighting: the look of the surface, up to four lamps, ambient light of sky and ground, the specular highlight of the
//! surface, exposure and tone mapping. Converts them to the [`Lighting`] of the shaders.

use std::path::{Path, PathBuf};

use glam::Vec3;
use serde::Deserialize;

use crate::options::{self, InvalidOption, require_in};
use crate::sculpture::Rgb;
use crate::shade::{
    Light, LightFrame, LightSource, Lighting, Look, MAX_LIGHTS, Matcap, Shadow, ToneMapping,
};

/// Largest intensity of a lamp.
pub const MAX_INTENSITY: f32 = 4.0;
/// Largest exposure to either side, as a power of two.
pub const MAX_EXPOSURE_EV: f32 = 4.0;
/// Largest angle of the sun's disc.
pub const MAX_SUN_DEG: f32 = 45.0;

/// The light on a sculpture.
#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LightOptions {
    pub look: Look,
    pub matcap: MatcapFile,
    /// Factor on the linear light of sky and ground.
    pub ambient: f32,
    /// Ambient light from above and from below.
    #[serde(deserialize_with = "options::from_text")]
    pub sky: Rgb,
    #[serde(deserialize_with = "options::from_text")]
    pub ground: Rgb,
    /// Factor on all light, as a power of two.
    pub exposure: f32,
    pub tone: ToneMapping,
    /// The first distant lamp throws shadows.
    pub shadow: bool,
    /// The angle that it takes in the sky, in degrees.
    pub sun_deg: f32,
    pub specular: f32,
    pub shininess: u32,
    /// At most [`MAX_LIGHTS`].
    pub lamps: Vec<Lamp>,
}

/// A matcap and the file that it was read from.
#[derive(Clone, PartialEq, Default, Deserialize)]
#[serde(from = "PathBuf")]
pub struct MatcapFile {
    /// Empty: the program's own matcap.
    path: PathBuf,
    image: Matcap,
}

impl MatcapFile {
    /// Creates it from `image`, which was read from `path`.
    pub fn new(path: PathBuf, image: Matcap) -> MatcapFile {
        MatcapFile { path, image }
    }

    /// Returns the path; `None`: the program's own matcap.
    pub fn path(&self) -> Option<&Path> {
        Some(self.path.as_path()).filter(|path| !path.as_os_str().is_empty())
    }
}

impl From<PathBuf> for MatcapFile {
    /// Names the matcap of a file that is still to be read: a reader of settings replaces it by [`MatcapFile::new`].
    fn from(path: PathBuf) -> MatcapFile {
        MatcapFile { path, image: Matcap::built_in() }
    }
}

impl std::fmt::Debug for MatcapFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.path.fmt(f)
    }
}

/// The meaning of a lamp's place.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LampKind {
    /// The direction towards a lamp that is infinitely far away.
    #[default]
    Direction,
    /// The position of a point light.
    Position,
}

/// The space in which a lamp is fixed.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LampFrame {
    #[default]
    Eye,
    World,
}

#[derive(Clone, Copy, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Lamp {
    pub on: bool,
    pub kind: LampKind,
    pub frame: LampFrame,
    /// The direction towards the lamp, or its position in voxels of the sculpture's shortest edge.
    pub place: [f32; 3],
    #[serde(deserialize_with = "options::from_text")]
    pub colour: Rgb,
    /// Factor on the linear colour.
    pub intensity: f32,
}

impl Default for Lamp {
    fn default() -> Self {
        Lamp {
            on: true,
            kind: LampKind::Direction,
            frame: LampFrame::Eye,
            place: [-0.4, 0.7, 0.6],
            colour: Rgb::new(255, 255, 255),
            intensity: 1.0,
        }
    }
}

impl Default for LightOptions {
    fn default() -> Self {
        LightOptions {
            look: Look::Colours,
            matcap: MatcapFile::default(),
            ambient: 0.4,
            sky: Rgb::new(200, 215, 235),
            ground: Rgb::new(120, 110, 100),
            exposure: -0.5,
            tone: ToneMapping::Filmic,
            shadow: false,
            sun_deg: 4.0,
            specular: 0.25,
            shininess: 32,
            lamps: vec![Lamp::default()],
        }
    }
}

impl LightOptions {
    /// Returns the input of the shaders.
    pub fn lighting(&self) -> Lighting {
        let mut lights = [None; MAX_LIGHTS];
        for (light, lamp) in lights.iter_mut().zip(&self.lamps) {
            *light = lamp.on.then(|| lamp.light());
        }
        Lighting {
            lights,
            look: self.look,
            matcap: self.matcap.image,
            ambient: self.ambient,
            sky: self.sky,
            ground: self.ground,
            exposure_ev: self.exposure,
            tone: self.tone,
            shadow: self.shadow.then_some(Shadow { sun_deg: self.sun_deg, sample: 0 }),
            specular: self.specular,
            shininess: self.shininess,
            ..Lighting::default()
        }
    }

    /// Checks the values of all lamps and of the surface.
    pub fn check(&self) -> Result<(), InvalidOption> {
        let share = "must be 0 to 1";
        require_in(0.0..=1.0, "ambient", self.ambient, share)?;
        let ev = -MAX_EXPOSURE_EV..=MAX_EXPOSURE_EV;
        require_in(ev, "exposure", self.exposure, "must be -4 to 4")?;
        require_in(0.0..=MAX_SUN_DEG, "sun_deg", self.sun_deg, "must be 0 to 45 degrees")?;
        require_in(0.0..=1.0, "specular", self.specular, share)?;
        require_in(1..=1024, "shininess", self.shininess, "must be 1 to 1024")?;
        let count = self.lamps.len();
        require_in(0..=MAX_LIGHTS, "lamps", count, "must be at most 4 lamps")?;
        self.lamps.iter().try_for_each(Lamp::check)
    }
}

impl Lamp {
    fn check(&self) -> Result<(), InvalidOption> {
        let rule = "must be 0 to 4";
        require_in(0.0..=MAX_INTENSITY, "lamps.intensity", self.intensity, rule)?;
        let length = Vec3::from(self.place).length();
        let (range, rule) = match self.kind {
            LampKind::Direction => (1e-6..=1e6, "must be three finite numbers, not all zero"),
            LampKind::Position => (0.0..=1e6, "must be three finite numbers"),
        };
        require_in(range, "lamps.place, its length,", length, rule)
    }

    fn light(&self) -> Light {
        let place = Vec3::from(self.place);
        Light {
            frame: match self.frame {
                LampFrame::Eye => LightFrame::Eye,
                LampFrame::World => LightFrame::World,
            },
            source: match self.kind {
                LampKind::Direction => LightSource::Direction(place),
                LampKind::Position => LightSource::Position(place),
            },
            colour: self.colour,
            intensity: self.intensity,
        }
    }
}
