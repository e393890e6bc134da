//! The final picture: path tracing of the sculpture with sun, sky, a square lamp and a lens.
//!
//! Takes a sculpture, a camera and options, returns a [`Film`] of linear light: `scene` finds the surfaces that rays
//! meet, `path` the light that arrives along them, `environment` its sources, `sampling` the directions to try. A
//! picture is the mean of passes, each with one ray per pixel. All rays of a pass are shifted by the same fraction of a
//! pixel, so that without a lens the sampler of whole pictures finds what the eye sees. `denoise` removes the remaining
//! noise, and `tone` computes values for a screen.
//!
//! The result is the same to the bit for any number of threads: every pixel has its own random numbers, and its passes
//! are added in order. Knows no files and no documents.

mod denoise;
mod environment;
#[cfg(test)]
mod environment_tests;
mod film;
mod lens;
mod linear;
mod path;
mod prepared;
mod sampling;
mod scene;
mod smooth;
mod tone;

use std::f32::consts::FRAC_1_PI;

use glam::{Affine3A, UVec3, Vec2, Vec3};
use rayon::prelude::*;
use thiserror::Error;

pub use denoise::denoise;
pub use environment::{AreaLight, Gradient, Lamp, LightOptions, SunDisc, SunLight};
pub use film::{Film, MAX_PIXELS, PixelSum};
pub use lens::Pupil;
pub use prepared::{PreparedGround, PreparedTrace, pass_rays, prepare};
pub use tone::{display_pixels, preview_pixels};

use crate::progress::Progress;
use crate::sculpture::Rgb;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::shade::ground::GROUND_COLOUR;
use crate::shade::level_set::CellCache;
use crate::shade::{LevelSet, ShadeSource};
use crate::surface::{IndexMap, raycast};
use crate::view::{Eye, PixelRays};
use environment::{Environment, Standpoint, disc_point};
use film::Sample;
use path::Tracer;
use sampling::Sampler;
use scene::{Met, PathScene};

/// The most samples of a pixel of a final picture.
pub const MAX_FINAL_SAMPLES: u32 = 4096;
/// The largest useful value of [`TraceOptions::bounces`].
pub const MAX_BOUNCES: u32 = 64;
/// Distance from the sculpture, in its radii, at which half of the ground has faded into the horizon.
const HALF_FADED_RADII: f32 = 12.0;

/// The ground under the sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TraceGround {
    /// Its colour.
    pub colour: Rgb,
}

/// The lens of the camera.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lens {
    /// Diameter of its aperture over the distance in focus; at 0 everything is sharp.
    pub aperture: f32,
    /// The point of the picture in focus: fractions of its width from the left and height from the top.
    pub focus: Vec2,
}

/// The options of a final picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TraceOptions {
    /// Rays per pixel.
    pub samples: u32,
    /// The most surfaces on the path of light before the visible one.
    pub bounces: u32,
    /// The sources of light.
    pub light: LightOptions,
    /// The ground; if `None`, the sculpture floats.
    pub ground: Option<TraceGround>,
    /// The lens.
    pub lens: Lens,
}

impl Default for TraceOptions {
    fn default() -> Self {
        TraceOptions {
            samples: 64,
            bounces: 8,
            light: LightOptions::default(),
            ground: Some(TraceGround { colour: GROUND_COLOUR }),
            lens: Lens { aperture: 0.0, focus: Vec2::splat(0.5) },
        }
    }
}

/// The viewpoint of a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TraceCamera {
    /// The eye.
    pub eye: Eye,
    /// The placement of the grid.
    pub world_from_grid: Affine3A,
    /// The direction that is up in the world.
    pub up: Vec3,
}

/// Why there is no final picture.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum TraceError {
    /// Cancelled by the progress.
    #[error("the final picture was cancelled")]
    Cancelled,
    /// Too many pixels.
    #[error(
        "a final picture of {0}x{1} pixels is too large; it may have up to {MAX_PIXELS} pixels"
    )]
    TooLarge(u32, u32),
}

