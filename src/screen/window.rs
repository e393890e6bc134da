//! Owns the swapchain of a window: where finished pictures go, and what happens when the window
//! changes its size, is minimised, or its surface is lost.
//!
//! Takes a surface and sizes; gives a [`Target`] to draw to, or none while there is nothing to
//! draw to. Knows nothing of what is drawn, and not winit either: the window system's events
//! come in as sizes.

use std::sync::Arc;
use std::time::Duration;

use ash::{khr, vk};

use crate::gpu::{
    Device, During, FRAMES_IN_FLIGHT, GpuError, ImagePart, Recorder, Result, Surface, Use,
};

/// An image of the window to be drawn and presented.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    pub image: vk::Image,
    /// A view a layer; of one layer both are the same.
    views: [vk::ImageView; 2],
    layers: u32,
    /// Pixels.
    pub size: [u32; 2],
    acquired: vk::Semaphore,
    finished: vk::Semaphore,
    index: u32,
}

impl Target {
    /// The image for barriers, with all its layers.
    pub fn part(&self) -> ImagePart {
        ImagePart { layers: self.layers, ..ImagePart::colour(self.image, 0) }
    }

    /// Layers: 2 in a quad-buffered window.
    pub fn layers(&self) -> u32 {
        self.layers
    }

    /// What an eye's picture is drawn to: 0 is the left one, and the only one without layers.
    pub fn view(&self, eye: usize) -> vk::ImageView {
        self.views[eye.min(1)]
    }

    /// The use that the image's first barrier comes from: the window system is done with it once
    /// [`Target::wait`] has been waited for, and what it shows may be lost.
    pub const FIRST: Use = Use::COPY_TARGET.discarded();

    /// What a submission that draws to the image waits for before it copies or draws.
    pub fn wait(&self) -> vk::SemaphoreSubmitInfo<'static> {
        let stages =
            vk::PipelineStageFlags2::COPY | vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT;
        vk::SemaphoreSubmitInfo::default().semaphore(self.acquired).stage_mask(stages)
    }

    /// What a submission that finishes the image signals.
    pub fn signal(&self) -> vk::SemaphoreSubmitInfo<'static> {
        vk::SemaphoreSubmitInfo::default()
            .semaphore(self.finished)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
    }
}

/// A window that pictures are shown in.
pub struct WindowScreen {
    swapchain: Option<Swapchain>,
    /// One a frame slot.
    acquired: [vk::Semaphore; FRAMES_IN_FLIGHT],
    loader: khr::swapchain::Device,
    format: vk::SurfaceFormatKHR,
    /// Size of the window in pixels; zero while it is minimised.
    size: [u32; 2],
    /// Layers an image: one, or one an eye.
    layers: u32,
    can_layer: bool,
    /// The swapchain does not fit the window any more.
    stale: bool,
    surface: Surface,
    device: Arc<Device>,
}

struct Swapchain {
    handle: vk::SwapchainKHR,
    size: [u32; 2],
    images: Vec<SwapImage>,
}

struct SwapImage {
    image: vk::Image,
    /// One a layer.
    views: Vec<vk::ImageView>,
    finished: vk::Semaphore,
}

impl WindowScreen {
    /// `size`: pixels of the window.
    pub fn new(device: &Arc<Device>, surface: Surface, size: [u32; 2]) -> Result<WindowScreen> {
        let format = choose_format(device, &surface)?;
        let mut screen = WindowScreen {
            swapchain: None,
            acquired: [vk::Semaphore::null(); FRAMES_IN_FLIGHT],
            loader: khr::swapchain::Device::new(device.instance().raw(), device.raw()),
            format,
            size,
            layers: 1,
            can_layer: false,
            stale: true,
            surface,
            device: device.clone(),
        };
        screen.can_layer = screen.capabilities()?.max_image_array_layers >= 2;
        for semaphore in &mut screen.acquired {
            *semaphore = make_semaphore(device, "image acquired")?;
        }
        Ok(screen)
    }

    pub fn format(&self) -> vk::Format {
        self.format.format
    }

    /// Whether colours written to the window are converted from linear to sRGB on the way.
    pub fn encodes_srgb(&self) -> bool {
        matches!(self.format(), vk::Format::B8G8R8A8_SRGB | vk::Format::R8G8B8A8_SRGB)
    }

    /// The window has another size in pixels; zero for a minimised one.
    pub fn resize(&mut self, size: [u32; 2]) {
        self.stale |= self.size != size;
        self.size = size;
    }

