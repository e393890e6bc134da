//! Draws the overlay: the semi-transparent tool preview and lines, each tested against the
//! sculpture's depth and fainter where it lies behind the sculpture.
//!
//! The previews and lines to draw come in as values; the depth attachment is read only. Faces and lines that lie in the
//! surface win the depth test by a margin, so that they do not flicker. The faces of solids, which surfaces of voxels
//! follow in steps, win it by as much as these steps are high.

use std::sync::Arc;

use ash::vk;
use glam::{DAffine3, Mat3, Mat4, Vec2, Vec3};

use super::overlay_scene::grid_from_tool;
pub use super::overlay_scene::{OverlayDrawing, OverlayLine, ToolPreview};
use super::reference::References;
use super::slicing::corner_margin_px;
use super::solid_mesh::{Vertex, sagitta, triangles};
use crate::gpu::{
    Attribute, Blend, Buffer, Depth, Device, Graphics, MemoryLocation, Pipeline, PipelineLayout,
    Recorder, Result, Staging, Vertices, shaders,
};
use crate::sculpture::Rgb;
use crate::tools::solid::Solid;
use crate::tools::solid::body::Body;

/// Factor on the depth of lines, which puts them in front of a surface that they coincide with.
const LINE_DEPTH: f32 = 1.002;
/// Likewise for the faces of tools, below their lines: more than the rounding difference between depths of the surface
/// and of the rasterizer.
const FACE_DEPTH: f32 = 1.0004;
/// Largest displacement of a face on the screen, in units of the rasterizer's sub-pixel precision: a vertex is rounded
/// by up to one unit in x and in y. At a grazing angle, a fraction of a pixel changes the depth more than
/// [`FACE_DEPTH`].
const FACE_SHIFT: f32 = 2.0;

/// Push constants of the `overlay_solid` stages.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct SolidConstants {
    clip_x: [f32; 4],
    clip_y: [f32; 4],
    clip_w: [f32; 4],
    /// Fourth elements: half extents of the ellipsoid that rounds the solid.
    eye_from_normal: [[f32; 4]; 3],
    eye: [f32; 3],
    colour: [u8; 4],
    margin: f32,
    most: f32,
    bend: f32,
    straight: f32,
}

impl SolidConstants {
    /// Fills the constants. `displaced_px`: largest displacement of a face by the rasterizer.
    fn new(
        scene: &OverlayDrawing,
        preview: &ToolPreview,
        side: usize,
        displaced_px: f32,
    ) -> SolidConstants {
        let primitive = &preview.primitive;
        let eye_from_tool = scene.eye_from_grid * grid_from_tool(primitive, preview.voxel_size);
        // Clip z is the near distance everywhere.
        let clip_z = scene.projection.w_axis.z * scene.nearer(FACE_DEPTH);
        let clip = scene.projection * Mat4::from(eye_from_tool);
        let [clip_x, clip_y, clip_w] = [0, 1, 3].map(|row| clip.row(row) / clip_z);
        let rows = Mat3::from(eye_from_tool.matrix3).inverse();
        let round = primitive.shape().round().as_vec3();
        let row = |i: usize| rows.col(i).extend(round[i]).to_array();
        // From afar, single precision is not enough.
        let in_double = DAffine3 {
            matrix3: Mat3::from(eye_from_tool.matrix3).as_dmat3(),
            translation: Vec3::from(eye_from_tool.translation).as_dvec3(),
        };

        let voxel = scene.eye_from_grid.matrix3;
        let edges = [voxel.x_axis, voxel.y_axis, voxel.z_axis].map(|edge| edge.length());
        let steps = preview.steps_vx() * edges.into_iter().fold(0.0, f32::max);
        let tool = eye_from_tool.matrix3;
        let halves = [tool.x_axis, tool.y_axis, tool.z_axis].map(|half| half.length());
        let [smallest, largest] = [f32::min, f32::max].map(|of| halves.into_iter().reduce(of));
        let body = &primitive.solid.spec().body;
        let faces = sagitta(body) * largest.unwrap_or_default();
        // The farthest corner of the bounding box has the largest displacement.
        let farthest = (clip_w.truncate().abs().element_sum() + clip_w.w) * clip_z;
        let half_size = 0.5 * Vec2::from(scene.size.map(|n| n as f32));
        let pixels = half_size * Vec2::new(scene.projection.x_axis.x, scene.projection.y_axis.y);
        let displaced = displaced_px * farthest.max(0.0) / pixels.abs().min_element();
        let margin = steps + faces + displaced;
        // A tangent of this length to a ball within the solid stays within the margin.
        let radius = smallest.unwrap_or_default();
        let tangent = (2.0 * radius * margin).sqrt();
        let is_round = matches!(body, Body::Revolved { .. });
        let most = if body.has_straight_lines() { f32::MAX } else { tangent };
        let curvature = if is_round { radius.recip() } else { 0.0 };
        let has_ends = is_round && body.has_straight_lines();
        SolidConstants {
            clip_x: clip_x.to_array(),
            clip_y: clip_y.to_array(),
            clip_w: clip_w.to_array(),
            eye_from_normal: [row(0), row(1), row(2)],
            eye: in_double.inverse().translation.as_vec3().to_array(),
            colour: bytes_with_opacity(preview.colour, preview.opacity[side]),
            margin,
            most: (most / clip_z).min(f32::MAX),
            bend: 2.0 * margin * curvature * clip_z * clip_z,
            straight: if has_ends { 1.0 } else { 0.0 },
        }
    }
}

