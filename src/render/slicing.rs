//! The slicing pass: the areas of a grid, drawn layer by layer from front to back, give an index map.
//!
//! After J. Mueller's slicing core (2005), with two changes. Instead of reading one texel on the middle plane of its
//! slice, a fragment walks the voxels that its ray crosses within the layer, so that the map equals the ray caster's. A
//! layer may be thicker than one voxel, which takes fewer fragments.
//!
//! Takes a volume, the areas along its axes and the rays of an eye; fills an [`IndexTarget`].

use std::sync::Arc;

use ash::vk;
use glam::{DMat3, UVec2, Vec3};

use crate::gpu::layout::{SliceInstance, SliceView};
use crate::gpu::{
    Attribute, Depth, DescriptorSets, Device, FRAMES_IN_FLIGHT, Graphics, Pipeline, PipelineLayout,
    Recorder, Result, SetLayout, Staging, Vertices, shaders,
};
use crate::render::{EyeTask, IndexTarget, Volume};
use crate::surface::SmallBricks;
use crate::surface::slices::{LayerRect, SliceAreas, SliceLayers, facing_axis};
use crate::view::PixelRays;

/// Initial capacity of a frame for instances, in bytes.
const STAGING_BYTES: u64 = 256 << 10;

/// Draws index maps by slicing.
pub struct Slicing {
    pipeline: Pipeline,
    sets: DescriptorSets,
    /// The image that each set refers to.
    named: [u64; FRAMES_IN_FLIGHT],
    staging: Staging,
    /// Reused allocation.
    instances: Vec<SliceInstance>,
    slot: usize,
    margin_px: f32,
    /// Thickness of a layer in voxels; `None`: that of a slab.
    thickness: Option<u32>,
}

impl Slicing {
    pub fn new(device: &Arc<Device>) -> Result<Slicing> {
        let fragment = vk::ShaderStageFlags::FRAGMENT;
        let set_layout =
            SetLayout::new(device, "slicing", &[(0, vk::DescriptorType::SAMPLED_IMAGE, fragment)])?;
        let stages = vk::ShaderStageFlags::VERTEX | fragment;
        let push = Some((stages, size_of::<SliceView>()));
        let layout = PipelineLayout::new(device, "slicing", Some(&set_layout), push)?;
        let format = vk::Format::R16G16B16A16_UINT;
        let attributes = [
            Attribute { location: 0, format, offset: std::mem::offset_of!(SliceInstance, rect) },
            Attribute { location: 1, format, offset: std::mem::offset_of!(SliceInstance, layer) },
        ];
        let pipeline = Pipeline::graphics(
            device,
            &Graphics {
                name: "slicing",
                vertex: shaders::SLICING_VERT,
                fragment: shaders::SLICING_FRAG,
                layout: &layout,
                vertices: Some(Vertices {
                    stride: size_of::<SliceInstance>(),
                    per_instance: true,
                    attributes: &attributes,
                }),
                topology: vk::PrimitiveTopology::TRIANGLE_STRIP,
                cull: vk::CullModeFlags::NONE,
                colour: Some((vk::Format::R32_UINT, Default::default())),
                depth: Some(Depth::NEARER),
                constants: &[],
            },
        )?;
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        Ok(Slicing {
            pipeline,
            sets: DescriptorSets::new(device, "slicing", &set_layout, FRAMES_IN_FLIGHT)?,
            named: [0; FRAMES_IN_FLIGHT],
            staging: Staging::new(device, "areas", usage, STAGING_BYTES)?,
            instances: Vec::new(),
            slot: 0,
            margin_px: corner_margin_px(device),
            thickness: None,
        })
    }

