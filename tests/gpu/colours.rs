//! The device's copy of the colours always equals the sculpture's.

use std::sync::Arc;

use ash::vk;
use glam::{UVec3, Vec3};
use virtual_sculpture::command::{Command, NewSculpture};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Buffer, Device, Frames, MemoryLocation, Use, run_once};
use virtual_sculpture::render::Colours;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Material, Rgb};

use super::fixture::with_device;

/// The device's copy of each brick's page; none if the brick is not painted.
fn read_back(device: &Arc<Device>, colours: &Colours, bricks: usize) -> Vec<Option<Vec<u8>>> {
    let from = colours.buffer();
    let (usage, location) = (vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu);
    let to = Buffer::new(device, "colours read back", from.bytes(), usage, location).unwrap();
    run_once(device, |recorder| {
        let all = vk::BufferCopy { src_offset: 0, dst_offset: 0, size: from.bytes() };
        recorder.buffer_barrier(Use::COPY_TARGET, Use::COPY_SOURCE);
        recorder.copy_buffer(from.handle(), to.handle(), &[all]);
        recorder.buffer_barrier(Use::COPY_TARGET, Use::HOST_READ);
        Ok(())
    })
    .unwrap();
    let (table, pages) = to.mapped().split_at(bricks * 4);
    let page_bytes = 512 * colours.bytes_per_voxel() as usize;
    let page = |number: u32| {
        let first = number.checked_sub(1)? as usize * page_bytes;
        Some(pages[first..first + page_bytes].to_vec())
    };
    bytemuck::pod_collect_to_vec::<u8, u32>(table).into_iter().map(page).collect()
}

fn update(frames: &mut Frames, colours: &mut Colours, material: &Material, changed: &[u32]) {
    let mut recorder = frames.begin().unwrap();
    let slot = frames.slot();
    colours.update(&mut recorder, slot, material, BRICKS, Some(changed)).unwrap();
    frames.submit(recorder, &[], &[]).unwrap();
}

/// More pages than are uploaded within a frame.
const BRICKS: usize = 20 * 20 * 20;

#[test]
fn the_copy_follows_paint_and_undo_in_frames_and_at_once() {
    with_device(|device| {
        for colour_depth in [ColourDepth::Bits8, ColourDepth::Bits24] {
            let new = NewSculpture {
                dims: UVec3::splat(160),
                voxel_size: Vec3::ONE,
                colour_depth,
                base: Rgb::new(200, 200, 200),
                solid: true,
            };
            let mut document = Document::new(&new, Limits::default()).unwrap();
            let mut frames = Frames::new(device).unwrap();
            let mut colours = Colours::new(device, document.material(), BRICKS).unwrap();
            document.drain_changes(|_, _| ());
            for text in [
                "recolour ellipsoid at=30,40,50 half=20,10,30 colour=#ff0000",
                "recolour ellipsoid at=80,80,80 half=70,60,70 colour=#00ff00",
                "undo 1",
                "recolour cuboid at=100,20,90 half=30,12,3 colour=#0000ff",
                "undo all",
                "recolour cuboid at=80,80,80 half=80,80,80 colour=#123456",
                "undo 1",
                "recolour ellipsoid at=80,70,80 half=10,90,20 colour=#fedcba",
            ] {
                let command: Command = text.parse().unwrap();
                document.apply(&command).unwrap();
                let changed =
                    document.drain_changes(|_, changed| changed.unwrap_or_default().to_vec());
                assert!(!changed.is_empty(), "{text}");
                update(&mut frames, &mut colours, document.material(), &changed);
                let copy = read_back(device, &colours, BRICKS);
                for (brick, page) in copy.iter().enumerate() {
                    let expected = document.material().page(brick);
                    assert!(page.as_deref() == expected, "{colour_depth:?}, {text}: {brick}");
                }
            }
        }
    });
}

/// Checks that only changed pages are uploaded: a change that was not reported must not arrive.
#[test]
fn more_pages_than_room_are_a_copy_on_the_device_and_what_changed() {
    with_device(|device| {
        let mut material = Material::new(ColourDepth::Bits24, Rgb::new(9, 9, 9), BRICKS);
        let paint = |material: &mut Material, brick: usize| {
            material.paint(brick, &Brick::FULL, Rgb::new(brick as u8, (brick / 256) as u8, 1));
        };
        (0..10).for_each(|brick| paint(&mut material, brick));
        let mut frames = Frames::new(device).unwrap();
        let mut colours = Colours::new(device, &material, BRICKS).unwrap();
        let before = colours.buffer().bytes();
        let unsaid = BRICKS - 1;
        paint(&mut material, unsaid);
        // Within a frame; then as many as are uploaded at once.
        for changed in [100..1100u32, 1100..7500] {
            changed.clone().for_each(|brick| paint(&mut material, brick as usize));
            let changed: Vec<u32> = changed.collect();
            update(&mut frames, &mut colours, &material, &changed);
            assert!(colours.buffer().bytes() > before);
            let copy = read_back(device, &colours, BRICKS);
            for (brick, page) in copy.iter().enumerate() {
                let expected = material.page(brick).filter(|_| brick != unsaid);
                assert!(page.as_deref() == expected, "brick {brick}");
            }
        }
    });
}
