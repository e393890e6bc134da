//! Owns the device's copy of a grid's bits: a 3D image of `R32G32_UINT`, in which a texel is a
//! word of 4^3 voxels (low and high 32 bits) and the eight words of a brick follow each other
//! along x. A row of bricks is thus the same bytes in grid and image, and nothing is repacked.
//!
//! Beside it lies which bricks are near something ([`super::near_image`]).
//!
//! The first time all of it is uploaded, afterwards only the bricks that changed. Knows no
//! colours and no history: undo is a change like any other.

use std::sync::Arc;

use ash::vk;
use glam::UVec3;

use super::near_image::NearImage;
use crate::gpu::{
    Buffer, Device, Image, ImageInfo, MemoryLocation, Recorder, Result, Staging, Use, run_once,
};
use crate::sculpture::brick::BRICK_WORDS;
use crate::sculpture::{Brick, Grid};

/// Bytes of a whole upload that are in flight at once.
const CHUNK_BYTES: usize = 8 << 20;

/// Bytes of changed bricks that a frame has room for without growing.
const STAGING_BYTES: u64 = 1 << 20;

/// Where more than this part of the bricks changed, all are uploaded.
const WHOLE_FROM_SHARE: usize = 4;

const BRICK_BYTES: usize = size_of::<Brick>();

/// The device's copy of a grid's bits, always in the layout of [`Use::SHADER_READ`].
pub struct Volume {
    image: Image,
    near: NearImage,
    dims: UVec3,
    staging: Staging,
    /// Kept for their memory.
    changed: Vec<u32>,
    copies: Vec<vk::BufferImageCopy>,
    device: Arc<Device>,
}

impl Volume {
    /// Uploads all of `grid` and waits for it. A grid whose image would be too large for the
    /// device is refused with the name of the limit.
    pub fn new(device: &Arc<Device>, grid: &Grid) -> Result<Volume> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let mut volume = Volume {
            image: make_image(device, grid)?,
            near: NearImage::new(device, grid)?,
            dims: grid.dims(),
            staging: Staging::new(device, "changed bricks", usage, STAGING_BYTES)?,
            changed: Vec::new(),
            copies: Vec::new(),
            device: device.clone(),
        };
        volume.upload_whole(grid, Use::NOTHING)?;
        Ok(volume)
    }

    /// Brings the copy up to date with `changed` bricks (as from
    /// [`crate::document::Document::take_dirty`]; `None` means all, perhaps of another size).
    /// The copies are recorded in `recorder`, for frame `slot`; what is too much for a frame is
    /// uploaded at once. On an error the copy is not current.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        changed: Option<&[u32]>,
    ) -> Result<()> {
        if grid.dims() != self.dims {
            self.image = make_image(&self.device, grid)?;
            self.near = NearImage::new(&self.device, grid)?;
            self.dims = grid.dims();
            return self.upload_whole(grid, Use::NOTHING);
        }
        match changed {
            Some([]) => return Ok(()),
            changed => self.near.update(recorder, slot, grid, changed)?,
        }
        match changed {
            Some(bricks) if bricks.len() * WHOLE_FROM_SHARE <= grid.bricks().len() => {
                self.upload_bricks(recorder, slot, grid, bricks)
            }
            _ => self.upload_whole(grid, Use::SHADER_READ),
        }
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Which bricks are near one that holds anything ([`NearImage::image`]).
    pub fn near(&self) -> &Image {
        self.near.image()
    }

    /// Size of the grid in voxels.
    pub fn dims(&self) -> UVec3 {
        self.dims
    }

    fn upload_whole(&mut self, grid: &Grid, before: Use) -> Result<()> {
        let brick_dims = grid.brick_dims();
        let per_slab = (brick_dims.x * brick_dims.y) as usize;
        let slabs_per_chunk = (CHUNK_BYTES / (per_slab * BRICK_BYTES)).max(1);
        let chunk_bytes = slabs_per_chunk.min(brick_dims.z as usize) * per_slab * BRICK_BYTES;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let mut buffer = Buffer::new(
            &self.device,
            "all bricks",
            chunk_bytes as u64,
            usage,
            MemoryLocation::CpuToGpu,
        )?;
        let part = self.image.whole();
        let mut from = before.discarded();
        for (chunk, bricks) in grid.bricks().chunks(slabs_per_chunk * per_slab).enumerate() {
            buffer.write(0, bricks)?;
            let first = UVec3::new(0, 0, (chunk * slabs_per_chunk) as u32);
            let size = brick_dims.with_z((bricks.len() / per_slab) as u32);
            run_once(&self.device, |recorder| {
                recorder.image_barrier(part, from, Use::COPY_TARGET);
                recorder.copy_to_image(buffer.handle(), part, &[copy(0, first, size)]);
                recorder.image_barrier(part, Use::COPY_TARGET, Use::SHADER_READ);
                Ok(())
            })?;
            from = Use::SHADER_READ;
        }
        Ok(())
    }

    fn upload_bricks(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        bricks: &[u32],
    ) -> Result<()> {
        self.staging.begin(slot);
        self.changed.clear();
        self.changed.extend_from_slice(bricks);
        self.changed.sort_unstable();
        self.changed.dedup();
        let width = grid.brick_dims().x;
        let part = self.image.whole();
        recorder.image_barrier(part, Use::SHADER_READ, Use::COPY_TARGET);

        let bytes = (self.changed.len() * BRICK_BYTES) as u64;
        let (changed, copies) = (&self.changed, &mut self.copies);
        copies.clear();
        let piece = self.staging.fill(bytes, BRICK_BYTES as u64, |target| {
            let mut offset = 0;
            let same_row = |a: &u32, b: &u32| *b == a + 1 && !b.is_multiple_of(width);
            for run in changed.chunk_by(same_row) {
                let first = run[0] as usize;
                let source: &[u8] = bytemuck::cast_slice(&grid.bricks()[first..first + run.len()]);
                target[offset..offset + source.len()].copy_from_slice(source);
                let size = UVec3::new(run.len() as u32, 1, 1);
                copies.push(copy(offset, grid.brick_coords(first), size));
                offset += source.len();
            }
        })?;
        for copy in copies.iter_mut() {
            copy.buffer_offset += piece.offset;
        }
        recorder.copy_to_image(piece.buffer, part, copies);
        recorder.image_barrier(part, Use::COPY_TARGET, Use::SHADER_READ);
        Ok(())
    }
}

fn make_image(device: &Arc<Device>, grid: &Grid) -> Result<Image> {
    let bricks = grid.brick_dims();
    Image::new(
        device,
        &ImageInfo {
            name: "the bits of the sculpture",
            size: [bricks.x * BRICK_WORDS as u32, bricks.y, bricks.z],
            volume: true,
            layers: 1,
            format: vk::Format::R32G32_UINT,
            usage: vk::ImageUsageFlags::SAMPLED
                | vk::ImageUsageFlags::TRANSFER_DST
                | vk::ImageUsageFlags::TRANSFER_SRC,
        },
    )
}

/// A copy from `offset` of a buffer to a box of bricks.
fn copy(offset: usize, first: UVec3, size: UVec3) -> vk::BufferImageCopy {
    let words = BRICK_WORDS as u32;
    vk::BufferImageCopy::default()
        .buffer_offset(offset as u64)
        .image_subresource(vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            mip_level: 0,
            base_array_layer: 0,
            layer_count: 1,
        })
        .image_offset(vk::Offset3D {
            x: (first.x * words) as i32,
            y: first.y as i32,
            z: first.z as i32,
        })
        .image_extent(vk::Extent3D { width: size.x * words, height: size.y, depth: size.z })
}
