//! Owns the device's copy of which bricks of a grid hold anything: a 3D image of `R32G32_UINT`, in
//! which a texel stands for 4^3 bricks, a bit each, as [`Grid::occupancy`] has them.
//!
//! It is small (32 KiB for 512^3 voxels): of a change the slabs of blocks that it touches are
//! uploaded anew. Knows no bits within bricks.

use std::sync::Arc;

use ash::vk;

use crate::gpu::{Device, Image, ImageInfo, Recorder, Result, Staging, Use, run_once};
use crate::sculpture::Grid;

/// Bricks along the edge of a block.
const BLOCK_BRICKS: u32 = 4;

/// The copy, always in the layout of [`Use::SHADER_READ`].
pub struct Occupancy {
    image: Image,
    staging: Staging,
}

impl Occupancy {
    /// Uploads that of `grid` and waits for it.
    pub fn new(device: &Arc<Device>, grid: &Grid) -> Result<Occupancy> {
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let bytes = size_of_val(grid.occupancy()) as u64;
        let mut made = Occupancy {
            image: Image::new(
                device,
                &ImageInfo {
                    name: "the bricks in use",
                    size: grid.occupancy_dims().to_array(),
                    volume: true,
                    layers: 1,
                    format: vk::Format::R32G32_UINT,
                    usage: vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST,
                },
            )?,
            staging: Staging::new(device, "bricks in use", usage, bytes)?,
        };
        run_once(device, |recorder| made.upload(recorder, grid, 0, u32::MAX, Use::NOTHING))?;
        Ok(made)
    }

    /// Brings the copy up to date with `changed` bricks (linear indices; `None` means all) of a
    /// grid of the same size. Recorded in `recorder`, for frame `slot`, once a frame.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        changed: Option<&[u32]>,
    ) -> Result<()> {
        self.staging.begin(slot);
        let slab = |brick: u32| grid.brick_coords(brick as usize).z / BLOCK_BRICKS;
        let bricks = changed.unwrap_or(&[]);
        let (first, last) = match (bricks.iter().min(), bricks.iter().max()) {
            (Some(&first), Some(&last)) => (slab(first), slab(last)),
            _ => (0, u32::MAX),
        };
        self.upload(recorder, grid, first, last, Use::SHADER_READ)
    }

    /// One texel for each block of 4^3 bricks.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Uploads the slabs of blocks from `first` to `last`.
    fn upload(
        &mut self,
        recorder: &mut Recorder,
        grid: &Grid,
        first: u32,
        last: u32,
        before: Use,
    ) -> Result<()> {
        let [width, height, depth] = self.image.size();
        let end = last.saturating_add(1).min(depth);
        let per_slab = (width * height) as usize;
        let words = &grid.occupancy()[first as usize * per_slab..end as usize * per_slab];
        let piece = self.staging.push(words, 8)?;
        let copy = vk::BufferImageCopy::default()
            .buffer_offset(piece.offset)
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: 1,
            })
            .image_offset(vk::Offset3D { x: 0, y: 0, z: first as i32 })
            .image_extent(vk::Extent3D { width, height, depth: end - first });
        let part = self.image.whole();
        recorder.image_barrier(part, before, Use::COPY_TARGET);
        recorder.copy_to_image(piece.buffer, part, &[copy]);
        recorder.image_barrier(part, Use::COPY_TARGET, Use::SHADER_READ);
        Ok(())
    }
}
