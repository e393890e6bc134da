//! An OpenXR API layer for tests, controlled by environment variables:
//!
//! - `VS_LAYER_BLEND`: the blend modes to report (`alpha`, `additive`, `opaque`, separated by commas). The
//!   runtime gets all frames as opaque.
//! - `VS_LAYER_LOG`: a file to which blend mode and layers of the frames are written, a line whenever they
//!   change.
//! - `VS_LAYER_OFF`: while this file exists, the headset is taken off: the session stops, and begins again
//!   afterwards ([`lifecycle`]).
//! - `VS_LAYER_SLOW_MS`: milliseconds added to each call of connecting (`xrCreateInstance`,
//!   `xrGetSystem`).
//!
//! Loaded by the OpenXR loader into the program under test. Must not know the program.

use std::ffi::{CStr, c_char};
use std::io::Write as _;
use std::sync::Mutex;
use std::time::Duration;

use openxr_sys as xr;
use xr::pfn;

mod lifecycle;

/// The functions of the next layer, or of the runtime.
#[derive(Clone, Copy)]
struct Next {
    get_instance_proc_addr: pfn::GetInstanceProcAddr,
    end_frame: pfn::EndFrame,
    get_system: pfn::GetSystem,
    session: lifecycle::Calls,
}

static NEXT: Mutex<Option<Next>> = Mutex::new(None);
static LAST_LINE: Mutex<String> = Mutex::new(String::new());

fn next() -> Option<Next> {
    NEXT.lock().ok().and_then(|next| *next)
}

/// The modes to report, the preferred one first.
fn modes() -> Vec<xr::EnvironmentBlendMode> {
    let named = |name: &str| match name {
        "alpha" => Some(xr::EnvironmentBlendMode::ALPHA_BLEND),
        "additive" => Some(xr::EnvironmentBlendMode::ADDITIVE),
        "opaque" => Some(xr::EnvironmentBlendMode::OPAQUE),
        _ => None,
    };
    let text = std::env::var("VS_LAYER_BLEND").unwrap_or_default();
    text.split(',').filter_map(named).collect()
}

/// Waits as long as `VS_LAYER_SLOW_MS` says.
fn delay() {
    let slow = std::env::var("VS_LAYER_SLOW_MS").ok().and_then(|text| text.parse().ok());
    std::thread::sleep(Duration::from_millis(slow.unwrap_or(0)));
}

unsafe extern "system" fn get_system(
    instance: xr::Instance,
    info: *const xr::SystemGetInfo,
    system: *mut xr::SystemId,
) -> xr::Result {
    let Some(next) = next() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    delay();
    // SAFETY: passed on as it came.
    unsafe { (next.get_system)(instance, info, system) }
}

/// Writes a line, unless it equals the last one.
fn log(line: String) {
    let (Ok(mut last), Some(path)) = (LAST_LINE.lock(), std::env::var_os("VS_LAYER_LOG")) else {
        return;
    };
    if *last != line {
        let file = std::fs::File::options().create(true).append(true).open(path);
        if let Err(error) = file.and_then(|mut file| writeln!(file, "{line}")) {
            eprintln!("the layer cannot write: {error}");
        }
        *last = line;
    }
}

unsafe extern "system" fn enumerate_blend_modes(
    _instance: xr::Instance,
    _system: xr::SystemId,
    _views: xr::ViewConfigurationType,
    capacity: u32,
    count: *mut u32,
    into: *mut xr::EnvironmentBlendMode,
) -> xr::Result {
    let modes = modes();
    // SAFETY: the caller gives a place for the count.
    unsafe { *count = modes.len() as u32 };
    if capacity == 0 {
        return xr::Result::SUCCESS;
    }
    if (capacity as usize) < modes.len() {
        return xr::Result::ERROR_SIZE_INSUFFICIENT;
    }
    // SAFETY: the caller gives room for `capacity` modes, which is enough.
    unsafe { std::ptr::copy_nonoverlapping(modes.as_ptr(), into, modes.len()) };
    xr::Result::SUCCESS
}

