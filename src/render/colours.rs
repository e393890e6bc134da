//! Owns the device's copy of a sculpture's colours: one buffer with a number for each brick (0: not
//! painted, else the page's, counted from 1), then the pages, packed as the sculpture has them.
//!
//! The first time all of it is uploaded, afterwards only the pages of bricks that changed. Where
//! the colours are more than the device can address or has room for, making or updating the copy
//! fails with the name of the limit, and the sculpture can still be drawn in its base colour.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{
    Buffer, Device, GpuError, MemoryLocation, Recorder, Result, Staging, Use, run_once,
};
use crate::sculpture::Material;

/// Bytes of a whole upload that are in flight at once.
const CHUNK_BYTES: usize = 8 << 20;

/// Bytes of changed pages that a frame has room for without growing.
const STAGING_BYTES: u64 = 1 << 20;

/// The copy.
pub struct Colours {
    buffer: Buffer,
    /// The page of each brick, as in the buffer.
    table: Vec<u32>,
    /// Pages given back.
    free: Vec<u32>,
    /// Pages ever given out, and those that there is room for.
    used: u32,
    room: u32,
    bytes_per_voxel: u32,
    staging: Staging,
    /// Kept for its memory.
    copies: Vec<vk::BufferCopy>,
    device: Arc<Device>,
}

