//! The differences between the hosts that a device is made for: headless, a window, and a headset, whose runtime
//! creates instance and device itself (XR_KHR_vulkan_enable2) through the hooks of [`Host`].

use std::ffi::{CStr, CString};
use std::sync::Arc;

use ash::{khr, vk};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};

use super::error::{During, GpuError, Result};
use super::instance::{Host, Instance};

/// No screen: pictures go to memory.
#[derive(Default)]
pub struct Headless;

impl Host for Headless {
    fn name(&self) -> &'static str {
        "headless work"
    }
}

/// A window and, once the device exists, its surface.
pub struct WindowHost<W> {
    window: Arc<W>,
    surface: Option<WindowSurface>,
}

impl<W: HasDisplayHandle + HasWindowHandle + 'static> WindowHost<W> {
    pub fn new(window: Arc<W>) -> WindowHost<W> {
        WindowHost { window, surface: None }
    }

    /// Returns the surface, after `Device::new` has returned.
    pub fn into_surface(self) -> Result<WindowSurface> {
        self.surface.ok_or_else(|| GpuError::Host("the window has no surface yet".to_string()))
    }
}

impl<W: HasDisplayHandle + HasWindowHandle + 'static> Host for WindowHost<W> {
    fn name(&self) -> &'static str {
        "a window"
    }

    fn instance_extensions(&self) -> Result<Vec<CString>> {
        let display = self.window.display_handle().map_err(|e| handle_error(&e))?;
        let names = ash_window::enumerate_required_extensions(display.as_raw())
            .during("find the surface extensions of this display")?;
        // SAFETY: ash-window gives pointers to static NUL-terminated names.
        Ok(names.iter().map(|&name| unsafe { CStr::from_ptr(name) }.to_owned()).collect())
    }

    fn attach(&mut self, instance: &Arc<Instance>) -> Result<()> {
        self.surface = Some(WindowSurface::of_window(instance, self.window.clone())?);
        Ok(())
    }

    fn can_show(&self, device: vk::PhysicalDevice, queue_family: u32) -> Result<bool> {
        self.surface.as_ref().map_or(Ok(false), |surface| surface.can_show(device, queue_family))
    }

    fn device_extensions(&self) -> Vec<&'static CStr> {
        vec![khr::swapchain::NAME]
    }
}

/// A window's surface; keeps window and instance alive.
pub struct WindowSurface {
    handle: vk::SurfaceKHR,
    loader: khr::surface::Instance,
    instance: Arc<Instance>,
    window: Arc<dyn Handles>,
}

/// A window with the handles that Vulkan needs.
trait Handles: HasDisplayHandle + HasWindowHandle {}

impl<W: HasDisplayHandle + HasWindowHandle> Handles for W {}

impl WindowSurface {
    /// Returns the surface of `window`.
    pub(super) fn of_window<W>(instance: &Arc<Instance>, window: Arc<W>) -> Result<WindowSurface>
    where
        W: HasDisplayHandle + HasWindowHandle + 'static,
    {
        let mut surface = WindowSurface {
            handle: vk::SurfaceKHR::null(),
            loader: khr::surface::Instance::new(instance.entry(), instance.raw()),
            instance: instance.clone(),
            window,
        };
        surface.renew()?;
        Ok(surface)
    }

    /// Replaces this lost surface by another one of the same window. Nothing created from it may exist.
    pub fn renew(&mut self) -> Result<()> {
        let display = self.window.display_handle().map_err(|e| handle_error(&e))?.as_raw();
        let window = self.window.window_handle().map_err(|e| handle_error(&e))?.as_raw();
        let (entry, raw) = (self.instance.entry(), self.instance.raw());
        let former = std::mem::take(&mut self.handle);
        // SAFETY: the swapchain made from it is gone (the caller's duty); null is ignored. The
        // handles are of a live window, which the surface keeps alive.
        self.handle = unsafe {
            self.loader.destroy_surface(former, None);
            ash_window::create_surface(entry, raw, display, window, None)
        }
        .during("create the window's surface")?;
        Ok(())
    }

    /// Returns whether a queue family of a device of the same instance can present to it.
    pub(super) fn can_show(&self, device: vk::PhysicalDevice, queue_family: u32) -> Result<bool> {
        // SAFETY: device and surface are of the same instance.
        unsafe {
            self.loader.get_physical_device_surface_support(device, queue_family, self.handle)
        }
        .during("ask whether the device can draw to the window")
    }

    pub fn handle(&self) -> vk::SurfaceKHR {
        self.handle
    }

    pub fn loader(&self) -> &khr::surface::Instance {
        &self.loader
    }
}

impl Drop for WindowSurface {
    fn drop(&mut self) {
        // SAFETY: the swapchain made from it is dropped before (its owner's duty).
        unsafe { self.loader.destroy_surface(self.handle, None) };
    }
}

fn handle_error(error: &winit::raw_window_handle::HandleError) -> GpuError {
    GpuError::Host(format!("the window gives no handle: {error}"))
}