unsafe extern "system" fn end_frame(
    session: xr::Session,
    info: *const xr::FrameEndInfo,
) -> xr::Result {
    let Some(next) = next() else { return xr::Result::ERROR_RUNTIME_FAILURE };
    // SAFETY: the caller gives a frame.
    let info = unsafe { &*info };
    let mode = match info.environment_blend_mode {
        xr::EnvironmentBlendMode::ALPHA_BLEND => "alpha",
        xr::EnvironmentBlendMode::ADDITIVE => "additive",
        xr::EnvironmentBlendMode::OPAQUE => "opaque",
        _ => "unknown",
    };
    let mut line = mode.to_owned();
    for i in 0..info.layer_count as usize {
        // SAFETY: the frame has as many layers, and each begins with this header.
        let layer = unsafe { &**info.layers.add(i) };
        line.push_str(match layer.ty {
            xr::StructureType::COMPOSITION_LAYER_PROJECTION => " projection",
            xr::StructureType::COMPOSITION_LAYER_QUAD => " quad",
            _ => " other",
        });
        use xr::CompositionLayerFlags as Flags;
        for (flag, name) in [
            (Flags::BLEND_TEXTURE_SOURCE_ALPHA, "+alpha"),
            (Flags::UNPREMULTIPLIED_ALPHA, "+unpremultiplied"),
        ] {
            if layer.layer_flags.contains(flag) {
                line.push_str(name);
            }
        }
    }
    log(line);
    let passed =
        xr::FrameEndInfo { environment_blend_mode: xr::EnvironmentBlendMode::OPAQUE, ..*info };
    // SAFETY: the function is that of the next layer, and all that the frame points to is alive.
    unsafe { (next.end_frame)(session, &passed) }
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: xr::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> xr::Result {
    // SAFETY: the caller gives a text that ends with 0.
    let own = match unsafe { CStr::from_ptr(name) }.to_bytes() {
        b"xrEnumerateEnvironmentBlendModes" => {
            let own: pfn::EnumerateEnvironmentBlendModes = enumerate_blend_modes;
            // SAFETY: the caller knows by the name which type the function has.
            Some(unsafe {
                std::mem::transmute::<pfn::EnumerateEnvironmentBlendModes, pfn::VoidFunction>(own)
            })
        }
        b"xrEndFrame" => {
            let own: pfn::EndFrame = end_frame;
            // SAFETY: as above.
            Some(unsafe { std::mem::transmute::<pfn::EndFrame, pfn::VoidFunction>(own) })
        }
        b"xrGetSystem" => {
            let own: pfn::GetSystem = get_system;
            // SAFETY: as above.
            Some(unsafe { std::mem::transmute::<pfn::GetSystem, pfn::VoidFunction>(own) })
        }
        name => lifecycle::own(name),
    };
    if own.is_some() {
        // SAFETY: the caller gives a place for the function.
        unsafe { *function = own };
        return xr::Result::SUCCESS;
    }
    match next() {
        // SAFETY: passed on as it came.
        Some(next) => unsafe { (next.get_instance_proc_addr)(instance, name, function) },
        None => xr::Result::ERROR_HANDLE_INVALID,
    }
}

unsafe extern "system" fn create_instance(
    info: *const xr::InstanceCreateInfo,
    layer: *const xr::ApiLayerCreateInfo,
    instance: *mut xr::Instance,
) -> xr::Result {
    // SAFETY: the loader gives both structures and what they point to.
    let (layer, link) = unsafe { (&*layer, &*(*layer).next_info) };
    let (Some(create), Some(get)) =
        (link.next_create_api_layer_instance, link.next_get_instance_proc_addr)
    else {
        return xr::Result::ERROR_INITIALIZATION_FAILED;
    };
    delay();
    let below = xr::ApiLayerCreateInfo { next_info: link.next, ..*layer };
    // SAFETY: the function is that of the next layer, whose link is the next one.
    let made = unsafe { create(info, &below, instance) };
    if made != xr::Result::SUCCESS {
        return made;
    }
    let function = |name: &CStr| {
        let mut found: Option<pfn::VoidFunction> = None;
        // SAFETY: the instance has just been made; the name ends with 0.
        let result = unsafe { get(*instance, name.as_ptr(), &mut found) };
        found.filter(|_| result == xr::Result::SUCCESS)
    };
    let (Some(end), Some(system), Some(session)) =
        (function(c"xrEndFrame"), function(c"xrGetSystem"), lifecycle::Calls::find(&function))
    else {
        return xr::Result::ERROR_INITIALIZATION_FAILED;
    };
    // SAFETY: the names say which types the functions have.
    let (end_frame, get_system) = unsafe {
        (
            std::mem::transmute::<pfn::VoidFunction, pfn::EndFrame>(end),
            std::mem::transmute::<pfn::VoidFunction, pfn::GetSystem>(system),
        )
    };
    if let Ok(mut next) = NEXT.lock() {
        *next = Some(Next { get_instance_proc_addr: get, end_frame, get_system, session });
    }
    xr::Result::SUCCESS
}

/// The entry point, called first by the loader.
///
/// # Safety
///
/// The loader gives structures of the types that it says.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn xrNegotiateLoaderApiLayerInterface(
    loader: *const xr::NegotiateLoaderInfo,
    _name: *const c_char,
    request: *mut xr::NegotiateApiLayerRequest,
) -> xr::Result {
    // SAFETY: see above.
    let (loader, request) = unsafe { (&*loader, &mut *request) };
    if loader.struct_type != xr::NegotiateLoaderInfo::TYPE
        || request.struct_type != xr::NegotiateApiLayerRequest::TYPE
        || loader.min_interface_version > INTERFACE
        || loader.max_interface_version < INTERFACE
    {
        return xr::Result::ERROR_INITIALIZATION_FAILED;
    }
    request.layer_interface_version = INTERFACE;
    request.layer_api_version = xr::Version::new(1, 0, 0);
    request.get_instance_proc_addr = Some(get_instance_proc_addr);
    request.create_api_layer_instance = Some(create_instance);
    xr::Result::SUCCESS
}

/// Version of the interface between loader and layers.
const INTERFACE: u32 = 1;
