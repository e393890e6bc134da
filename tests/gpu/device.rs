//! The device, its memory and its frames; and the messages if there is none.

use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use ash::vk;
use virtual_sculpture::gpu::{
    Attachment, Device, DeviceChoice, DeviceOptions, FRAMES_IN_FLIGHT, Frames, GpuError, Headless,
    Image, ImageInfo, Load, Readback, ResourceUse, Staging, Validation, read_image_once, run_once,
};

use virtual_sculpture::render::Renderer;

use super::fixture::{need_device, with_device};

const COLOUR: vk::ImageUsageFlags = vk::ImageUsageFlags::from_raw(
    vk::ImageUsageFlags::COLOR_ATTACHMENT.as_raw()
        | vk::ImageUsageFlags::TRANSFER_SRC.as_raw()
        | vk::ImageUsageFlags::TRANSFER_DST.as_raw(),
);

#[test]
fn frames_draw_and_read_back_in_a_pipeline() {
    with_device(|device| {
        let info = ImageInfo::plane("target", [5, 3], vk::Format::R8G8B8A8_UNORM, COLOUR);
        let target = Image::new(device, &info).unwrap();
        let mut frames = Frames::new(device).unwrap();
        let mut readback = Readback::new(device, "picture");
        let mut before = ResourceUse::NOTHING;
        for frame in 0..5usize {
            let mut recorder = frames.begin().unwrap();
            let slot = frames.slot();
            if frame >= FRAMES_IN_FLIGHT {
                // The last picture of this slot can be read now.
                let earlier = (frame - FRAMES_IN_FLIGHT) as u8;
                assert_eq!(readback.wait(slot).unwrap(), [51 * earlier; 5 * 3 * 4]);
            }
            let part = target.whole();
            recorder.image_barrier(part, before.discarded(), ResourceUse::COLOUR_TARGET);
            let grey = Load::Colour([frame as f32 * 0.2; 4]);
            let colour = Attachment { view: target.view(), load: grey, store: true };
            recorder.begin_rendering([5, 3], Some(colour), None);
            recorder.end_rendering();
            recorder.image_barrier(part, ResourceUse::COLOUR_TARGET, ResourceUse::COPY_SOURCE);
            readback.record(&mut recorder, slot, part, target.size(), 4).unwrap();
            before = ResourceUse::COPY_SOURCE;
            let serial = frames.submit(recorder, &[], &[]).unwrap();
            readback.submitted(slot, serial);
        }
    });
}

/// Each rendering clears what the previous one has drawn; only a barrier that waits for its writes orders the two.
/// Synchronization validation (tests/drivers.sh) complains if there is none.
#[test]
fn a_depth_buffer_is_cleared_after_the_drawing_before_has_written_it() {
    with_device(|device| {
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let depth = vk::Format::D32_SFLOAT;
        let target = Image::new(device, &ImageInfo::plane("depth", [9, 7], depth, usage)).unwrap();
        let mut frames = Frames::new(device).unwrap();
        let mut before = ResourceUse::NOTHING;
        for _ in 0..3 {
            let mut recorder = frames.begin().unwrap();
            for nearest in [0.25, 0.5] {
                recorder.image_barrier(
                    target.whole(),
                    before.discarded(),
                    ResourceUse::DEPTH_TARGET,
                );
                let load = Load::Depth(nearest);
                let depth = Attachment { view: target.view(), load, store: true };
                recorder.begin_rendering([9, 7], None, Some(depth));
                recorder.end_rendering();
                before = ResourceUse::DEPTH_TARGET;
            }
            frames.submit(recorder, &[], &[]).unwrap();
        }
    });
    let written = vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE;
    assert!(ResourceUse::DEPTH_TARGET.discarded().access.contains(written));
    assert_eq!(ResourceUse::DEPTH_TARGET.discarded().layout, vk::ImageLayout::UNDEFINED);
}