    /// The next image to draw to, waited for up to `patience`; none while the window is minimised
    /// or hidden. `slot` is that of the frame begun ([`crate::gpu::Frames::slot`]), whose
    /// semaphore is free again.
    pub fn acquire(&mut self, slot: usize, patience: Duration) -> Result<Option<Target>> {
        // A swapchain that is out of date at once is made anew, but not for ever.
        for _ in 0..3 {
            if self.size.contains(&0) {
                return Ok(None);
            }
            if self.stale || self.swapchain.is_none() {
                self.rebuild()?;
            }
            let Some(swapchain) = &self.swapchain else { return Ok(None) };
            let semaphore = self.acquired[slot % FRAMES_IN_FLIGHT];
            // SAFETY: the semaphore's last use is done, as `Frames::begin` has waited for it.
            let result = unsafe {
                self.loader.acquire_next_image(
                    swapchain.handle,
                    patience.as_nanos() as u64,
                    semaphore,
                    vk::Fence::null(),
                )
            };
            match result {
                Ok((index, suboptimal)) => {
                    self.stale |= suboptimal;
                    let image = &swapchain.images[index as usize];
                    let view = |layer: usize| {
                        image.views.get(layer).or(image.views.first()).copied().unwrap_or_default()
                    };
                    return Ok(Some(Target {
                        image: image.image,
                        views: [view(0), view(1)],
                        layers: image.views.len() as u32,
                        size: swapchain.size,
                        acquired: semaphore,
                        finished: image.finished,
                        index,
                    }));
                }
                Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(None),
                Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => self.stale = true,
                Err(error) => return Err(GpuError::vulkan("get an image of the window", error)),
            }
        }
        Ok(None)
    }

    /// Shows a finished target.
    pub fn present(&mut self, target: &Target) -> Result<()> {
        let Some(swapchain) = &self.swapchain else { return Ok(()) };
        let (chains, indices, waits) = ([swapchain.handle], [target.index], [target.finished]);
        let info = vk::PresentInfoKHR::default()
            .wait_semaphores(&waits)
            .swapchains(&chains)
            .image_indices(&indices);
        // SAFETY: the queue is locked; the image was acquired and its commands are submitted.
        let result =
            self.device.with_queue(|queue| unsafe { self.loader.queue_present(queue, &info) });
        match result {
            Ok(suboptimal) => self.stale |= suboptimal,
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => self.stale = true,
            Err(error) => return Err(GpuError::vulkan("show a picture in the window", error)),
        }
        Ok(())
    }

