//! Chooses the physical device, and reports why the others cannot be used, including devices with a broken driver.

use std::ffi::CStr;

use ash::{khr, vk};

use super::error::{During, GpuError, Result};
use super::instance::{Host, Instance, version_text};

/// The device to use.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub enum DeviceChoice {
    /// Discrete, then integrated, then virtual, then software.
    #[default]
    Preferred,
    /// The n-th one listed by the loader, from 0.
    Index(usize),
    /// The first usable device whose name contains this, ignoring case.
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

/// A usable device.
pub(super) struct DeviceCandidate {
    pub physical: vk::PhysicalDevice,
    pub properties: vk::PhysicalDeviceProperties,
    pub queue_family: u32,
    /// Device extensions to enable.
    pub extensions: Vec<&'static CStr>,
    /// Number of valid bits of the queue's time stamps; 0 if it has none.
    pub time_stamp_bits: u32,
}

impl DeviceCandidate {
    pub fn name(&self) -> String {
        device_name(&self.properties)
    }
}

/// Returns the usable devices, best first, and for every other device the reason against it.
pub(super) fn candidates(
    instance: &Instance,
    host: &mut dyn Host,
    choice: &DeviceChoice,
) -> Result<(Vec<DeviceCandidate>, Vec<String>)> {
    if let Some(physical) = host.prescribed_device(instance)? {
        let candidate = candidate(instance, host, physical)?.map_err(GpuError::NoneSuitable)?;
        return Ok((vec![candidate], Vec::new()));
    }
    let (all, names) = all_devices(instance)?;
    let wanted: Vec<vk::PhysicalDevice> = match choice {
        DeviceChoice::Preferred => all.clone(),
        DeviceChoice::Index(index) => all.get(*index).copied().into_iter().collect(),
        DeviceChoice::Name(part) => {
            let part = part.to_lowercase();
            let named = std::iter::zip(&all, &names);
            named.filter(|(_, n)| n.to_lowercase().contains(&part)).map(|(&p, _)| p).collect()
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
        match candidate(instance, host, physical) {
            Ok(Ok(candidate)) => usable.push(candidate),
            Ok(Err(reason)) => refused.push(reason),
            Err(error) => refused.push(broken(&name_of(instance, physical), &error)),
        }
    }
    if *choice == DeviceChoice::Preferred {
        usable.sort_by_key(|c| rank(c.properties.device_type));
    }
    Ok((usable, refused))
}

/// Returns the result of `make` for the first candidate for which it succeeds, or an error with the reasons for every
/// candidate and for those in `refused`.
pub(super) fn first_that_works<C, D>(
    usable: Vec<C>,
    mut refused: Vec<String>,
    name: impl Fn(&C) -> String,
    mut make: impl FnMut(C) -> Result<D>,
) -> Result<D> {
    let only = usable.len() == 1 && refused.is_empty();
    for candidate in usable {
        let name = name(&candidate);
        match make(candidate) {
            Ok(made) => return Ok(made),
            // A single candidate's own error is the best message.
            Err(error) if only => return Err(error),
            Err(error) => refused.push(broken(&name, &error)),
        }
    }
    Err(GpuError::NoneSuitable(refused.join("; ")))
}

/// Returns the reason against a device with a failing driver.
fn broken(name: &str, error: &GpuError) -> String {
    let reason = format!("the driver of {name} is broken ({error})");
    tracing::warn!("{reason}; passing it over");
    reason
}

/// Returns every device of the computer with its name, in the loader's order; an error if there is none.
fn all_devices(instance: &Instance) -> Result<(Vec<vk::PhysicalDevice>, Vec<String>)> {
    // SAFETY: plain query.
    let all = match unsafe { instance.raw().enumerate_physical_devices() } {
        // The result of loaders without any installed driver.
        Err(vk::Result::ERROR_INITIALIZATION_FAILED) => Vec::new(),
        result => result.during("list the Vulkan devices")?,
    };
    if all.is_empty() {
        return Err(GpuError::NoDevice);
    }
    let names = all.iter().map(|&physical| name_of(instance, physical)).collect();
    Ok((all, names))
}

fn name_of(instance: &Instance, physical: vk::PhysicalDevice) -> String {
    // SAFETY: a handle of this instance, which was listed.
    device_name(&unsafe { instance.raw().get_physical_device_properties(physical) })
}

/// Returns the version of Vulkan that a device offers, and its driver.
fn driver_of(instance: &Instance, physical: vk::PhysicalDevice) -> String {
    // SAFETY: a handle of this instance, which was listed.
    let properties = unsafe { instance.raw().get_physical_device_properties(physical) };
    let version = version_text(properties.api_version);
    // Older devices do not report the names of drivers.
    if properties.api_version < vk::API_VERSION_1_2 {
        return format!("Vulkan {version}, driver {:#x}", properties.driver_version);
    }
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    // SAFETY: as above; a device of version 1.2 knows the structure, and the instance asks for more.
    unsafe { instance.raw().get_physical_device_properties2(physical, &mut all) };
    let text = |name: std::result::Result<&CStr, std::ffi::FromBytesUntilNulError>| {
        name.map(|name| name.to_string_lossy().into_owned())
    };
    match (text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str())) {
        (Ok(name), Ok(info)) => format!("Vulkan {version}, {name} {info}"),
        _ => format!("Vulkan {version}, driver {:#x}", properties.driver_version),
    }
}

