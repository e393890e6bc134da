//! A device that runs out of memory, as a software device does in a process whose memory is limited.
//! The test runs itself again in a process of its own.

use std::process::Command;

use ash::vk;
use egui::epaint::{ImageData, ImageDelta};
use egui::{Color32, ColorImage, TextureId, TextureOptions, TexturesDelta};
use virtual_sculpture::gpu::{Buffer, GpuError, Image, ImageInfo, MemoryLocation};
use virtual_sculpture::render::gui::Gui;

use crate::fixture::with_device;

const INSIDE: &str = "VS_MEMORY_TEST_LIMITED";
const NAME: &str = "memory::where_no_block_fits_there_is_room_for_one_thing_and_a_texture_waits";

/// Limits the address space of this process to so much more than it has, in MiB.
fn limit(more_mib: Option<u64>) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmSize")).unwrap();
    let kib: u64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    let most =
        more_mib.map_or("unlimited".to_owned(), |mib| (kib * 1024 + (mib << 20)).to_string());
    let done = Command::new("prlimit")
        .args(["--pid", &std::process::id().to_string(), &format!("--as={most}:unlimited")])
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
    if std::env::var_os(INSIDE).is_none() {
        let status = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", NAME, "--nocapture", "--test-threads=1"])
            .env(INSIDE, "1")
            .status()
            .unwrap();
        assert!(status.success(), "{status}");
        return;
    }
    with_device(|device| {
        if device.device_name().contains("llvmpipe") {
            run_out(device);
        } else {
            eprintln!("skipped: {} has memory of its own", device.device_name());
        }
    });
}

fn run_out(device: &std::sync::Arc<virtual_sculpture::gpu::Device>) {
    let mut gui = Gui::new(device, vk::Format::R8G8B8A8_UNORM, false).unwrap();
    let mut delta = texture(1024);
    // Less than any block, enough for one image of 16 MiB and what brings a texture over.
    limit(Some(60));
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    let info = ImageInfo::plane("picture", [2048, 2048], vk::Format::R8G8B8A8_UNORM, usage);
    let image = Image::new(device, &info).unwrap();
    let usage = vk::BufferUsageFlags::TRANSFER_SRC;
    let small = Buffer::new(device, "words", 4096, usage, MemoryLocation::CpuToGpu).unwrap();
    // What is too large for all that is left is an error, and one that says what to do.
    let large = Buffer::new(device, "volume", 1 << 30, usage, MemoryLocation::CpuToGpu);
    let error = large.err().unwrap();
    assert!(matches!(error, GpuError::OutOfMemory(_)), "{error}");
    // A texture of the interface waits, and that is said once.
    gui.upload(&mut delta).unwrap();
    let lack = gui.take_lack();
    assert!(matches!(lack, Some(GpuError::OutOfMemory(_))), "{lack:?}");
    gui.upload(&mut TexturesDelta::default()).unwrap();
    assert!(gui.take_lack().is_none());
    limit(None);
    gui.upload(&mut TexturesDelta::default()).unwrap();
    assert!(gui.take_lack().is_none());
    drop((image, small));
}
