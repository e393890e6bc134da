//! The light around a sculpture: a sun with a disc, the sky, and a square lamp.
//!
//! Maps angles and strengths to radiances in linear Rec. 709. Angles are relative to the viewer: azimuth 0 is behind
//! the viewer, positive to the right, and elevation is above the horizon. The sky is a gradient from zenith to horizon
//! with a glow around the sun, and sunlight is reddened by the air it passes: the mean optical depths of a clear
//! atmosphere, with the optical mass of Kasten and Young (Applied Optics 28, 1989). Everything is scaled so that a
//! white surface that faces the sun is nearly white in the picture, whatever the elevation.
//!
//! Knows no voxels and no rays.

use std::f32::consts::PI;

use glam::Vec3;

/// The sun.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SunLight {
    /// Azimuth from behind the viewer, to the right.
    pub azimuth_deg: f32,
    /// Elevation above the horizon.
    pub elevation_deg: f32,
    /// Angular diameter of its disc: the larger, the softer its shadows. That of the real sun is 0.53.
    pub size_deg: f32,
    /// Strength; 1 is a clear day.
    pub strength: f32,
}

/// A square lamp that faces the centre of the sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct AreaLight {
    /// Azimuth from behind the viewer, to the right.
    pub azimuth_deg: f32,
    /// Elevation above the horizon.
    pub elevation_deg: f32,
    /// Its edge length, in radii of the sculpture; it is three radii away.
    pub size: f32,
    /// Strength; at 1 it lights the sculpture's centre about as the sun does.
    pub strength: f32,
}

/// The light of a final picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum LightOptions {
    /// Sun, sky and optionally a lamp.
    Outdoors {
        /// The sun.
        sun: SunLight,
        /// Strength of the sky; 1 is a clear day.
        sky: f32,
        /// The lamp.
        area_light: Option<AreaLight>,
    },
    /// The same radiance from all directions.
    Uniform(Vec3),
}

impl Default for LightOptions {
    fn default() -> Self {
        let sun =
            SunLight { azimuth_deg: -50.0, elevation_deg: 42.0, size_deg: 2.0, strength: 1.0 };
        LightOptions::Outdoors { sun, sky: 1.0, area_light: None }
    }
}

/// The viewpoint, in the world.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Standpoint {
    /// Unit vector that points up.
    pub up: Vec3,
    /// The direction from the sculpture to the viewer.
    pub to_viewer: Vec3,
    /// The centre of the sculpture.
    pub middle: Vec3,
    /// The radius of the bounding sphere about the centre.
    pub radius: f32,
}

impl Standpoint {
    /// Returns the unit vector towards azimuth and elevation.
    pub fn towards(&self, azimuth_deg: f32, elevation_deg: f32) -> Vec3 {
        let up = self.up;
        let back = self.to_viewer.reject_from(up);
        // Seen from straight above, any direction is as good.
        let back = match back.length_squared() > 1e-6 * self.to_viewer.length_squared() {
            true => back.normalize(),
            false => up.any_orthonormal_vector(),
        };
        let right = up.cross(back);
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let level = back * azimuth.cos() + right * azimuth.sin();
        (level * elevation.cos() + up * elevation.sin()).normalize()
    }
}

/// The sun of one picture.
#[derive(Clone, Copy, Debug)]
pub struct SunDisc {
    /// Unit vector towards its centre.
    pub direction: Vec3,
    /// Sine of its angular radius.
    pub sin_radius: f32,
    /// Irradiance of a surface that faces it.
    pub irradiance: Vec3,
    /// Radiance of the disc.
    pub radiance: Vec3,
}

impl SunDisc {
    /// Returns whether the disc is visible in `direction` (unit length).
    fn covers(&self, direction: Vec3) -> bool {
        let off = direction.cross(self.direction).length_squared();
        direction.dot(self.direction) > 0.0 && off < self.sin_radius * self.sin_radius
    }
}

/// The lamp of one picture.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Its centre.
    pub centre: Vec3,
    /// One half edge.
    pub half_u: Vec3,
    /// The other half edge.
    pub half_v: Vec3,
    /// Unit vector to the lit side.
    pub normal: Vec3,
    /// Radiance of its surface.
    pub radiance: Vec3,
}

