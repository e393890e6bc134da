//! Pipelines and their layouts, made from plain structs.

use std::sync::Arc;
use std::time::Instant;

use ash::vk;

use super::descriptors::SetLayout;
use super::device::Device;
use super::error::{During, GpuError, Result};
use super::retire::Retired;

/// Size of push constants that every Vulkan device supports, in bytes.
pub const MAX_PUSH_BYTES: u32 = 128;

/// A pipeline layout: at most one descriptor set and one block of push constants.
pub struct PipelineLayout {
    handle: vk::PipelineLayout,
    push_stages: vk::ShaderStageFlags,
    device: Arc<Device>,
}

impl PipelineLayout {
    /// Creates a layout. `push`: the stages that read the push constants, and their size.
    pub fn new(
        device: &Arc<Device>,
        name: &str,
        set: Option<&SetLayout>,
        push: Option<(vk::ShaderStageFlags, usize)>,
    ) -> Result<Arc<PipelineLayout>> {
        let sets: Vec<_> = set.map(SetLayout::handle).into_iter().collect();
        let (push_stages, bytes) = push.unwrap_or_default();
        let bytes = bytes as u32;
        if bytes > MAX_PUSH_BYTES {
            return Err(GpuError::Limit {
                what: format!("the push constants of {name}"),
                needed: u64::from(bytes),
                limit: "maxPushConstantsSize",
                allowed: u64::from(MAX_PUSH_BYTES),
            });
        }
        let ranges = [vk::PushConstantRange { stage_flags: push_stages, offset: 0, size: bytes }];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&sets)
            .push_constant_ranges(&ranges[..usize::from(bytes > 0)]);
        // SAFETY: the info is complete and its handles live.
        let handle = unsafe { device.raw().create_pipeline_layout(&info, None) }
            .during("create a pipeline layout")?;
        device.name(handle, name);
        Ok(Arc::new(PipelineLayout { handle, push_stages, device: device.clone() }))
    }

    pub fn handle(&self) -> vk::PipelineLayout {
        self.handle
    }

    pub fn push_stages(&self) -> vk::ShaderStageFlags {
        self.push_stages
    }
}

impl Drop for PipelineLayout {
    fn drop(&mut self) {
        self.device.retire(Retired::PipelineLayout(self.handle));
    }
}

/// The blending of drawn colours with the target's.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Blend {
    /// They replace it.
    #[default]
    Replace,
    /// By alpha, without premultiplication.
    Alpha,
    /// No colour is written, only depth.
    DepthOnly,
}

/// The use of the depth buffer (reversed: nearer is greater).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Depth {
    pub format: vk::Format,
    pub compare: vk::CompareOp,
    pub write: bool,
}

impl Depth {
    /// Nearer fragments win and write their depth. Clear to 0.
    pub const NEARER: Depth = Depth::of(vk::CompareOp::GREATER, true);
    /// Nearer fragments win, and depth is not written: for transparent surfaces.
    pub const TEST_ONLY: Depth = Depth::of(vk::CompareOp::GREATER_OR_EQUAL, false);
    /// All fragments pass, and depth is not written: for backgrounds.
    pub const KEEP: Depth = Depth::of(vk::CompareOp::ALWAYS, false);
    /// All fragments pass and write their depth.
    pub const OVERWRITE: Depth = Depth::of(vk::CompareOp::ALWAYS, true);

    const fn of(compare: vk::CompareOp, write: bool) -> Depth {
        Depth { format: vk::Format::D32_SFLOAT, compare, write }
    }
}

/// One input of the vertex shader, from the one vertex buffer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Attribute {
    pub location: u32,
    pub format: vk::Format,
    /// Offset in the vertex, in bytes.
    pub offset: usize,
}

/// The vertex buffer: the stride in bytes, and its attributes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Vertices<'a> {
    pub stride: usize,
    pub per_instance: bool,
    pub attributes: &'a [Attribute],
}

