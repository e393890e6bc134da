//! Measures saving and loading in the program's own format and as PVM, through the same functions as the program, until
//! the data is on disk.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sculpture_core::format::options::{ExportForm, ImportOptions};
use sculpture_core::format::{load, save};
use sculpture_core::progress::Progress;
use sculpture_core::scenes;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::orientation::Up;
use sculpture_core::sculpture::{ColourDepth, Limits, Material, Rgb};
use sculpture_core::voxelise::{Fill, InputMesh, MeshPlacement, MeshSize, to_contents};

fn files(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let scenes = [
        ("engine_256", scenes::engine_like(256)),
        ("cheese_512", scenes::cheese(512, 2000, 1)),
        ("gyroid_512", scenes::gyroid(512, 1)),
    ];
    let mut group = c.benchmark_group("files");
    group.sample_size(10);
    for (name, grid) in scenes {
        let grid = grid.expect("the scenes are small");
        let base = Rgb::new(200, 190, 170);
        let material = Material::for_grid(&grid, ColourDepth::None, base);
        let contents = Contents::new(grid, material);
        for ending in ["vsc", "pvm"] {
            let path = folder.path().join(format!("{name}.{ending}"));
            group.bench_function(BenchmarkId::new(format!("save_{ending}"), name), |b| {
                b.iter(|| save(&path, &contents, ExportForm::Auto, &()).expect("it fits the disk"));
            });
            let (options, limits) = (ImportOptions::default(), Limits::default());
            group.bench_function(BenchmarkId::new(format!("load_{ending}"), name), |b| {
                b.iter(|| load(&path, &options, &limits, &()).expect("it was just written"));
            });
        }
    }
    group.finish();
}

/// Returns a sphere with bumps, of `4 * rows^2` triangles, with coloured corners.
fn bumpy_ball(rows: u32) -> InputMesh {
    let corner = |i: u32, j: u32| {
        let (a, b) = (j as f32 / rows as f32, (i % (rows * 2)) as f32 / (rows * 2) as f32);
        let (polar, azimuth) = (a * std::f32::consts::PI, b * std::f32::consts::TAU);
        let radius = 1.0 + 0.1 * (9.0 * azimuth).sin() * (7.0 * polar).sin();
        let (sin, cos) = polar.sin_cos();
        glam::Vec3::new(azimuth.cos() * sin, cos, azimuth.sin() * sin) * radius
    };
    let mut mesh = InputMesh::default();
    let around = rows * 2;
    mesh.positions = (0..=rows).flat_map(|j| (0..around).map(move |i| corner(i, j))).collect();
    for (i, j) in (0..rows).flat_map(|j| (0..around).map(move |i| (i, j))) {
        let at = |i: u32, j: u32| (i % around) + around * j;
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    let colour = |p: u32| Rgb([p, p >> 8, p >> 16].map(|v| v as u8));
    mesh.corner_colours = mesh.triangles.iter().map(|t| t.map(colour)).collect();
    mesh
}

fn meshes(c: &mut Criterion) {
    let mut group = c.benchmark_group("meshes");
    group.sample_size(10);
    let mesh = bumpy_ball(160);
    let quiet: &dyn Progress = &();
    let frame =
        MeshPlacement::around(&mesh, MeshSize::LongestVx(512), Up::Y, 1.0).expect("it has a size");
    for (name, depth) in [("plain", ColourDepth::None), ("coloured", ColourDepth::Bits24)] {
        group.bench_function(BenchmarkId::new("voxelise_512", name), |b| {
            let limits = Limits::default();
            let run = || to_contents(&mesh, &frame, Fill::Auto, depth, &limits, quiet);
            b.iter(|| run().expect("it fits the memory"));
        });
    }
    group.finish();
}

criterion_group!(benches, files, meshes);
criterion_main!(benches);