/// Returns the name, version and driver of every device of the computer, in the order of [`DeviceChoice::Index`], with
/// the reason if it cannot be used.
pub fn survey() -> Result<Vec<(String, Option<String>)>> {
    let mut host = super::host::Headless;
    let instance = Instance::new(&mut host, super::instance::Validation::Off)?;
    let (all, names) = all_devices(&instance)?;
    let mut devices = Vec::new();
    for (physical, name) in all.into_iter().zip(names) {
        let fault = match candidate(&instance, &host, physical) {
            Ok(candidate) => candidate.err(),
            Err(error) => Some(broken(&name, &error)),
        };
        let version = driver_of(&instance, physical);
        devices.push((format!("{name} ({version})"), fault));
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

/// Returns the device with the queue family to use, or the missing features in words.
fn candidate(
    instance: &Instance,
    host: &dyn Host,
    physical: vk::PhysicalDevice,
) -> Result<std::result::Result<DeviceCandidate, String>> {
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
    let offered = extensions.iter().filter_map(|e| e.extension_name_as_c_str().ok());
    let extensions = match device_extensions(&host.device_extensions(), offered) {
        Ok(extensions) => extensions,
        Err(lacking) => {
            let (lacking, host) = (lacking.to_string_lossy(), host.name());
            return Ok(Err(format!("{name} lacks the extension {lacking}, which {host} needs")));
        }
    };
    if let Some(feature) = missing_feature(instance, physical) {
        return Ok(Err(format!("{name} lacks the feature {feature} (update its driver)")));
    }
    let needed = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    for (index, family) in families.iter().enumerate() {
        let index = index as u32;
        if family.queue_flags.contains(needed) && host.can_show(physical, index)? {
            let time_stamp_bits = family.timestamp_valid_bits;
            return Ok(Ok(DeviceCandidate {
                physical,
                properties,
                queue_family: index,
                extensions,
                time_stamp_bits,
            }));
        }
    }
    Ok(Err(format!("{name} has no queue that draws, computes and serves {}", host.name())))
}

/// Returns the extensions to enable: all `wanted` ones, or an error naming the missing ones; on a device with an
/// incomplete Vulkan also the portability extension, which must be enabled there.
fn device_extensions<'a>(
    wanted: &[&'static CStr],
    offered: impl Iterator<Item = &'a CStr>,
) -> std::result::Result<Vec<&'static CStr>, &'static CStr> {
    let offered: Vec<&CStr> = offered.collect();
    if let Some(&lacking) = wanted.iter().find(|name| !offered.contains(name)) {
        return Err(lacking);
    }
    let subset = khr::portability_subset::NAME;
    Ok(wanted.iter().copied().chain(offered.contains(&subset).then_some(subset)).collect())
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
    fn a_broken_device_is_passed_over_and_the_next_is_taken() {
        let mut tried = Vec::new();
        let mut make = |name: &'static str| {
            tried.push(name);
            match name {
                "good" => Ok(name),
                _ => Err(GpuError::vulkan("create the device", vk::Result::ERROR_UNKNOWN)),
            }
        };
        let name = |name: &&str| name.to_string();
        let taken = first_that_works(vec!["bad", "good", "best"], Vec::new(), name, &mut make);
        assert_eq!(taken.unwrap(), "good");

        let refused = vec!["old has Vulkan 1.1".to_string()];
        let error = first_that_works(vec!["bad", "worse"], refused, name, &mut make).unwrap_err();
        let said = error.to_string();
        assert!(["old has Vulkan 1.1", "bad", "worse"].iter().all(|n| said.contains(n)), "{said}");
        assert_eq!(tried, ["bad", "good", "bad", "worse"]);

        // A single fault is returned unchanged, so that the caller can match on it.
        let lost = |_| Err::<(), _>(GpuError::DeviceLost("create the device"));
        let error = first_that_works(vec!["one"], Vec::new(), name, lost).unwrap_err();
        assert!(matches!(error, GpuError::DeviceLost(_)));
        let none = first_that_works(Vec::<&str>::new(), vec!["x".to_string()], name, |_| Ok(()));
        assert!(matches!(none, Err(GpuError::NoneSuitable(_))));
    }

    #[test]
    fn a_device_that_lacks_a_part_of_vulkan_is_told_that_this_is_known() {
        let (swapchain, subset) = (khr::swapchain::NAME, khr::portability_subset::NAME);
        let enabled =
            |offered: &[&'static CStr]| device_extensions(&[swapchain], offered.iter().copied());
        assert_eq!(enabled(&[subset, swapchain]), Ok(vec![swapchain, subset]));
        assert_eq!(enabled(&[swapchain]), Ok(vec![swapchain]));
        assert_eq!(enabled(&[subset]), Err(swapchain));
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