#[test]
fn each_layer_is_a_picture_of_its_own() {
    with_device(|device| {
        let plane = ImageInfo::plane("eyes", [2, 2], vk::Format::R32_UINT, COLOUR);
        let eyes = Image::new(device, &ImageInfo { layers: 2, ..plane }).unwrap();
        run_once(device, |recorder| {
            recorder.image_barrier(eyes.whole(), ResourceUse::NOTHING, ResourceUse::COLOUR_TARGET);
            for eye in 0..2 {
                let load = Load::Integers([7 + eye; 4]);
                let colour = Attachment { view: eyes.layer_view(eye), load, store: true };
                recorder.begin_rendering([2, 2], Some(colour), None);
                recorder.end_rendering();
            }
            Ok(())
        })
        .unwrap();
        for eye in 0..2 {
            let bytes =
                read_image_once(device, eyes.layer(eye), [2, 2, 1], 4, ResourceUse::COLOUR_TARGET)
                    .unwrap();
            assert_eq!(bytemuck::pod_collect_to_vec::<u8, u32>(&bytes), [7 + eye; 4]);
        }
    });
}

#[test]
fn staging_grows_and_what_was_pushed_stays() {
    with_device(|device| {
        let info = ImageInfo::plane("target", [64, 1], vk::Format::R32_UINT, COLOUR);
        let target = Image::new(device, &info).unwrap();
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let mut staging = Staging::new(device, "staging", usage, 64).unwrap();
        run_once(device, |recorder| {
            recorder.image_barrier(target.whole(), ResourceUse::NOTHING, ResourceUse::COPY_TARGET);
            for x in 0..64u32 {
                let piece = staging.push(&[1000 + x], 4)?;
                let copy = vk::BufferImageCopy::default()
                    .buffer_offset(piece.offset)
                    .image_subresource(vk::ImageSubresourceLayers {
                        aspect_mask: vk::ImageAspectFlags::COLOR,
                        layer_count: 1,
                        ..Default::default()
                    })
                    .image_offset(vk::Offset3D { x: x as i32, y: 0, z: 0 })
                    .image_extent(vk::Extent3D { width: 1, height: 1, depth: 1 });
                recorder.copy_to_image(piece.buffer, target.whole(), &[copy]);
            }
            Ok(())
        })
        .unwrap();
        let bytes =
            read_image_once(device, target.whole(), [64, 1, 1], 4, ResourceUse::COPY_TARGET)
                .unwrap();
        let values: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        assert_eq!(values, (1000..1064).collect::<Vec<_>>());
    });
}

#[test]
fn a_retired_object_waits_for_its_submission() {
    with_device(|device| {
        let gone = Arc::new(AtomicUsize::new(0));
        let mut frames = Frames::new(device).unwrap();
        let recorder = frames.begin().unwrap();
        let counter = gone.clone();
        device.retire_with(move |_| {
            counter.fetch_add(1, Ordering::Relaxed);
        });
        device.wait_idle().unwrap();
        assert_eq!(gone.load(Ordering::Relaxed), 0, "the open recording may use it");
        let serial = frames.submit(recorder, &[], &[]).unwrap();
        device.wait(serial).unwrap();
        device.collect().unwrap();
        assert_eq!(gone.load(Ordering::Relaxed), 1);
    });
}

#[test]
fn an_image_beyond_the_limits_is_refused_by_name() {
    with_device(|device| {
        let limit = device.limits().max_image_dimension2_d;
        let info = ImageInfo::plane("big", [limit + 1, 1], vk::Format::R32_UINT, COLOUR);
        let error = Image::new(device, &info).err().unwrap().to_string();
        assert!(error.contains("maxImageDimension2D") && error.contains("big"), "{error}");
    });
}

#[test]
fn memory_that_is_not_there_is_an_error_value() {
    with_device(|device| {
        let error = virtual_sculpture::gpu::Buffer::new(
            device,
            "impossible",
            1 << 50,
            vk::BufferUsageFlags::STORAGE_BUFFER,
            virtual_sculpture::gpu::MemoryLocation::GpuOnly,
        )
        .err()
        .unwrap();
        assert!(matches!(error, GpuError::OutOfMemory(_) | GpuError::Allocation { .. }), "{error}");
    });
}

#[test]
fn an_unknown_device_is_refused_with_the_list() {
    need_device();
    for (choice, wanted) in [
        (DeviceChoice::Name("no such renderer".to_string()), "no such renderer"),
        (DeviceChoice::Index(99), "99"),
    ] {
        let options = DeviceOptions { choice, ..DeviceOptions::default() };
        let error = Device::new(&mut Headless, &options).err().unwrap().to_string();
        assert!(error.contains(wanted) && error.contains("0: "), "{error}");
    }
}

