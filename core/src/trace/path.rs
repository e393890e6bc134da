//! Paths of light that reach the eye from a surface.
//!
//! Traced backwards from the surface that the eye sees. At each surface, the path adds the light of sun and lamp unless
//! they are blocked, then continues in a random direction, until the sky is met or the light is too weak to matter
//! (Russian roulette). Surfaces are matt, and directions are cosine-distributed around the smooth normal, so that no
//! surface loses or gains light. Each light is sampled in one way only, sun and lamp from the surface and the sky by
//! chance, so nothing is counted twice and no weights are needed.
//!
//! Knows no pictures.

use std::f32::consts::FRAC_1_PI;

use glam::{Vec2, Vec3};

use super::environment::{Environment, cosine_direction, disc_point};
use super::sampling::Sampler;
use super::scene::{Met, PathScene, PathVertex};
use crate::shade::level_set::CellCache;

/// The bounce from which on roulette decides whether a path continues.
const ROULETTE_FROM: u32 = 1;

/// See the module text.
pub(super) struct Tracer<'a> {
    pub scene: PathScene<'a>,
    pub environment: Environment,
    /// Radiance of unshadowed ground.
    pub open_ground: Vec3,
    /// The most surfaces on a path after the visible one.
    pub bounces: u32,
}

impl Tracer<'_> {
    /// Returns the radiance that `seen` sends to the eye.
    pub fn radiance(
        &self,
        seen: &PathVertex,
        sampler: &mut Sampler,
        cache: &mut CellCache,
    ) -> Vec3 {
        let (mut surface, mut radiance) = (*seen, Vec3::ZERO);
        let mut throughput = surface.albedo;
        for bounce in 0.. {
            radiance += throughput * (FRAC_1_PI * self.direct(&surface, sampler, cache));
            let direction = cosine_direction(surface.normal, sampler.next_2d());
            let next = match self.scene.meet(surface.start, direction, cache) {
                Met::Nothing => return radiance + throughput * self.environment.sky(direction),
                Met::OpenGround => return radiance + throughput * self.open_ground,
                Met::Sculpture(next) | Met::Ground(next) => next,
            };
            if bounce >= self.bounces {
                break;
            }
            surface = next;
            throughput *= surface.albedo;
            if bounce >= ROULETTE_FROM {
                let survival = throughput.max_element().min(1.0);
                if sampler.next_1d() >= survival {
                    break;
                }
                throughput /= survival;
            }
        }
        radiance
    }

    /// Returns the irradiance of sun and lamp.
    fn direct(&self, surface: &PathVertex, sampler: &mut Sampler, cache: &mut CellCache) -> Vec3 {
        let mut irradiance = Vec3::ZERO;
        if let Some(sun) = &self.environment.sun {
            let at = sampler.next_2d();
            let direction = cone_direction(sun.direction, sun.sin_radius, at);
            let cosine = direction.dot(surface.normal);
            let mut is_blocked =
                || self.scene.is_blocked(surface.start, direction, f32::INFINITY, cache);
            if cosine > 0.0 && !is_blocked() {
                irradiance += sun.irradiance * cosine;
            }
        }
        if let Some(lamp) = &self.environment.lamp {
            let at = sampler.next_2d() * 2.0 - 1.0;
            let from = self.scene.world_from_grid.transform_point3(surface.start);
            let to_lamp = lamp.centre + lamp.half_u * at.x + lamp.half_v * at.y - from;
            let squared = to_lamp.length_squared();
            let (cosine, facing) = (to_lamp.dot(surface.normal), -to_lamp.dot(lamp.normal));
            let mut is_blocked = || self.scene.is_blocked(surface.start, to_lamp, 1.0, cache);
            if cosine > 0.0 && facing > 0.0 && !is_blocked() {
                let area = 4.0 * lamp.half_u.length() * lamp.half_v.length();
                irradiance += lamp.radiance * (area * cosine * facing / (squared * squared));
            }
        }
        irradiance
    }
}

/// Returns a direction within the cone around `axis`, uniformly distributed over the disc that it cuts from the sky.
fn cone_direction(axis: Vec3, sin_radius: f32, at: Vec2) -> Vec3 {
    let disc = disc_point(at) * sin_radius;
    let (u, v) = axis.any_orthonormal_pair();
    u * disc.x + v * disc.y + axis * (1.0 - disc.length_squared()).max(0.0).sqrt()
}