impl Colours {
    /// Uploads all colours of `bricks` bricks and waits for it.
    pub fn new(device: &Arc<Device>, material: &Material, bricks: usize) -> Result<Colours> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let room = room_for(material.page_count());
        let mut made = Colours {
            buffer: make_buffer(device, bricks, material, room)?,
            table: vec![0; bricks],
            free: Vec::new(),
            used: 0,
            room,
            bytes_per_voxel: material.depth().bytes() as u32,
            staging: Staging::new(device, "changed colours", usage, STAGING_BYTES)?,
            copies: Vec::new(),
            device: device.clone(),
        };
        made.upload_whole(material)?;
        Ok(made)
    }

    /// Brings the copy up to date with `changed` bricks (as from
    /// [`crate::document::Document::take_dirty`]; `None` means all, perhaps of another sculpture
    /// of `bricks` bricks). Recorded in `recorder`, for frame `slot`, once a frame. On an error
    /// the copy is not current.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        material: &Material,
        bricks: usize,
        changed: Option<&[u32]>,
    ) -> Result<()> {
        let fits = bricks == self.table.len()
            && material.depth().bytes() as u32 == self.bytes_per_voxel
            && material.page_count() <= self.room as usize;
        match changed {
            Some(changed) if fits => self.upload_bricks(recorder, slot, material, changed),
            _ => {
                *self = Colours::new(&self.device, material, bricks)?;
                Ok(())
            }
        }
    }

    /// Bytes of a voxel's colour; 0 where the sculpture has but one.
    pub fn bytes_per_voxel(&self) -> u32 {
        self.bytes_per_voxel
    }

    pub(super) fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    fn page_bytes(&self) -> usize {
        512 * self.bytes_per_voxel as usize
    }

    /// Where the page of that number begins in the buffer, in bytes.
    fn place(&self, page: u32) -> u64 {
        (self.table.len() * 4 + (page as usize - 1) * self.page_bytes()) as u64
    }

    fn upload_whole(&mut self, material: &Material) -> Result<()> {
        for (brick, page) in self.table.iter_mut().enumerate() {
            if material.page(brick).is_some() {
                self.used += 1;
                *page = self.used;
            }
        }
        let painted: Vec<u32> =
            (0..self.table.len() as u32).filter(|&b| self.table[b as usize] != 0).collect();
        let mut chunk = Buffer::new(
            &self.device,
            "all colours",
            CHUNK_BYTES as u64,
            vk::BufferUsageFlags::TRANSFER_SRC,
            MemoryLocation::CpuToGpu,
        )?;
        for (i, table) in self.table.chunks(CHUNK_BYTES / 4).enumerate() {
            chunk.write(0, table)?;
            self.copy_chunk(&chunk, (i * CHUNK_BYTES) as u64, size_of_val(table) as u64)?;
        }
        let per_chunk = CHUNK_BYTES / self.page_bytes().max(1);
        for bricks in painted.chunks(per_chunk) {
            let bytes = self.page_bytes();
            for (i, &brick) in bricks.iter().enumerate() {
                if let Some(page) = material.page(brick as usize) {
                    chunk.write((i * bytes) as u64, page)?;
                }
            }
            let first = self.place(self.table[bricks[0] as usize]);
            self.copy_chunk(&chunk, first, (bricks.len() * bytes) as u64)?;
        }
        Ok(())
    }

    fn copy_chunk(&self, chunk: &Buffer, to: u64, bytes: u64) -> Result<()> {
        let copy = vk::BufferCopy { src_offset: 0, dst_offset: to, size: bytes };
        run_once(&self.device, |recorder| {
            recorder.copy_buffer(chunk.handle(), self.buffer.handle(), &[copy]);
            recorder.buffer_barrier(Use::COPY_TARGET, Use::SHADER_READ);
            Ok(())
        })
    }

    fn upload_bricks(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        material: &Material,
        changed: &[u32],
    ) -> Result<()> {
        self.staging.begin(slot);
        if self.bytes_per_voxel == 0 || changed.is_empty() {
            return Ok(());
        }
        recorder.buffer_barrier(Use::SHADER_READ, Use::COPY_TARGET);
        // Pages first, so that what they leave is there for others.
        for &brick in changed {
            if material.page(brick as usize).is_none() && self.table[brick as usize] != 0 {
                self.free.push(self.table[brick as usize]);
                self.set_entry(recorder, brick, 0)?;
            }
        }
        let bytes = self.page_bytes();
        for chunk in changed.chunks(CHUNK_BYTES / bytes) {
            self.copies.clear();
            let painted = || chunk.iter().filter_map(|&b| Some((b, material.page(b as usize)?)));
            let count = painted().count();
            if count == 0 {
                continue;
            }
            let piece = self.staging.fill((count * bytes) as u64, 4, |target| {
                for (target, (_, page)) in target.chunks_exact_mut(bytes).zip(painted()) {
                    target.copy_from_slice(page);
                }
            })?;
            for (i, (brick, _)) in painted().enumerate() {
                let page = match self.table[brick as usize] {
                    0 => {
                        let page = self.new_page();
                        self.set_entry(recorder, brick, page)?;
                        page
                    }
                    page => page,
                };
                self.copies.push(vk::BufferCopy {
                    src_offset: piece.offset + (i * bytes) as u64,
                    dst_offset: self.place(page),
                    size: bytes as u64,
                });
            }
            recorder.copy_buffer(piece.buffer, self.buffer.handle(), &self.copies);
        }
        recorder.buffer_barrier(Use::COPY_TARGET, Use::SHADER_READ);
        Ok(())
    }

    /// The number of a page that no brick has. There is room, since there is for all pages.
    fn new_page(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.used += 1;
            self.used
        })
    }

    fn set_entry(&mut self, recorder: &mut Recorder, brick: u32, page: u32) -> Result<()> {
        self.table[brick as usize] = page;
        let piece = self.staging.push(&[page], 4)?;
        let copy =
            vk::BufferCopy { src_offset: piece.offset, dst_offset: 4 * u64::from(brick), size: 4 };
        recorder.copy_buffer(piece.buffer, self.buffer.handle(), &[copy]);
        Ok(())
    }
}

/// Pages to make room for where `pages` are needed now.
fn room_for(pages: usize) -> u32 {
    (pages + pages / 2 + 256) as u32
}

fn make_buffer(
    device: &Arc<Device>,
    bricks: usize,
    material: &Material,
    room: u32,
) -> Result<Buffer> {
    let bytes = (bricks * 4 + room as usize * material.page_bytes()) as u64;
    let allowed = u64::from(device.limits().max_storage_buffer_range);
    if bytes > allowed {
        return Err(GpuError::Limit {
            what: "the colours of the sculpture".to_string(),
            needed: bytes,
            limit: "maxStorageBufferRange",
            allowed,
        });
    }
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
    Buffer::new(device, "colours", bytes, usage, MemoryLocation::GpuOnly)
}
