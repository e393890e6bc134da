//! Readback: one mapped buffer per frame in flight, to read a picture at once or a frame later.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;

use super::commands::{FRAMES_IN_FLIGHT, Recorder, ResourceUse};
use super::device::{Device, Serial};
use super::error::{GpuError, Result};
use super::memory::{Buffer, ImagePart, MemoryLocation};

/// Pictures being copied to the CPU, one per slot.
pub struct Readback {
    name: String,
    slots: Vec<ReadbackSlot>,
    device: Arc<Device>,
}

/// Whole rows of a 2D layer, and the size of a texel.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TexelRows {
    /// The texels of a row.
    pub width: u32,
    pub rows: Range<u32>,
    pub texel_bytes: u64,
}

#[derive(Default)]
struct ReadbackSlot {
    buffer: Option<Buffer>,
    /// Size of the picture recorded last.
    bytes: u64,
    serial: Serial,
}

impl Readback {
    /// Creates one without buffers, which are allocated when first needed.
    pub fn new(device: &Arc<Device>, name: &str) -> Readback {
        let slots = (0..FRAMES_IN_FLIGHT).map(|_| ReadbackSlot::default()).collect();
        Readback { name: name.to_string(), slots, device: device.clone() }
    }

    /// Records the copy of one layer, `size` texels of `texel_bytes`, in the layout of
    /// [`ResourceUse::COPY_SOURCE`], to `slot`.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        part: ImagePart,
        size: [u32; 3],
        texel_bytes: u64,
    ) -> Result<()> {
        self.record_box(recorder, slot, part, ([0; 3], size), texel_bytes)
    }

    /// Records the copy of rows of a 2D layer.
    pub fn record_rows(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        part: ImagePart,
        texels: TexelRows,
    ) -> Result<()> {
        let TexelRows { width, rows, texel_bytes } = texels;
        let corner = [0, rows.start as i32, 0];
        let size = [width, rows.len() as u32, 1];
        self.record_box(recorder, slot, part, (corner, size), texel_bytes)
    }

    fn record_box(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        part: ImagePart,
        ([x, y, z], size): ([i32; 3], [u32; 3]),
        texel_bytes: u64,
    ) -> Result<()> {
        let bytes = size.iter().map(|&n| u64::from(n)).product::<u64>() * texel_bytes;
        let count = self.slots.len();
        let slot = &mut self.slots[slot % count];
        if slot.buffer.as_ref().is_none_or(|b| b.bytes() < bytes) {
            slot.buffer = Some(Buffer::new(
                &self.device,
                &self.name,
                bytes,
                vk::BufferUsageFlags::TRANSFER_DST,
                MemoryLocation::GpuToCpu,
            )?);
        }
        slot.bytes = bytes;
        let Some(buffer) = &slot.buffer else { return Ok(()) };
        let copy = vk::BufferImageCopy::default()
            .image_subresource(part.copy_layers())
            .image_offset(vk::Offset3D { x, y, z })
            .image_extent(vk::Extent3D { width: size[0], height: size[1], depth: size[2] });
        recorder.copy_from_image(part, buffer.handle(), &[copy]);
        recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::HOST_READ);
        Ok(())
    }

    /// Notes the submission that contains the copy to `slot`.
    pub fn submitted(&mut self, slot: usize, serial: Serial) {
        let count = self.slots.len();
        self.slots[slot % count].serial = serial;
    }

    /// Waits for the copy to `slot` and returns its bytes, row by row.
    pub fn wait(&self, slot: usize) -> Result<&[u8]> {
        let slot = &self.slots[slot % self.slots.len()];
        self.device.wait(slot.serial)?;
        match &slot.buffer {
            Some(buffer) => Ok(&buffer.mapped()[..slot.bytes as usize]),
            None => Err(GpuError::Host(format!("nothing was read back for {}", self.name))),
        }
    }
}

/// Reads one layer of an image and waits. `from`: its present use, which is restored.
pub fn read_image_once(
    device: &Arc<Device>,
    part: ImagePart,
    size: [u32; 3],
    texel_bytes: u64,
    from: ResourceUse,
) -> Result<Vec<u8>> {
    let mut readback = Readback::new(device, "read once");
    super::commands::run_once(device, |recorder| {
        recorder.image_barrier(part, from, ResourceUse::COPY_SOURCE);
        readback.record(recorder, 0, part, size, texel_bytes)?;
        recorder.image_barrier(part, ResourceUse::COPY_SOURCE, from);
        Ok(())
    })?;
    readback.wait(0).map(<[u8]>::to_vec)
}