/// Makes a final picture of the smooth surface, or of voxels if there are no `levels`; `source` has all its normals.
pub fn trace(
    (source, levels): (&ShadeSource, Option<&LevelSet>),
    camera: &TraceCamera,
    options: &TraceOptions,
    progress: &dyn Progress,
) -> Result<Film, TraceError> {
    trace_watched((source, levels), camera, options, progress, &mut |_, _| {})
}

/// Performs [`trace`], and passes the sums so far and their number of samples to the progress after each pass.
pub fn trace_watched(
    (source, levels): (&ShadeSource, Option<&LevelSet>),
    camera: &TraceCamera,
    options: &TraceOptions,
    progress: &dyn Progress,
    watch: &mut dyn FnMut(&Film, u32),
) -> Result<Film, TraceError> {
    let size = camera.eye.size;
    let mut film = Film::new(size).ok_or(TraceError::TooLarge(size.x, size.y))?;
    let tracer = tracer((source, levels), camera, options);
    let rays = camera.eye.pixel_rays(&camera.world_from_grid);
    let mut map = IndexMap::new(rays);
    let pupil = pupil(&tracer.scene, camera, &rays, &options.lens);
    progress.begin("tracing light");
    let passes = options.samples.clamp(1, MAX_FINAL_SAMPLES);
    for index in 0..passes {
        let rays = pass_rays(camera, index);
        match (pupil, levels) {
            (Some(_), _) => map.forget(rays),
            (None, None) => raycast::sample_exact(source.grid, &rays, &mut map),
            (None, Some(levels)) => {
                let rays = LevelSet::rays_of_cells(&rays);
                raycast::sample_exact(levels.cells(), &rays, &mut map);
            }
        }
        let pass = Pass { tracer: &tracer, pupil, rays, map: &map, index, progress };
        film.par_rows_mut()
            .for_each_init(CellCache::default, |cache, (y, row)| pass.add_row(y, row, cache));
        if progress.is_cancelled() {
            progress.end();
            return Err(TraceError::Cancelled);
        }
        progress.advance((index + 1) as f32 / passes as f32);
        watch(&film, index + 1);
    }
    progress.end();
    film.close(passes);
    Ok(film)
}

fn tracer<'a>(
    (source, levels): (&ShadeSource<'a>, Option<&'a LevelSet>),
    camera: &TraceCamera,
    options: &TraceOptions,
) -> Tracer<'a> {
    let (low, high) = source.grid.opaque_bounds().unwrap_or((UVec3::ZERO, source.grid.dims()));
    let bounds = (low.as_vec3(), high.as_vec3());
    let up = camera.up.normalize_or(Vec3::Y);
    let world = |point: Vec3| camera.world_from_grid.transform_point3(point);
    let middle = world((bounds.0 + bounds.1) * 0.5);
    let radius = middle.distance(world(bounds.1));
    let to_viewer = camera.eye.position() - middle;
    let at = Standpoint { up, to_viewer, middle, radius };
    let environment = Environment::new(&options.light, &at);
    let lowest = lowest_along(source, &camera.world_from_grid, up);
    let scene = PathScene::new(
        (*source, levels),
        camera.world_from_grid,
        up,
        bounds,
        lowest,
        options.ground,
    );
    let open_ground = scene.ground_albedo() * (FRAC_1_PI * environment.open_irradiance(up));
    Tracer { scene, environment, open_ground, bounces: options.bounces }
}

/// Returns the least height of the voxels along `up`, in the world.
fn lowest_along(source: &ShadeSource, world_from_grid: &Affine3A, up: Vec3) -> f32 {
    let slope = world_from_grid.matrix3.transpose() * up;
    let mut lowest = f32::INFINITY;
    for (brick, voxels) in source.grid.nonempty_bricks() {
        let corner = (brick * BRICK_EDGE_VX).as_vec3();
        let height = |p: Vec3| slope.dot(corner + p);
        let farthest = Vec3::select(slope.cmplt(Vec3::ZERO), Vec3::splat(8.0), Vec3::ZERO);
        if height(farthest) < lowest {
            // The lowest corner of a voxel.
            let corner_of_voxel = farthest / 8.0;
            voxels.for_each(|local| {
                let at = UVec3::from(local_coords(local)).as_vec3() + corner_of_voxel;
                lowest = lowest.min(height(at));
            });
        }
    }
    let origin = up.dot(world_from_grid.translation.into());
    if lowest.is_finite() { lowest + origin } else { origin }
}

