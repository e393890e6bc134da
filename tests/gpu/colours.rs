//! The device's copy of the colours always equals the sculpture's.

use std::sync::Arc;

use ash::vk;
use glam::{UVec3, Vec3};
use virtual_sculpture::command::{Command, NewSculpture};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Buffer, Device, Frames, MemoryLocation, ResourceUse, run_once};
use virtual_sculpture::render::DeviceColours;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::ShownColours;

use super::fixture::with_device;

/// Returns the packed colours of a brick; none if it is not painted.
fn packed(material: &Material, b: UVec3) -> Option<Vec<u8>> {
    Some(material.page(b)?.write_to(&mut [0; 512 * 3]).to_vec())
}

/// The device's copy of each brick's page; none if the brick is not painted.
fn read_back(device: &Arc<Device>, colours: &DeviceColours, bricks: usize) -> Vec<Option<Vec<u8>>> {
    let from = colours.buffer();
    let (usage, location) = (vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu);
    let to = Buffer::new(device, "colours read back", from.bytes(), usage, location).unwrap();
    run_once(device, |recorder| {
        let all = vk::BufferCopy { src_offset: 0, dst_offset: 0, size: from.bytes() };
        recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::COPY_SOURCE);
        recorder.copy_buffer(from.handle(), to.handle(), &[all]);
        recorder.buffer_barrier(ResourceUse::COPY_TARGET, ResourceUse::HOST_READ);
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

fn update(frames: &mut Frames, colours: &mut DeviceColours, shown: &ShownColours, changed: &[u32]) {
    let mut recorder = frames.begin().unwrap();
    let slot = frames.slot();
    colours.update(&mut recorder, slot, shown, Some(changed)).unwrap();
    frames.submit(recorder, &[], &[]).unwrap();
}

/// The voxels' own colours.
fn own<'a>(grid: &'a Grid, material: &'a Material) -> ShownColours<'a> {
    ShownColours { grid, material, instead: None, mask: None }
}

fn own_of(document: &Document) -> ShownColours<'_> {
    own(document.grid(), document.material())
}

/// The same, or `instead`, and protected voxels tinted.
fn masked(document: &Document, instead: Option<Rgb>) -> ShownColours<'_> {
    let mask = document.contents().mask.as_deref();
    ShownColours { instead, mask, ..own_of(document) }
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
                room_vx: 0,
                grows: false,
            };
            let mut document = Document::new(&new, Limits::default()).unwrap();
            let mut frames = Frames::new(device).unwrap();
            let mut colours = DeviceColours::new(device, &own_of(&document)).unwrap();
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
                update(&mut frames, &mut colours, &own_of(&document), &changed);
                let copy = read_back(device, &colours, BRICKS);
                for (brick, page) in copy.iter().enumerate() {
                    let b = document.grid().brick_coords(brick);
                    let expected = packed(document.material(), b);
                    assert!(*page == expected, "{colour_depth:?}, {text}: {brick}");
                }
            }
        }
    });
}

/// Checks that only changed pages are uploaded: a change that was not reported must not arrive.
#[test]
fn more_pages_than_room_are_a_copy_on_the_device_and_what_changed() {
    with_device(|device| {
        let grid = Grid::new(UVec3::splat(160), Vec3::ONE, 1 << 20).unwrap();
        let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(9, 9, 9));
        let paint = |material: &mut Material, brick: usize| {
            let colour = Rgb::new(brick as u8, (brick / 256) as u8, 1);
            material.paint(grid.brick_coords(brick), &Brick::FULL, colour);
        };
        (0..10).for_each(|brick| paint(&mut material, brick));
        let mut frames = Frames::new(device).unwrap();
        let mut colours = DeviceColours::new(device, &own(&grid, &material)).unwrap();
        let before = colours.buffer().bytes();
        let unsaid = BRICKS - 1;
        paint(&mut material, unsaid);
        // Within a frame; then as many as are uploaded at once.
        for changed in [100..1100u32, 1100..7500] {
            changed.clone().for_each(|brick| paint(&mut material, brick as usize));
            let changed: Vec<u32> = changed.collect();
            update(&mut frames, &mut colours, &own(&grid, &material), &changed);
            assert!(colours.buffer().bytes() > before);
            let copy = read_back(device, &colours, BRICKS);
            for (brick, page) in copy.iter().enumerate() {
                let expected = packed(&material, grid.brick_coords(brick));
                assert!(*page == expected.filter(|_| brick != unsaid), "brick {brick}");
            }
        }
    });
}

/// A copy that has followed edits has the pages of a new one, also of bricks that came to be seen or buried by the
/// edits of others.
#[test]
fn the_copy_shows_the_mask_and_follows_what_becomes_visible() {
    with_device(|device| {
        for (colour_depth, instead) in [
            (ColourDepth::Bits8, None),
            (ColourDepth::None, None),
            (ColourDepth::Bits24, Some(Rgb::new(178, 112, 84))),
        ] {
            let mut grid = Grid::new(UVec3::splat(80), Vec3::ONE, 1 << 20).unwrap();
            grid.fill_bricks(|b| if b.z < 9 { Brick::FULL } else { Brick::EMPTY });
            let material = Material::for_grid(&grid, colour_depth, Rgb::new(200, 200, 200));
            let mut mask = grid.emptied();
            mask.fill_bricks(|b| if b.x < 6 { Brick::FULL } else { Brick::EMPTY });
            let contents = Contents { mask: Some(Box::new(mask)), ..Contents::new(grid, material) };
            let mut document = Document::from_contents(contents, Limits::default());
            let mut frames = Frames::new(device).unwrap();
            let mut copy = DeviceColours::new(device, &masked(&document, instead)).unwrap();
            document.drain_changes(|_, _| ());
            let mut pages = 0;
            for text in [
                "recolour ellipsoid at=60,40,72 half=30,10,30 colour=#ff0000",
                "subtract cuboid at=64,40,40 half=16,8,50",
                "add cuboid at=64,40,76 half=10,10,4 colour=#30ff20",
                "undo 1",
                "undo all",
            ] {
                if colour_depth == ColourDepth::None && text.starts_with("recolour") {
                    continue;
                }
                document.apply(&text.parse().unwrap()).unwrap();
                let changed =
                    document.drain_changes(|_, changed| changed.unwrap_or_default().to_vec());
                let shown = masked(&document, instead);
                update(&mut frames, &mut copy, &shown, &changed);
                let expected: Vec<_> = (0..shown.grid.brick_count())
                    .map(|brick| {
                        let mut page = vec![0; 512 * shown.depth().bytes()];
                        shown.has_page(brick).then(|| shown.write_page(brick, &mut page))?;
                        Some(page)
                    })
                    .collect();
                pages = expected.iter().flatten().count();
                assert!(read_back(device, &copy, expected.len()) == expected, "{text}");
            }
            assert!(pages > 100, "{pages}");
        }
    });
}
