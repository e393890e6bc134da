//! The device's copy of the normals of a sculpture's surface ([`NormalField`]): one buffer with the page of
//! each brick, then all pages and blocks, as they lie in memory (shaders/normal_field.wgsl).
//!
//! It is uploaded as a whole at first, and afterwards by the pages and blocks that were written; when there are
//! more than it has room for, it is uploaded anew. Where it exceeds a limit of the device, that fails with the
//! name of the limit.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{
    Buffer, Device, GpuError, MemoryLocation, Recorder, Result, Staging, Use, run_once,
};
use crate::shade::NormalField;
use crate::shade::normal_field::Unit;

/// Most bytes in flight at once. Larger uploads are done in pieces, waiting for each.
const CHUNK_BYTES: usize = 8 << 20;
/// Initial capacity of a frame for what was written, in bytes.
const STAGING_BYTES: u64 = 1 << 18;
/// Largest gap between changed entries of the table that one copy bridges.
const GAP_ENTRIES: u32 = 256;

/// The copy.
pub struct Normals {
    buffer: Buffer,
    /// Entries of the table, and units for which there is room.
    entries: usize,
    room: usize,
    /// The [`NormalField::generation`] that the copy follows.
    generation: u64,
    staging: Staging,
    copies: Vec<vk::BufferCopy>,
    device: Arc<Device>,
}

impl Normals {
    /// Uploads all normals and waits for it.
    pub fn new(device: &Arc<Device>, field: &NormalField) -> Result<Normals> {
        let (entries, units) = (field.table().len(), field.pages().units());
        let (buffer, room) = make_buffer(device, entries, units.len())?;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let normals = Normals {
            buffer,
            entries,
            room,
            generation: field.generation(),
            staging: Staging::new(device, "changed normals", usage, STAGING_BYTES)?,
            copies: Vec::new(),
            device: device.clone(),
        };
        normals.upload_whole(0, bytemuck::cast_slice(field.table()))?;
        normals.upload_whole(normals.offset(0), bytemuck::cast_slice(units))?;
        Ok(normals)
    }

    /// Brings the copy up to date: `written` units and the entries of `bricks`, both rising, differ. Recorded in
    /// `recorder`, for frame `slot`, once per frame. After an error the copy is out of date.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        field: &NormalField,
        written: &[u32],
        bricks: &[u32],
    ) -> Result<()> {
        let units = field.pages().units();
        let is_other = self.generation != field.generation() || units.len() > self.room;
        if is_other || size_of::<Unit>() * written.len() > CHUNK_BYTES {
            *self = Normals::new(&self.device, field)?;
            return Ok(());
        }
        self.staging.begin(slot);
        if written.is_empty() && bricks.is_empty() {
            return Ok(());
        }
        recorder.buffer_barrier(Use::SHADER_READ, Use::COPY_TARGET);
        self.upload_units(recorder, units, written)?;
        for near in bricks.chunk_by(|a, b| b - a <= GAP_ENTRIES) {
            let (first, last) = (near[0] as usize, near[near.len() - 1] as usize);
            let piece = self.staging.push(&field.table()[first..=last], 4)?;
            let (src_offset, size) = (piece.offset, piece.bytes);
            let copy = vk::BufferCopy { src_offset, dst_offset: 4 * first as u64, size };
            recorder.copy_buffer(piece.buffer, self.buffer.handle(), &[copy]);
        }
        recorder.buffer_barrier(Use::COPY_TARGET, Use::SHADER_READ);
        Ok(())
    }

    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// The offset of a unit in the buffer, in bytes.
    fn offset(&self, unit: usize) -> u64 {
        table_bytes(self.entries) + (unit * size_of::<Unit>()) as u64
    }

    fn upload_whole(&self, offset: u64, bytes: &[u8]) -> Result<()> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let location = MemoryLocation::CpuToGpu;
        let size = bytes.len().clamp(16, CHUNK_BYTES) as u64;
        let mut chunk = Buffer::new(&self.device, "many normals", size, usage, location)?;
        for (i, part) in bytes.chunks(CHUNK_BYTES).enumerate() {
            chunk.write(0, part)?;
            let dst_offset = offset + (i * CHUNK_BYTES) as u64;
            let copy = vk::BufferCopy { src_offset: 0, dst_offset, size: part.len() as u64 };
            run_once(&self.device, |recorder| {
                recorder.buffer_barrier(Use::SHADER_READ, Use::COPY_TARGET);
                recorder.copy_buffer(chunk.handle(), self.buffer.handle(), &[copy]);
                recorder.buffer_barrier(Use::COPY_TARGET, Use::SHADER_READ);
                Ok(())
            })?;
        }
        Ok(())
    }

    fn upload_units(
        &mut self,
        recorder: &mut Recorder,
        units: &[Unit],
        written: &[u32],
    ) -> Result<()> {
        if written.is_empty() {
            return Ok(());
        }
        let unit_bytes = size_of::<Unit>();
        let piece = self.staging.fill((written.len() * unit_bytes) as u64, 4, |target| {
            for (target, &unit) in target.chunks_exact_mut(unit_bytes).zip(written) {
                target.copy_from_slice(bytemuck::bytes_of(&units[unit as usize]));
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

/// Bytes of a table, filled up so that units begin at a multiple of their size.
fn table_bytes(entries: usize) -> u64 {
    (entries * 4).next_multiple_of(size_of::<Unit>()) as u64
}

/// A buffer for a table and `units`, with some reserve as far as the device can address it; and its capacity in
/// units.
fn make_buffer(device: &Arc<Device>, entries: usize, units: usize) -> Result<(Buffer, usize)> {
    let bytes_for = |units: usize| table_bytes(entries) + (units * size_of::<Unit>()) as u64;
    let allowed = u64::from(device.limits().max_storage_buffer_range);
    if bytes_for(units) > allowed {
        return Err(GpuError::Limit {
            what: "the normals of the sculpture".to_string(),
            needed: bytes_for(units),
            limit: "maxStorageBufferRange",
            allowed,
        });
    }
    let most = (allowed - bytes_for(0)) as usize / size_of::<Unit>();
    let room = (units + units / 2 + 1024).min(most);
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
    let location = MemoryLocation::GpuOnly;
    Ok((Buffer::new(device, "normals", bytes_for(room), usage, location)?, room))
}
