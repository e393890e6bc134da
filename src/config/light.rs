//! The settings of light: up to four lamps, the light from everywhere, and how stone shines.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde::Deserialize;

use super::rgb;
use crate::sculpture::Rgb;
use crate::shade::{Light, LightFrame, LightSource, Lighting, MAX_LIGHTS};

/// Largest brightness of a lamp.
pub const MAX_INTENSITY: f32 = 4.0;

/// All light.
#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LightSettings {
    /// Share of linear light.
    pub ambient: f32,
    pub specular: f32,
    pub shininess: u32,
    /// At most [`MAX_LIGHTS`].
    pub lamps: Vec<Lamp>,
}

/// What a lamp's place is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LampKind {
    /// Far away.
    #[default]
    Direction,
    /// A point.
    Position,
}

/// What a lamp stays with.
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
    #[serde(deserialize_with = "rgb")]
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

impl Default for LightSettings {
    fn default() -> Self {
        LightSettings { ambient: 0.25, specular: 0.25, shininess: 32, lamps: vec![Lamp::default()] }
    }
}

impl LightSettings {
    /// What the shaders take.
    pub fn lighting(&self) -> Lighting {
        // The share is of linear light, which the shader takes as the square of a colour.
        let grey = (self.ambient.sqrt() * 255.0).round() as u8;
        let mut lights = [None; MAX_LIGHTS];
        for (light, lamp) in lights.iter_mut().zip(&self.lamps) {
            *light = lamp.on.then(|| lamp.light());
        }
        Lighting {
            lights,
            ambient: Rgb::new(grey, grey, grey),
            specular: self.specular,
            shininess: self.shininess,
            ..Lighting::default()
        }
    }

    /// Key, value, what it may be, and that in words.
    pub(super) fn ranges(&self) -> Vec<(&'static str, f32, RangeInclusive<f32>, &'static str)> {
        let share = "must be 0 to 1";
        let mut ranges = vec![
            ("light.ambient", self.ambient, 0.0..=1.0, share),
            ("light.specular", self.specular, 0.0..=1.0, share),
            ("light.shininess", self.shininess as f32, 1.0..=1024.0, "must be 1 to 1024"),
            ("light.lamps", self.lamps.len() as f32, 0.0..=4.0, "must be at most 4 lamps"),
        ];
        for lamp in &self.lamps {
            ranges.push((
                "light.lamps.intensity",
                lamp.intensity,
                0.0..=MAX_INTENSITY,
                "must be 0 to 4",
            ));
            let place = Vec3::from(lamp.place);
            let length = place.length();
            let (range, rule) = match lamp.kind {
                LampKind::Direction => (1e-6..=1e6, "must be three finite numbers, not all zero"),
                LampKind::Position => (0.0..=1e6, "must be three finite numbers"),
            };
            ranges.push(("light.lamps.place, its length,", length, range, rule));
        }
        ranges
    }
}

impl Lamp {
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
