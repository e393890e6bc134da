//! The job `doctor`: reports the abilities of this machine, and what to install if something is missing. It changes
//! nothing and never fails.

use crate::folders::{self, personal_file};
use crate::gpu;
use crate::screen::{headset, pen};

/// Returns the facts for every bug report: the program, the system and the folders, one line each.
pub fn system() -> Vec<String> {
    vec![
        format!(
            "virtual-sculpture {} (commit {})",
            env!("CARGO_PKG_VERSION"),
            env!("VIRTUAL_SCULPTURE_COMMIT")
        ),
        format!("system: {}", operating_system()),
        format!("session: {}", graphical_session()),
        format!("memory: {}", memory()),
        format!("state: {}", folders::state_folder().display()),
        format!("journals: {}", folders::journal_folder().display()),
    ]
}

fn operating_system() -> String {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let name = ["/etc/os-release", "/usr/lib/os-release"].iter().find_map(|path| {
        let text = read(path)?;
        let name = text.lines().find_map(|line| line.strip_prefix("PRETTY_NAME="))?;
        Some(name.trim_matches('"').to_owned())
    });
    let kernel = read("/proc/sys/kernel/osrelease").map(|text| text.trim().to_owned());
    let name = name.unwrap_or_else(|| std::env::consts::OS.to_owned());
    let kernel = kernel.map_or_else(String::new, |kernel| format!(", kernel {kernel}"));
    format!("{name}{kernel}, {}", std::env::consts::ARCH)
}

/// Returns Wayland, X11 or none, by the environment variables.
fn graphical_session() -> String {
    if !cfg!(target_os = "linux") {
        return "that of the system".to_owned();
    }
    let names = ["WAYLAND_DISPLAY", "DISPLAY", "XDG_SESSION_TYPE", "XDG_CURRENT_DESKTOP"];
    let value = |name| std::env::var(name).ok().filter(|value| !value.is_empty());
    let set: Vec<String> =
        names.into_iter().filter_map(|name| Some(format!("{name}={}", value(name)?))).collect();
    let kind = match (value("WAYLAND_DISPLAY"), value("DISPLAY")) {
        (Some(_), _) => "Wayland",
        (None, Some(_)) => "X11",
        (None, None) => "none",
    };
    if set.is_empty() { kind.to_owned() } else { format!("{kind} ({})", set.join(", ")) }
}

fn memory() -> String {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let mib = |name: &str| {
        let kib = text.lines().find_map(|line| line.strip_prefix(name))?;
        kib.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib / 1024)
    };
    match (mib("MemTotal:"), mib("MemAvailable:")) {
        (Some(total), Some(free)) => format!("{total} MiB, {free} MiB available"),
        _ => "unknown".to_owned(),
    }
}

/// Returns a line for each thing that the program can use.
pub fn report() -> String {
    let mut lines = system();
    lines.push(match personal_file() {
        Some(path) if path.exists() => format!("settings: {}", path.display()),
        Some(path) => format!("settings: defaults ({} does not exist)", path.display()),
        None => "settings: the defaults, as there is no home folder".to_string(),
    });
    lines.push(match std::thread::available_parallelism() {
        Ok(cores) => format!("processor: {cores} threads"),
        Err(error) => format!("processor: unknown ({error})"),
    });
    lines.extend(vulkan());
    lines.push(gamepads());
    lines.push(format!("pens: {}", pen::survey()));
    lines.push(cameras());
    lines.push(match headset::probe() {
        Ok(runtime) => format!(
            "OpenXR: {} {}{}",
            runtime.name,
            runtime.version,
            if runtime.vulkan { "" } else { ", but it cannot share Vulkan images" }
        ),
        Err(reason) => format!("OpenXR: {reason}"),
    });
    lines.join("\n")
}

fn vulkan() -> Vec<String> {
    match gpu::survey() {
        Ok(devices) => devices
            .into_iter()
            .enumerate()
            .map(|(index, (name, refused))| match refused {
                None => format!("Vulkan device {index}: {name}"),
                Some(reason) => format!("Vulkan device {index}: {reason}"),
            })
            .collect(),
        Err(error) => vec![format!("Vulkan: {error}")],
    }
}

#[cfg(target_os = "linux")]
fn cameras() -> String {
    match crate::video::cameras() {
        Ok(cameras) if cameras.is_empty() => "cameras: none connected".to_string(),
        Ok(cameras) => {
            let name = |camera: &crate::video::CameraInfo| {
                let modes = match &camera.modes {
                    Ok(modes) if modes.is_empty() => " (no supported format)".to_string(),
                    Ok(_) => String::new(),
                    Err(error) => format!(" ({error})"),
                };
                format!("v4l2:{} {}{modes}", camera.device.display(), camera.name)
            };
            format!("cameras: {}", cameras.iter().map(name).collect::<Vec<_>>().join(", "))
        }
        Err(error) => format!("cameras: {error}"),
    }
}

#[cfg(not(target_os = "linux"))]
fn cameras() -> String {
    "cameras: can only be listed on Linux; use a video file or a phone's http:// address"
        .to_string()
}

fn gamepads() -> String {
    match gilrs::Gilrs::new() {
        Ok(pads) => {
            let names: Vec<String> = pads.gamepads().map(|(_, pad)| pad.name().into()).collect();
            match names.is_empty() {
                true => "gamepads: none connected".to_string(),
                false => format!("gamepads: {}", names.join(", ")),
            }
        }
        Err(error) => format!("gamepads: not available ({error})"),
    }
}
