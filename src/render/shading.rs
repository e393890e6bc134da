//! The inputs of every pass that lights surfaces on the device: voxels, colours and lights, as
//! values and as uniforms of the shaders.
//!
//! The numbers are those of the software shader ([`crate::shade`]), so that pictures are equal up
//! to rounding.

use std::sync::Arc;

use ash::vk;
use glam::UVec3;

use crate::gpu::layout::Shading;
use crate::gpu::{
    Buffer, BufferRange, DescriptorSets, Device, MemoryLocation, ResourceUse, Result, Staging,
    run_once,
};
use crate::render::{DeviceColours, Normals};
use crate::sculpture::Rgb;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::shade::{Illumination, LightSource, Lighting, Look, Matcap, ShadePose};
use crate::surface::SmallBricks;

/// Bindings that the shaders of these passes share (shaders/lighting.wgsl and the others).
pub(super) const VOLUME: u32 = 0;
pub(super) const COLOURS: u32 = 4;
pub(super) const UNIFORMS: u32 = 5;
pub(super) const NORMALS: u32 = 7;
pub(super) const MATCAP: u32 = 8;

/// A sculpture and its lighting, for one eye.
#[derive(Clone, Copy)]
pub struct LitSurface<'a> {
    /// Size of the grid in voxels.
    pub dims: UVec3,
    /// None: every voxel has the base colour.
    pub colours: Option<&'a DeviceColours>,
    pub base: Rgb,
    /// The normals for shading on the device.
    pub normals: Option<&'a Normals>,
    /// Normals are incomplete: estimates replace missing ones.
    pub estimates: bool,
    pub pose: ShadePose,
    pub lighting: &'a Lighting,
}

/// Specialization constants of the shaders that light surfaces.
pub(super) const KIND_CONSTANTS: usize = 6;

impl LitSurface<'_> {
    /// Returns the features of the shader that lights it (shaders/kind.wgsl).
    pub(super) fn kind(&self) -> [u32; KIND_CONSTANTS] {
        [
            self.lighting.lights.iter().flatten().count() as u32,
            self.lighting.occlusion.into(),
            self.colours
                .filter(|colours| colours.shows_mask() || self.lighting.look == Look::Colours)
                .map_or(0, DeviceColours::bytes_per_voxel),
            self.estimates.into(),
            (self.lighting.look == Look::Matcap).into(),
            self.lighting.shadow.is_some().into(),
        ]
    }
}

/// Uniforms being uploaded.
pub(super) struct Uniforms {
    staging: Staging,
    align: u64,
    /// Bound if there are no colours.
    nothing: Buffer,
    /// The matcaps used since the start: few, as [`Matcap`] says.
    matcaps: Vec<(Matcap, Buffer)>,
    device: Arc<Device>,
}

