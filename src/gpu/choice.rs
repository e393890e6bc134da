//! Owns which of the computer's devices is taken, and why the others are not.

use std::ffi::CStr;

use ash::vk;

use super::error::{During, GpuError, Result};
use super::host::Host;
use super::instance::{Instance, version_text};

/// Which device to take.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub enum DeviceChoice {
    /// Discrete, then integrated, then virtual, then software.
    #[default]
    Preferred,
    /// The n-th that the loader lists, from 0.
    Index(usize),
    /// The first whose name contains this, letter case aside.
    Name(String),
}

impl DeviceChoice {
    /// "" or "auto", a number, or part of a name.
    pub fn parse(text: &str) -> DeviceChoice {
        match text.trim() {
            "" | "auto" => DeviceChoice::Preferred,
            text => match text.parse() {
                Ok(index) => DeviceChoice::Index(index),
                Err(_) => DeviceChoice::Name(text.to_string()),
            },
        }
    }
}

/// A device that can be used.
pub(super) struct Candidate {
    pub physical: vk::PhysicalDevice,
    pub properties: vk::PhysicalDeviceProperties,
    pub queue_family: u32,
    /// Bits of the queue's time stamps that count; 0 where it has none.
    pub time_stamp_bits: u32,
}

impl Candidate {
    pub fn name(&self) -> String {
        device_name(&self.properties)
    }
}

/// The device to use, or an error that names every device with what it lacks.
pub(super) fn choose(
    instance: &Instance,
    host: &mut dyn Host,
    choice: &DeviceChoice,
) -> Result<Candidate> {
    if let Some(physical) = host.prescribed_device(instance)? {
        return candidate(instance, host, physical)?.map_err(GpuError::NoneSuitable);
    }
    let (all, names) = all_devices(instance)?;
    let wanted: Vec<vk::PhysicalDevice> = match choice {
        DeviceChoice::Preferred => all.clone(),
        DeviceChoice::Index(index) => all.get(*index).copied().into_iter().collect(),
        DeviceChoice::Name(part) => {
            let part = part.to_lowercase();
            let named = names.iter().position(|n| n.to_lowercase().contains(&part));
            named.map(|i| all[i]).into_iter().collect()
        }
    };
    if wanted.is_empty() {
        let wanted = match choice {
            DeviceChoice::Index(index) => index.to_string(),
            DeviceChoice::Name(part) => part.clone(),
            DeviceChoice::Preferred => String::new(),
        };
        let list = names.iter().enumerate().map(|(i, n)| format!("{i}: {n}"));
        let available = list.collect::<Vec<_>>().join(", ");
        return Err(GpuError::NoSuchDevice { wanted, available });
    }
    let mut usable = Vec::new();
    let mut refused = Vec::new();
    for physical in wanted {
        match candidate(instance, host, physical)? {
            Ok(candidate) => usable.push(candidate),
            Err(reason) => refused.push(reason),
        }
    }
    usable
        .into_iter()
        .min_by_key(|c| rank(c.properties.device_type))
        .ok_or_else(|| GpuError::NoneSuitable(refused.join("; ")))
}

/// Every device of the computer with its name, in the loader's order; an error if there is none.
fn all_devices(instance: &Instance) -> Result<(Vec<vk::PhysicalDevice>, Vec<String>)> {
    // SAFETY: plain query.
    let all = match unsafe { instance.raw().enumerate_physical_devices() } {
        // What loaders say where no driver is installed.
        Err(vk::Result::ERROR_INITIALIZATION_FAILED) => Vec::new(),
        result => result.during("list the Vulkan devices")?,
    };
    if all.is_empty() {
        return Err(GpuError::NoDevice);
    }
    // SAFETY: the handles were just listed.
    let properties = |physical| unsafe { instance.raw().get_physical_device_properties(physical) };
    let names = all.iter().map(|&p| device_name(&properties(p))).collect();
    Ok((all, names))
}

/// Says of every device of the computer, in the order of [`DeviceChoice::Index`], its name and,
/// where it cannot be used, why.
pub fn survey() -> Result<Vec<(String, Option<String>)>> {
    let mut host = super::host::Headless;
    let instance = Instance::new(&mut host, super::instance::Validation::Off)?;
    let (all, names) = all_devices(&instance)?;
    let mut devices = Vec::new();
    for (physical, name) in all.into_iter().zip(names) {
        devices.push((name, candidate(&instance, &host, physical)?.err()));
    }
    Ok(devices)
}

