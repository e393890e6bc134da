//! Options of the device: which one to use, and whether to validate its use.

use std::path::PathBuf;

use serde::Deserialize;

use super::{DeviceChoice, DeviceOptions, Validation};

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GpuOptions {
    /// Text of a [`DeviceChoice`].
    pub device: String,
    /// Require the Vulkan validation layer.
    pub validation: bool,
}

impl GpuOptions {
    /// Returns the device parameters, including the environment's; see [`DeviceOptions::with_environment`].
    pub fn device_options(&self, pipeline_cache: Option<PathBuf>) -> DeviceOptions {
        let choice = DeviceChoice::parse(&self.device);
        let validation = if self.validation { Validation::Required } else { Validation::default() };
        DeviceOptions { choice, validation, pipeline_cache }.with_environment()
    }
}
