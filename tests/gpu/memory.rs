//! A device that runs out of memory: a software device in a process whose memory is limited. The test runs itself again
//! in a process of its own.

use std::sync::Arc;

use ash::vk;
use egui::epaint::{ImageData, ImageDelta};
use egui::{Color32, ColorImage, TextureId, TextureOptions, TexturesDelta};
use trials::Limiter;
use virtual_sculpture::gpu::{
    Buffer, Device, GpuError, Image, ImageInfo, MemoryLocation, run_once,
};
use virtual_sculpture::render::gui::Gui;

use super::fixture::with_device;

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
fn one_thing_fits_without_a_block_and_a_texture_waits() {
    if !trials::alone() {
        return;
    }
    with_device(|device| {
        if !device.device_name().contains("llvmpipe") {
            trials::skip(&format!("{} has memory of its own", device.device_name()));
        }
        let mut limiter = Limiter::start();
        room_for_one(device, &mut limiter);
        a_texture_waits(device, &mut limiter);
    });
}

fn room_for_one(device: &Arc<Device>, limiter: &mut Limiter) {
    // Less than any block, enough for one image of 16 MiB.
    limiter.limit(60);
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    let info = ImageInfo::plane("picture", [2048, 2048], vk::Format::R8G8B8A8_UNORM, usage);
    let image = Image::new(device, &info).unwrap();
    let usage = vk::BufferUsageFlags::TRANSFER_SRC;
    let small = Buffer::new(device, "words", 4096, usage, MemoryLocation::CpuToGpu).unwrap();
    // An allocation that exceeds what is left is an error that says what to do.
    let large = Buffer::new(device, "volume", 1 << 30, usage, MemoryLocation::CpuToGpu);
    limiter.lift();
    let error = large.err().unwrap();
    assert!(matches!(error, GpuError::OutOfMemory(_)), "{error}");
    drop((image, small));
}

/// An interface texture without memory is reported once, and created later.
fn a_texture_waits(device: &Arc<Device>, limiter: &mut Limiter) {
    let mut gui = Gui::new(device, vk::Format::R8G8B8A8_UNORM).unwrap();
    let mut upload = |delta: &mut TexturesDelta| {
        run_once(device, |recorder| gui.upload(recorder, 0, delta)).unwrap();
        gui.take_lack()
    };
    // 64 MiB.
    let mut delta = texture(4096);
    limiter.limit(40);
    let lack = upload(&mut delta);
    let again = upload(&mut TexturesDelta::default());
    limiter.lift();
    assert!(matches!(lack, Some(GpuError::OutOfMemory(_))), "{lack:?}");
    assert!(again.is_none(), "{again:?}");
    assert!(upload(&mut TexturesDelta::default()).is_none());
}