/// Push constants of `overlay_line.vert.wgsl`.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct LineConstants {
    clip_from_grid: [f32; 16],
    picture: [f32; 4],
}

#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct LineInstance {
    from_and_width: [f32; 4],
    to: [f32; 4],
    colour: [f32; 4],
}

/// In front of the sculpture, behind it.
const SIDES: [vk::CompareOp; 2] = [vk::CompareOp::GREATER_OR_EQUAL, vk::CompareOp::LESS];

/// The overlay's passes.
pub struct Overlay {
    solids: [Pipeline; 2],
    lines: [Pipeline; 2],
    mesh: Buffer,
    /// First byte and number of vertices of each solid in the mesh.
    ranges: [(u64, u32); Solid::ALL.len()],
    instances: Staging,
    /// Largest displacement of a face by the rasterizer, in pixels.
    displaced_px: f32,
    /// Created when there are any.
    pub(super) references: Option<References>,
}

impl Overlay {
    /// Creates one for a target of `colour` with a depth attachment of `depth`.
    pub fn new(device: &Arc<Device>, colour: vk::Format, depth: vk::Format) -> Result<Overlay> {
        let both = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let solid_push = Some((both, size_of::<SolidConstants>()));
        let solid_layout = PipelineLayout::new(device, "tool", None, solid_push)?;
        let line_push = Some((vk::ShaderStageFlags::VERTEX, size_of::<LineConstants>()));
        let line_layout = PipelineLayout::new(device, "lines", None, line_push)?;
        let solid = |compare| {
            Pipeline::graphics(
                device,
                &Graphics {
                    name: "tool",
                    vertex: shaders::OVERLAY_SOLID_VERT,
                    fragment: shaders::OVERLAY_SOLID_FRAG,
                    layout: &solid_layout,
                    vertices: Some(Vertices {
                        stride: size_of::<Vertex>(),
                        per_instance: false,
                        attributes: &attributes(vk::Format::R32G32B32_SFLOAT, 12, 3),
                    }),
                    topology: vk::PrimitiveTopology::TRIANGLE_LIST,
                    cull: vk::CullModeFlags::BACK,
                    colour: Some((colour, Blend::Alpha)),
                    depth: Some(Depth { format: depth, compare, ..Depth::TEST_ONLY }),
                    constants: &[],
                },
            )
        };
        let line = |compare| {
            Pipeline::graphics(
                device,
                &Graphics {
                    name: "lines",
                    vertex: shaders::OVERLAY_LINE_VERT,
                    fragment: shaders::OVERLAY_LINE_FRAG,
                    layout: &line_layout,
                    vertices: Some(Vertices {
                        stride: size_of::<LineInstance>(),
                        per_instance: true,
                        attributes: &attributes(vk::Format::R32G32B32A32_SFLOAT, 16, 3),
                    }),
                    topology: vk::PrimitiveTopology::TRIANGLE_LIST,
                    cull: vk::CullModeFlags::NONE,
                    colour: Some((colour, Blend::Alpha)),
                    depth: Some(Depth { format: depth, compare, ..Depth::TEST_ONLY }),
                    constants: &[],
                },
            )
        };
        let (mesh, ranges) = make_mesh(device)?;
        Ok(Overlay {
            solids: [solid(SIDES[0])?, solid(SIDES[1])?],
            lines: [line(SIDES[0])?, line(SIDES[1])?],
            mesh,
            ranges,
            instances: Staging::new(
                device,
                "lines",
                vk::BufferUsageFlags::VERTEX_BUFFER,
                64 * size_of::<LineInstance>() as u64,
            )?,
            displaced_px: FACE_SHIFT * corner_margin_px(device),
            references: None,
        })
    }

