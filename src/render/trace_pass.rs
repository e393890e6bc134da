//! Final pictures on the device: the twin of [`crate::trace::trace`], pass by pass in a compute shader.
//!
//! Takes a sculpture, a camera and options; gives the film, whose pixels differ from those of the CPU by rounding, and
//! by paths that rounding diverts. It uploads its own copies of bits, colours and normals and frees them at the end, so
//! it shares nothing with the rendering of windows. The work is submitted in bands of rows, so that no submission takes
//! long; it can be cancelled between them.

use std::sync::Arc;

use ash::vk;
use glam::{Affine3A, Mat3, Vec3};
use thiserror::Error;

use super::shading::{COLOURS, NORMALS, UNIFORMS, VOLUME};
use super::{DeviceColours, Normals, Volume};
use crate::gpu::layout::{TraceRays, TraceScene};
use crate::gpu::{
    Buffer, DescriptorSets, Device, GpuError, MemoryLocation, Pipeline, PipelineLayout, Recorder,
    ResourceUse, SetLayout, run_once, shaders,
};
use crate::progress::Progress;
use crate::shade::ShadeSource;
use crate::trace::{
    Film, MAX_FINAL_SAMPLES, MAX_PIXELS, PixelSum, PreparedTrace, TraceCamera, TraceError,
    TraceOptions, pass_rays, prepare,
};
use crate::view::PixelRays;

/// The binding of the film.
const FILM: u32 = 1;
/// Most pixels of a submission.
const BAND_PIXELS: u32 = 1 << 16;
/// Edge of the square of pixels that a workgroup computes (shaders/square.wgsl).
const SQUARE_PX: u32 = 8;
/// Bytes that are read back at once.
const CHUNK_BYTES: u64 = 8 << 20;

/// The reason why a device gives no final picture.
#[derive(Debug, Error)]
pub enum DeviceTraceError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Makes a final picture; `source` has all its normals.
pub fn trace_on_device(
    device: &Arc<Device>,
    source: &ShadeSource,
    camera: &TraceCamera,
    options: &TraceOptions,
    progress: &dyn Progress,
) -> Result<Film, DeviceTraceError> {
    let size = camera.eye.size;
    let count = u64::from(size.x) * u64::from(size.y);
    if !(1..=MAX_PIXELS).contains(&count) {
        return Err(TraceError::TooLarge(size.x, size.y).into());
    }
    progress.begin("uploading the sculpture");
    let tracer = DeviceTracer::new(device, source, camera, options, count)?;
    progress.end();
    progress.begin("tracing light");
    let samples = options.samples.clamp(1, MAX_FINAL_SAMPLES);
    let traced = tracer.trace(camera, samples, progress);
    progress.end();
    traced?;
    let sums = tracer.read_back(count)?;
    Ok(Film::of_sums(size, sums, samples).ok_or(TraceError::TooLarge(size.x, size.y))?)
}

/// The resources that a picture needs on the device.
struct DeviceTracer {
    pipeline: Pipeline,
    sets: DescriptorSets,
    film: Buffer,
    // The set refers to it.
    _volume: Volume,
    _colours: Option<DeviceColours>,
    _normals: Normals,
    _others: [Buffer; 2],
    device: Arc<Device>,
}

