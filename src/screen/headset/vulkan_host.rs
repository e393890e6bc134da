//! Vulkan instance and device created by the OpenXR runtime (`XR_KHR_vulkan_enable2`): the runtime adds its own
//! extensions to those of the program, and prescribes the physical device.

use std::ffi::c_void;

use ash::vk;
use ash::vk::Handle as _;
use openxr as xr;

use crate::gpu::{GpuError, Host, Instance, Result};

/// Creates instance and device through the runtime.
pub struct XrVulkanHost<'a> {
    pub xr: &'a xr::Instance,
    pub system: xr::SystemId,
}

impl Host for XrVulkanHost<'_> {
    fn name(&self) -> &'static str {
        "a headset"
    }

    fn create_instance(
        &mut self,
        entry: &ash::Entry,
        info: &vk::InstanceCreateInfo<'_>,
    ) -> Result<ash::Instance> {
        let info: *const vk::InstanceCreateInfo<'_> = info;
        // SAFETY: `info` and all that it points to are alive; the loader's function has the type
        // that both libraries name differently.
        let result = unsafe {
            self.xr.create_vulkan_instance(self.system, proc_addr(entry), info.cast::<c_void>())
        };
        let raw = checked(result, "create the instance through the headset's runtime")?;
        let handle = vk::Instance::from_raw(raw as u64);
        // SAFETY: the runtime has just made it with this loader.
        Ok(unsafe { ash::Instance::load(entry.static_fn(), handle) })
    }

    fn prescribed_device(&mut self, instance: &Instance) -> Result<Option<vk::PhysicalDevice>> {
        let handle = instance.raw().handle().as_raw();
        // SAFETY: the runtime has made the instance.
        let device =
            unsafe { self.xr.vulkan_graphics_device(self.system, handle as *const c_void) }
                .map_err(|error| host_error("find the headset's graphics device", error))?;
        Ok(Some(vk::PhysicalDevice::from_raw(device as u64)))
    }

    fn create_device(
        &mut self,
        instance: &Instance,
        physical: vk::PhysicalDevice,
        info: &vk::DeviceCreateInfo<'_>,
    ) -> Result<ash::Device> {
        let (proc_addr, info) = (proc_addr(instance.entry()), std::ptr::from_ref(info));
        let physical = physical.as_raw() as *const c_void;
        // SAFETY: `info` and all that it points to are alive, `physical` is of the instance that
        // the runtime has made.
        let result = unsafe {
            self.xr.create_vulkan_device(self.system, proc_addr, physical, info.cast::<c_void>())
        };
        let raw = checked(result, "create the device through the headset's runtime")?;
        let handle = vk::Device::from_raw(raw as u64);
        // SAFETY: the runtime has just made it from this instance.
        Ok(unsafe { ash::Device::load(instance.raw().fp_v1_0(), handle) })
    }
}

/// Returns the loader's entry point, in the type of the openxr crate.
fn proc_addr(entry: &ash::Entry) -> xr::sys::platform::VkGetInstanceProcAddr {
    let function = entry.static_fn().get_instance_proc_addr;
    // SAFETY: both are Vulkan's vkGetInstanceProcAddr; the crates differ only in how they spell
    // its opaque handles.
    unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr::sys::platform::VkGetInstanceProcAddr>(
            function,
        )
    }
}

/// Returns the handle that the runtime has created, or the error of the runtime or of Vulkan.
fn checked<T>(
    result: xr::Result<std::result::Result<T, xr::sys::platform::VkResult>>,
    doing: &'static str,
) -> Result<T> {
    match result {
        Ok(Ok(handle)) => Ok(handle),
        Ok(Err(code)) => Err(GpuError::vulkan(doing, vk::Result::from_raw(code))),
        Err(error) => Err(host_error(doing, error)),
    }
}

fn host_error(doing: &'static str, error: xr::sys::Result) -> GpuError {
    GpuError::Host(format!("the headset's runtime could not {doing}: {error}"))
}
