//! Measures edits as a user makes them: a command applied to a document, including counts, dirty set and undo record.
//! Restoring the sculpture between two runs is not timed.
//!
//! The print check and the longest of the repair commands are measured on sculptures of the benchmark.
//!
//! Throughput is given in voxels that the solid holds.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{EulerRot, Quat, UVec3, Vec3};
use sculpture_core::command::{Area, Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::print_check::{CheckOptions, check};
use sculpture_core::scenes;
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::tools::repair::Repair;
use sculpture_core::tools::solid::{Primitive, Solid};

const PAINT: Rgb = Rgb::new(190, 30, 60);

fn document(solid: bool, colour_depth: ColourDepth) -> Document {
    let new = NewSculpture {
        dims: UVec3::splat(512),
        voxel_size: Vec3::ONE,
        colour_depth,
        base: Rgb::new(200, 190, 170),
        solid,
        room_vx: 0,
        grows: false,
    };
    Document::new(&new, Limits::default()).expect("512^3 is within the default limits")
}

fn apply(document: &mut Document, command: &Command) -> u64 {
    let applied = document.apply(command).expect("the benchmark's commands are valid");
    applied.stats.voxels_changed()
}

fn forget_dirty(document: &mut Document) {
    document.drain_changes(|_, bricks| {
        black_box(bricks);
    });
}

fn construct(op: EditOp, solid: Solid, centre: Vec3, half: Vec3, rotation: Quat) -> Command {
    let primitive = Primitive { solid, centre_vx: centre, half, rotation };
    Command::Construct { op, primitive, to_vx: None }
}

fn subtract(solid: Solid, half: Vec3, rotation: Quat) -> Command {
    construct(EditOp::Subtract, solid, Vec3::new(251.3, 260.7, 255.1), half, rotation)
}

/// Times `command` on a fresh copy of the same state, which an undo restores.
fn time_command(document: &mut Document, command: &Command, runs: u64) -> Duration {
    let mut total = Duration::ZERO;
    for _ in 0..runs {
        let start = Instant::now();
        black_box(apply(document, command));
        total += start.elapsed();
        apply(document, &Command::Undo { steps: Some(1) });
        forget_dirty(document);
    }
    total
}

fn primitives(c: &mut Criterion) {
    let turned = Quat::from_euler(EulerRot::XYZ, 0.4, 0.7, 1.1);
    let add = EditOp::Add(Some(PAINT));
    let cases = [
        (
            "sphere",
            true,
            ColourDepth::None,
            subtract(Solid::Ellipsoid, Vec3::splat(64.0), Quat::IDENTITY),
        ),
        (
            "cuboid",
            true,
            ColourDepth::None,
            subtract(Solid::Cuboid, Vec3::splat(64.0), Quat::IDENTITY),
        ),
        (
            "pyramid",
            true,
            ColourDepth::None,
            subtract(Solid::Pyramid, Vec3::splat(64.0), Quat::IDENTITY),
        ),
        (
            "rotated_ellipsoid",
            true,
            ColourDepth::None,
            subtract(Solid::Ellipsoid, Vec3::new(64.0, 40.0, 90.0), turned),
        ),
        (
            "rotated_cuboid",
            true,
            ColourDepth::None,
            subtract(Solid::Cuboid, Vec3::splat(64.0), turned),
        ),
        (
            "rotated_pyramid",
            true,
            ColourDepth::None,
            subtract(Solid::Pyramid, Vec3::splat(64.0), turned),
        ),
        (
            "sphere_added",
            false,
            ColourDepth::None,
            construct(add, Solid::Ellipsoid, Vec3::splat(255.2), Vec3::splat(64.0), Quat::IDENTITY),
        ),
        (
            "sphere_added_in_colour",
            false,
            ColourDepth::Bits24,
            construct(add, Solid::Ellipsoid, Vec3::splat(255.2), Vec3::splat(64.0), Quat::IDENTITY),
        ),
        (
            "sphere_recoloured",
            true,
            ColourDepth::Bits24,
            construct(
                EditOp::Recolour(PAINT),
                Solid::Ellipsoid,
                Vec3::splat(255.2),
                Vec3::splat(64.0),
                Quat::IDENTITY,
            ),
        ),
    ];
    let mut group = c.benchmark_group("radius_64");
    for (name, solid, depth, command) in cases {
        let mut document = document(solid, depth);
        forget_dirty(&mut document);
        let voxels = apply(&mut document, &command);
        apply(&mut document, &Command::Undo { steps: None });
        group.throughput(Throughput::Elements(voxels));
        group.bench_function(name, |b| {
            b.iter_custom(|runs| time_command(&mut document, &command, runs));
        });
    }
    group.finish();
}

/// Returns the same 2000 spheres of radius 4 to 28 in every run.
fn cheese_holes() -> Vec<Command> {
    let mut state = 0x5EED_u64;
    let mut unit = || {
        // splitmix64
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ z >> 31) >> 40) as f32 / (1u64 << 24) as f32
    };
    (0..2000)
        .map(|_| {
            let centre = Vec3::new(unit(), unit(), unit()) * 512.0;
            let radius = 4.0 + 24.0 * unit();
            construct(
                EditOp::Subtract,
                Solid::Ellipsoid,
                centre,
                Vec3::splat(radius),
                Quat::IDENTITY,
            )
        })
        .collect()
}

