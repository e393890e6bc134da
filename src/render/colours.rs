//! The device's copy of a sculpture's colours: one buffer with a number for each brick (0: not painted, otherwise that
//! of its page, counted from 1), then the pages, packed as in the sculpture; or those of the mask's tints
//! ([`ShownColours`]).
//!
//! It is uploaded as a whole at first, and afterwards by pages of changed bricks; when there are more pages than
//! capacity, the buffer is copied to a larger one on the device. Where the colours exceed a limit of the device, making
//! or updating the copy fails with the name of the limit, and the sculpture can still be drawn in its base colour.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{
    Buffer, Device, GpuError, MemoryLocation, Recorder, ResourceUse, Result, Staging, run_once,
};
use crate::sculpture::brick::BRICK_VOXELS;
use crate::sculpture::{ColourDepth, Rgb};
use crate::shade::ShownColours;

/// Most bytes of pages in flight at once. Larger uploads are done in pieces, waiting for each.
const CHUNK_BYTES: usize = 8 << 20;

/// Initial capacity of a frame for changed pages, in bytes.
const STAGING_BYTES: u64 = 1 << 20;

/// Largest gap between changed entries of the table that one copy bridges.
const GAP_ENTRIES: u32 = 256;

/// The values on which the pages of all bricks depend.
#[derive(Clone, Copy, PartialEq, Eq)]
struct PageInputs {
    depth: ColourDepth,
    base: Rgb,
    instead: Option<Rgb>,
    shows_mask: bool,
}

impl PageInputs {
    fn of(shown: &ShownColours) -> PageInputs {
        let (depth, base) = (shown.depth(), shown.base());
        PageInputs { depth, base, instead: shown.instead, shows_mask: shown.mask.is_some() }
    }
}

/// The copy.
pub struct DeviceColours {
    buffer: Buffer,
    /// The page of each brick, as in the buffer.
    table: Vec<u32>,
    /// Free pages.
    free: Vec<u32>,
    /// The number of pages ever allocated, and the capacity.
    used: u32,
    room: u32,
    kind: PageInputs,
    staging: Staging,
    /// Reused allocations: bricks whose pages may have changed, bricks whose pages to upload, bricks whose entries to
    /// upload, copies.
    affected: Vec<u32>,
    painted: Vec<u32>,
    entries: Vec<u32>,
    copies: Vec<vk::BufferCopy>,
    device: Arc<Device>,
}

