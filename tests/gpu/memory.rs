//! A device that runs out of memory: a software device in a process whose memory is limited. The test runs itself again
//! in a process of its own.

use std::process::Command;
use std::sync::Arc;

use ash::vk;
use egui::epaint::{ImageData, ImageDelta};
use egui::{Color32, ColorImage, TextureId, TextureOptions, TexturesDelta};
use virtual_sculpture::gpu::{
    Buffer, Device, GpuError, Image, ImageInfo, MemoryLocation, run_once,
};
use virtual_sculpture::render::gui::Gui;

use super::fixture::with_device;

/// Limits the address space of this process to this much more than it uses, in MiB.
fn limit(more_mib: Option<u64>) {
    let Some(mib) = more_mib else { return set_limit("unlimited") };
    // A thread of the driver that has just started reserves 64 MiB for its heap. If it does so after the size was read,
    // nothing is left: the limit is right once the size has not changed around it.
    loop {
        let used_kib = address_space_kib();
        set_limit(&(used_kib * 1024 + (mib << 20)).to_string());
        if address_space_kib() == used_kib {
            return;
        }
        set_limit("unlimited");
    }
}

fn address_space_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmSize")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

fn set_limit(bytes: &str) {
    let done = Command::new("prlimit")
        .args(["--pid", &std::process::id().to_string(), &format!("--as={bytes}:unlimited")])
        .status()
        .unwrap();
    assert!(done.success());
}

fn texture(side: usize) -> TexturesDelta {
    let image = ColorImage::filled([side, side], Color32::RED);
    let image = ImageDelta {
        image: ImageData::Color(image.into()),
        options: TextureOptions::LINEAR,
        pos: None,
    };
    let mut delta = TexturesDelta::default();
    delta.set.entry(TextureId::Managed(1)).or_default().push(image);
    delta
}

#[test]
fn where_no_block_fits_there_is_room_for_one_thing_and_a_texture_waits() {
    if !trials::alone() {
        return;
    }
    with_device(|device| {
        if !device.device_name().contains("llvmpipe") {
            trials::skip(&format!("{} has memory of its own", device.device_name()));
        }
        room_for_one(device);
        a_texture_waits(device);
    });
}

fn room_for_one(device: &Arc<Device>) {
    // Less than any block, enough for one image of 16 MiB.
    limit(Some(60));
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    let info = ImageInfo::plane("picture", [2048, 2048], vk::Format::R8G8B8A8_UNORM, usage);
    let image = Image::new(device, &info).unwrap();
    let usage = vk::BufferUsageFlags::TRANSFER_SRC;
    let small = Buffer::new(device, "words", 4096, usage, MemoryLocation::CpuToGpu).unwrap();
    // An allocation that exceeds what is left is an error that says what to do.
    let large = Buffer::new(device, "volume", 1 << 30, usage, MemoryLocation::CpuToGpu);
    limit(None);
    let error = large.err().unwrap();
    assert!(matches!(error, GpuError::OutOfMemory(_)), "{error}");
    drop((image, small));
}

/// An interface texture without memory is reported once, and created later.
fn a_texture_waits(device: &Arc<Device>) {
    let mut gui = Gui::new(device, vk::Format::R8G8B8A8_UNORM).unwrap();
    let mut upload = |delta: &mut TexturesDelta| {
        run_once(device, |recorder| gui.upload(recorder, 0, delta)).unwrap();
        gui.take_lack()
    };
    // 64 MiB.
    let mut delta = texture(4096);
    limit(Some(40));
    let lack = upload(&mut delta);
    let again = upload(&mut TexturesDelta::default());
    limit(None);
    assert!(matches!(lack, Some(GpuError::OutOfMemory(_))), "{lack:?}");
    assert!(again.is_none(), "{again:?}");
    assert!(upload(&mut TexturesDelta::default()).is_none());
}