impl Uniforms {
    pub fn new(device: &Arc<Device>) -> Result<Uniforms> {
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let align = device.limits().min_uniform_buffer_offset_alignment.max(16);
        let bytes = 4 * (size_of::<Shading>() as u64).next_multiple_of(align);
        Ok(Uniforms {
            staging: Staging::new(device, "lights", usage, bytes)?,
            align,
            nothing: Buffer::new(
                device,
                "nothing",
                16,
                vk::BufferUsageFlags::STORAGE_BUFFER,
                MemoryLocation::GpuOnly,
            )?,
            matcaps: Vec::new(),
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.staging.begin(slot);
    }

    /// Uploads the uniforms of `surface` and binds them to `set`, with the matcap if it has one.
    pub fn write(&mut self, sets: &DescriptorSets, set: usize, surface: &LitSurface) -> Result<()> {
        self.write_seen(sets, set, surface, &SmallBricks::NONE)
    }

    /// Performs [`Uniforms::write`] for a shader that must know which bricks are hit as a whole.
    pub fn write_seen(
        &mut self,
        sets: &DescriptorSets,
        set: usize,
        surface: &LitSurface,
        small: &SmallBricks,
    ) -> Result<()> {
        let [small_x, small_y, small_z] = small.weights.to_array();
        let small_least = small.least;
        let uniforms = Shading { small_least, small_x, small_y, small_z, ..uniforms(surface) };
        let piece: BufferRange = self.staging.push(&[uniforms], self.align)?;
        let kind = vk::DescriptorType::UNIFORM_BUFFER;
        sets.write_buffer(set, UNIFORMS, kind, piece);
        let matcap = match surface.lighting.look {
            Look::Matcap => self.matcap(surface.lighting.matcap)?,
            _ => &self.nothing,
        };
        let kind = vk::DescriptorType::STORAGE_BUFFER;
        sets.write_buffer(set, MATCAP, kind, matcap.whole());
        Ok(())
    }

    /// Returns the device's copy of a matcap. Waits for its upload when it is first used.
    fn matcap(&mut self, matcap: Matcap) -> Result<&Buffer> {
        let place = match self.matcaps.iter().position(|(known, _)| *known == matcap) {
            Some(place) => place,
            None => {
                self.matcaps.push((matcap, upload(&self.device, matcap)?));
                self.matcaps.len() - 1
            }
        };
        Ok(&self.matcaps[place].1)
    }

    /// Binds the colours and normals of `surface` to `set`.
    pub fn write_surface(&self, sets: &DescriptorSets, set: usize, surface: &LitSurface) {
        let kind = vk::DescriptorType::STORAGE_BUFFER;
        let colours = surface.colours.map_or(&self.nothing, DeviceColours::buffer);
        sets.write_buffer(set, COLOURS, kind, colours.whole());
        let normals = surface.normals.map_or(&self.nothing, Normals::buffer);
        sets.write_buffer(set, NORMALS, kind, normals.whole());
    }
}

fn upload(device: &Arc<Device>, matcap: Matcap) -> Result<Buffer> {
    use vk::BufferUsageFlags as Usage;
    let name = "matcap";
    let texels: &[u8] = bytemuck::cast_slice(matcap.texels());
    let bytes = texels.len() as u64;
    let mut source =
        Buffer::new(device, name, bytes, Usage::TRANSFER_SRC, MemoryLocation::CpuToGpu)?;
    source.write(0, texels)?;
    let usage = Usage::STORAGE_BUFFER | Usage::TRANSFER_DST;
    let target = Buffer::new(device, name, bytes, usage, MemoryLocation::GpuOnly)?;
    run_once(device, |recorder| {
        let copy = vk::BufferCopy { src_offset: 0, dst_offset: 0, size: bytes };
        recorder.copy_buffer(source.handle(), target.handle(), &[copy]);
        recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
        Ok(())
    })?;
    Ok(target)
}

fn uniforms(surface: &LitSurface) -> Shading {
    let LitSurface { dims, base, pose, lighting, .. } = *surface;
    let light = Illumination::new(lighting, &pose.eye_from_world, &pose.world_from_grid);
    let mut shading = Shading {
        ambient: light.ambient.to_array(),
        specular: light.specular,
        base: light.colour.unwrap_or(base).0.map(|c| f32::from(c) / 255.0),
        shininess: light.shininess,
        dims: dims.to_array(),
        tone_floor: light.tone.floor,
        bricks: ((dims + (BRICK_EDGE_VX - 1)) / BRICK_EDGE_VX).to_array(),
        ambient_slope: light.ambient_slope.to_array(),
        up: light.up.to_array(),
        tone: light.tone.factors,
        sun_light: u32::MAX,
        ..Shading::default()
    };
    if let Some(sun) = &light.sun {
        (shading.sun_light, shading.sun_sample) = (sun.light as u32, sun.sample);
        shading.sun_towards = sun.towards.to_array();
        [shading.sun_right, shading.sun_up] = sun.across.map(|axis| axis.to_array());
    }
    let matrix = light.eye_from_grid.matrix3;
    let translation = light.eye_from_grid.translation;
    let turn = light.normal_from_gradient;
    for row in 0..3 {
        let point = matrix.row(row);
        shading.eye_from_grid[row] = [point.x, point.y, point.z, translation[row]];
        shading.normal_from_gradient[row] = turn.row(row).extend(0.0).to_array();
    }
    for (i, light) in light.lights.iter().flatten().enumerate() {
        shading.sources[i] = match light.source {
            LightSource::Direction(d) => d.extend(0.0).to_array(),
            LightSource::Position(p) => p.extend(1.0).to_array(),
        };
        shading.radiances[i] = light.radiance.extend(0.0).to_array();
    }
    shading
}
