//! A steady frame allocates nothing: the ray caster, the software shader and the partial update reuse the memory of the
//! previous frame, and so do edits within a stroke in progress.
//!
//! The allocations of all threads are counted. rayon allocates itself (its threads, and occasionally a block of its
//! queue), so a frame is measured many times, and most of these must be without any allocation.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{Affine3A, Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::command::{Command, NewSculpture};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::scenes;
use virtual_sculpture::sculpture::edit::EditOp;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::{
    self, Lighting, NORMAL_REACH_VX, NormalField, Pixels, ShadePose, ShadeSource,
};
use virtual_sculpture::surface::{IndexMap, changed_pixels, quickstep, raycast};
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::{Camera, Eye};

/// Counts the requests to the system's allocator.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is handed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const RUNS: usize = 64;

/// Runs `f` until caches and queues are warm, then counts the allocations of each further run. All but a few must
/// have none: rayon's queue allocates a block for every 63 tasks injected from outside its threads.
fn assert_free(what: &str, mut f: impl FnMut()) {
    (0..8).for_each(|_| f());
    let counts: Vec<usize> = (0..RUNS)
        .map(|_| {
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            f();
            ALLOCATIONS.load(Ordering::Relaxed) - before
        })
        .collect();
    let free = counts.iter().filter(|&&count| count == 0).count();
    assert!(free + 4 >= RUNS && counts.iter().all(|&count| count <= 4), "{what}: {counts:?}");
}

fn view(grid: &Grid) -> (Eye, Affine3A) {
    let edge = grid.dims().x as f32;
    let world_from_grid = Affine3A::from_translation(Vec3::splat(-0.5 * edge));
    let camera = Camera { eye: Vec3::new(0.8, 0.6, 1.0) * edge, ..Camera::default() };
    (camera.eye(UVec2::new(320, 240)), world_from_grid)
}

#[test]
fn a_steady_frame_on_the_cpu_allocates_nothing() {
    // The counters are those of the whole process.
    if !trials::alone() {
        return;
    }
    let grid = scenes::cheese(128, 60, 1).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::new(9, 9, 9));
    let (eye, world_from_grid) = view(&grid);
    let rays = eye.pixel_rays(&world_from_grid);
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let lighting = Lighting::default();
    let mut map = IndexMap::new(rays);
    let mut pixels = Pixels::default();
    let normals = NormalField::of(&grid);
    let source = ShadeSource { grid: &grid, material: &material, normals: &normals, mask: None };
    assert_free("ray caster", || raycast::sample(&grid, &rays, &mut map));
    assert_free("Quickstep", || quickstep::sample(&grid, &rays, &mut map));
    assert_free("shader", || shade::shade(&map, &source, &pose, &lighting, &mut pixels));
    let changed: Vec<u32> = (700..760).chain(900..930).collect();
    assert_free("partial update", || {
        let rects = changed_pixels(&grid, &changed, &rays, NORMAL_REACH_VX);
        assert!(!rects.is_empty());
        for &rect in rects.as_slice() {
            raycast::sample_rect(&grid, &mut map, rect);
            shade::shade_rect(&map, &source, &pose, &lighting, rect, &mut pixels);
        }
    });
}

#[test]
fn an_edit_allocates_for_its_command_and_nothing_for_its_voxels() {
    if !trials::alone() {
        return;
    }
    let new = NewSculpture {
        dims: UVec3::splat(128),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::None,
        base: Rgb::default(),
        solid: true,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    let ball = |radius: f32| {
        let primitive = Primitive {
            solid: Solid::Ellipsoid,
            centre_vx: Vec3::splat(64.0),
            half: Vec3::splat(radius),
            rotation: Quat::IDENTITY,
        };
        Command::Construct { op: EditOp::Subtract, primitive, to_vx: None }
    };
    // Within one stroke, whose undo record has saved the bricks already, after many such strokes.
    let mut allocations = |radius: f32| {
        let command = ball(radius);
        let mut fewest = usize::MAX;
        for _ in 0..16 {
            document.apply(&Command::Begin { label: String::new() }).unwrap();
            document.apply(&ball(2.0)).unwrap();
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            document.apply(&command).unwrap();
            fewest = fewest.min(ALLOCATIONS.load(Ordering::Relaxed) - before);
            document.apply(&Command::Cancel).unwrap();
            document.drain_changes(|_, _| ());
        }
        fewest
    };
    let (small, large, parallel) = (allocations(3.0), allocations(45.0), allocations(60.0));
    // All touch the same eight leaves of the tree. A list of mirror images, one of regions, and the operations that an
    // array may repeat; the leaves that the edit opens, in a list that grows once, their rows of bricks, and the leaves
    // that have changed.
    assert!(small <= 7, "{small} allocations for a small ball");
    // Each leaf is made anew at most once, with its bricks, and the list of rows grows: whatever the number of voxels.
    assert!(large <= small + 8 * 2 + 4, "{large} allocations for a large ball");
    // On several threads, each of the four rows of leaves has lists of its own.
    assert!(parallel <= small + 8 * 2 + 4 * 12, "{parallel} allocations for a ball in parallel");
}