    /// Records the copy of a picture in the layout of [`crate::gpu::Use::COPY_SOURCE`] to a place
    /// in a target in the layout of [`crate::gpu::Use::COPY_TARGET`]. What lies beyond the target
    /// is cut off.
    pub fn paste(
        recorder: &mut Recorder,
        from: ImagePart,
        size: [u32; 2],
        to: &Target,
        at: [u32; 2],
    ) {
        let fits = |i: usize| size[i].min(to.size[i].saturating_sub(at[i]));
        let (width, height) = (fits(0), fits(1));
        if width == 0 || height == 0 {
            return;
        }
        let layers = vk::ImageSubresourceLayers::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .layer_count(1);
        let copy = [vk::ImageCopy::default()
            .src_subresource(layers.base_array_layer(from.layer))
            .dst_subresource(layers)
            .dst_offset(vk::Offset3D { x: at[0] as i32, y: at[1] as i32, z: 0 })
            .extent(vk::Extent3D { width, height, depth: 1 })];
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

    /// Whether the window's images can have a layer an eye (`maxImageArrayLayers`).
    pub fn can_layer(&self) -> bool {
        self.can_layer
    }

    /// Gives the window's images a layer an eye, or one for both, from the next one on. Without
    /// [`WindowScreen::can_layer`] it is always one.
    pub fn set_layered(&mut self, layered: bool) {
        let layers = if layered && self.can_layer { 2 } else { 1 };
        self.stale |= self.layers != layers;
        self.layers = layers;
    }

    fn capabilities(&self) -> Result<vk::SurfaceCapabilitiesKHR> {
        let (loader, surface) = (self.surface.loader(), self.surface.handle());
        // SAFETY: the surface lives.
        unsafe { loader.get_physical_device_surface_capabilities(self.device.physical(), surface) }
            .map_err(|error| GpuError::vulkan("ask what the window can show", error))
    }

    /// Makes the swapchain anew for the window as it is now.
    fn rebuild(&mut self) -> Result<()> {
        let surface = self.surface.handle();
        let capabilities = self.capabilities()?;
        let size = extent(&capabilities, self.size);
        if size.contains(&0) {
            self.size = size;
            return Ok(());
        }
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
        if !capabilities.supported_usage_flags.contains(usage) {
            return Err(GpuError::Host(
                "the window's images cannot be copied to; choose another device".to_string(),
            ));
        }
        let most = match capabilities.max_image_count {
            0 => u32::MAX,
            most => most,
        };
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(surface)
            .min_image_count((capabilities.min_image_count + 1).min(most))
            .image_format(self.format.format)
            .image_color_space(self.format.color_space)
            .image_extent(vk::Extent2D { width: size[0], height: size[1] })
            .image_array_layers(self.layers)
            .image_usage(usage)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(capabilities.current_transform)
            .composite_alpha(composite_alpha(&capabilities))
            // FIFO is everywhere and spends no power on pictures that nobody sees.
            .present_mode(vk::PresentModeKHR::FIFO)
            .clipped(true);
        // Before the old images go, all that draws to them must be done.
        self.device.wait_idle()?;
        self.drop_swapchain();
        // SAFETY: the info is complete, the surface has no other swapchain.
        let handle = unsafe { self.loader.create_swapchain(&info, None) }
            .during("make the window's swapchain")?;
        self.swapchain = Some(Swapchain { handle, size, images: Vec::new() });
        // SAFETY: just made.
        let images = unsafe { self.loader.get_swapchain_images(handle) }
            .during("list the window's images")?;
        for image in images {
            let made = self.swap_image(image)?;
            if let Some(swapchain) = &mut self.swapchain {
                swapchain.images.push(made);
            }
        }
        self.stale = false;
        tracing::debug!("swapchain of {}x{} pixels", size[0], size[1]);
        Ok(())
    }

    fn swap_image(&self, image: vk::Image) -> Result<SwapImage> {
        let mut made = SwapImage { image, views: Vec::new(), finished: vk::Semaphore::null() };
        let result = (0..self.layers).try_for_each(|layer| {
            let range = vk::ImageSubresourceRange::default()
                .aspect_mask(vk::ImageAspectFlags::COLOR)
                .level_count(1)
                .base_array_layer(layer)
                .layer_count(1);
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(self.format.format)
                .subresource_range(range);
            // SAFETY: the image is the swapchain's, in its format, with so many layers.
            let view = unsafe { self.device.raw().create_image_view(&info, None) }
                .during("look at the window's images")?;
            made.views.push(view);
            Ok(())
        });
        let finished = result.and_then(|()| make_semaphore(&self.device, "image finished"));
        match finished {
            Ok(finished) => Ok(SwapImage { finished, ..made }),
            Err(error) => {
                self.drop_image(made);
                Err(error)
            }
        }
    }

    /// Nothing may use the image any more.
    fn drop_image(&self, image: SwapImage) {
        let raw = self.device.raw();
        // SAFETY: ours, and unused; null handles are ignored.
        unsafe {
            for view in image.views {
                raw.destroy_image_view(view, None);
            }
            raw.destroy_semaphore(image.finished, None);
        }
    }

    /// The device must be idle.
    fn drop_swapchain(&mut self) {
        let Some(swapchain) = self.swapchain.take() else { return };
        for image in swapchain.images {
            self.drop_image(image);
        }
        // SAFETY: nothing is in flight.
        unsafe { self.loader.destroy_swapchain(swapchain.handle, None) };
    }
}

impl Drop for WindowScreen {
    fn drop(&mut self) {
        if let Err(error) = self.device.wait_idle() {
            tracing::warn!("the device did not come to rest: {error}");
        }
        self.drop_swapchain();
        for semaphore in self.acquired {
            // SAFETY: nothing is in flight; null handles are ignored.
            unsafe { self.device.raw().destroy_semaphore(semaphore, None) };
        }
    }
}

fn make_semaphore(device: &Device, name: &str) -> Result<vk::Semaphore> {
    let info = vk::SemaphoreCreateInfo::default();
    // SAFETY: the info is complete.
    let semaphore = unsafe { device.raw().create_semaphore(&info, None) }
        .during("create a semaphore for the window")?;
    device.name(semaphore, name);
    Ok(semaphore)
}

/// Plain 8-bit formats first: pictures are shaded and blended as sRGB values.
fn choose_format(device: &Device, surface: &Surface) -> Result<vk::SurfaceFormatKHR> {
    // SAFETY: device and surface are of the same instance.
    let formats = unsafe {
        surface.loader().get_physical_device_surface_formats(device.physical(), surface.handle())
    }
    .during("list the window's formats")?;
    let wanted = [
        vk::Format::B8G8R8A8_UNORM,
        vk::Format::R8G8B8A8_UNORM,
        vk::Format::B8G8R8A8_SRGB,
        vk::Format::R8G8B8A8_SRGB,
    ];
    wanted
        .iter()
        .find_map(|&wanted| {
            formats
                .iter()
                .find(|f| f.format == wanted && f.color_space == vk::ColorSpaceKHR::SRGB_NONLINEAR)
        })
        .copied()
        .ok_or_else(|| GpuError::Host("the window has no format of 8 bits a colour".to_string()))
}

/// The window's size as the surface reports it, or `wanted` where it lets us choose.
fn extent(capabilities: &vk::SurfaceCapabilitiesKHR, wanted: [u32; 2]) -> [u32; 2] {
    let vk::Extent2D { width, height } = capabilities.current_extent;
    if width != u32::MAX {
        return [width, height];
    }
    let (min, max) = (capabilities.min_image_extent, capabilities.max_image_extent);
    [wanted[0].clamp(min.width, max.width), wanted[1].clamp(min.height, max.height)]
}

fn composite_alpha(capabilities: &vk::SurfaceCapabilitiesKHR) -> vk::CompositeAlphaFlagsKHR {
    let supported = capabilities.supported_composite_alpha;
    [vk::CompositeAlphaFlagsKHR::OPAQUE, vk::CompositeAlphaFlagsKHR::INHERIT]
        .into_iter()
        .find(|&alpha| supported.contains(alpha))
        .unwrap_or(vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED)
}
