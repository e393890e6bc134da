//! The device's copy of the bits always equals the grid.

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use virtual_sculpture::command::{Command, NewSculpture};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames, GpuError, ResourceUse, read_image_once};
use virtual_sculpture::render::Volume;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Grid, Rgb};

use super::fixture::with_device;

fn read_back(device: &Arc<Device>, volume: &Volume) -> Vec<Brick> {
    let image = volume.image();
    let bytes =
        read_image_once(device, image.whole(), image.size(), 8, ResourceUse::SHADER_READ).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}

fn bricks(grid: &Grid) -> Vec<Brick> {
    (0..grid.brick_count()).map(|index| *grid.brick_at(index)).collect()
}

fn document(dims: [u32; 3], solid: bool) -> Document {
    let new = NewSculpture {
        dims: UVec3::from(dims),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::None,
        base: Rgb::new(200, 200, 200),
        solid,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, Limits::default()).unwrap()
}

fn command(text: &str) -> Command {
    text.parse().unwrap_or_else(|e| panic!("{text}: {e}"))
}

#[test]
fn the_copy_follows_random_edits_and_undo() {
    with_device(|device| {
        let config = Config { cases: 12, failure_persistence: None, ..Config::default() };
        let ball = (prop::array::uniform3(-60f32..60.0), 1f32..40.0, any::<bool>());
        let balls = prop::collection::vec(ball, 1..8);
        let strategy = (prop::array::uniform3(1u32..100), any::<bool>(), balls);
        let run = TestRunner::new(config).run(&strategy, |(dims, solid, balls)| {
            let mut document = document(dims, solid);
            let mut frames = Frames::new(device).unwrap();
            let mut volume = None;
            let mut commands: Vec<Command> = balls
                .iter()
                .map(|(centre, radius, add)| {
                    let (op, colour) =
                        if *add { ("add", "colour=#ffffff") } else { ("subtract", "") };
                    let [x, y, z] = centre;
                    let half = format!("{radius},{radius},{radius}");
                    command(&format!("{op} ellipsoid at={x},{y},{z} half={half} {colour}"))
                })
                .collect();
            commands.push(command("undo"));
            commands.push(command("clear"));
            commands.push(command("undo"));
            for command in commands {
                document.apply(&command).unwrap();
                let recorder = frames.begin().unwrap();
                let slot = frames.slot();
                let recorder = document.drain_changes(|contents, changed| {
                    let mut recorder = recorder;
                    match &mut volume {
                        None => volume = Some(Volume::new(device, &contents.grid).unwrap()),
                        Some(volume) => {
                            volume.update(&mut recorder, slot, &contents.grid, changed).unwrap();
                        }
                    }
                    recorder
                });
                frames.submit(recorder, &[], &[]).unwrap();
                let copy = read_back(device, volume.as_ref().unwrap());
                prop_assert!(copy == bricks(document.grid()), "after {command:?}");
            }
            Ok(())
        });
        run.unwrap();
    });
}

#[test]
fn another_size_makes_another_image() {
    with_device(|device| {
        let small = document([9, 20, 3], true);
        let large = document([50, 8, 90], true);
        let mut volume = Volume::new(device, small.grid()).unwrap();
        let before = volume.image().id();
        let mut frames = Frames::new(device).unwrap();
        let mut recorder = frames.begin().unwrap();
        volume.update(&mut recorder, frames.slot(), large.grid(), None).unwrap();
        frames.submit(recorder, &[], &[]).unwrap();
        assert_ne!(volume.image().id(), before);
        assert!(read_back(device, &volume) == bricks(large.grid()));
    });
}

#[test]
fn the_longest_axes_work_or_are_refused_by_the_limits_name() {
    with_device(|device| {
        let limit = device.limits().max_image_dimension3_d;
        for dims in [UVec3::new(1024, 9, 1000), UVec3::new(1, 4096, 8), UVec3::new(4096, 1, 8)] {
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            grid.set(dims.as_ivec3() - IVec3::ONE, true);
            let needed = (grid.brick_dims() * UVec3::new(8, 1, 1)).max_element();
            match Volume::new(device, &grid) {
                Ok(volume) => assert!(read_back(device, &volume) == bricks(&grid)),
                Err(GpuError::Limit { limit: name, .. }) => {
                    assert!(needed > limit && name == "maxImageDimension3D");
                }
                Err(error) => panic!("{error}"),
            }
        }
    });
}

/// Too many for a frame, too few for all to be uploaded.
#[test]
fn scattered_bricks_of_a_large_grid_are_uploaded_piece_by_piece() {
    with_device(|device| {
        let mut grid = Grid::new(UVec3::new(1024, 512, 520), Vec3::ONE, 1 << 30).unwrap();
        let mut volume = Volume::new(device, &grid).unwrap();
        let mut changed: Vec<u32> = (0..grid.brick_count() as u32).step_by(4).collect();
        // As documents hear of them: in no order, and more than once.
        changed.reverse();
        changed.truncate(changed.len() - 9);
        changed.extend([3, 3]);
        for &brick in &changed {
            grid.set_brick(brick as usize, Brick::FULL);
        }
        let mut frames = Frames::new(device).unwrap();
        let mut recorder = frames.begin().unwrap();
        volume.update(&mut recorder, frames.slot(), &grid, Some(&changed)).unwrap();
        frames.submit(recorder, &[], &[]).unwrap();
        assert!(read_back(device, &volume) == bricks(&grid));
    });
}
