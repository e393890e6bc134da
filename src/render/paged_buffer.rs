//! A buffer on the device with a table of entries, one per brick, and the units of bytes to which they refer. It holds
//! the normals ([`super::Normals`]) and the levels of the smooth surface ([`super::Levels`]).
//!
//! It is uploaded as a whole at first, and afterwards by the units and entries that were written. It has room for some
//! additional units; an owner with more makes a new one. If it exceeds a limit of the device, that fails with the name
//! of the limit. Does not know the meaning of units.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{
    Buffer, Device, GpuError, MemoryLocation, Recorder, ResourceUse, Result, Staging, run_once,
};

/// Most bytes in flight at once. Larger uploads are done in pieces, waiting for each.
pub(super) const CHUNK_BYTES: usize = 8 << 20;
/// Initial capacity of a frame for writes, in bytes.
const STAGING_BYTES: u64 = 1 << 18;
/// Largest gap between changed entries of the table that one copy bridges.
const GAP_ENTRIES: u32 = 256;

/// The purpose of a buffer.
#[derive(Clone, Copy)]
pub(super) struct PagedKind {
    /// The name of the buffer, for debuggers.
    pub name: &'static str,
    /// The name of its contents, in messages.
    pub what: &'static str,
    pub unit_bytes: usize,
}

/// See the module text.
pub(super) struct PagedBuffer {
    kind: PagedKind,
    buffer: Buffer,
    /// Number of entries of the table, and of units with room.
    entries: usize,
    room: usize,
    staging: Staging,
    copies: Vec<vk::BufferCopy>,
    device: Arc<Device>,
}

impl PagedBuffer {
    /// Uploads all entries and units and waits for it.
    pub fn new(
        device: &Arc<Device>,
        kind: PagedKind,
        table: &[u32],
        units: &[u8],
    ) -> Result<PagedBuffer> {
        let (buffer, room) = make_buffer(device, kind, table.len(), units.len() / kind.unit_bytes)?;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let made = PagedBuffer {
            kind,
            buffer,
            entries: table.len(),
            room,
            staging: Staging::new(device, kind.name, usage, STAGING_BYTES)?,
            copies: Vec::new(),
            device: device.clone(),
        };
        made.upload_whole(0, bytemuck::cast_slice(table))?;
        made.upload_whole(made.offset(0), units)?;
        Ok(made)
    }

    /// Returns whether it has room for so many entries and units.
    pub fn has_room(&self, entries: usize, units: usize) -> bool {
        self.entries == entries && units <= self.room
    }

    /// Updates it: the entries of `bricks` and the `written` units, both rising, differ. Recorded in `recorder`, for
    /// frame `slot`, once per frame. After an error it is out of date.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        (table, bricks): (&[u32], &[u32]),
        (units, written): (&[u8], &[u32]),
    ) -> Result<()> {
        self.staging.begin(slot);
        if written.is_empty() && bricks.is_empty() {
            return Ok(());
        }
        recorder.buffer_barrier(ResourceUse::SHADER_READ, ResourceUse::COPY_TARGET);
        self.upload_units(recorder, units, written)?;
        for near in bricks.chunk_by(|a, b| b - a <= GAP_ENTRIES) {
            let (first, last) = (near[0] as usize, near[near.len() - 1] as usize);
            let piece = self.staging.push(&table[first..=last], 4)?;
            let (src_offset, size) = (piece.offset, piece.bytes);
            let copy = vk::BufferCopy { src_offset, dst_offset: 4 * first as u64, size };
            recorder.copy_buffer(piece.buffer, self.buffer.handle(), &[copy]);
        }
        recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
        Ok(())
    }

    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// Returns the offset of a unit in the buffer, in bytes.
    fn offset(&self, unit: usize) -> u64 {
        table_bytes(self.kind, self.entries) + (unit * self.kind.unit_bytes) as u64
    }

    fn upload_whole(&self, offset: u64, bytes: &[u8]) -> Result<()> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let location = MemoryLocation::CpuToGpu;
        let size = bytes.len().clamp(16, CHUNK_BYTES) as u64;
        let mut chunk = Buffer::new(&self.device, self.kind.name, size, usage, location)?;
        for (i, part) in bytes.chunks(CHUNK_BYTES).enumerate() {
            chunk.write(0, part)?;
            let dst_offset = offset + (i * CHUNK_BYTES) as u64;
            let copy = vk::BufferCopy { src_offset: 0, dst_offset, size: part.len() as u64 };
            run_once(&self.device, |recorder| {
                recorder.buffer_barrier(ResourceUse::SHADER_READ, ResourceUse::COPY_TARGET);
                recorder.copy_buffer(chunk.handle(), self.buffer.handle(), &[copy]);
                recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
                Ok(())
            })?;
        }
        Ok(())
    }

    fn upload_units(
        &mut self,
        recorder: &mut Recorder,
        units: &[u8],
        written: &[u32],
    ) -> Result<()> {
        if written.is_empty() {
            return Ok(());
        }
        let unit_bytes = self.kind.unit_bytes;
        let piece = self.staging.fill((written.len() * unit_bytes) as u64, 4, |target| {
            for (target, &unit) in target.chunks_exact_mut(unit_bytes).zip(written) {
                target.copy_from_slice(&units[unit as usize * unit_bytes..][..unit_bytes]);
            }
        })?;
        self.copies.clear();
        for (i, &unit) in written.iter().enumerate() {
            let dst_offset = self.offset(unit as usize);
            let size = unit_bytes as u64;
            match self.copies.last_mut() {
                Some(last) if last.dst_offset + last.size == dst_offset => last.size += size,
                _ => {
                    let src_offset = piece.offset + i as u64 * size;
                    self.copies.push(vk::BufferCopy { src_offset, dst_offset, size });
                }
            }
        }
        recorder.copy_buffer(piece.buffer, self.buffer.handle(), &self.copies);
        Ok(())
    }
}

/// Returns the bytes of a table, padded so that units begin at a multiple of their size.
fn table_bytes(kind: PagedKind, entries: usize) -> u64 {
    (entries * 4).next_multiple_of(kind.unit_bytes) as u64
}

/// Returns a buffer for a table and `units`, with some reserve if the device can address it, and its capacity in units.
fn make_buffer(
    device: &Arc<Device>,
    kind: PagedKind,
    entries: usize,
    units: usize,
) -> Result<(Buffer, usize)> {
    let bytes_for = |units: usize| table_bytes(kind, entries) + (units * kind.unit_bytes) as u64;
    let allowed = u64::from(device.limits().max_storage_buffer_range);
    if bytes_for(units) > allowed {
        return Err(GpuError::Limit {
            what: kind.what.to_string(),
            needed: bytes_for(units),
            limit: "maxStorageBufferRange",
            allowed,
        });
    }
    let most = (allowed - bytes_for(0)) as usize / kind.unit_bytes;
    let room = (units + units / 2 + (128 << 10) / kind.unit_bytes).min(most);
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
    let location = MemoryLocation::GpuOnly;
    Ok((Buffer::new(device, kind.name, bytes_for(room), usage, location)?, room))
}
