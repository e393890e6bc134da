//! Owns the points pass: the voxels that an eye sees, a point each, lit by the pipeline.
//!
//! A point covers the pixels whose rays meet its voxel's box. So points have no size to be rounded:
//! near by they leave no gaps, far away none grows, shrinks or vanishes from picture to picture
//! otherwise than the voxels themselves do, and the picture is the software shader's.
//!
//! Takes the points of an index map ([`PointCloud`]) and the rays that it was made with; draws them
//! over the background with the depth of the surface.

use std::sync::Arc;

use ash::vk;

use super::background::BackgroundPass;
use super::composite::{CompositeEye, constants, is_srgb};
use super::shading::{KIND_CONSTANTS, Surface, UNIFORMS, Uniforms};
use super::slicing::{clip_rows, corner_margin_px};
use super::specialised::Specialised;
use crate::gpu::layout::{CompositeView, PointView};
use crate::gpu::{
    Blend, Depth, DescriptorSets, Device, FRAMES_IN_FLIGHT, GpuError, Graphics, Piece, Pipeline,
    PipelineLayout, Recorder, Result, SetLayout, Staging, shaders,
};
use crate::shade::points::PointCloud;

/// The binding of the points.
const POINTS: u32 = 6;

/// Draws points to a screen.
pub struct Points {
    pipelines: Specialised<KIND_CONSTANTS, Pipeline>,
    layout: Arc<PipelineLayout>,
    format: vk::Format,
    background: BackgroundPass,
    sets: DescriptorSets,
    uniforms: Uniforms,
    staging: Staging,
    /// The points of each eye in this frame.
    pieces: Vec<Option<(Piece, u32)>>,
    /// Where in the staging points may begin, and how many bytes of them a shader can see.
    align: u64,
    most_bytes: u64,
    slot: usize,
    eyes: u32,
    margin_px: f32,
    /// The target stores linear values, encoded by the device.
    linear: bool,
    device: Arc<Device>,
}

impl Points {
    /// For targets of `format` with a D32 depth buffer and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<Points> {
        let (vertex, fragment) = (vk::ShaderStageFlags::VERTEX, vk::ShaderStageFlags::FRAGMENT);
        let bindings = [
            (UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER, vertex),
            (POINTS, vk::DescriptorType::STORAGE_BUFFER, vertex),
        ];
        let set_layout = SetLayout::new(device, "points", &bindings)?;
        let push = Some((vertex | fragment, size_of::<PointView>()));
        let layout = PipelineLayout::new(device, "points", Some(&set_layout), push)?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let limits = device.limits();
        Ok(Points {
            pipelines: Specialised::new(),
            layout,
            format,
            background: BackgroundPass::new(device, format)?,
            sets: DescriptorSets::new(
                device,
                "points",
                &set_layout,
                FRAMES_IN_FLIGHT * eyes as usize,
            )?,
            uniforms: Uniforms::new(device)?,
            staging: Staging::new(device, "points", usage, 1 << 20)?,
            pieces: vec![None; eyes as usize],
            align: limits.min_storage_buffer_offset_alignment.max(16),
            most_bytes: limits.max_storage_buffer_range.into(),
            slot: 0,
            eyes,
            margin_px: corner_margin_px(device),
            linear: is_srgb(format),
            device: device.clone(),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.uniforms.begin(slot);
        self.staging.begin(slot);
        self.pieces.fill(None);
    }

    /// Uploads the points of `eye`, for this frame.
    pub fn upload(&mut self, eye: u32, cloud: &PointCloud) -> Result<()> {
        let points = cloud.points();
        let bytes = size_of_val(points) as u64;
        if bytes > self.most_bytes {
            return Err(GpuError::Limit {
                what: format!("a picture of {} points", points.len()),
                needed: bytes,
                limit: "maxStorageBufferRange",
                allowed: self.most_bytes,
            });
        }
        self.pieces[eye as usize] = match points {
            [] => None,
            _ => Some((self.staging.push(points, self.align)?, points.len() as u32)),
        };
        Ok(())
    }

    /// Draws the points of `eye` over the background, within rendering, to a target that holds
    /// nothing or, where the background is kept, depth. `view` has as many pixels as its rays.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        surface: &Surface,
        eye: u32,
        view: &CompositeEye,
    ) -> Result<()> {
        self.background.draw(recorder, view);
        let Some((piece, count)) = self.pieces[eye as usize] else { return Ok(()) };
        let Some(point_view) = point_view(view, self.margin_px, self.linear) else { return Ok(()) };
        let set = self.slot * self.eyes as usize + eye as usize;
        self.uniforms.write(&self.sets, set, surface)?;
        let kind = vk::DescriptorType::STORAGE_BUFFER;
        self.sets.write_buffer(set, POINTS, kind, piece.buffer, piece.offset, piece.bytes);
        let pipeline = self.pipelines.get(surface.kind(), |constants| {
            let points = Graphics {
                name: "points",
                vertex: shaders::POINTS_VERT,
                fragment: shaders::POINTS_FRAG,
                layout: &self.layout,
                vertices: None,
                topology: vk::PrimitiveTopology::TRIANGLE_LIST,
                cull: vk::CullModeFlags::NONE,
                colour: Some((self.format, Blend::Replace)),
                depth: Some(Depth::NEARER),
                constants,
            };
            Pipeline::graphics(&self.device, &points)
        })?;
        recorder.bind_pipeline(pipeline);
        recorder.bind_set(pipeline, self.sets.set(set));
        recorder.push(pipeline.layout(), &point_view);
        recorder.set_scissor(view.scissor());
        recorder.draw(3 * count, 1);
        Ok(())
    }
}

/// `None` where the rays do not span a picture.
fn point_view(view: &CompositeEye, margin_px: f32, linear: bool) -> Option<PointView> {
    let [clip_x, clip_y, clip_w] = clip_rows(&view.rays)?.map(|row| row.to_array());
    let CompositeView {
        origin, depth_slope, corner, depth_at_0, step_x, step_y, left, upper, ..
    } = constants(view, linear);
    // Clip coordinates go from -1 to 1 across the picture. What is added is for rounding in them.
    let [margin_x, margin_y] =
        view.rays.size.to_array().map(|edge| 2.0 * margin_px / edge as f32 + 1e-5);
    Some(PointView {
        origin,
        depth_slope,
        corner,
        depth_at_0,
        step_x,
        left,
        step_y,
        upper,
        clip_x,
        linear: linear.into(),
        clip_y,
        margin_x,
        clip_w,
        margin_y,
    })
}
