//! The points pass: one lit point for each visible voxel.
//!
//! A point covers the pixels whose rays meet the box of its voxel, or of the brick that it stands for where bricks are
//! smaller than pixels, so it has no size to be rounded. Up close, points leave
//! no gaps. Far away, they change from frame to frame only with the voxels. The picture equals that of the software
//! shader.
//!
//! Takes the points of an index map ([`PointCloud`]) and the rays that it was made with; draws them over the background
//! with the depth of the surface.

use std::sync::Arc;

use ash::vk;

use super::composite_eye::{CompositeEye, constants};
use super::screen_pass::ScreenPass;
use super::shading::{KIND_CONSTANTS, LitSurface, MATCAP, UNIFORMS, Uniforms};
use super::slicing::{clip_rows, corner_margin_px};
use super::specialised::Specialised;
use crate::gpu::layout::{CompositeView, PointView};
use crate::gpu::{
    BufferRange, Depth, Device, GpuError, Graphics, Pipeline, Recorder, Result, Staging, shaders,
};
use crate::shade::points::PointCloud;
use crate::surface::SmallBricks;

/// The binding of the points.
const POINTS: u32 = 6;

/// Draws points to a target.
pub struct PointsPass {
    screen: ScreenPass,
    pipelines: Specialised<KIND_CONSTANTS, Pipeline>,
    uniforms: Uniforms,
    staging: Staging,
    /// The points of each eye in this frame.
    pieces: Vec<Option<(BufferRange, u32)>>,
    /// Alignment of the points in the staging buffer, and the most bytes of them that a shader can address.
    align: u64,
    most_bytes: u64,
    margin_px: f32,
}

impl PointsPass {
    /// Creates one for targets of `format` with a D32 depth buffer and up to `eyes` eyes.
    pub fn new(device: &Arc<Device>, format: vk::Format, eyes: u32) -> Result<PointsPass> {
        let (vertex, fragment) = (vk::ShaderStageFlags::VERTEX, vk::ShaderStageFlags::FRAGMENT);
        let bindings = [
            (UNIFORMS, vk::DescriptorType::UNIFORM_BUFFER, vertex),
            (POINTS, vk::DescriptorType::STORAGE_BUFFER, vertex),
            (MATCAP, vk::DescriptorType::STORAGE_BUFFER, vertex),
        ];
        let (name, stages) = ("points", vertex | fragment);
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let limits = device.limits();
        Ok(PointsPass {
            screen: ScreenPass::new::<PointView>(device, name, format, eyes, &bindings, stages)?,
            pipelines: Specialised::new(),
            uniforms: Uniforms::new(device)?,
            staging: Staging::new(device, name, usage, 1 << 20)?,
            pieces: vec![None; eyes as usize],
            align: limits.min_storage_buffer_offset_alignment.max(16),
            most_bytes: limits.max_storage_buffer_range.into(),
            margin_px: corner_margin_px(device),
        })
    }

    /// Starts a frame that uses `slot`.
    pub fn begin(&mut self, slot: usize) {
        self.screen.begin(slot);
        self.uniforms.begin(slot);
        self.staging.begin(slot);
        self.pieces.fill(None);
    }

    /// Uploads the points of `eye` for this frame.
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

    /// Draws the points of the eye of `view` over the background, within rendering, to a cleared target or, if the
    /// background is kept, one with valid depth. `view` has as many pixels as its rays.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        surface: &LitSurface,
        view: &CompositeEye,
    ) -> Result<()> {
        let eye = view.eye;
        self.screen.draw_background(recorder, view);
        let Some((piece, count)) = self.pieces[eye as usize] else { return Ok(()) };
        let linear = self.screen.is_linear();
        let Some(point_view) = point_view(view, self.margin_px, linear) else { return Ok(()) };
        let (sets, set) = (self.screen.sets(), self.screen.set(eye));
        self.uniforms.write_seen(sets, set, surface, &SmallBricks::new(&view.rays))?;
        let kind = vk::DescriptorType::STORAGE_BUFFER;
        sets.write_buffer(set, POINTS, kind, piece);
        let pipeline = self.pipelines.get(surface.kind(), |constants| {
            let pass = self.screen.graphics(shaders::POINTS_FRAG, Depth::NEARER);
            let points = Graphics { vertex: shaders::POINTS_VERT, constants, ..pass };
            Pipeline::graphics(self.screen.device(), &points)
        })?;
        self.screen.draw(recorder, pipeline, view, &point_view, 3 * count);
        Ok(())
    }
}

/// Returns the push constants; `None` if the rays do not span a picture.
fn point_view(view: &CompositeEye, margin_px: f32, linear: bool) -> Option<PointView> {
    let [clip_x, clip_y, clip_w] = clip_rows(&view.rays)?.map(|row| row.to_array());
    let CompositeView {
        origin, depth_slope, corner, depth_at_0, step_x, step_y, left, upper, ..
    } = constants(view, linear);
    // Clip coordinates go from -1 to 1 across the picture. The addend allows for rounding in them.
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
