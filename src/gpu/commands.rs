//! Command buffers: recording, the ring of frames in flight, and blocking submissions.
//!
//! The methods of [`Recorder`] are Vulkan commands with plain arguments. They are memory safe in
//! Rust's sense; the validation layers, under which all GPU tests run, check barriers and layouts.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use super::device::{Device, Serial};
use super::error::{During, Result};
use super::memory::ImagePart;
use super::pipeline::{Pipeline, PipelineLayout};
use super::retire::Retired;

/// Number of frames that the CPU may be ahead of the device.
pub const FRAMES_IN_FLIGHT: usize = 2;

/// The use of an image or a buffer on one side of a barrier.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ResourceUse {
    pub stage: vk::PipelineStageFlags2,
    pub access: vk::AccessFlags2,
    pub layout: vk::ImageLayout,
}

impl ResourceUse {
    const fn new(
        stage: vk::PipelineStageFlags2,
        access: vk::AccessFlags2,
        layout: vk::ImageLayout,
    ) -> ResourceUse {
        ResourceUse { stage, access, layout }
    }

    /// Not used before, or its contents may be discarded.
    pub const NOTHING: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::NONE,
        vk::AccessFlags2::NONE,
        vk::ImageLayout::UNDEFINED,
    );
    pub const COPY_SOURCE: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::COPY,
        vk::AccessFlags2::TRANSFER_READ,
        vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
    );
    pub const COPY_TARGET: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::COPY,
        vk::AccessFlags2::TRANSFER_WRITE,
        vk::ImageLayout::TRANSFER_DST_OPTIMAL,
    );
    /// Fetched from in a fragment or compute shader.
    pub const SHADER_READ: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::FRAGMENT_SHADER.as_raw()
                | vk::PipelineStageFlags2::COMPUTE_SHADER.as_raw(),
        ),
        vk::AccessFlags2::SHADER_READ,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    );
    /// Written by a compute shader.
    pub const SHADER_WRITE: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::COMPUTE_SHADER,
        vk::AccessFlags2::SHADER_WRITE,
        vk::ImageLayout::GENERAL,
    );
    pub const COLOUR_TARGET: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
        vk::AccessFlags2::from_raw(
            vk::AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw()
                | vk::AccessFlags2::COLOR_ATTACHMENT_READ.as_raw(),
        ),
        vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
    );
    pub const DEPTH_TARGET: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw()
                | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
        ),
        vk::AccessFlags2::from_raw(
            vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()
                | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw(),
        ),
        vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL,
    );
    /// Presented. A semaphore orders it.
    pub const PRESENT: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::NONE,
        vk::AccessFlags2::NONE,
        vk::ImageLayout::PRESENT_SRC_KHR,
    );
    /// Read by the CPU after the submission.
    pub const HOST_READ: ResourceUse = ResourceUse::new(
        vk::PipelineStageFlags2::HOST,
        vk::AccessFlags2::HOST_READ,
        vk::ImageLayout::GENERAL,
    );

    /// Returns the same use with its contents discarded: no layout to keep, but still ordered after the former use,
    /// whose writes must finish before others to the same memory.
    pub const fn discarded(self) -> ResourceUse {
        ResourceUse::new(self.stage, self.access, vk::ImageLayout::UNDEFINED)
    }
}

/// The initial contents of an attachment.
#[derive(Clone, Copy, Debug)]
pub enum Load {
    Keep,
    Forget,
    Colour([f32; 4]),
    /// For integer formats.
    Integers([u32; 4]),
    Depth(f32),
}

/// A render target, in the layout of [`ResourceUse::COLOUR_TARGET`] or [`ResourceUse::DEPTH_TARGET`].
#[derive(Clone, Copy, Debug)]
pub struct Attachment {
    pub view: vk::ImageView,
    pub load: Load,
    pub store: bool,
}

/// Commands being recorded. Submit them with [`Frames::submit`].
pub struct Recorder {
    device: Arc<Device>,
    buffer: vk::CommandBuffer,
    /// Rendering has begun and not ended.
    rendering: bool,
}

