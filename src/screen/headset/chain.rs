//! A swapchain of the headset: images that the runtime shows, with a layer per eye, and the copy of
//! finished pictures to them.
//!
//! Pictures are rendered to the renderer's own images and copied bit by bit: the runtime's images
//! have an sRGB format, and the copied values are encoded already.

use ash::vk;
use ash::vk::Handle as _;
use glam::UVec2;
use openxr as xr;

use super::error::{Doing, HeadsetError, Result};
use crate::gpu::{ImagePart, Recorder, Use};

/// The colour format of the headset: that of the renderer, but declared as sRGB.
pub(super) const COLOUR: vk::Format = vk::Format::R8G8B8A8_SRGB;
pub(super) const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// Images of one size and format, used in turns.
pub(super) struct Chain {
    handle: xr::Swapchain<xr::Vulkan>,
    images: Images,
    /// The acquired image that has not been released.
    held: Option<usize>,
}

/// The images themselves, to record copies to them.
#[derive(Clone, Debug)]
pub(super) struct Images {
    images: Vec<vk::Image>,
    pub size: UVec2,
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
        let images = Images { images, size, layers, depth };
        Ok(Some(Chain { handle, images, held: None }))
    }

    pub fn images(&self) -> Images {
        self.images.clone()
    }

    /// Acquires an image and waits for it, unless there is one that has not been filled.
    /// [`Chain::release`] follows after the submission that fills it.
    pub fn acquire(&mut self) -> Result<usize> {
        if let Some(index) = self.held {
            return Ok(index);
        }
        let index = self.handle.acquire_image().doing("get an image of the headset")? as usize;
        self.handle.wait_image(xr::Duration::INFINITE).doing("wait for an image of the headset")?;
        self.held = Some(index);
        Ok(index)
    }

    /// Releases the image after the submission that fills it.
    pub fn release(&mut self) -> Result<()> {
        match self.held.take() {
            Some(_) => self.handle.release_image().doing("give an image to the headset"),
            None => Ok(()),
        }
    }

    /// A layer of the image released last.
    pub fn view(&self, layer: u32) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        let size = self.images.size;
        let extent = xr::Extent2Di { width: size.x as i32, height: size.y as i32 };
        let rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
        xr::SwapchainSubImage::new()
            .swapchain(&self.handle)
            .image_array_index(layer)
            .image_rect(rect)
    }
}

impl Images {
    /// Records an image of the chain with `record`, during which it is in the layout of
    /// [`Use::COPY_TARGET`].
    pub fn fill(
        &self,
        recorder: &mut Recorder,
        index: usize,
        record: impl FnOnce(&mut Recorder, ImagePart),
    ) -> Result<()> {
        let image = *self
            .images
            .get(index)
            .ok_or(HeadsetError::Lost("the runtime names an image that is not there"))?;
        let aspect =
            if self.depth { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
        let part = ImagePart { image, aspect, layer: 0, layers: self.layers };
        // The runtime acquires and releases images in the attachment layout.
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
