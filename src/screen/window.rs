//! The swapchain of a window: presents finished pictures, and handles a window that is resized or minimised, or whose
//! surface is lost.
//!
//! Takes a surface and sizes; returns a [`WindowTarget`] to draw to, or none while nothing can be drawn. Does not know the
//! contents, nor winit: events of the window system come in as sizes. Presenting never blocks where the driver has a
//! mailbox, so callers must not draw more often than the screen refreshes ([`WindowScreen::is_paced`]).

mod choices;

use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::{khr, vk};

use choices::Recovery;

use crate::gpu::{
    Device, During, FRAMES_IN_FLIGHT, GpuError, ImagePart, Recorder, ResourceUse, Result,
    WindowSurface,
};

/// Time for which a window system may refuse a swapchain before that is an error.
const GIVE_UP_AFTER: Duration = Duration::from_secs(10);

/// An acquired image of the window, to be drawn and presented.
#[derive(Clone, Copy, Debug)]
pub struct WindowTarget {
    pub image: vk::Image,
    /// A view per layer; with one layer both are the same.
    views: [vk::ImageView; 2],
    layers: u32,
    /// Pixels.
    pub size: [u32; 2],
    acquired: vk::Semaphore,
    finished: vk::Semaphore,
    index: u32,
}

impl WindowTarget {
    /// Returns the image for barriers, with all layers.
    pub fn part(&self) -> ImagePart {
        ImagePart { layers: self.layers, ..ImagePart::colour(self.image, 0) }
    }

    /// Returns the number of layers: 2 in a quad-buffered window.
    pub fn layers(&self) -> u32 {
        self.layers
    }

    /// Returns the view for an eye's picture: 0 is the left eye, and the only one without layers.
    pub fn view(&self, eye: usize) -> vk::ImageView {
        self.views[eye.min(1)]
    }

    /// The use before the first barrier: the window system has finished after [`WindowTarget::wait`], and the contents may be
    /// discarded.
    pub const FIRST: ResourceUse = ResourceUse::COPY_TARGET.discarded();

    /// Returns the semaphore that a submission waits for before it copies or draws to the image.
    pub fn wait(&self) -> vk::SemaphoreSubmitInfo<'static> {
        let stages =
            vk::PipelineStageFlags2::COPY | vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT;
        vk::SemaphoreSubmitInfo::default().semaphore(self.acquired).stage_mask(stages)
    }

    /// Returns the semaphore for the submission that finishes the image to signal.
    pub fn signal(&self) -> vk::SemaphoreSubmitInfo<'static> {
        vk::SemaphoreSubmitInfo::default()
            .semaphore(self.finished)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
    }
}

/// The swapchain of a window.
pub struct WindowScreen {
    swapchain: Option<Swapchain>,
    /// One per frame slot.
    acquired: [vk::Semaphore; FRAMES_IN_FLIGHT],
    loader: khr::swapchain::Device,
    format: vk::SurfaceFormatKHR,
    mode: vk::PresentModeKHR,
    /// Size of the window in pixels; zero while it is minimised.
    size: [u32; 2],
    /// Layers per image: one, or one per eye.
    layers: u32,
    can_layer: bool,
    /// The swapchain no longer fits the window.
    stale: bool,
    /// Time since the window system has been refusing.
    refused: Option<Instant>,
    surface: WindowSurface,
    device: Arc<Device>,
}

struct Swapchain {
    handle: vk::SwapchainKHR,
    size: [u32; 2],
    images: Vec<SwapImage>,
}

struct SwapImage {
    image: vk::Image,
    /// One per layer.
    views: Vec<vk::ImageView>,
    finished: vk::Semaphore,
}

