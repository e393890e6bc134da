//! A swapchain of the headset: images that the runtime shows, with a layer per eye, and the copy of
//! rendered pictures to them.
//!
//! Pictures are rendered to the renderer's own images and copied without conversion: the runtime's
//! images have an sRGB format, and the copied values are encoded already.

use ash::vk;
use ash::vk::Handle as _;
use glam::UVec2;
use openxr as xr;

use super::error::{Doing, HeadsetError, Result};
use crate::gpu::{ImagePart, Recorder, ResourceUse};

/// The colour format of the headset: that of the renderer, but declared as sRGB.
const COLOUR: vk::Format = vk::Format::R8G8B8A8_SRGB;
const DEPTH: vk::Format = vk::Format::D32_SFLOAT;

/// Images of one size and format.
pub(super) struct Swapchain {
    handle: xr::Swapchain<xr::Vulkan>,
    images: SwapchainImages,
    /// The acquired image that has not been released.
    acquired: Option<usize>,
}

/// The Vulkan images, to record copies to them.
#[derive(Clone, Debug)]
pub(super) struct SwapchainImages {
    images: Vec<vk::Image>,
    pub size: UVec2,
    layers: u32,
    depth: bool,
}

impl Swapchain {
    /// Creates images of `size` pixels with `layers` array layers, for colour, or with `depth` for depth. Returns
    /// `None` if the runtime does not have the format.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        size: UVec2,
        layers: u32,
        depth: bool,
    ) -> Result<Option<Swapchain>> {
        use xr::SwapchainUsageFlags as Usage;
        let (format, usage) = match depth {
            true => (DEPTH, Usage::DEPTH_STENCIL_ATTACHMENT),
            false => (COLOUR, Usage::COLOR_ATTACHMENT),
        };
        let format = format.as_raw() as xr::sys::platform::VkFormat;
        let formats = session.enumerate_swapchain_formats().doing("list swapchain formats")?;
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
        let handle = session.create_swapchain(&info).doing("create a swapchain")?;
        let images = handle.enumerate_images().doing("list the images of a swapchain")?;
        let images = images.into_iter().map(vk::Image::from_raw).collect();
        let images = SwapchainImages { images, size, layers, depth };
        Ok(Some(Swapchain { handle, images, acquired: None }))
    }

    pub fn images(&self) -> SwapchainImages {
        self.images.clone()
    }

    /// Acquires an image and waits for it, unless the last acquired one was not released. [`Swapchain::release`]
    /// follows after the submission that writes it.
    pub fn acquire(&mut self) -> Result<usize> {
        if let Some(index) = self.acquired {
            return Ok(index);
        }
        let index = self.handle.acquire_image().doing("acquire a swapchain image")? as usize;
        self.handle.wait_image(xr::Duration::INFINITE).doing("wait for a swapchain image")?;
        self.acquired = Some(index);
        Ok(index)
    }

    /// Releases the image after the submission that writes it.
    pub fn release(&mut self) -> Result<()> {
        match self.acquired.take() {
            Some(_) => self.handle.release_image().doing("release a swapchain image"),
            None => Ok(()),
        }
    }

    /// Returns a layer of the image released last.
    pub fn sub_image(&self, layer: u32) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        let size = self.images.size;
        let extent = xr::Extent2Di { width: size.x as i32, height: size.y as i32 };
        let rect = xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent };
        xr::SwapchainSubImage::new()
            .swapchain(&self.handle)
            .image_array_index(layer)
            .image_rect(rect)
    }
}

impl SwapchainImages {
    /// Transitions the image `index` to [`ResourceUse::COPY_TARGET`], calls `record`, and transitions it
    /// back to the layout that the runtime expects.
    pub fn write(
        &self,
        recorder: &mut Recorder,
        index: usize,
        record: impl FnOnce(&mut Recorder, ImagePart),
    ) -> Result<()> {
        let image = *self
            .images
            .get(index)
            .ok_or(HeadsetError::Lost("the runtime returned an image index out of range"))?;
        let aspect =
            if self.depth { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
        let part = ImagePart { image, aspect, layer: 0, layers: self.layers };
        // The runtime acquires and releases images in the attachment layout.
        let runtime_use = match self.depth {
            true => ResourceUse {
                layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                ..ResourceUse::DEPTH_TARGET
            },
            false => ResourceUse::COLOUR_TARGET,
        };
        recorder.image_barrier(part, runtime_use.discarded(), ResourceUse::COPY_TARGET);
        record(recorder, part);
        recorder.image_barrier(part, ResourceUse::COPY_TARGET, runtime_use);
        Ok(())
    }
}

/// Records the copy of all layers of `from`, of the same size and in the layout of
/// [`ResourceUse::COPY_SOURCE`].
pub(super) fn copy_image(recorder: &mut Recorder, from: ImagePart, to: ImagePart, size: UVec2) {
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
