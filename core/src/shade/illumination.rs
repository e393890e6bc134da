//! The lighting formula: Blinn-Phong (Blinn, "Models of light reflection for computer synthesized
//! pictures", 1977) with ambient light from a hemisphere, for sixteen surface points at once.
//!
//! The ambient light on a surface is that of a uniform sky above a uniform ground: their mean, weighted by the part of
//! each that the surface faces. That is (1 + cos) / 2 of the sky for the cosine between its normal and the direction
//! up.
//!
//! Colours are sRGB; light is added in linear space. Gamma 2.0 approximates the sRGB curve (square to linear, square
//! root back): it costs a multiplication where the true curve costs a power, and differs from it by at most 0.043 of
//! full scale in linear light. Shaders do the same.
//!
//! Works in eye space: the eye is at the origin. Knows no grid and no pictures.

use fearless_simd::{Simd, f32x16, prelude::*, u32x16};
use glam::{Affine3A, Mat3, Vec3};

use super::light::{Light, LightFrame, LightSource, Lighting, MAX_LIGHTS, MAX_SHININESS};
use super::look::{Look, MATCAP_EDGE, MATCAP_RADIUS, Matcap};
use super::shadow::ShadowSun;
use super::tone::ToneCurve;
use crate::sculpture::Rgb;
use crate::sculpture::vectors::for_axes;

/// Number of points lit at once.
pub(super) const LANES: usize = 16;

/// Lower bound for squared lengths that are divisors. A device may flush much smaller numbers to 0; the shaders use the
/// same bound.
const LEAST_SQUARE: f32 = 1e-30;

/// Sixteen points of a surface, in grid coordinates.
#[derive(Clone)]
pub struct SurfacePoints {
    /// In grid coordinates.
    pub position: [[f32; LANES]; 3],
    /// Points out of the solid, of any length. A covector of grid coordinates.
    pub gradient: [[f32; LANES]; 3],
    /// sRGB: red in the lowest byte. [`Illumination::colour`], if there is one and the mask does not change it.
    pub colour: [u32; LANES],
    /// Share of the ambient light that arrives, 0 to 1.
    pub open: [f32; LANES],
    /// Share of the sun's light that arrives, 0 to 1.
    pub sunlit: [f32; LANES],
}

impl Default for SurfacePoints {
    fn default() -> Self {
        SurfacePoints {
            position: Default::default(),
            gradient: Default::default(),
            colour: [0; LANES],
            open: [1.0; LANES],
            sunlit: [1.0; LANES],
        }
    }
}

/// A light in eye space, with its linear colour times intensity.
#[derive(Clone, Copy, Debug)]
pub struct EyeLight {
    /// Direction or position, in eye space.
    pub source: LightSource,
    /// Linear colour times intensity.
    pub radiance: Vec3,
}

/// [`Lighting`] prepared for one picture.
#[derive(Clone, Debug)]
pub struct Illumination {
    /// The map from grid to eye coordinates.
    pub eye_from_grid: Affine3A,
    /// Maps covectors of grid coordinates to eye space.
    pub normal_from_gradient: Mat3,
    /// The lights; `None` is an unused slot.
    pub lights: [Option<EyeLight>; MAX_LIGHTS],
    /// Ambient light on a surface that faces the horizon, linear.
    pub ambient: Vec3,
    /// The additional ambient light on a surface that faces the sky.
    pub ambient_slope: Vec3,
    /// Towards the sky, in eye space.
    pub up: Vec3,
    /// Maps the light of the surface to that of the picture.
    pub tone: ToneCurve,
    /// The colour of all voxels, sRGB, if it replaces their own.
    pub colour: Option<Rgb>,
    /// The light that casts shadows.
    pub sun: Option<ShadowSun>,
    /// Replaces all light; its colours multiply those of the surface.
    pub matcap: Option<Matcap>,
    /// Share of light in the highlight, 0 to 1.
    pub specular: f32,
    /// Exponent of highlights.
    pub shininess: u32,
}

impl Illumination {
    /// Prepares `lighting` for an eye and a grid at these poses.
    pub fn new(
        lighting: &Lighting,
        eye_from_world: &Affine3A,
        world_from_grid: &Affine3A,
    ) -> Illumination {
        let eye_from_grid = eye_from_world * world_from_grid;
        let covectors = Mat3::from(eye_from_grid.matrix3).inverse().transpose();
        // Comparable in magnitude to the gradients, whatever the voxel size.
        let largest = covectors.to_cols_array().into_iter().fold(0f32, |a, b| a.max(b.abs()));
        let substance = lighting.look.substance();
        let exposure = lighting.exposure_ev.exp2();
        let [sky, ground] =
            [lighting.sky, lighting.ground].map(|c| linear(c) * (lighting.ambient * exposure));
        let up = eye_from_world.transform_vector3(lighting.up);
        let in_eye_space = |light| in_eye_space(light, eye_from_world, exposure);
        let lights = lighting.lights.map(|light| light.map(in_eye_space));
        let sources = lights.iter().flatten().map(|light| light.source);
        let shadow = lighting.shadow.filter(|_| lighting.look != Look::Matcap);
        Illumination {
            sun: shadow.and_then(|shadow| ShadowSun::new(&shadow, sources, &eye_from_grid)),
            eye_from_grid,
            normal_from_gradient: covectors * (1.0 / largest),
            lights,
            ambient: (sky + ground) * 0.5,
            ambient_slope: (sky - ground) * 0.5,
            up: up.try_normalize().unwrap_or(Vec3::Y),
            tone: lighting.tone.curve(),
            colour: substance.map(|substance| substance.colour),
            matcap: (lighting.look == Look::Matcap).then_some(lighting.matcap),
            specular: substance.map_or(lighting.specular, |substance| substance.specular),
            shininess: substance
                .map_or(lighting.shininess, |substance| substance.shininess)
                .min(MAX_SHININESS),
        }
    }

