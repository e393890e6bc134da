//! The numbers of a final picture for a device that traces it: the inputs of the CPU tracer, as plain values.
//!
//! Takes the inputs of [`super::trace`]. A device adds samples to [`PixelSum`](super::PixelSum)s as this room does,
//! pass by pass, and gets its film from [`Film::of_sums`](super::Film::of_sums). Knows no device.

use glam::{Affine3A, Mat3, Vec3};

use super::environment::{Gradient, Lamp, SunDisc};
use super::lens::Pupil;
use super::{TraceCamera, TraceOptions, pupil, tracer};
use crate::shade::ShadeSource;
use crate::view::{PixelRays, sample_offset_px};

/// See the module text.
#[derive(Clone, Copy, Debug)]
pub struct PreparedTrace {
    /// The placement of the grid.
    pub world_from_grid: Affine3A,
    /// Its inverse for directions.
    pub grid_from_world: Mat3,
    /// Maps normals of the grid to the world.
    pub world_from_normal: Mat3,
    /// Up in the world.
    pub up: Vec3,
    /// The radius of the bounding sphere of the sculpture, in the world.
    pub radius: f32,
    /// The box around all voxels, in grid coordinates.
    pub bounds: (Vec3, Vec3),
    /// The centre of that box.
    pub middle: Vec3,
    /// The ground, if there is one.
    pub ground: Option<PreparedGround>,
    /// The radiance of unshadowed ground.
    pub open_ground: Vec3,
    /// The sun, if it is up.
    pub sun: Option<SunDisc>,
    /// The direction of the sun, even if it is below the horizon.
    pub towards_sun: Vec3,
    /// The sky.
    pub sky: Gradient,
    /// The lamp, if there is one.
    pub lamp: Option<Lamp>,
    /// The pupil of a lens with an opening.
    pub pupil: Option<Pupil>,
}

/// The ground: the plane where the height over it is 0.
#[derive(Clone, Copy, Debug)]
pub struct PreparedGround {
    /// Together with `offset`, gives the height of points of the grid over the ground, in the world.
    pub height: Vec3,
    /// The height of the grid's origin.
    pub offset: f32,
    /// Share of light that it reflects.
    pub albedo: Vec3,
}

/// Returns the numbers of a final picture of voxels; `source` has all its normals.
pub fn prepare(
    source: &ShadeSource,
    camera: &TraceCamera,
    options: &TraceOptions,
) -> PreparedTrace {
    let tracer = tracer((source, None), camera, options);
    let (scene, environment) = (&tracer.scene, &tracer.environment);
    let rays = camera.eye.pixel_rays(&camera.world_from_grid);
    PreparedTrace {
        world_from_grid: scene.world_from_grid,
        grid_from_world: scene.grid_from_world,
        world_from_normal: scene.world_from_normal,
        up: scene.up,
        radius: scene.radius,
        bounds: scene.bounds,
        middle: scene.middle,
        ground: scene.ground,
        open_ground: tracer.open_ground,
        sun: environment.sun,
        towards_sun: environment.towards_sun,
        sky: environment.gradient,
        lamp: environment.lamp,
        pupil: pupil(scene, camera, &rays, &options.lens),
    }
}

/// Returns the rays of a pass.
pub fn pass_rays(camera: &TraceCamera, index: u32) -> PixelRays {
    camera.eye.shifted_by_px(sample_offset_px(index)).pixel_rays(&camera.world_from_grid)
}