/// The state of a graphics pipeline. Viewport and scissor are dynamic.
#[derive(Clone, Copy)]
pub struct Graphics<'a> {
    pub name: &'a str,
    /// SPIR-V with the entry point `main`, from [`crate::gpu::shaders`].
    pub vertex: &'a [u32],
    pub fragment: &'a [u32],
    pub layout: &'a Arc<PipelineLayout>,
    pub vertices: Option<Vertices<'a>>,
    pub topology: vk::PrimitiveTopology,
    pub cull: vk::CullModeFlags,
    pub colour: Option<(vk::Format, Blend)>,
    pub depth: Option<Depth>,
    /// The specialization constants of the shaders, from number 0 on.
    pub constants: &'a [u32],
}

impl<'a> Graphics<'a> {
    /// Returns a pass that overwrites all pixels of a target of `format`; draw 3 vertices.
    pub fn screen(
        name: &'a str,
        fragment: &'a [u32],
        layout: &'a Arc<PipelineLayout>,
        format: vk::Format,
        depth: Option<Depth>,
    ) -> Graphics<'a> {
        Graphics {
            name,
            vertex: super::shaders::SCREEN_VERT,
            fragment,
            layout,
            vertices: None,
            topology: vk::PrimitiveTopology::TRIANGLE_LIST,
            cull: vk::CullModeFlags::NONE,
            colour: Some((format, Blend::Replace)),
            depth,
            constants: &[],
        }
    }
}

/// A graphics or compute pipeline; keeps its layout.
pub struct Pipeline {
    handle: vk::Pipeline,
    bind_point: vk::PipelineBindPoint,
    layout: Arc<PipelineLayout>,
    device: Arc<Device>,
}

impl Pipeline {
    pub fn graphics(device: &Arc<Device>, of: &Graphics<'_>) -> Result<Pipeline> {
        let modules = [Module::new(device, of.vertex)?, Module::new(device, of.fragment)?];
        let entries = constant_entries(of.constants);
        let constants = constants_info(of.constants, &entries);
        let stages = [
            modules[0].stage(vk::ShaderStageFlags::VERTEX).specialization_info(&constants),
            modules[1].stage(vk::ShaderStageFlags::FRAGMENT).specialization_info(&constants),
        ];
        let (bindings, attributes) = vertex_input(of.vertices);
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(of.topology);
        let viewport =
            vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(of.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let mut depth_state = vk::PipelineDepthStencilStateCreateInfo::default();
        let mut formats = vk::PipelineRenderingCreateInfo::default();
        if let Some(depth) = of.depth {
            depth_state = depth_state
                .depth_test_enable(true)
                .depth_write_enable(depth.write)
                .depth_compare_op(depth.compare);
            formats = formats.depth_attachment_format(depth.format);
        }
        let colour_formats: Vec<_> = of.colour.iter().map(|c| c.0).collect();
        let blends: Vec<_> = of.colour.iter().map(|c| blend_state(c.1)).collect();
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        formats = formats.color_attachment_formats(&colour_formats);
        let dynamic_states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic_states);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth_state)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(of.layout.handle())
            .push_next(&mut formats);
        let begun = Instant::now();
        // SAFETY: the info is complete and all it points to lives.
        let made = unsafe {
            device.raw().create_graphics_pipelines(device.pipeline_cache(), &[info], None)
        };
        device.pipeline_created(of.name, begun.elapsed());
        Pipeline::wrap(device, of.name, made, vk::PipelineBindPoint::GRAPHICS, of.layout)
    }

    /// Creates a compute pipeline. `shader`: SPIR-V with the entry point `main`. `constants`: its specialization
    /// constants, from number 0 on.
    pub fn compute(
        device: &Arc<Device>,
        name: &str,
        shader: &[u32],
        layout: &Arc<PipelineLayout>,
        constants: &[u32],
    ) -> Result<Pipeline> {
        let module = Module::new(device, shader)?;
        let entries = constant_entries(constants);
        let constants = constants_info(constants, &entries);
        let stage = module.stage(vk::ShaderStageFlags::COMPUTE);
        let info = vk::ComputePipelineCreateInfo::default()
            .stage(stage.specialization_info(&constants))
            .layout(layout.handle());
        let begun = Instant::now();
        // SAFETY: the info is complete and all it points to lives.
        let made = unsafe {
            device.raw().create_compute_pipelines(device.pipeline_cache(), &[info], None)
        };
        device.pipeline_created(name, begun.elapsed());
        Pipeline::wrap(device, name, made, vk::PipelineBindPoint::COMPUTE, layout)
    }

    fn wrap(
        device: &Arc<Device>,
        name: &str,
        made: std::result::Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>,
        bind_point: vk::PipelineBindPoint,
        layout: &Arc<PipelineLayout>,
    ) -> Result<Pipeline> {
        let handle = made.map_err(|(_, result)| result).during("create a pipeline")?[0];
        device.name(handle, name);
        Ok(Pipeline { handle, bind_point, layout: layout.clone(), device: device.clone() })
    }

    pub fn handle(&self) -> vk::Pipeline {
        self.handle
    }

    pub fn bind_point(&self) -> vk::PipelineBindPoint {
        self.bind_point
    }

    pub fn layout(&self) -> &Arc<PipelineLayout> {
        &self.layout
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.device.retire(Retired::Pipeline(self.handle));
    }
}

