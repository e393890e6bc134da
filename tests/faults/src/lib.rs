//! A Vulkan layer for tests that makes calls fail. The file `VS_FAULTS` is read at every call; its lines are
//! `CALL CODE [BYTES]`:
//!
//! - `allocate`, `swapchain`, `acquire`, `present` return this result (`VkResult`); allocations only from so
//!   many bytes on. Presents are passed on all the same, since their semaphores must be waited for.
//! - `fifo 0`: surfaces report FIFO as their only present mode.
//! - `storage 0 BYTES`: storage buffers have no larger range, in the limits of every device.
//!
//! Loaded by the Vulkan loader into the program under test, which it must not know.

use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::ptr::null;
use std::sync::Mutex;

use ash::vk::{self, Handle as _};

type Function = vk::PFN_vkVoidFunction;

/// The loader's structure for the chain of layers (vk_layer.h), the same for instances and devices except
/// for the functions.
#[repr(C)]
struct Chain {
    s_type: vk::StructureType,
    next: *const Chain,
    function: u32,
    link: *const Link,
}

#[repr(C)]
struct Link {
    next: *const Link,
    instance: vk::PFN_vkGetInstanceProcAddr,
    /// In the link of a device only; that of an instance has another function here.
    device: vk::PFN_vkGetDeviceProcAddr,
}

const INSTANCE_CHAIN: i32 = 47;
const DEVICE_CHAIN: i32 = 48;

/// Finds functions of the layer below.
#[derive(Clone, Copy)]
enum Below {
    Instance(vk::PFN_vkGetInstanceProcAddr, vk::Instance),
    Device(vk::PFN_vkGetDeviceProcAddr, vk::Device),
}

/// The function that returns the properties of devices, by the table of their instance: the loader finds it for us only while the
/// instance is created, and afterwards gives our own.
static PROPERTIES: Mutex<BTreeMap<usize, vk::PFN_vkGetPhysicalDeviceProperties>> =
    Mutex::new(BTreeMap::new());

/// By the dispatch table that the loader puts into each object: all objects of a device share one.
static BELOW: Mutex<BTreeMap<usize, Below>> = Mutex::new(BTreeMap::new());

fn table(object: u64) -> usize {
    // SAFETY: an object that can be called with begins with the pointer to its table.
    unsafe { *(object as *const usize) }
}

/// A function of the layer below for a dispatchable object.
fn below(object: u64, name: &CStr) -> Function {
    let below = BELOW.lock().ok().and_then(|below| below.get(&table(object)).copied());
    // SAFETY: the functions are of the layer below, the handles of its instance and device.
    unsafe {
        match below? {
            Below::Instance(find, instance) => find(instance, name.as_ptr()),
            Below::Device(find, device) => find(device, name.as_ptr()),
        }
    }
}

/// The result with which a call is to fail, and the smallest size in bytes.
fn fault(call: &str) -> Option<(vk::Result, u64)> {
    let text = std::fs::read_to_string(std::env::var_os("VS_FAULTS")?).ok()?;
    text.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        if words.next()? != call {
            return None;
        }
        let code = words.next()?.parse().ok()?;
        let bytes = words.next().map_or(Some(0), |word| word.parse().ok())?;
        Some((vk::Result::from_raw(code), bytes))
    })
}

/// Defines a function of the layer: it runs `$first`, which may return a result, and then calls the layer
/// below.
macro_rules! intercept {
    ($own:ident, $name:literal, ($object:ident: $of:ty $(, $argument:ident: $kind:ty)*), $first:expr) => {
        unsafe extern "system" fn $own($object: $of $(, $argument: $kind)*) -> vk::Result {
            if let Some(result) = $first {
                return result;
            }
            type Kind = unsafe extern "system" fn($of $(, $kind)*) -> vk::Result;
            match below($object.as_raw(), $name) {
                // SAFETY: the name says which type the function has; what comes is passed on.
                Some(found) => unsafe {
                    transmute::<unsafe extern "system" fn(), Kind>(found)($object $(, $argument)*)
                },
                None => vk::Result::ERROR_INITIALIZATION_FAILED,
            }
        }
    };
}