impl Recorder {
    fn begin(device: &Arc<Device>, buffer: vk::CommandBuffer) -> Result<Recorder> {
        let info = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the buffer's pool was reset or just made, and is used by one thread.
        unsafe { device.raw().begin_command_buffer(buffer, &info) }.during("begin commands")?;
        device.recording_begun();
        Ok(Recorder { device: device.clone(), buffer, rendering: false })
    }

    fn submit(
        self,
        wait: &[vk::SemaphoreSubmitInfo<'_>],
        signal: &[vk::SemaphoreSubmitInfo<'_>],
    ) -> Result<Serial> {
        // SAFETY: begun by `begin`.
        unsafe { self.device.raw().end_command_buffer(self.buffer) }.during("end commands")?;
        self.device.submit(&[self.buffer], wait, signal)
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Returns the command buffer for libraries that record commands themselves.
    pub fn raw(&self) -> vk::CommandBuffer {
        self.buffer
    }

    /// Makes the use `to` of the image wait for the use `from`.
    pub fn image_barrier(&mut self, part: ImagePart, from: ResourceUse, to: ResourceUse) {
        let barrier = [vk::ImageMemoryBarrier2::default()
            .src_stage_mask(from.stage)
            .src_access_mask(from.access)
            .old_layout(from.layout)
            .dst_stage_mask(to.stage)
            .dst_access_mask(to.access)
            .new_layout(to.layout)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(part.image)
            .subresource_range(part.range())];
        let info = vk::DependencyInfo::default().image_memory_barriers(&barrier);
        // SAFETY: recording; the image lives until the submission is done.
        unsafe { self.device.raw().cmd_pipeline_barrier2(self.buffer, &info) };
    }

    /// Makes the use `to` of any buffer wait for the use `from`.
    pub fn buffer_barrier(&mut self, from: ResourceUse, to: ResourceUse) {
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(from.stage)
            .src_access_mask(from.access)
            .dst_stage_mask(to.stage)
            .dst_access_mask(to.access)];
        let info = vk::DependencyInfo::default().memory_barriers(&barrier);
        // SAFETY: recording.
        unsafe { self.device.raw().cmd_pipeline_barrier2(self.buffer, &info) };
    }

    /// Starts rendering to a picture of `size` pixels; viewport and scissor cover all of it.
    pub fn begin_rendering(
        &mut self,
        size: [u32; 2],
        colour: Option<Attachment>,
        depth: Option<Attachment>,
    ) {
        self.begin_rendering_in(size, ([0, 0], size), colour, depth);
    }

    /// Starts rendering to a rectangle, given by corner and size, of a picture of `size` pixels. Only the rectangle is
    /// cleared or discarded, and it is the scissor; later scissors must stay within it. The viewport is the whole
    /// picture.
    pub fn begin_rendering_in(
        &mut self,
        size: [u32; 2],
        (corner, extent): ([u32; 2], [u32; 2]),
        colour: Option<Attachment>,
        depth: Option<Attachment>,
    ) {
        let area = vk::Rect2D {
            offset: vk::Offset2D { x: corner[0] as i32, y: corner[1] as i32 },
            extent: vk::Extent2D { width: extent[0], height: extent[1] },
        };
        let colours = [colour
            .map(|c| attachment(c, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL))
            .unwrap_or_default()];
        let depth = depth.map(|d| attachment(d, vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL));
        let mut info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&colours[..usize::from(colour.is_some())]);
        if let Some(depth) = &depth {
            info = info.depth_attachment(depth);
        }
        let viewport = [vk::Viewport {
            x: 0.0,
            y: 0.0,
            width: size[0] as f32,
            height: size[1] as f32,
            min_depth: 0.0,
            max_depth: 1.0,
        }];
        let raw = self.device.raw();
        // SAFETY: recording; the views live until the submission is done.
        unsafe {
            raw.cmd_begin_rendering(self.buffer, &info);
            raw.cmd_set_viewport(self.buffer, 0, &viewport);
            raw.cmd_set_scissor(self.buffer, 0, &[area]);
        }
        self.rendering = true;
    }

    pub fn end_rendering(&mut self) {
        // SAFETY: recording.
        unsafe { self.device.raw().cmd_end_rendering(self.buffer) };
        self.rendering = false;
    }

    /// Ends rendering if it has begun, for callers that continue recording after a failure at an unknown point.
    pub fn end_rendering_if_begun(&mut self) {
        if self.rendering {
            self.end_rendering();
        }
    }

    /// Sets the scissor: x, y, width, height in pixels.
    pub fn set_scissor(&mut self, rect: [u32; 4]) {
        let area = vk::Rect2D {
            offset: vk::Offset2D { x: rect[0] as i32, y: rect[1] as i32 },
            extent: vk::Extent2D { width: rect[2], height: rect[3] },
        };
        // SAFETY: recording.
        unsafe { self.device.raw().cmd_set_scissor(self.buffer, 0, &[area]) };
    }

    pub fn bind_pipeline(&mut self, pipeline: &Pipeline) {
        // SAFETY: recording; the pipeline lives until the submission is done.
        unsafe {
            self.device.raw().cmd_bind_pipeline(
                self.buffer,
                pipeline.bind_point(),
                pipeline.handle(),
            );
        }
    }

    /// Binds set 0.
    pub fn bind_set(&mut self, pipeline: &Pipeline, set: vk::DescriptorSet) {
        // SAFETY: recording; set and layout live until the submission is done.
        unsafe {
            self.device.raw().cmd_bind_descriptor_sets(
                self.buffer,
                pipeline.bind_point(),
                pipeline.layout().handle(),
                0,
                &[set],
                &[],
            );
        }
    }

    /// Sets all of the layout's push constants.
    pub fn push<T: Pod>(&mut self, layout: &PipelineLayout, constants: &T) {
        let bytes = bytemuck::bytes_of(constants);
        let stages = layout.push_stages();
        let raw = self.device.raw();
        // SAFETY: recording.
        unsafe { raw.cmd_push_constants(self.buffer, layout.handle(), stages, 0, bytes) };
    }

    pub fn bind_vertices(&mut self, buffer: vk::Buffer, offset: u64) {
        let raw = self.device.raw();
        // SAFETY: recording; the buffer lives until the submission is done.
        unsafe { raw.cmd_bind_vertex_buffers(self.buffer, 0, &[buffer], &[offset]) };
    }

    pub fn draw(&mut self, vertices: u32, instances: u32) {
        // SAFETY: recording, within rendering.
        unsafe { self.device.raw().cmd_draw(self.buffer, vertices, instances, 0, 0) };
    }

    pub fn dispatch(&mut self, groups: [u32; 3]) {
        let raw = self.device.raw();
        // SAFETY: recording.
        unsafe { raw.cmd_dispatch(self.buffer, groups[0], groups[1], groups[2]) };
    }

    /// Copies from one buffer to another.
    pub fn copy_buffer(&mut self, from: vk::Buffer, to: vk::Buffer, copies: &[vk::BufferCopy]) {
        if copies.is_empty() {
            return;
        }
        // SAFETY: recording; both live until the submission is done.
        unsafe { self.device.raw().cmd_copy_buffer(self.buffer, from, to, copies) };
    }

    /// Copies from a buffer to an image in the layout of [`ResourceUse::COPY_TARGET`].
    pub fn copy_to_image(
        &mut self,
        from: vk::Buffer,
        to: ImagePart,
        copies: &[vk::BufferImageCopy],
    ) {
        let layout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        let raw = self.device.raw();
        // SAFETY: recording; both live until the submission is done.
        unsafe { raw.cmd_copy_buffer_to_image(self.buffer, from, to.image, layout, copies) };
    }

    /// Copies from an image in the layout of [`ResourceUse::COPY_SOURCE`] to a buffer.
    pub fn copy_from_image(
        &mut self,
        from: ImagePart,
        to: vk::Buffer,
        copies: &[vk::BufferImageCopy],
    ) {
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        let raw = self.device.raw();
        // SAFETY: recording; both live until the submission is done.
        unsafe { raw.cmd_copy_image_to_buffer(self.buffer, from.image, layout, to, copies) };
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.device.recording_ended();
    }
}

fn attachment(a: Attachment, layout: vk::ImageLayout) -> vk::RenderingAttachmentInfo<'static> {
    let colour = |color| vk::ClearValue { color };
    let (load, clear) = match a.load {
        Load::Keep => (vk::AttachmentLoadOp::LOAD, vk::ClearValue::default()),
        Load::Forget => (vk::AttachmentLoadOp::DONT_CARE, vk::ClearValue::default()),
        Load::Colour(float32) => {
            (vk::AttachmentLoadOp::CLEAR, colour(vk::ClearColorValue { float32 }))
        }
        Load::Integers(uint32) => {
            (vk::AttachmentLoadOp::CLEAR, colour(vk::ClearColorValue { uint32 }))
        }
        Load::Depth(depth) => {
            let depth_stencil = vk::ClearDepthStencilValue { depth, stencil: 0 };
            (vk::AttachmentLoadOp::CLEAR, vk::ClearValue { depth_stencil })
        }
    };
    vk::RenderingAttachmentInfo::default()
        .image_view(a.view)
        .image_layout(layout)
        .load_op(load)
        .store_op(if a.store {
            vk::AttachmentStoreOp::STORE
        } else {
            vk::AttachmentStoreOp::DONT_CARE
        })
        .clear_value(clear)
}

