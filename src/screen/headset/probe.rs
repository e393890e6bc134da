//! The installed OpenXR runtime, for reports. The loader is a system library that is loaded when first
//! needed, so that the program runs without it.

use openxr as xr;

use crate::install_hint;

/// An available OpenXR runtime.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AvailableRuntime {
    pub name: String,
    pub version: String,
    /// Whether it can share Vulkan images with the program (`XR_KHR_vulkan_enable2`).
    pub vulkan: bool,
}

/// Queries the installed runtime. The error names the missing part.
pub fn probe() -> Result<AvailableRuntime, String> {
    // SAFETY: loading runs the loader's initialisers; a system's OpenXR loader is trusted as the
    // Vulkan loader is.
    let entry = unsafe { xr::Entry::load(&()) }
        .map_err(|error| format!("no OpenXR loader ({error}); {}", install_hint::OPENXR_LOADER))?;
    let extensions = entry
        .enumerate_extensions()
        .map_err(|error| format!("the OpenXR loader finds no runtime ({error}); start one"))?;
    let application = xr::ApplicationInfo {
        application_name: "virtual-sculpture",
        application_version: 1,
        engine_name: "",
        engine_version: 0,
        api_version: xr::Version::new(1, 0, 0),
    };
    let instance = entry
        .create_instance(&application, &xr::ExtensionSet::default(), &[], &())
        .map_err(|error| format!("the OpenXR runtime does not answer ({error})"))?;
    let properties = instance
        .properties()
        .map_err(|error| format!("the OpenXR runtime does not report its name ({error})"))?;
    Ok(AvailableRuntime {
        name: properties.runtime_name,
        version: properties.runtime_version.to_string(),
        vulkan: extensions.khr_vulkan_enable2,
    })
}