    /// Returns the light that each point sends to the eye, as opaque sRGB: red in the lowest byte.
    #[inline(always)]
    pub fn shade<S: Simd>(&self, simd: S, points: &SurfacePoints) -> u32x16<S> {
        let splat = |v: f32| f32x16::splat(simd, v);
        let map = Mat3::from(self.eye_from_grid.matrix3);
        let offset = Vec3::from(self.eye_from_grid.translation);
        let position = add(simd, transform(simd, &map, load(simd, &points.position)), offset);
        let to_eye = {
            let away_by = dot(position, position).max(LEAST_SQUARE).sqrt();
            scale(position, splat(-1.0) / away_by)
        };
        let gradient = transform(simd, &self.normal_from_gradient, load(simd, &points.gradient));
        let normal = facing(simd, gradient, to_eye);
        let open = f32x16::load_array_ref(simd, &points.open);
        let colours = u32x16::load_array_ref(simd, &points.colour);
        let albedo = for_axes(
            #[inline(always)]
            |i| {
                let v = (colours >> (8 * i as u32) & 255).to_float::<f32x16<S>>() * (1.0 / 255.0);
                v * v
            },
        );
        if let Some(matcap) = &self.matcap {
            return from_matcap(simd, matcap, normal, to_eye, scale(albedo, open));
        }
        let cos_eye = dot(normal, to_eye);
        let upwards = dot(normal, [splat(self.up.x), splat(self.up.y), splat(self.up.z)]);
        let mut sum = for_axes(
            #[inline(always)]
            |i| albedo[i] * (open * (upwards * self.ambient_slope[i] + self.ambient[i])),
        );
        let sunlit = f32x16::load_array_ref(simd, &points.sunlit);
        let sun = self.sun.map(|sun| sun.light);
        for (i, light) in self.lights.iter().flatten().enumerate() {
            let to_light = match light.source {
                LightSource::Direction(d) => [splat(d.x), splat(d.y), splat(d.z)],
                LightSource::Position(p) => {
                    let v = add(simd, scale(position, splat(-1.0)), p);
                    scale(v, splat(1.0) / dot(v, v).max(LEAST_SQUARE).sqrt())
                }
            };
            let cos_light = dot(normal, to_light);
            // The half vector has length sqrt(2 + 2 cos) before it is normalised.
            let between = (dot(to_light, to_eye) * 2.0 + 2.0).max(LEAST_SQUARE).sqrt();
            let cos_half = ((cos_light + cos_eye) / between).max(0.0);
            let lit = cos_light.simd_gt(0.0);
            let highlight = power(simd, cos_half, self.shininess) * self.specular;
            let highlight = lit.select(highlight, splat(0.0));
            let lambert = cos_light.max(0.0);
            let share = if sun == Some(i) { sunlit } else { splat(1.0) };
            for (i, radiance) in light.radiance.to_array().into_iter().enumerate() {
                sum[i] += (albedo[i] * lambert + highlight) * (share * radiance);
            }
        }
        let [r, g, b] = for_axes(
            #[inline(always)]
            |i| srgb(self.tone.map(sum[i])),
        );
        r | g << 8 | b << 16 | 0xFF00_0000
    }
}

