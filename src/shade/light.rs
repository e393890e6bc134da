//! Owns the lights and the lighting formula: Blinn-Phong with ambient light (Blinn, "Models of
//! light reflection for computer synthesized pictures", 1977).
//!
//! Colours are sRGB; light is added in linear space. Gamma 2.0 stands for the sRGB curve (square
//! to linear, square root back), which costs a multiplication where the true one costs a power
//! and differs from it by at most 0.043 of full scale in linear light. Shaders do the same.

use glam::{Affine3A, Vec3};

use crate::sculpture::Rgb;

/// Lights that a picture can have.
pub const MAX_LIGHTS: usize = 4;

/// What a light keeps its place in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LightFrame {
    /// It stays where it is while the eye moves.
    World,
    /// It moves with the eye, as a lamp on the head.
    Eye,
}

/// Where light comes from, in the coordinates of a [`LightFrame`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum LightSource {
    /// From far away; the vector points towards the light.
    Direction(Vec3),
    /// From a point, as bright near as far.
    Position(Vec3),
}

/// One light.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Light {
    pub frame: LightFrame,
    pub source: LightSource,
    pub colour: Rgb,
    /// Factor on the linear colour.
    pub intensity: f32,
}

/// All that lights a sculpture, and how it shines.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lighting {
    pub lights: [Option<Light>; MAX_LIGHTS],
    /// Light from everywhere.
    pub ambient: Rgb,
    /// Share of light in the highlight, 0 to 1.
    pub specular: f32,
    /// Exponent of the highlight: larger is smaller and sharper.
    pub shininess: u32,
}

impl Default for Lighting {
    /// One white lamp above the left shoulder.
    fn default() -> Self {
        let lamp = Light {
            frame: LightFrame::Eye,
            source: LightSource::Direction(Vec3::new(-0.5, 0.7, 1.0)),
            colour: Rgb::new(255, 255, 255),
            intensity: 1.0,
        };
        Lighting {
            lights: [Some(lamp), None, None, None],
            ambient: Rgb::new(80, 80, 88),
            specular: 0.25,
            shininess: 32,
        }
    }
}

/// A surface point in eye space.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub position: Vec3,
    /// Unit length.
    pub normal: Vec3,
    /// Linear.
    pub albedo: Vec3,
}

/// A light in eye space, with its linear colour times intensity.
#[derive(Clone, Copy, Debug)]
struct EyeLight {
    source: LightSource,
    radiance: Vec3,
}

/// [`Lighting`] prepared for one picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeLighting {
    lights: [Option<EyeLight>; MAX_LIGHTS],
    ambient: Vec3,
    specular: f32,
    shininess: u32,
}

impl EyeLighting {
    pub fn new(lighting: &Lighting, eye_from_world: &Affine3A) -> EyeLighting {
        let lights = lighting.lights.map(|light| {
            light.map(|light| {
                let to_eye = match light.frame {
                    LightFrame::World => *eye_from_world,
                    LightFrame::Eye => Affine3A::IDENTITY,
                };
                let source = match light.source {
                    LightSource::Direction(d) => LightSource::Direction(
                        to_eye.transform_vector3(d).try_normalize().unwrap_or(Vec3::Z),
                    ),
                    LightSource::Position(p) => LightSource::Position(to_eye.transform_point3(p)),
                };
                EyeLight { source, radiance: linear(light.colour) * light.intensity }
            })
        });
        EyeLighting {
            lights,
            ambient: linear(lighting.ambient),
            specular: lighting.specular,
            shininess: lighting.shininess,
        }
    }

    /// Linear light that the point sends to the eye, which is at the origin.
    pub fn reflected(&self, point: &SurfacePoint) -> Vec3 {
        let to_eye = (-point.position).normalize_or_zero();
        let mut sum = self.ambient * point.albedo;
        for light in self.lights.iter().flatten() {
            let to_light = match light.source {
                LightSource::Direction(d) => d,
                LightSource::Position(p) => (p - point.position).normalize_or_zero(),
            };
            let lambert = point.normal.dot(to_light);
            if lambert > 0.0 {
                let half = (to_light + to_eye).normalize_or_zero();
                let highlight = point.normal.dot(half).max(0.0).powi(self.shininess as i32);
                sum += light.radiance * (point.albedo * lambert + self.specular * highlight);
            }
        }
        sum
    }
}

/// sRGB to linear by gamma 2.0, 0 to 1.
pub(super) fn linear(Rgb(channels): Rgb) -> Vec3 {
    let v = Vec3::from(channels.map(f32::from)) / 255.0;
    v * v
}

/// The inverse of [`linear`]; clamps.
pub(super) fn srgb(linear: Vec3) -> Rgb {
    let v = linear.clamp(Vec3::ZERO, Vec3::ONE);
    Rgb(v.to_array().map(|c| (c.sqrt() * 255.0 + 0.5) as u8))
}