/// The sky as a gradient.
#[derive(Clone, Copy, Debug)]
pub struct Gradient {
    /// Radiance straight above.
    pub zenith: Vec3,
    /// Radiance at the horizon.
    pub horizon: Vec3,
    /// Additional radiance around the sun.
    pub glow: Vec3,
    /// Radiance below the horizon.
    pub below: Vec3,
}

/// All light of one picture, in the world.
#[derive(Clone, Copy, Debug)]
pub struct Environment {
    /// The sun, if it is up.
    pub sun: Option<SunDisc>,
    /// The lamp, if there is one.
    pub lamp: Option<Lamp>,
    up: Vec3,
    /// The direction of the sun, even if it is below the horizon.
    pub towards_sun: Vec3,
    /// The sky.
    pub gradient: Gradient,
}

/// Optical depths of a clear atmosphere for red, green and blue light: Rayleigh scattering and aerosols.
const OPTICAL_DEPTH: Vec3 = Vec3::new(0.10, 0.17, 0.32);
/// Irradiance of the sun over that of the sky, on a surface that faces it, on a clear day with the sun overhead.
const SUN_OVER_SKY: f32 = 5.0;
/// The radiance of a white surface that faces the sun: a little more than the white of a screen, which tone mapping
/// compresses.
pub(super) const WHITE: f32 = 1.2;

impl Environment {
    /// Returns the light of `options` around this standpoint.
    pub fn new(options: &LightOptions, at: &Standpoint) -> Environment {
        match *options {
            LightOptions::Uniform(radiance) => {
                let gradient = Gradient {
                    zenith: radiance,
                    horizon: radiance,
                    glow: Vec3::ZERO,
                    below: radiance,
                };
                Environment { sun: None, lamp: None, up: at.up, towards_sun: at.up, gradient }
            }
            LightOptions::Outdoors { sun, sky, area_light } => {
                Environment::outdoors(sun, sky, area_light, at)
            }
        }
    }

    fn outdoors(
        sun: SunLight,
        sky_strength: f32,
        area_light: Option<AreaLight>,
        at: &Standpoint,
    ) -> Environment {
        let towards_sun = at.towards(sun.azimuth_deg, sun.elevation_deg);
        let height = sun.elevation_deg.clamp(0.0, 90.0);
        let mass = 1.0 / (height.to_radians().sin() + 0.505_72 * (height + 6.079_95).powf(-1.6364));
        let sunlight = (-OPTICAL_DEPTH * (mass - 1.0).max(0.0)).map(f32::exp);
        // Towards evening, the horizon takes the colour of the sunlight, and everything is darker.
        let day = sunlight.element_sum() / 3.0;
        let gradient = Gradient {
            zenith: Vec3::new(0.16, 0.31, 0.62) * (0.35 + 0.65 * day),
            horizon: Vec3::new(0.62, 0.74, 0.88) * sunlight.lerp(Vec3::ONE, 0.45),
            glow: sunlight * 0.9,
            below: Vec3::new(0.24, 0.23, 0.22) * sunlight.lerp(Vec3::ONE, 0.45),
        };
        let mut environment =
            Environment { sun: None, lamp: None, up: at.up, towards_sun, gradient };
        let sky_irradiance = environment.irradiance(at.up);
        let luminance = |v: Vec3| v.dot(Vec3::new(0.2126, 0.7152, 0.0722));
        let sun_irradiance = sunlight * (SUN_OVER_SKY * luminance(sky_irradiance));
        // With the strengths of a clear day, so that a stronger sun is brighter.
        let facing = luminance(sun_irradiance + environment.irradiance(towards_sun));
        let scale = WHITE * PI / facing.max(f32::MIN_POSITIVE);
        let gradient = &mut environment.gradient;
        for colour in
            [&mut gradient.zenith, &mut gradient.horizon, &mut gradient.glow, &mut gradient.below]
        {
            *colour *= scale * sky_strength;
        }
        let sin_radius = (0.5 * sun.size_deg).to_radians().sin();
        let irradiance = sun_irradiance * (scale * sun.strength);
        if sun.strength > 0.0 && sun.elevation_deg > 0.0 {
            // The projected disc: pi sin^2.
            let radiance = irradiance / (PI * sin_radius * sin_radius).max(f32::MIN_POSITIVE);
            let direction = towards_sun;
            environment.sun = Some(SunDisc { direction, sin_radius, irradiance, radiance });
        }
        environment.lamp = area_light.map(|light| Lamp::new(&light, at));
        environment
    }