/// Returns the map entries of specialization constants from number 0 on.
fn constant_entries(constants: &[u32]) -> Vec<vk::SpecializationMapEntry> {
    let size = size_of::<u32>();
    let entry = |number: usize| vk::SpecializationMapEntry {
        constant_id: number as u32,
        offset: (number * size) as u32,
        size,
    };
    (0..constants.len()).map(entry).collect()
}

fn constants_info<'a>(
    constants: &'a [u32],
    entries: &'a [vk::SpecializationMapEntry],
) -> vk::SpecializationInfo<'a> {
    vk::SpecializationInfo::default().map_entries(entries).data(bytemuck::cast_slice(constants))
}

/// A shader module, needed only to create a pipeline.
struct Module<'a> {
    handle: vk::ShaderModule,
    device: &'a Device,
}

impl<'a> Module<'a> {
    fn new(device: &'a Device, words: &[u32]) -> Result<Module<'a>> {
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words are SPIR-V that naga has validated.
        let handle = unsafe { device.raw().create_shader_module(&info, None) }
            .during("create a shader module")?;
        Ok(Module { handle, device })
    }

    fn stage(&self, stage: vk::ShaderStageFlags) -> vk::PipelineShaderStageCreateInfo<'_> {
        vk::PipelineShaderStageCreateInfo::default().stage(stage).module(self.handle).name(c"main")
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: pipelines do not need their modules once made.
        unsafe { self.device.raw().destroy_shader_module(self.handle, None) };
    }
}

type VertexInput =
    (Vec<vk::VertexInputBindingDescription>, Vec<vk::VertexInputAttributeDescription>);

fn vertex_input(vertices: Option<Vertices<'_>>) -> VertexInput {
    let Some(vertices) = vertices else { return Default::default() };
    let input_rate = if vertices.per_instance {
        vk::VertexInputRate::INSTANCE
    } else {
        vk::VertexInputRate::VERTEX
    };
    let stride = vertices.stride as u32;
    let bindings = vec![vk::VertexInputBindingDescription { binding: 0, stride, input_rate }];
    let attributes = vertices
        .attributes
        .iter()
        .map(|a| vk::VertexInputAttributeDescription {
            location: a.location,
            binding: 0,
            format: a.format,
            offset: a.offset as u32,
        })
        .collect();
    (bindings, attributes)
}

fn blend_state(blend: Blend) -> vk::PipelineColorBlendAttachmentState {
    let state = vk::PipelineColorBlendAttachmentState::default()
        .color_write_mask(vk::ColorComponentFlags::RGBA);
    match blend {
        Blend::Replace => state,
        Blend::Alpha => state
            .blend_enable(true)
            .src_color_blend_factor(vk::BlendFactor::SRC_ALPHA)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA),
        Blend::DepthOnly => state.color_write_mask(vk::ColorComponentFlags::empty()),
    }
}