fn cheese(c: &mut Criterion) {
    let holes = cheese_holes();
    let mut group = c.benchmark_group("cheese_2000_spheres");
    group.sample_size(20);
    for one_stroke in [true, false] {
        let mut document = document(true, ColourDepth::None);
        forget_dirty(&mut document);
        let name = if one_stroke { "one_stroke" } else { "2000_strokes" };
        group.bench_function(name, |b| {
            b.iter_custom(|runs| {
                time_of(&mut document, runs, one_stroke.then_some("cheese"), &holes)
            });
        });
    }
    group.finish();
}

/// Returns the duration of `commands`, run `runs` times, as one stroke of that label if there is one; undone each time.
fn time_of(
    document: &mut Document,
    runs: u64,
    stroke: Option<&str>,
    commands: &[Command],
) -> Duration {
    let mut total = Duration::ZERO;
    for _ in 0..runs {
        let start = Instant::now();
        if let Some(label) = stroke {
            apply(document, &Command::Begin { label: label.into() });
        }
        for command in commands {
            black_box(apply(document, command));
        }
        if stroke.is_some() {
            apply(document, &Command::End);
        }
        total += start.elapsed();
        apply(document, &Command::Undo { steps: None });
        forget_dirty(document);
    }
    total
}

/// Straight strokes of 200 voxels through a solid block along a diagonal of the rotated solid: in sweeps of a fifth of
/// the half extent, as the editor makes them, and in stamps at the same spacing, which leave ridges.
fn strokes(c: &mut Criterion) {
    const LENGTH_VX: f32 = 200.0;
    let turned = Quat::from_euler(EulerRot::XYZ, 0.4, 0.7, 1.1);
    let diagonal = turned * Vec3::new(1.0, 1.0, 0.0).normalize();
    let mut group = c.benchmark_group("stroke_200_vx");
    group.sample_size(10);
    let mut document = document(true, ColourDepth::None);
    forget_dirty(&mut document);
    for solid in Solid::ALL {
        for half in [8.0, 48.0] {
            let from = Vec3::splat(256.0) - diagonal * (0.5 * LENGTH_VX);
            let at = |i: u32| from + diagonal * (i as f32 * 0.2 * half);
            let tool = |i| Primitive {
                solid,
                centre_vx: at(i),
                half: Vec3::splat(half),
                rotation: turned,
            };
            for swept in [true, false] {
                let uses: Vec<Command> = (0..(LENGTH_VX / (0.2 * half)) as u32)
                    .map(|i| Command::Construct {
                        op: EditOp::Subtract,
                        primitive: tool(i),
                        to_vx: swept.then(|| at(i + 1)),
                    })
                    .collect();
                let kind = if swept { "sweeps" } else { "stamps" };
                let id = format!("{}_{half}_{}_{kind}", solid.name(), uses.len());
                group.bench_function(id, |b| {
                    b.iter_custom(|runs| time_of(&mut document, runs, Some("stroke"), &uses));
                });
            }
        }
    }
    group.finish();
}

fn whole(c: &mut Criterion) {
    let mut group = c.benchmark_group("whole_512");
    group.sample_size(20);
    group.throughput(Throughput::Elements(1 << 27));
    let mut document = document(true, ColourDepth::None);
    forget_dirty(&mut document);
    group.bench_function("clear", |b| {
        b.iter_custom(|runs| {
            time_command(&mut document, &Command::Clear { area: Area::Grid }, runs)
        });
    });
    for undo in [true, false] {
        let name = if undo { "undo" } else { "redo" };
        group.bench_function(BenchmarkId::new("clear", name), |b| {
            b.iter_custom(|runs| {
                let mut total = Duration::ZERO;
                for _ in 0..runs {
                    apply(&mut document, &Command::Clear { area: Area::Grid });
                    let start = Instant::now();
                    apply(&mut document, &Command::Undo { steps: Some(1) });
                    let undone = start.elapsed();
                    apply(&mut document, &Command::Redo { steps: Some(1) });
                    total += if undo { undone } else { start.elapsed() - undone };
                    apply(&mut document, &Command::Undo { steps: Some(1) });
                    forget_dirty(&mut document);
                }
                total
            });
        });
    }
    group.finish();
}

fn print_checks(c: &mut Criterion) {
    let mut group = c.benchmark_group("print check 512");
    group.sample_size(10);
    let gyroid = scenes::gyroid(512, 1).expect("a scene");
    let cheese = scenes::cheese(512, 300, 7).expect("a scene");
    for (name, grid) in [("gyroid", &gyroid), ("cheese", &cheese)] {
        for wall_mm in [2.0, 12.0] {
            let options = CheckOptions { wall_mm, ..Default::default() };
            group.bench_function(format!("{name}, walls of {wall_mm} voxels"), |b| {
                b.iter(|| black_box(check(grid, &options, 1 << 30, &())));
            });
        }
    }
    let thicken = Repair::Thicken { to_vx: 12.0 };
    group.bench_function("gyroid, thicken to 12 voxels", |b| {
        b.iter(|| black_box(thicken.plan(&gyroid, 1 << 30, &())));
    });
    group.finish();
}

criterion_group!(benches, primitives, cheese, strokes, whole, print_checks);
criterion_main!(benches);
