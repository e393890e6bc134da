//! Upload: a persistently mapped block per frame in flight, filled from its beginning each frame. A
//! steady frame allocates nothing.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;

use super::commands::FRAMES_IN_FLIGHT;
use super::device::Device;
use super::error::{GpuError, Result};
use super::memory::{Buffer, BufferRange, MemoryLocation};

/// Blocks that the CPU writes and the device reads, one per frame slot.
pub struct Staging {
    name: String,
    usage: vk::BufferUsageFlags,
    blocks: Vec<Buffer>,
    slot: usize,
    used: u64,
    device: Arc<Device>,
}

impl Staging {
    /// Creates the blocks. `bytes`: initial size of each block, which grows if a frame needs more.
    pub fn new(
        device: &Arc<Device>,
        name: &str,
        usage: vk::BufferUsageFlags,
        bytes: u64,
    ) -> Result<Staging> {
        let blocks = (0..FRAMES_IN_FLIGHT)
            .map(|_| Buffer::new(device, name, bytes, usage, MemoryLocation::CpuToGpu))
            .collect::<Result<_>>()?;
        let name = name.to_string();
        Ok(Staging { name, usage, blocks, slot: 0, used: 0, device: device.clone() })
    }

    /// Starts filling the block of `slot` ([`crate::gpu::Frames::slot`]) from its beginning.
    pub fn begin(&mut self, slot: usize) {
        self.slot = slot % FRAMES_IN_FLIGHT;
        self.used = 0;
    }

    /// Copies `data` to the block, at a multiple of `align` bytes (a power of two).
    pub fn push<T: Pod>(&mut self, data: &[T], align: u64) -> Result<BufferRange> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        self.fill(bytes.len() as u64, align, |target| target.copy_from_slice(bytes))
    }

    /// Lets `write` fill `bytes` of the block, at a multiple of `align` bytes (a power of two).
    pub fn fill(
        &mut self,
        bytes: u64,
        align: u64,
        write: impl FnOnce(&mut [u8]),
    ) -> Result<BufferRange> {
        let mut offset = self.used.next_multiple_of(align);
        if offset + bytes > self.blocks[self.slot].bytes() {
            // Data pushed before stay in the old block, which retires after this frame.
            let size = (2 * self.blocks[self.slot].bytes()).max(bytes.next_power_of_two());
            let location = MemoryLocation::CpuToGpu;
            self.blocks[self.slot] =
                Buffer::new(&self.device, &self.name, size, self.usage, location)?;
            offset = 0;
        }
        let block = &mut self.blocks[self.slot];
        let buffer = block.handle();
        let range = offset as usize..(offset + bytes) as usize;
        let target = block
            .mapped_mut()
            .get_mut(range)
            .ok_or_else(|| GpuError::Host(format!("{} is not mapped", self.name)))?;
        write(target);
        self.used = offset + bytes;
        Ok(BufferRange { buffer, offset, bytes })
    }
}