impl DeviceTracer {
    fn new(
        device: &Arc<Device>,
        source: &ShadeSource,
        camera: &TraceCamera,
        options: &TraceOptions,
        pixels: u64,
    ) -> Result<DeviceTracer, GpuError> {
        let name = "final picture";
        let ShadeSource { grid, material, normals, .. } = *source;
        let bytes = pixels * size_of::<PixelSum>() as u64;
        let allowed = u64::from(device.limits().max_storage_buffer_range);
        if bytes > allowed {
            let (what, limit) = ("the final picture".to_string(), "maxStorageBufferRange");
            return Err(GpuError::Limit { what, needed: bytes, limit, allowed });
        }
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_SRC;
        let film = Buffer::new(device, name, bytes, usage, MemoryLocation::GpuOnly)?;
        let volume = Volume::new(device, grid)?;
        let is_painted = material.page_count() > 0;
        let colours = is_painted.then(|| DeviceColours::new(device, &source.colours(None)));
        let colours = colours.transpose()?;
        let normals = Normals::new(device, normals)?;

        let prepared = prepare(source, camera, options);
        let scene = TraceScene {
            base: material.base().0.map(|channel| f32::from(channel) / 255.0),
            dims: grid.dims().to_array(),
            bricks: grid.brick_dims().to_array(),
            ..uniforms(&prepared)
        };
        let (usage, location) = (vk::BufferUsageFlags::UNIFORM_BUFFER, MemoryLocation::CpuToGpu);
        let scene_bytes = size_of::<TraceScene>() as u64;
        let mut uniforms = Buffer::new(device, name, scene_bytes, usage, location)?;
        uniforms.write(0, &[scene])?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let nothing = Buffer::new(device, "nothing", 16, usage, MemoryLocation::GpuOnly)?;

        let (uniform, storage) =
            (vk::DescriptorType::UNIFORM_BUFFER, vk::DescriptorType::STORAGE_BUFFER);
        let image = vk::DescriptorType::SAMPLED_IMAGE;
        let kinds = [
            (VOLUME, image),
            (FILM, storage),
            (COLOURS, storage),
            (UNIFORMS, uniform),
            (NORMALS, storage),
        ];
        let stage = vk::ShaderStageFlags::COMPUTE;
        let bindings = kinds.map(|(binding, kind)| (binding, kind, stage));
        let set_layout = SetLayout::new(device, name, &bindings)?;
        let push = Some((stage, size_of::<TraceRays>()));
        let layout = PipelineLayout::new(device, name, Some(&set_layout), push)?;
        let sets = DescriptorSets::new(device, name, &set_layout, 1)?;
        sets.write_sampled(0, VOLUME, volume.image().view());
        let colour_buffer = colours.as_ref().map_or(&nothing, DeviceColours::buffer);
        for (binding, kind, buffer) in [
            (FILM, storage, &film),
            (COLOURS, storage, colour_buffer),
            (UNIFORMS, uniform, &uniforms),
            (NORMALS, storage, normals.buffer()),
        ] {
            sets.write_buffer(0, binding, kind, buffer.whole());
        }
        let colour_bytes = colours.as_ref().map_or(0, DeviceColours::bytes_per_voxel);
        let constants = kind(&prepared, options.bounces, colour_bytes);
        let pipeline = Pipeline::compute(device, name, shaders::TRACE_COMP, &layout, &constants)?;
        Ok(DeviceTracer {
            pipeline,
            sets,
            film,
            _volume: volume,
            _colours: colours,
            _normals: normals,
            _others: [uniforms, nothing],
            device: device.clone(),
        })
    }

    fn trace(
        &self,
        camera: &TraceCamera,
        samples: u32,
        progress: &dyn Progress,
    ) -> Result<(), DeviceTraceError> {
        let rows = (BAND_PIXELS / camera.eye.size.x).max(1).next_multiple_of(SQUARE_PX);
        for index in 0..samples {
            let rays = pass_rays(camera, index);
            for first_row in (0..camera.eye.size.y).step_by(rows as usize) {
                if progress.is_cancelled() {
                    return Err(TraceError::Cancelled.into());
                }
                let push = push_constants(&rays, index, first_row);
                let height = rows.min(rays.size.y - first_row);
                run_once(&self.device, |recorder| {
                    self.record_band(recorder, &push, height);
                    Ok(())
                })?;
            }
            progress.advance((index + 1) as f32 / samples as f32);
        }
        Ok(())
    }

