//! The device's copy of a grid's bits: a 3D image of `R32G32_UINT`, in which a texel is a word of 4^3 voxels (low and
//! high 32 bits) and the eight words of a brick follow each other along x. A row of bricks has the same bytes in grid
//! and image, so nothing is repacked.
//!
//! The dilated occupancy ([`super::dilated_occupancy_image`]) belongs to it.
//!
//! It is uploaded as a whole at first, and afterwards by boxes with the bricks that changed ([`super::brick_boxes`]).
//! Knows no colours and no history: undo is a change like any other.

use std::sync::Arc;

use ash::vk;
use glam::UVec3;

use super::brick_boxes::{BrickBox, cover};
use super::dilated_occupancy_image::DilatedOccupancyImage;
use crate::gpu::{
    Buffer, Device, GpuError, Image, ImageInfo, MemoryLocation, Recorder, ResourceUse, Result,
    Staging, run_once,
};
use crate::sculpture::brick::BRICK_WORDS;
use crate::sculpture::{Brick, Grid, NO_VOXEL};
use crate::surface::is_linear;

/// Most bytes in flight at once. Larger uploads are done in pieces, waiting for each.
const CHUNK_BYTES: usize = 8 << 20;

/// Initial capacity of a frame for changed bricks, in bytes.
const STAGING_BYTES: u64 = 1 << 20;

/// If more than this share of the bricks changed, all are uploaded.
const WHOLE_FROM_SHARE: usize = 4;

const BRICK_BYTES: usize = size_of::<Brick>();

/// The device's copy of a grid's bits, always in the layout of [`ResourceUse::SHADER_READ`].
pub struct Volume {
    image: Image,
    dilated: DilatedOccupancyImage,
    dims: UVec3,
    staging: Staging,
    /// Reused allocations.
    changed: Vec<UVec3>,
    boxes: Vec<BrickBox>,
    copies: Vec<vk::BufferImageCopy>,
    device: Arc<Device>,
}