/// A command pool with one buffer. Libraries that record commands themselves allocate further ones.
pub struct Pool {
    pool: vk::CommandPool,
    buffer: vk::CommandBuffer,
    device: Arc<Device>,
}

impl Pool {
    pub fn new(device: &Arc<Device>, name: &str) -> Result<Pool> {
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::TRANSIENT)
            .queue_family_index(device.queue_family());
        // SAFETY: the info is complete.
        let pool = unsafe { device.raw().create_command_pool(&info, None) }
            .during("create a command pool")?;
        let mut made = Pool { pool, buffer: vk::CommandBuffer::null(), device: device.clone() };
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool was just made.
        let buffers = unsafe { device.raw().allocate_command_buffers(&info) }
            .during("create a command buffer")?;
        made.buffer = buffers[0];
        device.name(made.buffer, name);
        Ok(made)
    }

    pub fn handle(&self) -> vk::CommandPool {
        self.pool
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        self.device.retire(Retired::CommandPool(self.pool));
    }
}

/// The ring of frames. The commands of a frame are recorded anew once the device has finished those from
/// [`FRAMES_IN_FLIGHT`] frames before.
pub struct Frames {
    slots: Vec<(Pool, Serial)>,
    current: usize,
    device: Arc<Device>,
}

impl Frames {
    pub fn new(device: &Arc<Device>) -> Result<Frames> {
        let slots = (0..FRAMES_IN_FLIGHT)
            .map(|i| Ok((Pool::new(device, &format!("frame {i}"))?, Serial::default())))
            .collect::<Result<_>>()?;
        Ok(Frames { slots, current: 0, device: device.clone() })
    }