    fn record_band(&self, recorder: &mut Recorder, push: &TraceRays, height: u32) {
        // Each pixel is added to the result of the pass before; the first pass begins at 0.
        recorder.buffer_barrier(ResourceUse::SHADER_WRITE, ResourceUse::SHADER_READ);
        recorder.buffer_barrier(ResourceUse::SHADER_WRITE, ResourceUse::SHADER_WRITE);
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(0));
        recorder.push(self.pipeline.layout(), push);
        recorder.dispatch([push.width.div_ceil(SQUARE_PX), height.div_ceil(SQUARE_PX), 1]);
    }

    fn read_back(&self, pixels: u64) -> Result<Vec<PixelSum>, GpuError> {
        let bytes = pixels * size_of::<PixelSum>() as u64;
        let chunk = CHUNK_BYTES - CHUNK_BYTES % size_of::<PixelSum>() as u64;
        let usage = vk::BufferUsageFlags::TRANSFER_DST;
        let name = "rows of a final picture";
        let target =
            Buffer::new(&self.device, name, bytes.min(chunk), usage, MemoryLocation::GpuToCpu)?;
        let mut sums = Vec::with_capacity(pixels as usize);
        for src_offset in (0..bytes).step_by(chunk as usize) {
            let size = chunk.min(bytes - src_offset);
            let copy = vk::BufferCopy { src_offset, dst_offset: 0, size };
            run_once(&self.device, |recorder| {
                recorder.buffer_barrier(ResourceUse::SHADER_WRITE, ResourceUse::COPY_SOURCE);
                recorder.copy_buffer(self.film.handle(), target.handle(), &[copy]);
                recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::HOST_READ);
                Ok(())
            })?;
            let mapped = target.mapped().get(..size as usize);
            let mapped = mapped.ok_or_else(|| GpuError::Host(format!("{name} are not mapped")))?;
            sums.extend(
                mapped
                    .chunks_exact(size_of::<PixelSum>())
                    .map(bytemuck::pod_read_unaligned::<PixelSum>),
            );
        }
        Ok(sums)
    }
}

/// Returns the specialization constants of shaders/kind.wgsl and shaders/trace_kind.wgsl.
fn kind(prepared: &PreparedTrace, bounces: u32, colour_bytes: u32) -> [u32; 13] {
    let PreparedTrace { sun, lamp, ground, pupil, .. } = prepared;
    let mut constants = [0; 13];
    constants[2] = colour_bytes;
    constants[8] = bounces;
    constants[9] = sun.is_some().into();
    constants[10] = lamp.is_some().into();
    constants[11] = ground.is_some().into();
    constants[12] = pupil.is_some().into();
    constants
}

fn push_constants(rays: &PixelRays, index: u32, first_row: u32) -> TraceRays {
    TraceRays {
        origin: rays.origin.to_array(),
        index,
        corner: rays.corner.to_array(),
        width: rays.size.x,
        step_x: rays.step_x.to_array(),
        height: rays.size.y,
        step_y: rays.step_y.to_array(),
        first_row,
    }
}

fn uniforms(prepared: &PreparedTrace) -> TraceScene {
    let PreparedTrace { sky, bounds, .. } = prepared;
    let mut scene = TraceScene {
        world_from_grid: rows(&prepared.world_from_grid),
        grid_from_world: rows(&without_offset(prepared.grid_from_world)),
        world_from_normal: rows(&without_offset(prepared.world_from_normal)),
        up: prepared.up.to_array(),
        radius: prepared.radius,
        low: bounds.0.to_array(),
        high: bounds.1.to_array(),
        middle: prepared.middle.to_array(),
        open_ground: prepared.open_ground.to_array(),
        towards_sun: prepared.towards_sun.to_array(),
        zenith: sky.zenith.to_array(),
        horizon: sky.horizon.to_array(),
        glow: sky.glow.to_array(),
        below: sky.below.to_array(),
        ..TraceScene::default()
    };
    if let Some(ground) = &prepared.ground {
        scene.ground_height = ground.height.to_array();
        scene.ground_offset = ground.offset;
        scene.ground_albedo = ground.albedo.to_array();
    }
    if let Some(sun) = &prepared.sun {
        scene.sun_sine = sun.sin_radius;
        scene.sun_irradiance = sun.irradiance.to_array();
        scene.sun_radiance = sun.radiance.to_array();
    }
    if let Some(lamp) = &prepared.lamp {
        scene.lamp_centre = lamp.centre.to_array();
        scene.lamp_u = lamp.half_u.to_array();
        scene.lamp_v = lamp.half_v.to_array();
        scene.lamp_normal = lamp.normal.to_array();
        scene.lamp_radiance = lamp.radiance.to_array();
        scene.lamp_area = 4.0 * lamp.half_u.length() * lamp.half_v.length();
    }
    if let Some(pupil) = &prepared.pupil {
        scene.pupil_right = pupil.right.to_array();
        scene.pupil_up = pupil.up.to_array();
        scene.focus = pupil.focus;
    }
    scene
}

fn without_offset(matrix: Mat3) -> Affine3A {
    Affine3A::from_mat3_translation(matrix, Vec3::ZERO)
}

fn rows(map: &Affine3A) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|row| {
        let v = map.matrix3.row(row);
        [v.x, v.y, v.z, map.translation[row]]
    })
}
