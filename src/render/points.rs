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
use super::shading::{Surface, UNIFORMS, Uniforms};
use super::slicing::clip_rows;
use crate::gpu::layout::{CompositeView, PointView};
use crate::gpu::{
    Attribute, Blend, Depth, DescriptorSets, Device, FRAMES_IN_FLIGHT, Graphics, Piece, Pipeline,
    PipelineLayout, Recorder, Result, SetLayout, Staging, Vertices, shaders,
};
use crate::shade::points::{PointCloud, SurfacePoint};

/// Draws points to a screen.
pub struct Points {
    pipeline: Pipeline,
    background: BackgroundPass,
    sets: DescriptorSets,
    uniforms: Uniforms,
    staging: Staging,
    /// The points of each eye in this frame.
    pieces: Vec<Option<(Piece, u32)>>,
    slot: usize,
    eyes: u32,
    /// The target stores linear values, encoded by the device.
    linear: bool,
}

impl Points {
    /// For targets of `format` with a D32 depth buffer and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<Points> {
        let (vertex, fragment) = (vk::ShaderStageFlags::VERTEX, vk::ShaderStageFlags::FRAGMENT);
        let bindings = [(UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER, vertex)];
        let set_layout = SetLayout::new(device, "points", &bindings)?;
        let push = Some((vertex | fragment, size_of::<PointView>()));
        let layout = PipelineLayout::new(device, "points", Some(&set_layout), push)?;
        let attribute = |location, format, offset| Attribute { location, format, offset };
        let attributes = [
            attribute(0, vk::Format::R16G16B16A16_UINT, std::mem::offset_of!(SurfacePoint, voxel)),
            attribute(1, vk::Format::R8G8B8A8_SINT, std::mem::offset_of!(SurfacePoint, outwards)),
            attribute(2, vk::Format::R8G8B8A8_UNORM, std::mem::offset_of!(SurfacePoint, colour)),
        ];
        let points = Graphics {
            name: "points",
            vertex: shaders::POINTS_VERT,
            fragment: shaders::POINTS_FRAG,
            layout: &layout,
            vertices: Some(Vertices {
                stride: size_of::<SurfacePoint>(),
                per_instance: true,
                attributes: &attributes,
            }),
            topology: vk::PrimitiveTopology::TRIANGLE_LIST,
            cull: vk::CullModeFlags::NONE,
            colour: Some((format, Blend::Replace)),
            depth: Some(Depth::NEARER),
        };
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        Ok(Points {
            pipeline: Pipeline::graphics(device, &points)?,
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
            slot: 0,
            eyes,
            linear: is_srgb(format),
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
        self.pieces[eye as usize] = match points {
            [] => None,
            _ => Some((self.staging.push(points, 16)?, points.len() as u32)),
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
        let Some(point_view) = point_view(view, self.linear) else { return Ok(()) };
        let set = self.slot * self.eyes as usize + eye as usize;
        self.uniforms.write(&self.sets, set, surface)?;
        recorder.bind_pipeline(&self.pipeline);
        recorder.bind_set(&self.pipeline, self.sets.set(set));
        recorder.push(self.pipeline.layout(), &point_view);
        recorder.bind_vertices(piece.buffer, piece.offset);
        recorder.set_scissor(view.scissor());
        recorder.draw(3, count);
        Ok(())
    }
}

/// `None` where the rays do not span a picture.
fn point_view(view: &CompositeEye, linear: bool) -> Option<PointView> {
    let [clip_x, clip_y, clip_w] = clip_rows(&view.rays)?.map(|row| row.to_array());
    let CompositeView {
        origin, depth_slope, corner, depth_at_0, step_x, step_y, left, upper, ..
    } = constants(view, linear);
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
        clip_w,
        ..PointView::default()
    })
}