    /// Waits until the slot of the next frame is free, destroys retired objects, starts recording.
    pub fn begin(&mut self) -> Result<Recorder> {
        self.current = (self.current + 1) % FRAMES_IN_FLIGHT;
        let (pool, serial) = &self.slots[self.current];
        self.device.wait(*serial)?;
        self.device.collect()?;
        let flags = vk::CommandPoolResetFlags::empty();
        // SAFETY: the device is done with the pool's commands.
        unsafe { self.device.raw().reset_command_pool(pool.pool, flags) }
            .during("reset a command pool")?;
        Recorder::begin(&self.device, pool.buffer)
    }

    /// Returns the slot of the current frame, 0..[`FRAMES_IN_FLIGHT`]. Other resources with one copy per slot may also
    /// be written.
    pub fn slot(&self) -> usize {
        self.current
    }

    /// Submits the current frame.
    pub fn submit(
        &mut self,
        recorder: Recorder,
        wait: &[vk::SemaphoreSubmitInfo<'_>],
        signal: &[vk::SemaphoreSubmitInfo<'_>],
    ) -> Result<Serial> {
        let serial = recorder.submit(wait, signal)?;
        self.slots[self.current].1 = serial;
        Ok(serial)
    }
}

/// Records, submits and waits: for loading and for tests, not for frames.
pub fn run_once<T>(
    device: &Arc<Device>,
    record: impl FnOnce(&mut Recorder) -> Result<T>,
) -> Result<T> {
    let pool = Pool::new(device, "once")?;
    let mut recorder = Recorder::begin(device, pool.buffer)?;
    let result = record(&mut recorder)?;
    let serial = recorder.submit(&[], &[])?;
    device.wait(serial)?;
    drop(pool);
    device.collect()?;
    Ok(result)
}