impl DeviceColours {
    /// Uploads all colours and waits for it.
    pub fn new(device: &Arc<Device>, shown: &ShownColours) -> Result<DeviceColours> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let (kind, bricks) = (PageInputs::of(shown), shown.grid.brick_count());
        let page_bytes = BRICK_VOXELS as usize * kind.depth.bytes();
        let (buffer, room) = make_buffer(device, bricks, shown.page_count(), page_bytes)?;
        let mut made = DeviceColours {
            buffer,
            table: vec![0; bricks],
            free: Vec::new(),
            used: 0,
            room,
            kind,
            staging: Staging::new(device, "changed colours", usage, STAGING_BYTES)?,
            affected: Vec::new(),
            painted: Vec::new(),
            entries: Vec::new(),
            copies: Vec::new(),
            device: device.clone(),
        };
        made.upload_whole(shown)?;
        Ok(made)
    }

    /// Updates the copy with `changed` bricks (as from [`crate::document::Document::drain_changes`];
    /// `None` means all, perhaps of another sculpture). Recorded in `recorder`, for frame `slot`, once per frame. After an error the copy is out of date.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        shown: &ShownColours,
        changed: Option<&[u32]>,
    ) -> Result<()> {
        let fits =
            shown.grid.brick_count() == self.table.len() && PageInputs::of(shown) == self.kind;
        match changed {
            Some(changed) if fits => self.upload_bricks(recorder, slot, shown, changed),
            _ => {
                *self = DeviceColours::new(&self.device, shown)?;
                Ok(())
            }
        }
    }

    /// Returns the bytes of a voxel's colour; 0 if the sculpture has a single colour.
    pub fn bytes_per_voxel(&self) -> u32 {
        self.kind.depth.bytes() as u32
    }

    /// Returns whether protected voxels are tinted. If so, looks use these colours, too.
    pub fn shows_mask(&self) -> bool {
        self.kind.shows_mask
    }

    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    fn page_bytes(&self) -> usize {
        BRICK_VOXELS as usize * self.kind.depth.bytes()
    }

    /// Returns the offset of a page in the buffer, in bytes.
    fn place(&self, page: u32) -> u64 {
        (self.table.len() * 4 + (page as usize - 1) * self.page_bytes()) as u64
    }

    fn upload_whole(&mut self, shown: &ShownColours) -> Result<()> {
        let bricks: Vec<u32> = (0..self.table.len() as u32).collect();
        self.assign_pages(shown, &bricks);
        let mut chunk = self.chunk()?;
        for (i, table) in self.table.chunks(CHUNK_BYTES / 4).enumerate() {
            chunk.write(0, table)?;
            let (offset, size) = ((i * CHUNK_BYTES) as u64, size_of_val(table) as u64);
            let copy = vk::BufferCopy { src_offset: 0, dst_offset: offset, size };
            self.copy_at_once(&chunk, &[copy])?;
        }
        self.upload_pages_at_once(shown, &mut chunk)
    }

    /// Returns a staging buffer for a blocking upload.
    fn chunk(&self) -> Result<Buffer> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let location = MemoryLocation::CpuToGpu;
        Buffer::new(&self.device, "many colours", CHUNK_BYTES as u64, usage, location)
    }

    fn copy_at_once(&self, chunk: &Buffer, copies: &[vk::BufferCopy]) -> Result<()> {
        run_once(&self.device, |recorder| {
            recorder.buffer_barrier(ResourceUse::SHADER_READ, ResourceUse::COPY_TARGET);
            recorder.copy_buffer(chunk.handle(), self.buffer.handle(), copies);
            recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
            Ok(())
        })
    }

    /// Uploads the pages of the painted bricks and waits for it.
    fn upload_pages_at_once(&mut self, shown: &ShownColours, chunk: &mut Buffer) -> Result<()> {
        let bytes = self.page_bytes();
        let painted = std::mem::take(&mut self.painted);
        let mut page = vec![0u8; bytes];
        for bricks in painted.chunks(CHUNK_BYTES / bytes.max(1)) {
            for (i, &brick) in bricks.iter().enumerate() {
                shown.write_page(brick as usize, &mut page);
                chunk.write((i * bytes) as u64, &page)?;
            }
            self.find_page_copies(bricks, 0);
            self.copy_at_once(chunk, &self.copies)?;
        }
        self.painted = painted;
        Ok(())
    }

    /// Lists copies of the pages of `bricks`, which follow each other from `offset` on.
    fn find_page_copies(&mut self, bricks: &[u32], offset: u64) {
        let bytes = self.page_bytes() as u64;
        self.copies.clear();
        for (i, &brick) in bricks.iter().enumerate() {
            let dst_offset = self.place(self.table[brick as usize]);
            match self.copies.last_mut() {
                Some(last) if last.dst_offset + last.size == dst_offset => last.size += bytes,
                _ => {
                    let src_offset = offset + i as u64 * bytes;
                    self.copies.push(vk::BufferCopy { src_offset, dst_offset, size: bytes });
                }
            }
        }
    }

    /// Allocates pages for painted bricks and frees those of others. Collects the painted bricks,
    /// in the order of their pages, and the bricks whose table entries change, in their own order.
    fn assign_pages(&mut self, shown: &ShownColours, changed: &[u32]) {
        self.painted.clear();
        self.entries.clear();
        if self.kind.depth == ColourDepth::None {
            return;
        }
        // Freed pages are available to others.
        for &brick in changed {
            if shown.has_page(brick as usize) {
                self.painted.push(brick);
                continue;
            }
            let page = std::mem::take(&mut self.table[brick as usize]);
            if page != 0 {
                self.free.push(page);
                self.entries.push(brick);
            }
        }
        self.painted.sort_unstable();
        self.painted.dedup();
        for &brick in &self.painted {
            if self.table[brick as usize] == 0 {
                self.table[brick as usize] = self.free.pop().unwrap_or_else(|| {
                    self.used += 1;
                    self.used
                });
                self.entries.push(brick);
            }
        }
        let table = &self.table;
        self.painted.sort_unstable_by_key(|&brick| table[brick as usize]);
        self.entries.sort_unstable();
    }

    fn upload_bricks(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        shown: &ShownColours,
        changed: &[u32],
    ) -> Result<()> {
        self.staging.begin(slot);
        let mut affected = std::mem::take(&mut self.affected);
        affected.clear();
        affected.extend_from_slice(changed);
        for &brick in changed {
            shown.for_each_dependent(brick as usize, |brick| affected.push(brick as u32));
        }
        self.assign_pages(shown, &affected);
        self.affected = affected;
        if self.painted.is_empty() && self.entries.is_empty() {
            return Ok(());
        }
        let bytes = self.page_bytes();
        recorder.buffer_barrier(ResourceUse::SHADER_READ, ResourceUse::COPY_TARGET);
        if self.painted.len() * bytes <= CHUNK_BYTES {
            self.make_room(|copy| {
                copy(recorder);
                Ok(())
            })?;
            self.upload_pages(recorder, shown)?;
        } else {
            let device = self.device.clone();
            self.make_room(|copy| {
                run_once(&device, |recorder| {
                    copy(recorder);
                    Ok(())
                })
            })?;
            let mut chunk = self.chunk()?;
            self.upload_pages_at_once(shown, &mut chunk)?;
        }
        self.upload_entries(recorder)?;
        recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
        Ok(())
    }

    /// If there are more pages than capacity, records the copy to a larger buffer with `record`.
    fn make_room(
        &mut self,
        record: impl FnOnce(&dyn Fn(&mut Recorder)) -> Result<()>,
    ) -> Result<()> {
        if self.used <= self.room {
            return Ok(());
        }
        let (larger, room) =
            make_buffer(&self.device, self.table.len(), self.used as usize, self.page_bytes())?;
        let all = vk::BufferCopy { src_offset: 0, dst_offset: 0, size: self.buffer.bytes() };
        record(&|recorder| {
            recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::COPY_SOURCE);
            recorder.copy_buffer(self.buffer.handle(), larger.handle(), &[all]);
            recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::COPY_TARGET);
        })?;
        // The device may still read the old buffer, which retires when it has finished.
        self.buffer = larger;
        self.room = room;
        Ok(())
    }

    /// Records the upload of the pages of the painted bricks.
    fn upload_pages(&mut self, recorder: &mut Recorder, shown: &ShownColours) -> Result<()> {
        let bytes = self.page_bytes();
        let painted = std::mem::take(&mut self.painted);
        let piece = self.staging.fill((painted.len() * bytes) as u64, 4, |target| {
            for (target, &brick) in target.chunks_exact_mut(bytes).zip(&painted) {
                shown.write_page(brick as usize, target);
            }
        })?;
        self.find_page_copies(&painted, piece.offset);
        recorder.copy_buffer(piece.buffer, self.buffer.handle(), &self.copies);
        self.painted = painted;
        Ok(())
    }

    /// Records the upload of the changed entries, bridging small gaps.
    fn upload_entries(&mut self, recorder: &mut Recorder) -> Result<()> {
        for near in self.entries.chunk_by(|a, b| b - a <= GAP_ENTRIES) {
            let (first, last) = (near[0] as usize, near[near.len() - 1] as usize);
            let piece = self.staging.push(&self.table[first..=last], 4)?;
            let (src_offset, size) = (piece.offset, piece.bytes);
            let copy = vk::BufferCopy { src_offset, dst_offset: 4 * first as u64, size };
            recorder.copy_buffer(piece.buffer, self.buffer.handle(), &[copy]);
        }
        Ok(())
    }
}

/// Returns a buffer for the table of `bricks` bricks and `pages` pages of `page_bytes`, and its capacity in pages, with
/// some reserve if the device can address it.
fn make_buffer(
    device: &Arc<Device>,
    bricks: usize,
    pages: usize,
    page_bytes: usize,
) -> Result<(Buffer, u32)> {
    let bytes_for = |pages: usize| (bricks * 4 + pages * page_bytes) as u64;
    let allowed = u64::from(device.limits().max_storage_buffer_range);
    if bytes_for(pages) > allowed {
        return Err(GpuError::Limit {
            what: "the colours of the sculpture".to_string(),
            needed: bytes_for(pages),
            limit: "maxStorageBufferRange",
            allowed,
        });
    }
    let left = (allowed - bytes_for(0)) as usize / page_bytes.max(1);
    let room = (pages + pages / 2 + 256).min(left);
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER
        | vk::BufferUsageFlags::TRANSFER_DST
        | vk::BufferUsageFlags::TRANSFER_SRC;
    let location = MemoryLocation::GpuOnly;
    Ok((Buffer::new(device, "colours", bytes_for(room), usage, location)?, room as u32))
}