/// The program's report about Vulkan if it is started with these variables set to `value`.
fn message_with(variables: &[&str], value: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"))
        .arg("doctor")
        .envs(variables.iter().map(|variable| (variable, value)))
        .output()
        .unwrap();
    assert!(output.status.success(), "the doctor only looks");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    said.lines().filter(|line| line.contains("Vulkan")).collect::<Vec<_>>().join("\n")
}

#[test]
fn without_a_driver_the_error_says_what_to_install() {
    // Loaders before 1.3.207 read the older name.
    let said = message_with(&["VK_DRIVER_FILES", "VK_ICD_FILENAMES"], "/nonexistent/driver.json");
    assert!(said.starts_with("Vulkan: ") && said.contains("mesa-vulkan-drivers"), "{said}");
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_loader_the_error_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["libvulkan.so.1", "libvulkan.so"] {
        std::fs::write(folder.path().join(name), b"not a library").unwrap();
    }
    let said = message_with(&["LD_LIBRARY_PATH"], &folder.path().to_string_lossy());
    assert!(said.contains("Vulkan: no Vulkan loader") && said.contains("libvulkan1"), "{said}");
}

#[test]
fn a_failure_within_rendering_does_not_keep_the_recorder_from_going_on() {
    with_device(|device| {
        let info = ImageInfo::plane("target", [4, 4], vk::Format::R32_UINT, COLOUR);
        let target = Image::new(device, &info).unwrap();
        run_once(device, |recorder| {
            recorder.image_barrier(
                target.whole(),
                ResourceUse::NOTHING,
                ResourceUse::COLOUR_TARGET,
            );
            let load = Load::Integers([5; 4]);
            let colour = Attachment { view: target.view(), load, store: true };
            // An error leaves here; the caller does not learn where it occurred.
            recorder.begin_rendering([4, 4], Some(colour), None);
            recorder.end_rendering_if_begun();
            recorder.end_rendering_if_begun();
            // Not allowed within rendering, and the layers say so.
            recorder.image_barrier(
                target.whole(),
                ResourceUse::COLOUR_TARGET,
                ResourceUse::COLOUR_TARGET,
            );
            let load = Load::Integers([6; 4]);
            let colour = Attachment { view: target.view(), load, store: true };
            recorder.begin_rendering([4, 4], Some(colour), None);
            recorder.end_rendering();
            Ok(())
        })
        .unwrap();
        let bytes =
            read_image_once(device, target.whole(), [4, 4, 1], 4, ResourceUse::COLOUR_TARGET)
                .unwrap();
        assert_eq!(bytemuck::pod_collect_to_vec::<u8, u32>(&bytes), [6; 16]);
    });
}

#[test]
fn pipelines_are_kept_for_the_next_start_where_a_driver_gives_any_and_damage_is_survived() {
    need_device();
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().join("deeper");
    let options = || DeviceOptions { pipeline_cache: Some(kept.clone()), ..Default::default() };
    let use_it = |options: &DeviceOptions| {
        let device = Device::new(&mut Headless, options).unwrap();
        drop(Renderer::new(&device, vk::Format::R8G8B8A8_UNORM).unwrap());
    };
    let files = || -> Vec<std::path::PathBuf> {
        let list = std::fs::read_dir(&kept).into_iter().flatten();
        list.map(|entry| entry.unwrap().path()).collect()
    };
    use_it(&options());
    // Some drivers keep nothing; then nothing is written.
    let first = files();
    assert!(first.len() <= 1, "{first:?}");
    use_it(&options());
    assert_eq!(files(), first);
    for path in &first {
        std::fs::write(path, b"VSpipes1 and then something else").unwrap();
    }
    use_it(&options());
    assert_eq!(files(), first);
    // A folder that cannot be created is no error.
    let file = folder.path().join("file");
    std::fs::write(&file, b"").unwrap();
    use_it(&DeviceOptions { pipeline_cache: Some(file.join("x")), ..Default::default() });
    // With validation the cache is not used.
    if std::env::var_os("VS_VALIDATION").is_none() {
        let asked = DeviceOptions { validation: Validation::IfAvailable, ..options() };
        assert_eq!(asked.with_environment().pipeline_cache, None);
        assert_eq!(options().with_environment().pipeline_cache, Some(kept.clone()));
    }
}
