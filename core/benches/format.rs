//! Measures saving and loading in the program's own format and as PVM, through the same doors as
//! the program, with everything until the disk has it.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use sculpture_core::format::options::{ExportForm, ImportOptions};
use sculpture_core::format::{load, save};
use sculpture_core::scenes;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{ColourDepth, Limits, Material, Rgb};

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
        let contents = Contents { grid, material };
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

criterion_group!(benches, files);
criterion_main!(benches);
