//! The job `doctor`: reports what this machine offers, and what to install if something is missing.
//! It changes nothing and never fails.

use crate::folders::personal_file;
use crate::gpu;
use crate::screen::headset;

/// A line for each thing that the program can use.
pub fn report() -> String {
    let mut lines = vec![format!("virtual-sculpture {}", env!("CARGO_PKG_VERSION"))];
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