impl Volume {
    /// Uploads all of `grid` and waits for it. If its image exceeds a limit of the device, the
    /// error names the limit.
    pub fn new(device: &Arc<Device>, grid: &Grid) -> Result<Volume> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let mut volume = Volume {
            image: make_image(device, grid)?,
            dilated: DilatedOccupancyImage::new(device, grid)?,
            dims: grid.dims(),
            staging: Staging::new(device, "changed bricks", usage, STAGING_BYTES)?,
            changed: Vec::new(),
            boxes: Vec::new(),
            copies: Vec::new(),
            device: device.clone(),
        };
        volume.upload_whole(grid, ResourceUse::NOTHING)?;
        Ok(volume)
    }

    /// Updates the copy with `changed` bricks (as from [`crate::document::Document::drain_changes`]; `None` means all,
    /// perhaps of another size). Records the copies in `recorder`, for frame `slot`; uploads data beyond the capacity
    /// of a frame at once. After an error the copy is out of date.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        changed: Option<&[u32]>,
    ) -> Result<()> {
        if grid.dims() != self.dims {
            self.image = make_image(&self.device, grid)?;
            self.dilated = DilatedOccupancyImage::new(&self.device, grid)?;
            self.dims = grid.dims();
            return self.upload_whole(grid, ResourceUse::NOTHING);
        }
        match changed {
            Some([]) => return Ok(()),
            changed => self.dilated.update(recorder, slot, grid, changed)?,
        }
        match changed {
            Some(bricks) if bricks.len() * WHOLE_FROM_SHARE <= grid.brick_count() => {
                self.changed.clear();
                self.changed.extend(bricks.iter().map(|&b| grid.brick_coords(b as usize)));
                self.boxes.clear();
                cover(&mut self.changed, &mut self.boxes);
                let bricks: usize = self.boxes.iter().map(|b| b.bricks()).sum();
                match bricks * BRICK_BYTES <= CHUNK_BYTES {
                    true => self.upload_in_frame(recorder, slot, grid, bricks),
                    false => self.upload_at_once(grid, ResourceUse::SHADER_READ),
                }
            }
            _ => self.upload_whole(grid, ResourceUse::SHADER_READ),
        }
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Returns the image of the dilated occupancy.
    pub fn dilated_occupancy(&self) -> &Image {
        self.dilated.image()
    }

    /// Returns the size of the grid in voxels.
    pub fn dims(&self) -> UVec3 {
        self.dims
    }

    fn upload_whole(&mut self, grid: &Grid, before: ResourceUse) -> Result<()> {
        self.boxes.clear();
        self.boxes.push(BrickBox { min: UVec3::ZERO, size: grid.brick_dims() });
        self.upload_at_once(grid, before)
    }

    /// Uploads the boxes and waits for it.
    fn upload_at_once(&mut self, grid: &Grid, before: ResourceUse) -> Result<()> {
        let most = CHUNK_BYTES / BRICK_BYTES;
        let mut pieces = Vec::new();
        for of in &self.boxes {
            of.split(most, &mut |piece| pieces.push(piece));
        }
        let bricks: usize = pieces.iter().map(|piece| piece.bricks()).sum();
        let mut buffer = Buffer::new(
            &self.device,
            "many bricks",
            (bricks.min(most) * BRICK_BYTES) as u64,
            vk::BufferUsageFlags::TRANSFER_SRC,
            MemoryLocation::CpuToGpu,
        )?;
        let part = self.image.whole();
        let (mut from, mut rest) = (before, pieces.as_slice());
        while !rest.is_empty() {
            let mut bricks = 0;
            let fits = |piece: &&BrickBox| {
                bricks += piece.bricks();
                bricks <= most
            };
            let (now, later) = rest.split_at(rest.iter().take_while(fits).count());
            let target = buffer.mapped_mut();
            if target.is_empty() {
                return Err(GpuError::Host("many bricks is not mapped".to_string()));
            }
            pack(grid, now, target, &mut self.copies);
            run_once(&self.device, |recorder| {
                recorder.image_barrier(part, from, ResourceUse::COPY_TARGET);
                recorder.copy_to_image(buffer.handle(), part, &self.copies);
                recorder.image_barrier(part, ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
                Ok(())
            })?;
            (from, rest) = (ResourceUse::SHADER_READ, later);
        }
        Ok(())
    }

    /// Records the upload of the boxes, which contain `bricks` bricks.
    fn upload_in_frame(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        bricks: usize,
    ) -> Result<()> {
        let (boxes, copies) = (&self.boxes, &mut self.copies);
        self.staging.begin(slot);
        let bytes = (bricks * BRICK_BYTES) as u64;
        let piece = self.staging.fill(bytes, BRICK_BYTES as u64, |target| {
            pack(grid, boxes, target, copies);
        })?;
        for copy in copies.iter_mut() {
            copy.buffer_offset += piece.offset;
        }
        let part = self.image.whole();
        recorder.image_barrier(part, ResourceUse::SHADER_READ, ResourceUse::COPY_TARGET);
        recorder.copy_to_image(piece.buffer, part, copies);
        recorder.image_barrier(part, ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
        Ok(())
    }
}

/// Writes the bricks of `boxes` to `target`, one box after another, and their copies to the image to `copies`.
fn pack(grid: &Grid, boxes: &[BrickBox], target: &mut [u8], copies: &mut Vec<vk::BufferImageCopy>) {
    copies.clear();
    let mut offset = 0;
    for of in boxes {
        copies.push(copy(offset, of.min, of.size));
        for z in 0..of.size.z {
            for y in 0..of.size.y {
                let bytes = of.size.x as usize * BRICK_BYTES;
                let first = of.min + UVec3::new(0, y, z);
                grid.copy_row(first, &mut target[offset..offset + bytes]);
                offset += bytes;
            }
        }
    }
}

fn make_image(device: &Arc<Device>, grid: &Grid) -> Result<Image> {
    let dims = grid.dims();
    if !is_linear(dims) {
        return Err(GpuError::Limit {
            what: format!("naming each voxel of {}x{}x{}", dims.x, dims.y, dims.z),
            needed: dims.as_u64vec3().element_product(),
            limit: "32-bit voxel index",
            allowed: u64::from(NO_VOXEL) - 1,
        });
    }
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

/// Returns a copy from `offset` of a buffer to a box of bricks.
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