/// Returns the light of a matcap for surfaces: that of the point of its ball with the same orientation to the eye. The
/// ball's axes are those of the picture, rotated to the line of sight. Each colour channel reflects its share.
#[inline(always)]
fn from_matcap<S: Simd>(
    simd: S,
    matcap: &Matcap,
    normal: [f32x16<S>; 3],
    to_eye: [f32x16<S>; 3],
    shares: [f32x16<S>; 3],
) -> u32x16<S> {
    let splat = |v: f32| f32x16::splat(simd, v);
    let [zero, one] = [0.0, 1.0].map(splat);
    // Horizontal, and perpendicular to the line of sight.
    let right = unit_or(simd, [to_eye[2], zero, -to_eye[0]], [one, zero, zero]);
    let up = [
        to_eye[1] * right[2] - to_eye[2] * right[1],
        to_eye[2] * right[0] - to_eye[0] * right[2],
        to_eye[0] * right[1] - to_eye[1] * right[0],
    ];
    const LAST: f32 = (MATCAP_EDGE - 1) as f32;
    let [x, y, _] = for_axes(
        #[inline(always)]
        |i| {
            let across = if i == 0 { dot(normal, right) } else { -dot(normal, up) };
            (across * (0.5 * MATCAP_RADIUS * LAST) + 0.5 * LAST).max(0.0).min(LAST).to_array()
        },
    );
    let mut light = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let texel = matcap.sample(x[lane], y[lane]);
        for (axis, light) in light.iter_mut().enumerate() {
            light[lane] = texel[axis];
        }
    }
    let [r, g, b] = for_axes(
        #[inline(always)]
        |i| srgb(f32x16::load_array_ref(simd, &light[i]) * shares[i]),
    );
    r | g << 8 | b << 16 | 0xFF00_0000
}

fn in_eye_space(light: Light, eye_from_world: &Affine3A, exposure: f32) -> EyeLight {
    let to_eye = match light.frame {
        LightFrame::World => *eye_from_world,
        LightFrame::Eye => Affine3A::IDENTITY,
    };
    let source = match light.source {
        LightSource::Direction(d) => {
            LightSource::Direction(to_eye.transform_vector3(d).try_normalize().unwrap_or(Vec3::Z))
        }
        LightSource::Position(p) => LightSource::Position(to_eye.transform_point3(p)),
    };
    EyeLight { source, radiance: linear(light.colour) * (light.intensity * exposure) }
}

/// Converts sRGB to linear by gamma 2.0, 0 to 1.
fn linear(Rgb(channels): Rgb) -> Vec3 {
    let v = Vec3::from(channels.map(f32::from)) / 255.0;
    v * v
}

/// Converts linear to sRGB by gamma 2.0, 0 to 255.
#[inline(always)]
fn srgb<S: Simd>(linear: f32x16<S>) -> u32x16<S> {
    (linear.max(0.0).min(1.0).sqrt() * 255.0 + 0.5).to_int()
}

/// Returns the unit normal from one of any length. A visible surface cannot face away from the eye: the component that
/// does is removed, and a voxel without a normal faces the eye.
#[inline(always)]
fn facing<S: Simd>(simd: S, normal: [f32x16<S>; 3], to_eye: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    let normal = unit_or(simd, normal, to_eye);
    let away = dot(normal, to_eye).min(0.0);
    let turns = away.simd_lt(0.0);
    if !turns.any_true() {
        return normal;
    }
    let turned =
        [normal[0] - to_eye[0] * away, normal[1] - to_eye[1] * away, normal[2] - to_eye[2] * away];
    let turned = unit_or(simd, turned, to_eye);
    // The others are preserved to the bit: a pixel's shade does not depend on its neighbours.
    [
        turns.select(turned[0], normal[0]),
        turns.select(turned[1], normal[1]),
        turns.select(turned[2], normal[2]),
    ]
}

/// Returns the unit vector along `v`, or `other` if `v` has length 0.
#[inline(always)]
fn unit_or<S: Simd>(simd: S, v: [f32x16<S>; 3], other: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    let squared = dot(v, v);
    let none = squared.simd_lt(1e-12);
    let v = scale(v, f32x16::splat(simd, 1.0) / squared.max(1e-12).sqrt());
    [none.select(other[0], v[0]), none.select(other[1], v[1]), none.select(other[2], v[2])]
}

/// Raises `base` to an integer power by squaring.
#[inline(always)]
fn power<S: Simd>(simd: S, base: f32x16<S>, exponent: u32) -> f32x16<S> {
    let (mut square, mut rest) = (base, exponent);
    let mut product = f32x16::splat(simd, 1.0);
    while rest != 0 {
        if rest & 1 != 0 {
            product *= square;
        }
        square *= square;
        rest >>= 1;
    }
    product
}

#[inline(always)]
fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn scale<S: Simd>(v: [f32x16<S>; 3], factor: f32x16<S>) -> [f32x16<S>; 3] {
    [v[0] * factor, v[1] * factor, v[2] * factor]
}

#[inline(always)]
fn load<S: Simd>(simd: S, v: &[[f32; LANES]; 3]) -> [f32x16<S>; 3] {
    for_axes(
        #[inline(always)]
        |axis| f32x16::load_array_ref(simd, &v[axis]),
    )
}

#[inline(always)]
fn add<S: Simd>(_: S, v: [f32x16<S>; 3], offset: Vec3) -> [f32x16<S>; 3] {
    [v[0] + offset.x, v[1] + offset.y, v[2] + offset.z]
}

#[inline(always)]
fn transform<S: Simd>(_: S, m: &Mat3, v: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    for_axes(
        #[inline(always)]
        |i| v[0] * m.x_axis[i] + v[1] * m.y_axis[i] + v[2] * m.z_axis[i],
    )
}