fn rank(kind: vk::PhysicalDeviceType) -> u32 {
    match kind {
        vk::PhysicalDeviceType::DISCRETE_GPU => 0,
        vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
        vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
        vk::PhysicalDeviceType::CPU => 3,
        _ => 4,
    }
}

/// The device with the queue family to use, or in words what it lacks.
fn candidate(
    instance: &Instance,
    host: &dyn Host,
    physical: vk::PhysicalDevice,
) -> Result<std::result::Result<Candidate, String>> {
    let raw = instance.raw();
    // SAFETY: plain queries of a device of this instance.
    let (properties, families, extensions) = unsafe {
        (
            raw.get_physical_device_properties(physical),
            raw.get_physical_device_queue_family_properties(physical),
            raw.enumerate_device_extension_properties(physical).during("list device extensions")?,
        )
    };
    let name = device_name(&properties);
    if properties.api_version < vk::API_VERSION_1_3 {
        let version = version_text(properties.api_version);
        return Ok(Err(format!(
            "{name} has Vulkan {version}, version 1.3 is needed (update its driver)"
        )));
    }
    for wanted in host.device_extensions() {
        let has = |e: &vk::ExtensionProperties| {
            e.extension_name_as_c_str().is_ok_and(|n: &CStr| n == wanted)
        };
        if !extensions.iter().any(has) {
            return Ok(Err(format!(
                "{name} lacks the extension {}, which {} needs",
                wanted.to_string_lossy(),
                host.name()
            )));
        }
    }
    if let Some(feature) = missing_feature(instance, physical) {
        return Ok(Err(format!("{name} lacks the feature {feature} (update its driver)")));
    }
    let needed = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    for (index, family) in families.iter().enumerate() {
        let index = index as u32;
        if family.queue_flags.contains(needed) && host.can_show(physical, index)? {
            let time_stamp_bits = family.timestamp_valid_bits;
            return Ok(Ok(Candidate {
                physical,
                properties,
                queue_family: index,
                time_stamp_bits,
            }));
        }
    }
    Ok(Err(format!("{name} has no queue that draws, computes and serves {}", host.name())))
}

fn missing_feature(instance: &Instance, physical: vk::PhysicalDevice) -> Option<&'static str> {
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut features =
        vk::PhysicalDeviceFeatures2::default().push_next(&mut v12).push_next(&mut v13);
    // SAFETY: the chain holds structures that Vulkan 1.3 knows, and lives through the call.
    unsafe { instance.raw().get_physical_device_features2(physical, &mut features) };
    [
        (v12.timeline_semaphore, "timelineSemaphore"),
        (v13.dynamic_rendering, "dynamicRendering"),
        (v13.synchronization2, "synchronization2"),
    ]
    .into_iter()
    .find_map(|(has, name)| (has == vk::FALSE).then_some(name))
}

pub(super) fn device_name(properties: &vk::PhysicalDeviceProperties) -> String {
    properties.device_name_as_c_str().map_or_else(
        |_| "a device without a name".to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_auto_an_index_or_part_of_a_name() {
        assert_eq!(DeviceChoice::parse(" auto "), DeviceChoice::Preferred);
        assert_eq!(DeviceChoice::parse(""), DeviceChoice::Preferred);
        assert_eq!(DeviceChoice::parse("1"), DeviceChoice::Index(1));
        assert_eq!(DeviceChoice::parse("llvm"), DeviceChoice::Name("llvm".to_string()));
    }

    #[test]
    fn hardware_comes_before_software() {
        use vk::PhysicalDeviceType as Kind;
        let mut kinds =
            [Kind::OTHER, Kind::CPU, Kind::DISCRETE_GPU, Kind::VIRTUAL_GPU, Kind::INTEGRATED_GPU];
        kinds.sort_by_key(|&k| rank(k));
        assert_eq!(
            kinds,
            [Kind::DISCRETE_GPU, Kind::INTEGRATED_GPU, Kind::VIRTUAL_GPU, Kind::CPU, Kind::OTHER]
        );
    }
}
