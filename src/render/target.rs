//! Index maps on the device: drawn or uploaded, and read back to the CPU.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;
use glam::{UVec2, UVec3};

use crate::gpu::{
    Attachment, BufferRange, Device, EyeImage, Load, Readback, Recorder, ResourceUse, Result,
    Serial, TexelRows,
};
use crate::sculpture::NO_VOXEL;
use crate::surface::{IndexMap, PixelRect};
use crate::view::PixelRays;

/// The part of an eye's index map or picture to draw.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct EyeTask {
    pub eye: u32,
    pub rays: PixelRays,
    /// The pixels to draw; the others keep their contents.
    pub scissor: PixelRect,
    /// The visible rect: nothing is visible outside of it.
    pub visible: PixelRect,
}

impl EyeTask {
    /// Returns a task of all pixels, with a visible rect of the whole picture.
    pub fn whole(eye: u32, rays: PixelRays) -> EyeTask {
        let scissor = PixelRect::of_picture(rays.size);
        EyeTask { eye, rays, scissor, visible: scissor }
    }
}

/// Index maps on the device: an image of voxel indices and its depth buffer.
pub struct IndexTarget {
    index: EyeImage,
    depth: EyeImage,
    has_normals: bool,
}

/// The format of maps with a normal beside each voxel (shaders/level_march.frag.wgsl).
pub(super) const MAP_WITH_NORMALS: vk::Format = vk::Format::R32G32_UINT;

impl IndexTarget {
    /// Creates one for pictures of `size` pixels and `eyes` layers.
    pub fn new(device: &Arc<Device>, size: UVec2, eyes: u32) -> Result<IndexTarget> {
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_DST;
        IndexTarget::of(device, size, eyes, vk::Format::R32_UINT, usage)
    }

    /// Creates one for maps of the smooth surface, which the device alone makes and reads.
    pub fn with_normals(device: &Arc<Device>, size: UVec2, eyes: u32) -> Result<IndexTarget> {
        IndexTarget::of(device, size, eyes, MAP_WITH_NORMALS, vk::ImageUsageFlags::empty())
    }

    fn of(
        device: &Arc<Device>,
        size: UVec2,
        eyes: u32,
        format: vk::Format,
        usage: vk::ImageUsageFlags,
    ) -> Result<IndexTarget> {
        use vk::ImageUsageFlags as Usage;
        let usage = usage | Usage::COLOR_ATTACHMENT | Usage::SAMPLED | Usage::TRANSFER_SRC;
        let index = EyeImage::new(device, "index map", size, eyes, format, usage)?;
        let has_normals = format == MAP_WITH_NORMALS;
        let usage = Usage::DEPTH_STENCIL_ATTACHMENT;
        let format = vk::Format::D32_SFLOAT;
        let depth = EyeImage::new(device, "index map depth", size, eyes, format, usage)?;
        Ok(IndexTarget { index, depth, has_normals })
    }

    /// Returns whether maps have normals beside voxels.
    pub fn has_normals(&self) -> bool {
        self.has_normals
    }

    /// Returns the size in pixels.
    pub fn size(&self) -> UVec2 {
        self.index.size()
    }

    pub fn eyes(&self) -> u32 {
        self.index.eyes()
    }

    /// Returns the voxel indices.
    pub fn index(&self) -> &EyeImage {
        &self.index
    }

    /// Starts drawing the part of an index map described by `task`, cleared to "no voxel".
    pub fn begin(&mut self, recorder: &mut Recorder, task: &EyeTask) {
        let (eye, scissor) = (task.eye, task.scissor);
        self.index.begin_overwrite_area(
            recorder,
            eye,
            scissor.corner_and_size(),
            ResourceUse::COLOUR_TARGET,
        );
        self.depth.begin_overwrite(recorder, eye, ResourceUse::DEPTH_TARGET);
        recorder.begin_rendering_in(
            self.size().to_array(),
            scissor.corner_and_size(),
            Some(Attachment {
                view: self.index.image().layer_view(eye),
                load: Load::Integers([NO_VOXEL; 4]),
                store: true,
            }),
            Some(Attachment {
                view: self.depth.image().layer_view(eye),
                load: Load::Depth(0.0),
                store: false,
            }),
        );
    }

    /// Ends drawing.
    pub fn end(&self, recorder: &mut Recorder) {
        recorder.end_rendering();
    }

    /// Returns the voxel indices, for a pass that writes all of an eye's layer.
    pub fn index_mut(&mut self) -> &mut EyeImage {
        &mut self.index
    }

    /// Uploads rows of a map of the CPU from `piece` to the map of `eye`. The other rows are
    /// discarded.
    pub fn upload(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        piece: BufferRange,
        rows: Range<u32>,
    ) {
        self.index.upload_rows(recorder, eye, piece, rows);
    }

    /// Uploads rows likewise, but keeps the other rows.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        eye: u32,
        piece: BufferRange,
        rows: Range<u32>,
    ) {
        self.index.update_rows(recorder, eye, piece, rows);
    }

    /// Transitions the map of `eye` to be read by shaders.
    pub fn make_readable(&mut self, recorder: &mut Recorder, eye: u32) {
        self.index.transition(recorder, eye, ResourceUse::SHADER_READ);
    }
}

/// Index maps being read back, one per frame slot, for reading in the same frame or a later one. Each comes with its
/// rays.
pub struct IndexReadback {
    readback: Readback,
    tasks: [Option<EyeTask>; crate::gpu::FRAMES_IN_FLIGHT],
}

impl IndexReadback {
    /// Creates one for one eye.
    pub fn new(device: &Arc<Device>) -> IndexReadback {
        IndexReadback { readback: Readback::new(device, "index map"), tasks: Default::default() }
    }

    /// Records the readback of the rows of a map drawn by `task`.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        target: &mut IndexTarget,
        task: &EyeTask,
    ) -> Result<()> {
        target.index.transition(recorder, task.eye, ResourceUse::COPY_SOURCE);
        let image = target.index.image();
        let (layer, [width, ..]) = (image.layer(task.eye), image.size());
        let rows = TexelRows { width, rows: task.scissor.rows(), texel_bytes: 4 };
        self.readback.record_rows(recorder, slot, layer, rows)?;
        let count = self.tasks.len();
        self.tasks[slot % count] = Some(*task);
        Ok(())
    }

    /// Notes the submission that contains the copy to `slot`.
    pub fn submitted(&mut self, slot: usize, serial: Serial) {
        self.readback.submitted(slot, serial);
    }

    /// Waits for the last recording of `slot`, of a grid of `dims` voxels, and copies it to `map`, which keeps its
    /// allocation and its other rows.
    pub fn fetch(&self, slot: usize, dims: UVec3, map: &mut IndexMap) -> Result<()> {
        let bytes = self.readback.wait(slot)?;
        if let Some(task) = &self.tasks[slot % self.tasks.len()] {
            map.reset(dims, task.rays);
            let rows = task.scissor.rows_of_mut(&mut map.voxels, task.rays.size.x);
            bytemuck::cast_slice_mut::<u32, u8>(rows).copy_from_slice(bytes);
        }
        Ok(())
    }
}
