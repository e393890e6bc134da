//! The Vulkan loader, the instance, and the messenger of the validation layers; and the hooks of the host of instance
//! and device.
//!
//! Surfaces and the device keep an `Arc` of it, so it is destroyed last.

use std::ffi::{CStr, CString};
use std::sync::Arc;

use ash::{ext, khr, vk};

use super::error::{During, GpuError, Result};
use super::validation::{LAYER, ValidationLog, messenger_info};

/// Whether the validation layers check the program's calls.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Validation {
    #[default]
    Off,
    /// On if the layer is installed: for tests, which report a missing layer.
    IfAvailable,
    /// On, or an error with the way to install the layer.
    Required,
}

/// The hooks that [`crate::gpu::Device::new`] calls on its host, in this order.
pub trait Host {
    /// Returns a name for messages, such as "a window".
    fn name(&self) -> &'static str;

    fn instance_extensions(&self) -> Result<Vec<CString>> {
        Ok(Vec::new())
    }

    /// Creates the instance. The runtime of a headset does this itself.
    fn create_instance(
        &mut self,
        entry: &ash::Entry,
        info: &vk::InstanceCreateInfo<'_>,
    ) -> Result<ash::Instance> {
        // SAFETY: `info` and all that it points to are alive.
        match unsafe { entry.create_instance(info, None) } {
            // The result of loaders without any installed driver.
            Err(vk::Result::ERROR_INCOMPATIBLE_DRIVER) => Err(GpuError::NoDevice),
            result => result.during("create the instance"),
        }
    }

    /// Called once the instance exists; a window creates its surface.
    fn attach(&mut self, _instance: &Arc<Instance>) -> Result<()> {
        Ok(())
    }

    /// Returns the device prescribed by the host, if there is one.
    fn prescribed_device(&mut self, _instance: &Instance) -> Result<Option<vk::PhysicalDevice>> {
        Ok(None)
    }

    /// Returns whether the host can present images of this queue family.
    fn can_show(&self, _device: vk::PhysicalDevice, _queue_family: u32) -> Result<bool> {
        Ok(true)
    }

    fn device_extensions(&self) -> Vec<&'static CStr> {
        Vec::new()
    }

    /// Creates the device. The runtime of a headset does this itself.
    fn create_device(
        &mut self,
        instance: &Instance,
        physical: vk::PhysicalDevice,
        info: &vk::DeviceCreateInfo<'_>,
    ) -> Result<ash::Device> {
        // SAFETY: `info` and all that it points to are alive, `physical` is of this instance.
        unsafe { instance.raw().create_device(physical, info, None) }.during("create the device")
    }
}

/// The loader and the instance.
pub struct Instance {
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    raw: ash::Instance,
    entry: ash::Entry,
    log: Arc<ValidationLog>,
    validation: bool,
    debug_names: bool,
}

impl Instance {
    /// Loads Vulkan and creates the instance for `host`.
    pub fn new(host: &mut dyn Host, validation: Validation) -> Result<Arc<Instance>> {
        // SAFETY: the library found under the loader's name is the Vulkan loader.
        let entry = unsafe { ash::Entry::load() }.map_err(|e| GpuError::NoLoader(e.to_string()))?;
        require_loader_1_3(&entry)?;
        let validation = choose_validation(&entry, validation)?;

        // SAFETY: plain query.
        let available = unsafe { entry.enumerate_instance_extension_properties(None) }
            .during("list instance extensions")?;
        let has = |name: &CStr| {
            available.iter().any(|e| e.extension_name_as_c_str().is_ok_and(|n| n == name))
        };
        let mut extensions = host.instance_extensions()?;
        for name in &extensions {
            if !has(name) {
                let name = name.to_string_lossy().into_owned();
                return Err(GpuError::InstanceExtension(name, host.name().to_string()));
            }
        }
        let debug_names = has(ext::debug_utils::NAME);
        if debug_names {
            extensions.push(CString::from(ext::debug_utils::NAME));
        }
        // Otherwise loaders hide devices with an incomplete Vulkan, such as all of Apple's.
        let mut flags = vk::InstanceCreateFlags::empty();
        if has(khr::portability_enumeration::NAME) {
            extensions.push(CString::from(khr::portability_enumeration::NAME));
            flags |= vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
        }
        let extension_names: Vec<_> = extensions.iter().map(|e| e.as_ptr()).collect();
        let layer_names: Vec<_> = validation.then_some(LAYER.as_ptr()).into_iter().collect();

        let app = vk::ApplicationInfo::default()
            .application_name(c"Virtual Sculpture")
            .api_version(vk::API_VERSION_1_3);
        let log = Arc::new(ValidationLog::default());
        let mut messenger = messenger_info(&log);
        let mut info = vk::InstanceCreateInfo::default()
            .flags(flags)
            .application_info(&app)
            .enabled_extension_names(&extension_names)
            .enabled_layer_names(&layer_names);
        if validation && debug_names {
            info = info.push_next(&mut messenger);
        }
        let raw = host.create_instance(&entry, &info)?;
        let mut instance = Instance { messenger: None, raw, entry, log, validation, debug_names };
        if validation && debug_names {
            let loader = ext::debug_utils::Instance::new(&instance.entry, &instance.raw);
            let info = messenger_info(&instance.log);
            // SAFETY: the log lives in an Arc that `Instance` keeps until the messenger is gone.
            let messenger = unsafe { loader.create_debug_utils_messenger(&info, None) }
                .during("listen to the validation layers")?;
            instance.messenger = Some((loader, messenger));
        }
        Ok(Arc::new(instance))
    }

    pub fn raw(&self) -> &ash::Instance {
        &self.raw
    }

    pub fn entry(&self) -> &ash::Entry {
        &self.entry
    }

    /// Returns the messages of the validation layers; outlives the instance.
    pub fn validation_log(&self) -> &Arc<ValidationLog> {
        &self.log
    }

    /// Returns whether the validation layers are on.
    pub fn validated(&self) -> bool {
        self.validation
    }

    /// Returns whether objects can be given names.
    pub fn debug_names(&self) -> bool {
        self.debug_names
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some((loader, messenger)) = self.messenger.take() {
            // SAFETY: made from this instance and not used after.
            unsafe { loader.destroy_debug_utils_messenger(messenger, None) };
        }
        // SAFETY: everything made from the instance keeps an Arc of it, so nothing is left.
        unsafe { self.raw.destroy_instance(None) };
    }
}

fn require_loader_1_3(entry: &ash::Entry) -> Result<()> {
    // SAFETY: plain query.
    let version = unsafe { entry.try_enumerate_instance_version() }
        .during("ask for the loader's version")?
        .unwrap_or(vk::API_VERSION_1_0);
    if version < vk::API_VERSION_1_3 {
        return Err(GpuError::LoaderVersion(version_text(version)));
    }
    Ok(())
}

fn choose_validation(entry: &ash::Entry, wanted: Validation) -> Result<bool> {
    if wanted == Validation::Off {
        return Ok(false);
    }
    // SAFETY: plain query.
    let layers =
        unsafe { entry.enumerate_instance_layer_properties() }.during("list instance layers")?;
    let installed = layers.iter().any(|l| l.layer_name_as_c_str().is_ok_and(|n| n == LAYER));
    if !installed && wanted == Validation::Required {
        return Err(GpuError::NoValidation);
    }
    Ok(installed)
}

/// Formats a version, such as "1.3.239".
pub(super) fn version_text(version: u32) -> String {
    format!(
        "{}.{}.{}",
        vk::api_version_major(version),
        vk::api_version_minor(version),
        vk::api_version_patch(version)
    )
}