intercept!(
    allocate,
    c"vkAllocateMemory",
    (
        device: vk::Device,
        info: *const vk::MemoryAllocateInfo,
        callbacks: *const vk::AllocationCallbacks,
        memory: *mut vk::DeviceMemory
    ),
    // SAFETY: the caller gives an info.
    fault("allocate").filter(|fault| unsafe { (*info).allocation_size } >= fault.1).map(|f| f.0)
);

intercept!(
    swapchain,
    c"vkCreateSwapchainKHR",
    (
        device: vk::Device,
        info: *const vk::SwapchainCreateInfoKHR,
        callbacks: *const vk::AllocationCallbacks,
        made: *mut vk::SwapchainKHR
    ),
    fault("swapchain").map(|fault| fault.0)
);

intercept!(
    acquire,
    c"vkAcquireNextImageKHR",
    (
        device: vk::Device,
        chain: vk::SwapchainKHR,
        timeout: u64,
        semaphore: vk::Semaphore,
        fence: vk::Fence,
        index: *mut u32
    ),
    fault("acquire").map(|fault| fault.0)
);

intercept!(
    present_below,
    c"vkQueuePresentKHR",
    (queue: vk::Queue, info: *const vk::PresentInfoKHR),
    None
);

unsafe extern "system" fn present(queue: vk::Queue, info: *const vk::PresentInfoKHR) -> vk::Result {
    // SAFETY: passed on as it came.
    let given = unsafe { present_below(queue, info) };
    fault("present").map_or(given, |fault| fault.0)
}

intercept!(
    present_modes,
    c"vkGetPhysicalDeviceSurfacePresentModesKHR",
    (
        physical: vk::PhysicalDevice,
        surface: vk::SurfaceKHR,
        count: *mut u32,
        modes: *mut vk::PresentModeKHR
    ),
    fault("fifo").map(|_| {
        // SAFETY: the caller gives a place for the count, and for as many modes if for any.
        unsafe {
            if !modes.is_null() && *count > 0 {
                *modes = vk::PresentModeKHR::FIFO;
            }
            *count = 1;
        }
        vk::Result::SUCCESS
    })
);

unsafe extern "system" fn properties(
    physical: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties,
) {
    let found = PROPERTIES.lock().ok().and_then(|p| p.get(&table(physical.as_raw())).copied());
    let Some(found) = found else { return };
    // SAFETY: what comes is passed on, and the caller gives a place for the properties.
    unsafe {
        found(physical, properties);
        if let Some((_, bytes)) = fault("storage") {
            let range = &mut (*properties).limits.max_storage_buffer_range;
            *range = u64::from(*range).min(bytes) as u32;
        }
    }
}

intercept!(
    create_device_below,
    c"vkCreateDevice",
    (
        physical: vk::PhysicalDevice,
        info: *const vk::DeviceCreateInfo,
        callbacks: *const vk::AllocationCallbacks,
        device: *mut vk::Device
    ),
    None
);

/// Takes the layer's link out of the chain of a create info.
///
/// # Safety
///
/// `next` must begin the chain of structures that the loader gives.
unsafe fn take_link(next: *const c_void, kind: i32) -> Option<&'static Link> {
    let mut at = next.cast::<Chain>().cast_mut();
    // SAFETY: see above; the loader wants the link to be moved on for the layer below.
    unsafe {
        while !at.is_null() {
            if (*at).s_type.as_raw() == kind && (*at).function == 0 {
                let link = (*at).link;
                (*at).link = (*link).next;
                return Some(&*link);
            }
            at = (*at).next.cast_mut();
        }
    }
    None
}

unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo,
    callbacks: *const vk::AllocationCallbacks,
    instance: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: the loader gives these; the functions are of the layer below.
    unsafe {
        let Some(link) = take_link((*info).p_next, INSTANCE_CHAIN) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let Some(create) = (link.instance)(vk::Instance::null(), c"vkCreateInstance".as_ptr())
        else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let create: vk::PFN_vkCreateInstance = transmute(create);
        let result = create(info, callbacks, instance);
        if let (vk::Result::SUCCESS, Ok(mut below)) = (result, BELOW.lock()) {
            let table = table((*instance).as_raw());
            below.insert(table, Below::Instance(link.instance, *instance));
            let found = (link.instance)(*instance, c"vkGetPhysicalDeviceProperties".as_ptr());
            if let (Some(found), Ok(mut properties)) = (found, PROPERTIES.lock()) {
                let kind =
                    transmute::<unsafe extern "system" fn(), vk::PFN_vkGetPhysicalDeviceProperties>;
                properties.insert(table, kind(found));
            }
        }
        result
    }
}

unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo,
    callbacks: *const vk::AllocationCallbacks,
    device: *mut vk::Device,
) -> vk::Result {
    // SAFETY: the loader gives these.
    let Some(link) = (unsafe { take_link((*info).p_next, DEVICE_CHAIN) }) else {
        return vk::Result::ERROR_INITIALIZATION_FAILED;
    };
    // SAFETY: passed on as it came.
    let made = unsafe { create_device_below(physical, info, callbacks, device) };
    if let (vk::Result::SUCCESS, Ok(mut below)) = (made, BELOW.lock()) {
        // SAFETY: just made.
        let device = unsafe { *device };
        below.insert(table(device.as_raw()), Below::Device(link.device, device));
    }
    made
}

/// The layer's function with this name.
fn own(name: &[u8]) -> Function {
    macro_rules! function {
        ($function:expr, $kind:ty) => {
            // SAFETY: the caller knows by the name which type the function has.
            Some(unsafe { transmute::<$kind, unsafe extern "system" fn()>($function) })
        };
    }
    match name {
        b"vkGetInstanceProcAddr" => function!(instance_function, vk::PFN_vkGetInstanceProcAddr),
        b"vkGetDeviceProcAddr" => function!(device_function, vk::PFN_vkGetDeviceProcAddr),
        b"vkCreateInstance" => function!(create_instance, vk::PFN_vkCreateInstance),
        b"vkCreateDevice" => function!(create_device, vk::PFN_vkCreateDevice),
        b"vkAllocateMemory" => function!(allocate, vk::PFN_vkAllocateMemory),
        b"vkCreateSwapchainKHR" => function!(swapchain, vk::PFN_vkCreateSwapchainKHR),
        b"vkAcquireNextImageKHR" => function!(acquire, vk::PFN_vkAcquireNextImageKHR),
        b"vkQueuePresentKHR" => function!(present, vk::PFN_vkQueuePresentKHR),
        b"vkGetPhysicalDeviceProperties" => {
            function!(properties, vk::PFN_vkGetPhysicalDeviceProperties)
        }
        b"vkGetPhysicalDeviceSurfacePresentModesKHR" => {
            function!(present_modes, vk::PFN_vkGetPhysicalDeviceSurfacePresentModesKHR)
        }
        _ => None,
    }
}

/// The layer's function, unless the layer below is known not to have it.
fn find(object: u64, name: *const c_char) -> Function {
    // SAFETY: the caller gives a text that ends with 0.
    let name = unsafe { CStr::from_ptr(name) };
    let own = own(name.to_bytes());
    // While an instance is created, the loader queries with an object of its own.
    if object == 0 || name == c"vkCreateInstance" {
        return own;
    }
    let found = below(object, name);
    own.filter(|_| found.is_some()).or(found)
}

unsafe extern "system" fn instance_function(
    instance: vk::Instance,
    name: *const c_char,
) -> Function {
    find(instance.as_raw(), name)
}

unsafe extern "system" fn device_function(device: vk::Device, name: *const c_char) -> Function {
    find(device.as_raw(), name)
}

/// The interface between loader and layer (vk_layer.h).
#[repr(C)]
pub struct Negotiation {
    kind: u32,
    next: *mut c_void,
    version: u32,
    instance: Option<vk::PFN_vkGetInstanceProcAddr>,
    device: Option<vk::PFN_vkGetDeviceProcAddr>,
    physical: *const c_void,
}

/// The entry point, called first by the loader.
///
/// # Safety
///
/// The loader gives a structure of this type.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    with: *mut Negotiation,
) -> vk::Result {
    // SAFETY: see above.
    let with = unsafe { &mut *with };
    with.version = with.version.min(2);
    with.instance = Some(instance_function);
    with.device = Some(device_function);
    with.physical = null();
    vk::Result::SUCCESS
}
