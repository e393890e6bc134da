//! Owns a swapchain of the headset: images that the runtime shows, a layer an eye, and the copy of
//! finished pictures to them.
//!
//! Pictures are made in images of the renderer's own and copied, bit by bit: the runtime's images
//! are of an sRGB format, and what is copied to them is encoded already.

use ash::vk;
use ash::vk::Handle as _;
use glam::UVec2;
use openxr as xr;

use super::error::{Doing, HeadsetError, Result};
use crate::gpu::{ImagePart, Recorder, Use};

/// Pictures of the headset, as the renderer's are but for the name of their encoding.
pub(super) const COLOUR: vk::Format = vk::Format::R8G8B8A8_SRGB;
pub(super) const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// Images of one size and format that take turns.
pub(super) struct Chain {
    handle: xr::Swapchain<xr::Vulkan>,
    images: Vec<vk::Image>,
    size: UVec2,
    layers: u32,
    depth: bool,
}

impl Chain {
    /// Images of `size` pixels and `layers` for pictures, or with `depth` for their depth. None if
    /// the runtime has no such format.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        size: UVec2,
        layers: u32,
        depth: bool,
    ) -> Result<Option<Chain>> {
        use xr::SwapchainUsageFlags as Usage;
        let (format, usage) = match depth {
            true => (DEPTH, Usage::DEPTH_STENCIL_ATTACHMENT),
            false => (COLOUR, Usage::COLOR_ATTACHMENT),
        };
        let format = format.as_raw() as xr::sys::platform::VkFormat;
        let formats = session.enumerate_swapchain_formats().doing("list formats of pictures")?;
        if !formats.contains(&format) {
            return Ok(None);
        }
        let info = xr::SwapchainCreateInfo {
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: usage | Usage::TRANSFER_DST,
            format,
            sample_count: 1,
            width: size.x,
            height: size.y,
            face_count: 1,
            array_size: layers,
            mip_count: 1,
        };
        let handle = session.create_swapchain(&info).doing("make images for the headset")?;
        let images = handle.enumerate_images().doing("list the headset's images")?;
        let images = images.into_iter().map(vk::Image::from_raw).collect();
        Ok(Some(Chain { handle, images, size, layers, depth }))
    }

    /// Waits for a free image, into which `record` records what it will hold; in between it is in
    /// the layout of [`Use::COPY_TARGET`]. After the submission comes [`Chain::release`].
    pub fn fill(
        &mut self,
        recorder: &mut Recorder,
        record: impl FnOnce(&mut Recorder, ImagePart),
    ) -> Result<()> {
        let index = self.handle.acquire_image().doing("get an image of the headset")?;
        self.handle.wait_image(xr::Duration::INFINITE).doing("wait for an image of the headset")?;
        let image = *self
            .images
            .get(index as usize)
            .ok_or(HeadsetError::Lost("the runtime names an image that is not there"))?;
        let aspect =
            if self.depth { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
        let part = ImagePart { image, aspect, layer: 0, layers: self.layers };
        // The runtime hands images over, and takes them back, as attachments.
        let theirs = match self.depth {
            true => Use {
                layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                ..Use::DEPTH_TARGET
            },
            false => Use::COLOUR_TARGET,
        };
        recorder.image_barrier(part, theirs.discarded(), Use::COPY_TARGET);
        record(recorder, part);
        recorder.image_barrier(part, Use::COPY_TARGET, theirs);
        Ok(())
    }

    /// Gives the image back once all that fills it has been submitted.
    pub fn release(&mut self) -> Result<()> {
        self.handle.release_image().doing("give an image to the headset")
    }

    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// A layer of the image released last.
    pub fn view(&self, layer: u32) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        let extent = xr::Extent2Di { width: self.size.x as i32, height: self.size.y as i32 };
        let rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
        xr::SwapchainSubImage::new()
            .swapchain(&self.handle)
            .image_array_index(layer)
            .image_rect(rect)
    }
}

/// Records the copy of all layers of `from`, of the same size and in the layout of
/// [`Use::COPY_SOURCE`].
pub(super) fn copy(recorder: &mut Recorder, from: ImagePart, to: ImagePart, size: UVec2) {
    let layers = |part: &ImagePart| {
        vk::ImageSubresourceLayers::default()
            .aspect_mask(part.aspect)
            .base_array_layer(part.layer)
            .layer_count(part.layers)
    };
    let copy = [vk::ImageCopy::default()
        .src_subresource(layers(&from))
        .dst_subresource(layers(&to))
        .extent(vk::Extent3D { width: size.x, height: size.y, depth: 1 })];
    // SAFETY: recording; both images live until the submission is done.
    unsafe {
        recorder.device().raw().cmd_copy_image(
            recorder.raw(),
            from.image,
            vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
            to.image,
            vk::ImageLayout::TRANSFER_DST_OPTIMAL,
            &copy,
        );
    }
}
