//! Vulkan errors, with messages that name what is missing and how to get it. Nothing here panics: a lost device and
//! exhausted memory are values.

use ash::vk;
use thiserror::Error;

use crate::install_hint;

pub type Result<T> = std::result::Result<T, GpuError>;

#[derive(Debug, Error)]
pub enum GpuError {
    #[error("no Vulkan loader found ({0}); {hint}", hint = install_hint::VULKAN_LOADER)]
    NoLoader(String),
    #[error(
        "the Vulkan loader supports only version {0}; version 1.3 is needed: {hint}",
        hint = install_hint::NEWER_VULKAN_LOADER
    )]
    LoaderVersion(String),
    #[error(
        "the Vulkan validation layer was requested but is not installed; {hint}",
        hint = install_hint::VALIDATION_LAYER
    )]
    NoValidation,
    #[error("the Vulkan loader lacks the instance extension {0}, which {1} needs")]
    InstanceExtension(String, String),
    #[error("no Vulkan device found; {hint}", hint = install_hint::VULKAN_DRIVER)]
    NoDevice,
    #[error("no Vulkan device can be used: {0}")]
    NoneSuitable(String),
    #[error("no Vulkan device matches `{wanted}`; there are: {available}")]
    NoSuchDevice { wanted: String, available: String },
    #[error("not enough memory to {0}; close other programs or use a smaller sculpture")]
    OutOfMemory(&'static str),
    #[error(
        "the graphics device was lost, unable to {0} (driver reset or device unplugged); \
         restart the program"
    )]
    DeviceLost(&'static str),
    #[error("the graphics device did not finish within {0} s")]
    Timeout(u64),
    #[error("Vulkan could not {doing}: {result}")]
    Vulkan { doing: &'static str, result: vk::Result },
    #[error("could not place memory for {name}: {reason}")]
    Allocation { name: String, reason: String },
    /// A limit of the device, with the limit's Vulkan name.
    #[error("{what} needs {needed}, more than this device's {limit} of {allowed}")]
    Limit { what: String, needed: u64, limit: &'static str, allowed: u64 },
    #[error("{0}")]
    Host(String),
}

impl GpuError {
    /// Returns the error of a Vulkan result in the step "to ...".
    pub fn vulkan(doing: &'static str, result: vk::Result) -> GpuError {
        match result {
            vk::Result::ERROR_OUT_OF_HOST_MEMORY | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => {
                GpuError::OutOfMemory(doing)
            }
            vk::Result::ERROR_DEVICE_LOST => GpuError::DeviceLost(doing),
            result => GpuError::Vulkan { doing, result },
        }
    }
}

/// Names the step of a Vulkan call: `.during("create a fence")`.
pub trait During<T> {
    fn during(self, doing: &'static str) -> Result<T>;
}

impl<T> During<T> for ash::prelude::VkResult<T> {
    fn during(self, doing: &'static str) -> Result<T> {
        self.map_err(|result| GpuError::vulkan(doing, result))
    }
}