/// Returns the pupil of a lens with an opening.
fn pupil(scene: &PathScene, camera: &TraceCamera, rays: &PixelRays, lens: &Lens) -> Option<Pupil> {
    if lens.aperture <= 0.0 {
        return None;
    }
    let at = lens.focus * rays.size.as_vec2();
    let along = rays.direction_at(at.x, at.y);
    let first = scene.first(rays.origin, along);
    let (met, t) = scene.seen(rays.origin, along, first, &mut CellCache::default());
    let grid_from_eye = (camera.eye.eye_from_world * camera.world_from_grid).inverse();
    let focus = match met {
        Met::Nothing => -grid_from_eye.inverse().transform_point3(scene.middle).z,
        _ => t,
    };
    let focus = focus.max(f32::MIN_POSITIVE);
    let radius = 0.5 * lens.aperture * focus;
    let axis = |v: Vec3| grid_from_eye.transform_vector3(v * radius);
    Some(Pupil { right: axis(Vec3::X), up: axis(Vec3::Y), focus })
}

/// A pass with one ray per pixel.
struct Pass<'a> {
    tracer: &'a Tracer<'a>,
    pupil: Option<Pupil>,
    /// The rays of the eye.
    rays: PixelRays,
    /// The first voxel or cell on each; with a pupil none.
    map: &'a IndexMap,
    index: u32,
    progress: &'a dyn Progress,
}

impl Pass<'_> {
    fn add_row(&self, y: u32, row: &mut [film::PixelSum], cache: &mut CellCache) {
        if self.progress.is_cancelled() {
            return;
        }
        let width = self.rays.size.x;
        for (x, pixel) in (0..).zip(row) {
            let mut sampler = Sampler::new(x + y * width, self.index);
            pixel.add(&self.sample(x, y, &mut sampler, cache));
        }
    }

    fn sample(&self, x: u32, y: u32, sampler: &mut Sampler, cache: &mut CellCache) -> Sample {
        let (rays, scene) = (&self.rays, &self.tracer.scene);
        let (origin, along, first) = match &self.pupil {
            None => {
                let first = self.map.voxel(x, y);
                (rays.origin, rays.direction(x, y), first)
            }
            Some(pupil) => {
                let (origin, along) = pupil.ray(rays, x, y, disc_point(sampler.next_2d()));
                (origin, along, scene.first(origin, along))
            }
        };
        let (met, t) = scene.seen(origin, along, first, cache);
        let direction = scene.world_from_grid.transform_vector3(along).normalize_or(Vec3::Z);
        let environment = &self.tracer.environment;
        if let Some(lamp) = &environment.lamp {
            let world = scene.world_from_grid.transform_point3(origin);
            let step = scene.world_from_grid.transform_vector3(along);
            if lamp.hit(world, step).is_some_and(|lamp_t| lamp_t < t) {
                return Sample::background(lamp.radiance);
            }
        }
        match met {
            Met::Sculpture(surface) => {
                let radiance = self.tracer.radiance(&surface, sampler, cache);
                Sample::of_surface(&surface, radiance, t, 1.0)
            }
            Met::Ground(surface) => {
                let away = scene.distance_radii(origin + along * t) / HALF_FADED_RADII;
                let fade = away * away / (1.0 + away * away);
                let horizon = environment.horizon(direction);
                let radiance = self.tracer.radiance(&surface, sampler, cache);
                Sample::of_surface(&surface, radiance.lerp(horizon, fade), t, 0.0)
            }
            Met::Nothing | Met::OpenGround => Sample::background(environment.seen(direction)),
        }
    }
}

#[cfg(test)]
mod smooth_tests;
#[cfg(test)]
mod tests;