impl WindowScreen {
    /// Creates the swapchain. `size`: of the window, in pixels.
    pub fn new(
        device: &Arc<Device>,
        surface: WindowSurface,
        size: [u32; 2],
    ) -> Result<WindowScreen> {
        let format = choose_format(device, &surface)?;
        let mut screen = WindowScreen {
            swapchain: None,
            acquired: [vk::Semaphore::null(); FRAMES_IN_FLIGHT],
            loader: khr::swapchain::Device::new(device.instance().raw(), device.raw()),
            format,
            mode: choose_mode(device, &surface)?,
            size,
            layers: 1,
            can_layer: false,
            stale: true,
            refused: None,
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

    /// Returns whether images become available only as fast as the screen shows them.
    pub fn is_paced(&self) -> bool {
        self.mode == vk::PresentModeKHR::FIFO
    }

    /// Notes the new size of the window, in pixels; zero while it is minimised.
    pub fn resize(&mut self, size: [u32; 2]) {
        self.stale |= self.size != size;
        self.size = size;
    }

    /// Returns the next image to draw to, waiting up to `patience`; `None` while the window is minimised or hidden, or
    /// the window system is busy with it. `slot` is that of the current frame ([`crate::gpu::Frames::slot`]), whose
    /// semaphore is free again.
    pub fn acquire(&mut self, slot: usize, patience: Duration) -> Result<Option<WindowTarget>> {
        // A swapchain that is immediately out of date is recreated, but not forever.
        for _ in 0..3 {
            if self.size.contains(&0) {
                return Ok(None);
            }
            match self.try_acquire(slot, patience) {
                Ok(target) => {
                    self.refused = None;
                    return Ok(target);
                }
                Err(error) => {
                    if self.recover(error)? == Recovery::Later {
                        return Ok(None);
                    }
                }
            }
        }
        Ok(None)
    }

    fn try_acquire(&mut self, slot: usize, patience: Duration) -> Result<Option<WindowTarget>> {
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
        let (index, suboptimal) = match result {
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(None),
            result => result.during("get an image of the window")?,
        };
        let image = &swapchain.images[index as usize];
        let view = |layer: usize| {
            image.views.get(layer).or(image.views.first()).copied().unwrap_or_default()
        };
        let target = WindowTarget {
            image: image.image,
            views: [view(0), view(1)],
            layers: image.views.len() as u32,
            size: swapchain.size,
            acquired: semaphore,
            finished: image.finished,
            index,
        };
        self.stale |= suboptimal && self.has_another_size();
        Ok(Some(target))
    }

    /// Presents a finished target. Returns false if the window has changed too much to show it.
    pub fn present(&mut self, target: &WindowTarget) -> Result<bool> {
        let Some(swapchain) = &self.swapchain else { return Ok(false) };
        let (chains, indices, waits) = ([swapchain.handle], [target.index], [target.finished]);
        let info = vk::PresentInfoKHR::default()
            .wait_semaphores(&waits)
            .swapchains(&chains)
            .image_indices(&indices);
        // SAFETY: the queue is locked; the image was acquired and its commands are submitted.
        let result =
            self.device.with_queue(|queue| unsafe { self.loader.queue_present(queue, &info) });
        match result.during("show a picture in the window") {
            Ok(suboptimal) => {
                self.stale |= suboptimal && self.has_another_size();
                Ok(true)
            }
            Err(error) => self.recover(error).map(|_| false),
        }
    }

    /// Recovers from a failure of the window system. Returns when to try again: at once, except for
    /// [`Recovery::Later`].
    fn recover(&mut self, error: GpuError) -> Result<Recovery> {
        let recovery = match &error {
            GpuError::Vulkan { result, .. } => choices::recovery(*result),
            _ => None,
        };
        let Some(recovery) = recovery else { return Err(error) };
        self.stale = true;
        if recovery == Recovery::NewSwapchain {
            return Ok(recovery);
        }
        tracing::debug!("{error}; trying again");
        if self.refused.get_or_insert_with(Instant::now).elapsed() > GIVE_UP_AFTER {
            return Err(error);
        }
        self.device.wait_idle()?;
        self.drop_swapchain();
        if recovery == Recovery::NewSurface {
            let renewed =
                self.surface.renew().and_then(|()| choose_format(&self.device, &self.surface));
            // Another format needs other pipelines, which belong to the caller.
            if renewed.map(|format| format.format).ok() != Some(self.format.format) {
                return Err(error);
            }
        }
        Ok(recovery)
    }

    /// Returns whether window and swapchain differ in size. A swapchain may be suboptimal for other reasons, which a
    /// new one would not change.
    fn has_another_size(&self) -> bool {
        let size = self.capabilities().map(|of| choices::extent(&of, self.size));
        match (size, &self.swapchain) {
            (Ok(size), Some(swapchain)) => size != swapchain.size,
            _ => true,
        }
    }

    /// Records the copy of a picture in the layout of [`crate::gpu::ResourceUse::COPY_SOURCE`] to a
    /// position in a target in the layout of [`crate::gpu::ResourceUse::COPY_TARGET`], clipped to the
    /// target.
    pub fn paste(
        recorder: &mut Recorder,
        from: ImagePart,
        size: [u32; 2],
        to: &WindowTarget,
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

    /// Returns whether the window's images can have a layer per eye (`maxImageArrayLayers`).
    pub fn can_layer(&self) -> bool {
        self.can_layer
    }

    /// Uses images with a layer per eye, or with one layer, from the next one on. Without [`WindowScreen::can_layer`]
    /// it is always one.
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

    /// Recreates the swapchain for the present window.
    fn rebuild(&mut self) -> Result<()> {
        let capabilities = self.capabilities()?;
        let size = choices::extent(&capabilities, self.size);
        if size.contains(&0) {
            // No swapchain can be created, and the old one cannot be drawn to.
            self.device.wait_idle()?;
            self.drop_swapchain();
            return Ok(());
        }
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
        if !capabilities.supported_usage_flags.contains(usage) {
            return Err(GpuError::Host(
                "the window's images cannot be copied to; choose another device".to_string(),
            ));
        }
        let former = self.swapchain.as_ref().map_or(vk::SwapchainKHR::null(), |s| s.handle);
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(self.surface.handle())
            .min_image_count(choices::image_count(&capabilities))
            .image_format(self.format.format)
            .image_color_space(self.format.color_space)
            .image_extent(vk::Extent2D { width: size[0], height: size[1] })
            .image_array_layers(self.layers)
            .image_usage(usage)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(capabilities.current_transform)
            .composite_alpha(choices::composite_alpha(&capabilities))
            .present_mode(self.mode)
            .old_swapchain(former)
            .clipped(true);
        // All drawing to the old images must have finished.
        self.device.wait_idle()?;
        // SAFETY: the info is complete; the surface's former swapchain is handed over, and goes in
        // any case.
        let made = unsafe { self.loader.create_swapchain(&info, None) };
        self.drop_swapchain();
        let handle = made.during("make the window's swapchain")?;
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
        let [width, height] = size;
        tracing::debug!("swapchain of {width}x{height} pixels, {:?}", self.mode);
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

    /// Destroys an image that nothing uses any more.
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

    /// Destroys the swapchain. The device must be idle.
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

/// Returns the format to draw in.
fn choose_format(device: &Device, surface: &WindowSurface) -> Result<vk::SurfaceFormatKHR> {
    // SAFETY: device and surface are of the same instance.
    let formats = unsafe {
        surface.loader().get_physical_device_surface_formats(device.physical(), surface.handle())
    }
    .during("list the window's formats")?;
    choices::format(&formats, |format| can_draw_in(device, format)).ok_or_else(|| {
        GpuError::Host("the window has no format of 8 or 10 bits a colour".to_string())
    })
}

/// Returns whether pictures can be drawn, blended, sampled and copied in a format.
fn can_draw_in(device: &Device, format: vk::Format) -> bool {
    use vk::FormatFeatureFlags as Feature;
    let needed = Feature::COLOR_ATTACHMENT_BLEND
        | Feature::SAMPLED_IMAGE
        | Feature::TRANSFER_SRC
        | Feature::TRANSFER_DST;
    let (instance, physical) = (device.instance().raw(), device.physical());
    // SAFETY: plain query of a device of this instance.
    let properties = unsafe { instance.get_physical_device_format_properties(physical, format) };
    properties.optimal_tiling_features.contains(needed)
}

/// Returns the present mode.
fn choose_mode(device: &Device, surface: &WindowSurface) -> Result<vk::PresentModeKHR> {
    let (loader, handle) = (surface.loader(), surface.handle());
    // SAFETY: device and surface are of the same instance.
    let offered =
        unsafe { loader.get_physical_device_surface_present_modes(device.physical(), handle) }
            .during("list the window's ways of presenting")?;
    Ok(choices::present_mode(&offered))
}
