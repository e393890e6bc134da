//! The device's copy of the dilated occupancy of a grid: a 3D image of `R32G32_UINT` in which a texel is a word of 4^3
//! bricks, a bit each.
//!
//! It is small (46 KiB for 512^3 voxels), so all slabs of blocks touched by a change are uploaded again.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;

use super::dilated_occupancy::DilatedOccupancy;
use crate::gpu::{Device, Image, ImageInfo, Recorder, ResourceUse, Result, Staging, run_once};
use crate::sculpture::Grid;

/// Bricks along the edge of a block.
const BLOCK_BRICKS: u32 = 4;

/// The copy, always in the layout of [`ResourceUse::SHADER_READ`].
pub struct DilatedOccupancyImage {
    dilated: DilatedOccupancy,
    image: Image,
    staging: Staging,
}

impl DilatedOccupancyImage {
    /// Uploads the dilated occupancy of `grid` and waits for it.
    pub fn new(device: &Arc<Device>, grid: &Grid) -> Result<DilatedOccupancyImage> {
        let dilated = DilatedOccupancy::new(grid);
        let name = "dilated occupancy";
        let info = ImageInfo {
            name,
            size: dilated.dims().to_array(),
            volume: true,
            layers: 1,
            format: vk::Format::R32G32_UINT,
            usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
        };
        let image = Image::new(device, &info)?;
        let bytes = size_of_val(dilated.words()) as u64;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let staging = Staging::new(device, name, usage, bytes)?;
        let mut made = DilatedOccupancyImage { dilated, image, staging };
        let slabs = 0..made.dilated.dims().z;
        run_once(device, |recorder| made.upload(recorder, slabs, ResourceUse::NOTHING))?;
        Ok(made)
    }

    /// Updates the copy with `changed` bricks (linear indices; `None` means all) of a grid of the
    /// same size. Recorded in `recorder`, for frame `slot`, once per frame.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        changed: Option<&[u32]>,
    ) -> Result<()> {
        let slab = |brick: u32| grid.brick_coords(brick as usize).z / BLOCK_BRICKS;
        let bricks = changed.unwrap_or(&[]);
        let slabs = match (bricks.iter().min(), bricks.iter().max()) {
            (Some(&first), Some(&last)) => slab(first)..slab(last) + 1,
            _ => 0..grid.occupancy_dims().z,
        };
        let slabs = self.dilated.update(grid, slabs);
        self.staging.begin(slot);
        self.upload(recorder, slabs, ResourceUse::SHADER_READ)
    }

    /// Returns one texel per block of 4^3 bricks, from one block below the grid to one above it.
    pub fn image(&self) -> &Image {
        &self.image
    }

    fn upload(
        &mut self,
        recorder: &mut Recorder,
        slabs: Range<u32>,
        before: ResourceUse,
    ) -> Result<()> {
        let [width, height, _] = self.image.size();
        let per_slab = (width * height) as usize;
        let words =
            &self.dilated.words()[slabs.start as usize * per_slab..slabs.end as usize * per_slab];
        let piece = self.staging.push(words, size_of::<u64>() as u64)?;
        let copy = vk::BufferImageCopy::default()
            .buffer_offset(piece.offset)
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: 1,
            })
            .image_offset(vk::Offset3D { x: 0, y: 0, z: slabs.start as i32 })
            .image_extent(vk::Extent3D { width, height, depth: slabs.len() as u32 });
        let part = self.image.whole();
        recorder.image_barrier(part, before, ResourceUse::COPY_TARGET);
        recorder.copy_to_image(piece.buffer, part, &[copy]);
        recorder.image_barrier(part, ResourceUse::COPY_TARGET, ResourceUse::SHADER_READ);
        Ok(())
    }
}