    /// Returns the radiance from `direction` (unit length) without the sun's disc and the lamp.
    #[inline]
    pub fn sky(&self, direction: Vec3) -> Vec3 {
        let height = direction.dot(self.up);
        if height < 0.0 {
            return self.gradient.below;
        }
        let low = (1.0 - height) * (1.0 - height);
        let near_sun = direction.dot(self.towards_sun).max(0.0);
        let (c2, Gradient { zenith, horizon, glow, .. }) = (near_sun * near_sun, self.gradient);
        let c8 = (c2 * c2) * (c2 * c2);
        let c32 = (c8 * c8) * (c8 * c8);
        zenith + (horizon - zenith) * (low * low) + glow * (0.25 * c8 + 0.75 * c32)
    }

    /// Returns the colour to which the ground fades at the horizon in `direction`.
    #[inline]
    pub fn horizon(&self, direction: Vec3) -> Vec3 {
        let level = direction - self.up * direction.dot(self.up);
        self.sky(level.normalize_or(self.up))
    }

    /// Returns the radiance that the eye sees in `direction` where there is no surface: the sky with the sun's disc.
    #[inline]
    pub fn seen(&self, direction: Vec3) -> Vec3 {
        let disc = self.sun.filter(|sun| sun.covers(direction));
        self.sky(direction) + disc.map_or(Vec3::ZERO, |sun| sun.radiance)
    }

    /// Returns the irradiance of sun and sky on an unshaded surface of this normal.
    pub(crate) fn open_irradiance(&self, normal: Vec3) -> Vec3 {
        let sun =
            self.sun.map_or(Vec3::ZERO, |sun| sun.irradiance * sun.direction.dot(normal).max(0.0));
        sun + self.irradiance(normal)
    }

    /// Returns the irradiance of the sky alone on a surface of this normal, by a fixed grid of directions.
    fn irradiance(&self, normal: Vec3) -> Vec3 {
        const STEPS: u32 = 32;
        let mut sum = Vec3::ZERO;
        for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
            let at = glam::Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / STEPS as f32;
            sum += self.sky(cosine_direction(normal, at));
        }
        sum * (PI / (STEPS * STEPS) as f32)
    }
}

impl Lamp {
    fn new(light: &AreaLight, at: &Standpoint) -> Lamp {
        let towards = at.towards(light.azimuth_deg, light.elevation_deg);
        let distance = 3.0 * at.radius;
        let (u, v) = towards.any_orthonormal_pair();
        let half = 0.5 * light.size * at.radius;
        // From afar, the irradiance is radiance times area over the squared distance.
        let solid_angle = (2.0 * half / distance).powi(2);
        Lamp {
            centre: at.middle + towards * distance,
            half_u: u * half,
            half_v: v * half,
            normal: -towards,
            radiance: Vec3::splat(WHITE * PI * light.strength / solid_angle),
        }
    }

    /// Returns the distance at which a ray meets the lit side, in lengths of its direction.
    #[inline]
    pub fn hit(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let facing = direction.dot(self.normal);
        if facing >= 0.0 {
            return None;
        }
        let t = (self.centre - origin).dot(self.normal) / facing;
        let from_centre = origin + direction * t - self.centre;
        let inside = |half: Vec3| from_centre.dot(half).abs() <= half.length_squared();
        (t > 0.0 && inside(self.half_u) && inside(self.half_v)).then_some(t)
    }
}

/// Returns a cosine-distributed direction around `normal`, from a point of the unit square.
#[inline(always)]
pub(super) fn cosine_direction(normal: Vec3, at: glam::Vec2) -> Vec3 {
    let disc = disc_point(at);
    let (u, v) = normal.any_orthonormal_pair();
    let up = (1.0 - disc.length_squared()).max(0.0).sqrt();
    u * disc.x + v * disc.y + normal * up
}

/// Returns a uniformly distributed point of the unit disc, from a point of the unit square, without tearing strata
/// apart (Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997).
#[inline(always)]
pub(super) fn disc_point(at: glam::Vec2) -> glam::Vec2 {
    let p = at * 2.0 - 1.0;
    if p == glam::Vec2::ZERO {
        return p;
    }
    let (radius, angle) = match p.x.abs() > p.y.abs() {
        true => (p.x, PI / 4.0 * (p.y / p.x)),
        false => (p.y, PI / 2.0 - PI / 4.0 * (p.x / p.y)),
    };
    let (sin, cos) = angle.sin_cos();
    glam::Vec2::new(cos, sin) * radius
}