    /// Returns the same pass with layers of 1, 2, 4 or 8 voxels. Those of 2005 have 1.
    pub fn with_thickness(mut self, thickness_vx: u32) -> Slicing {
        self.thickness = Some(thickness_vx).filter(|t| matches!(t, 1 | 2 | 4 | 8));
        self
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize, volume: &Volume) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.staging.begin(slot);
        let image = volume.image();
        if self.named[self.slot] != image.id() {
            self.named[self.slot] = image.id();
            self.sets.write_sampled(self.slot, 0, image.view());
        }
    }

    /// Draws the part of an index map described by `task`, of the volume given to [`Slicing::begin`]. `areas` must be
    /// up to date with it. Leaves the map in the layout of [`crate::gpu::ResourceUse::COLOUR_TARGET`].
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        volume: &Volume,
        areas: &mut SliceAreas,
        task: &EyeTask,
        target: &mut IndexTarget,
    ) -> Result<()> {
        let rays = &task.rays;
        let axis = facing_axis(rays, volume.dims());
        let slab = areas.slab_vx();
        let thickness = self.thickness.unwrap_or(slab);
        let layers = SliceLayers::new(rays, volume.dims(), axis, thickness, slab);
        let slabs = areas.along(axis);
        let instances = &mut self.instances;
        instances.clear();
        layers.for_each(slabs, |rect| instances.push(instance(&rect)));
        let ranks = volume.dims()[axis].div_ceil(thickness) + 2;
        let view = slice_view(rays, volume, axis, ranks, self.margin_px);

        let piece = match &view {
            Some(_) if !instances.is_empty() => Some(self.staging.push(instances, 16)?),
            _ => None,
        };
        target.begin(recorder, task);
        if let (Some(piece), Some(view)) = (piece, view) {
            recorder.bind_pipeline(&self.pipeline);
            recorder.bind_set(&self.pipeline, self.sets.set(self.slot));
            recorder.push(self.pipeline.layout(), &view);
            recorder.bind_vertices(piece.buffer, piece.offset);
            recorder.draw(4, instances.len() as u32);
        }
        target.end(recorder);
        Ok(())
    }
}

fn instance(rect: &LayerRect) -> SliceInstance {
    let LayerRect { layer, rect } = rect;
    let (min, max) = rect.map_or((UVec2::ZERO, UVec2::ZERO), |r| (r.min, r.max));
    SliceInstance {
        rect: [min.x as u16, max.x as u16, min.y as u16, max.y as u16],
        layer: [layer.first as u16, layer.end as u16, layer.rank as u16, u16::from(rect.is_none())],
    }
}

/// Returns the largest displacement of a corner by the device, in pixels: its sub-pixel precision.
pub(super) fn corner_margin_px(device: &Device) -> f32 {
    0.5f32.powi(device.limits().sub_pixel_precision_bits as i32)
}

/// Returns rows that map `p - origin` of a point p to its clip x, y and w; `None` if the rays do not span a picture.
pub(super) fn clip_rows(rays: &PixelRays) -> Option<[Vec3; 3]> {
    let columns =
        DMat3::from_cols(rays.step_x.as_dvec3(), rays.step_y.as_dvec3(), rays.corner.as_dvec3());
    // A point is `origin + a step_x + b step_y + w corner`, seen at the pixel (a / w, b / w).
    let inverse = columns.inverse();
    if !inverse.is_finite() || !rays.origin.is_finite() {
        return None;
    }
    let rows = inverse.transpose();
    let size = rays.size.as_dvec2();
    let clip_x = 2.0 / size.x * rows.x_axis - rows.z_axis;
    let clip_y = 2.0 / size.y * rows.y_axis - rows.z_axis;
    Some([clip_x, clip_y, rows.z_axis].map(|row| row.as_vec3()))
}

/// Returns the push constants; `None` if the rays do not span a picture.
fn slice_view(
    rays: &PixelRays,
    volume: &Volume,
    axis: usize,
    ranks: u32,
    margin_px: f32,
) -> Option<SliceView> {
    let [clip_x, clip_y, clip_w] = clip_rows(rays)?.map(|row| row.to_array());
    let SmallBricks { weights, least } = SmallBricks::new(rays);
    Some(SliceView {
        origin: rays.origin.to_array(),
        axis: axis as u32,
        corner: rays.corner.to_array(),
        depth_step: 1.0 / ranks as f32,
        step_x: rays.step_x.to_array(),
        margin_px,
        step_y: rays.step_y.to_array(),
        small_least: least,
        clip_x,
        small_x: weights.x,
        clip_y,
        small_y: weights.y,
        clip_w,
        small_z: weights.z,
        dims: volume.dims().to_array(),
        ..SliceView::default()
    })
}