    /// Starts a frame that uses `slot` ([`crate::gpu::Frames::slot`]).
    pub fn begin(&mut self, slot: usize) {
        self.instances.begin(slot);
        if let Some(references) = &mut self.references {
            references.begin(slot);
        }
    }

    /// Returns whether there is anything of `scene` to draw.
    pub fn draws(&self, scene: &OverlayDrawing) -> bool {
        let OverlayDrawing { previews, lines, .. } = scene;
        self.references.is_some() || !(previews.is_empty() && lines.is_empty())
    }

    /// Records the overlay of an eye into a target with the depth of the sculpture.
    pub fn draw(&mut self, recorder: &mut Recorder, scene: &OverlayDrawing) -> Result<()> {
        if let Some(references) = &mut self.references {
            references.draw(recorder, scene);
        }
        // Parts behind the sculpture come first: they are farther away.
        for side in [1, 0] {
            self.draw_lines(recorder, scene, side)?;
            for preview in scene.previews {
                self.draw_ghost(recorder, scene, preview, side);
            }
        }
        Ok(())
    }

    fn draw_ghost(
        &self,
        recorder: &mut Recorder,
        scene: &OverlayDrawing,
        preview: &ToolPreview,
        side: usize,
    ) {
        if preview.opacity[side] <= 0.0 {
            return;
        }
        let constants = SolidConstants::new(scene, preview, side, self.displaced_px);
        let (offset, vertices) = self.ranges[preview.primitive.solid as usize];
        let pipeline = &self.solids[side];
        recorder.bind_pipeline(pipeline);
        recorder.push(pipeline.layout(), &constants);
        recorder.bind_vertices(self.mesh.handle(), offset);
        recorder.draw(vertices, 1);
    }

    fn draw_lines(
        &mut self,
        recorder: &mut Recorder,
        scene: &OverlayDrawing,
        side: usize,
    ) -> Result<()> {
        let instances: Vec<LineInstance> = scene
            .lines
            .iter()
            .filter(|line| line.opacity[side] > 0.0)
            .map(|line| LineInstance {
                from_and_width: line.from.extend(line.width_px).to_array(),
                to: line.to.extend(0.0).to_array(),
                colour: with_opacity(line.colour, line.opacity[side]),
            })
            .collect();
        if instances.is_empty() {
            return Ok(());
        }
        let piece = self.instances.push(&instances, 16)?;
        let [width, height] = scene.size.map(|n| n as f32);
        let constants = LineConstants {
            clip_from_grid: (scene.projection * Mat4::from(scene.eye_from_grid)).to_cols_array(),
            picture: [width, height, 1.0, scene.nearer(LINE_DEPTH)],
        };
        let pipeline = &self.lines[side];
        recorder.bind_pipeline(pipeline);
        recorder.push(pipeline.layout(), &constants);
        recorder.bind_vertices(piece.buffer, piece.offset);
        recorder.draw(6, instances.len() as u32);
        Ok(())
    }
}

fn with_opacity(Rgb(colour): Rgb, opacity: f32) -> [f32; 4] {
    let [r, g, b] = colour.map(|c| f32::from(c) / 255.0);
    [r, g, b, opacity]
}

/// Returns the result of [`with_opacity`], with a byte for each value.
fn bytes_with_opacity(Rgb([r, g, b]): Rgb, opacity: f32) -> [u8; 4] {
    [r, g, b, (opacity.clamp(0.0, 1.0) * 255.0).round() as u8]
}

/// Returns `count` consecutive attributes of one format, each `bytes` long.
fn attributes(format: vk::Format, bytes: usize, count: u32) -> Vec<Attribute> {
    (0..count)
        .map(|location| Attribute { location, format, offset: bytes * location as usize })
        .collect()
}

fn make_mesh(device: &Arc<Device>) -> Result<(Buffer, [(u64, u32); Solid::ALL.len()])> {
    let mut vertices: Vec<Vertex> = Vec::new();
    let mut ranges = [(0, 0); Solid::ALL.len()];
    for solid in Solid::ALL {
        let start = vertices.len();
        vertices.extend(triangles(&solid.spec().body).into_iter().flatten());
        let offset = (start * size_of::<Vertex>()) as u64;
        ranges[solid as usize] = (offset, (vertices.len() - start) as u32);
    }
    let mut mesh = Buffer::new(
        device,
        "tool meshes",
        size_of_val(vertices.as_slice()) as u64,
        vk::BufferUsageFlags::VERTEX_BUFFER,
        MemoryLocation::CpuToGpu,
    )?;
    mesh.write(0, &vertices)?;
    Ok((mesh, ranges))
}
