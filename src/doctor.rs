//! Owns `doctor`: what this machine offers to the program, and what to install where something
//! lacks. It only looks; it changes nothing and never fails.

use crate::config::personal_file;
use crate::gpu;
use crate::screen::headset;

/// Prints what the program can use, a line each.
pub fn report() {
    println!("virtual-sculpture {}", env!("CARGO_PKG_VERSION"));
    match personal_file() {
        Some(path) if path.exists() => println!("settings: {}", path.display()),
        Some(path) => println!("settings: the defaults, as {} does not exist", path.display()),
        None => println!("settings: the defaults, as HOME is not set"),
    }
    match std::thread::available_parallelism() {
        Ok(cores) => println!("processor: {cores} threads"),
        Err(error) => println!("processor: unknown ({error})"),
    }
    vulkan();
    gamepads();
    cameras();
    match headset::probe() {
        Ok(runtime) => println!(
            "OpenXR: {} {}{}",
            runtime.name,
            runtime.version,
            if runtime.vulkan { "" } else { ", but it cannot share Vulkan images" }
        ),
        Err(reason) => println!("OpenXR: {reason}"),
    }
}

fn vulkan() {
    match gpu::survey() {
        Ok(devices) => {
            for (index, (name, refused)) in devices.iter().enumerate() {
                match refused {
                    None => println!("Vulkan device {index}: {name}"),
                    Some(reason) => println!("Vulkan device {index}: {reason}"),
                }
            }
        }
        Err(error) => println!("Vulkan: {error}"),
    }
}

#[cfg(target_os = "linux")]
fn cameras() {
    match crate::video::cameras() {
        Ok(cameras) if cameras.is_empty() => println!("cameras: none connected"),
        Ok(cameras) => {
            let name = |camera: &crate::video::CameraInfo| {
                let modes = match &camera.modes {
                    Ok(modes) if modes.is_empty() => " (no format that can be shown)".to_string(),
                    Ok(_) => String::new(),
                    Err(error) => format!(" ({error})"),
                };
                format!("v4l2:{} {}{modes}", camera.device.display(), camera.name)
            };
            println!("cameras: {}", cameras.iter().map(name).collect::<Vec<_>>().join(", "));
        }
        Err(error) => println!("cameras: {error}"),
    }
}

#[cfg(not(target_os = "linux"))]
fn cameras() {
    println!("cameras: only Linux can be asked; name a film or a phone's http:// address");
}

fn gamepads() {
    match gilrs::Gilrs::new() {
        Ok(pads) => {
            let names: Vec<String> = pads.gamepads().map(|(_, pad)| pad.name().into()).collect();
            match names.is_empty() {
                true => println!("gamepads: none connected"),
                false => println!("gamepads: {}", names.join(", ")),
            }
        }
        Err(error) => println!("gamepads: not available ({error})"),
    }
}
