//! Tests studies of files before import: what a study shows is what the import makes.

use std::path::{Path, PathBuf};

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::format::options::{
    Colouring, Cubic, Existence, ExportForm, ImportOptions, MeshSize, ScanRegion,
};
use sculpture_core::format::{self, Family, Study, VolumeStudy};
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::orientation::Up;
use sculpture_core::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};
use trials::shared_file;

fn study(path: &Path) -> Study {
    format::study(path, &ImportOptions::default(), &Limits::default(), &())
        .unwrap_or_else(|error| panic!("{path:?}: {error}"))
}

fn volume(path: &Path) -> VolumeStudy {
    match study(path) {
        Study::Volume(study) => *study,
        other => panic!("{path:?}: {other:?}"),
    }
}

fn load(path: &Path, options: &ImportOptions) -> Contents {
    format::load(path, options, &Limits::default(), &())
        .unwrap_or_else(|error| panic!("{path:?}: {error}"))
        .contents
}

/// Returns a scan of 7 x 5 x 4 different voxels with three edge lengths, in the orientation of `directions`.
fn scan(folder: &Path, name: &str, directions: &str) -> PathBuf {
    let mut file = format!(
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 7 5 4\nendian: little\nencoding: raw\n{directions}\n"
    )
    .into_bytes();
    file.extend((0..140i16).flat_map(|i| ((i * 37) % 140 - 20).to_le_bytes()));
    let path = folder.join(name);
    std::fs::write(&path, file).unwrap();
    path
}

/// Compares every slice with the voxels of the import. `part`: the region in the upright volume.
fn is_what_is_made(path: &Path, study: &VolumeStudy, options: &ImportOptions) {
    let made = load(path, &study.settled(options));
    let outlook = study.outlook(&study.settled(options), &Limits::default()).unwrap();
    assert_eq!((outlook.dims, outlook.voxel_size), (made.grid.dims(), made.grid.voxel_size()));
    assert_eq!(outlook.grid_bytes, sculpture_core::sculpture::Grid::bytes_for(outlook.dims));
    let turn = study.turn(options);
    let part = study.upright_region(turn, options.region.unwrap_or(study.whole()));
    assert_eq!(part.dims(), outlook.dims, "{options:?}");
    assert_eq!(study.region_in_file(turn, part), options.region.unwrap_or(study.whole()));
    let existing = study.existing(options);
    for axis in 0..3 {
        let ([across, down], reversed) = VolumeStudy::picture_axes(axis);
        for at in part.low[axis]..=part.high[axis] {
            let (size, values) = study.slice(turn, axis, at, u32::MAX);
            for (i, value) in (0..).zip(&values) {
                let mut voxel = UVec3::ZERO;
                voxel[axis] = at;
                let flip =
                    |i: u32, size: u32, reversed: bool| if reversed { size - 1 - i } else { i };
                voxel[across] = flip(i % size.x, size.x, reversed[0]);
                voxel[down] = flip(i / size.x, size.y, reversed[1]);
                let is_inside = voxel.cmpge(part.low).all() && voxel.cmple(part.high).all();
                if is_inside {
                    let of_grid = made.grid.get((voxel - part.low).as_ivec3());
                    assert_eq!(existing.contains(*value), of_grid, "{options:?} {axis} {voxel}");
                }
            }
        }
    }
}

#[test]
fn slices_show_the_voxels_that_the_import_makes() {
    let folder = tempfile::tempdir().unwrap();
    let laid = [
        "spacings: 1 2 0.5\n",
        "space: left-posterior-superior\nspace directions: (1,0,0) (0,2,0) (0,0,0.5)\n",
        "space: right-anterior-superior\nspace directions: (0,0,-1) (0,2,0) (0.5,0,0)\n",
        "space: left-posterior-superior\nspace directions: (0,1,0) (0,0,2) (0.5,0,0)\n",
    ];
    for (i, directions) in laid.into_iter().enumerate() {
        let path = scan(folder.path(), &format!("{i}.nrrd"), directions);
        let study = volume(&path);
        assert_eq!(study.knows_up(), i > 0);
        for upright in [None, Some(Up::Z), Some(Up::MinusX)] {
            let plain = ImportOptions { upright, ..ImportOptions::default() };
            let region = ScanRegion { low: UVec3::new(1, 0, 2), high: UVec3::new(5, 3, 2) };
            for options in [
                plain,
                ImportOptions { existence: Existence::Range(-3.0, 30.0), ..plain },
                ImportOptions { existence: Existence::Threshold(50.5), ..plain },
                ImportOptions { colouring: Colouring::Labels, ..plain },
                // The part alone would have another automatic threshold.
                ImportOptions { region: Some(region), ..plain },
            ] {
                is_what_is_made(&path, &study, &options);
            }
        }
    }
    let labels = shared_file("data/nifti/anatomical.nii");
    is_what_is_made(&labels, &volume(&labels), &ImportOptions::default());
}

#[test]
fn large_slices_leave_voxels_out_evenly() {
    let folder = tempfile::tempdir().unwrap();
    let study = volume(&scan(folder.path(), "a.nrrd", ""));
    let turn = study.turn(&ImportOptions::default());
    let (size, values) = study.slice(turn, 2, 1, 3);
    assert_eq!((size.to_array(), values.len()), ([3, 3], 9));
    // The rows are those at 4, 3 and 1 from below, the columns 0, 2 and 4.
    assert_eq!(values[0], study.value(UVec3::new(0, 4, 1)));
    assert_eq!(values[8], study.value(UVec3::new(4, 1, 1)));
}

#[test]
fn cubic_voxels_and_memory_are_foretold() {
    let folder = tempfile::tempdir().unwrap();
    let path = scan(folder.path(), "a.nrrd", "spacings: 1 2 0.5\n");
    let study = volume(&path);
    for cubic in [Cubic::Finest, Cubic::EdgeMm(0.7)] {
        let options = ImportOptions { cubic, upright: Some(Up::Z), ..ImportOptions::default() };
        let settled = study.settled(&options);
        assert_eq!(settled.existence, Existence::Threshold(study.densities.threshold));
        let outlook = study.outlook(&settled, &Limits::default()).unwrap();
        let made = load(&path, &settled);
        assert_eq!((outlook.dims, outlook.voxel_size), (made.grid.dims(), made.grid.voxel_size()));
    }
    let tiny = ImportOptions { cubic: Cubic::EdgeMm(0.001), ..ImportOptions::default() };
    let error = study.outlook(&tiny, &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("voxel"), "{error}");
    // A file that is too large as a whole can be read in part.
    let limits = Limits { grid_bytes: 80, colour_bytes: 4096, ..Limits::default() };
    let Ok(Study::Volume(study)) = format::study(&path, &tiny, &limits, &()) else {
        panic!("it is read all the same")
    };
    // The default region is the whole file.
    let options = ImportOptions { region: Some(study.whole()), ..ImportOptions::default() };
    assert_eq!(study.settled(&options).region, None);
    let wide = ImportOptions { cubic: Cubic::EdgeMm(0.1), ..ImportOptions::default() };
    assert!(study.outlook(&wide, &limits).is_err());
}

#[test]
fn a_mesh_lies_in_the_grid_that_it_gets() {
    // Nowhere thinner than a voxel, unlike the legs of the ant.
    let path = shared_file("data/mesh/spot_triangulated.obj");
    let Study::Mesh(mesh) = study(&path) else { panic!("a mesh") };
    assert!(!mesh.sample.is_empty() && mesh.sample.len() <= 4000 && mesh.count > 100);
    for (mesh_size, upright) in
        [(MeshSize::LongestVx(40), None), (MeshSize::VoxelMm(0.03), Some(Up::MinusX))]
    {
        let options = ImportOptions { mesh_size, upright, ..ImportOptions::default() };
        let made = load(&path, &options);
        let outlook = mesh.outlook(&options).unwrap();
        assert_eq!((outlook.dims, outlook.voxel_size), (made.grid.dims(), made.grid.voxel_size()));
        let frame = mesh.frame(&options).unwrap();
        let reach = outlook.dims.as_vec3() + 1e-2;
        for corner in mesh.sample.iter().flatten().map(|corner| frame.in_grid(*corner)) {
            assert!(
                corner.cmpge(Vec3::splat(-1e-2)).all() && corner.cmple(reach).all(),
                "{corner}"
            );
        }
        // Its surface coincides with voxels.
        let near = mesh.sample.iter().flatten().filter(|corner| {
            let at = frame.in_grid(**corner).as_ivec3();
            (0..27).any(|i| made.grid.get(at + IVec3::new(i % 3, i / 3 % 3, i / 9) - 1))
        });
        let share = near.count() as f32 / (3 * mesh.sample.len()) as f32;
        assert!(share > 0.99, "{share}");
    }
    let huge = ImportOptions { mesh_size: MeshSize::VoxelMm(1e-5), ..ImportOptions::default() };
    assert!(mesh.outlook(&huge).is_err());
}

/// Returns an L of seven voxels in a grid of 4 x 3 x 2, two of them of another colour.
fn model(folder: &Path, name: &str) -> PathBuf {
    let limits = Limits::default();
    let mut grid = Grid::new(UVec3::new(4, 3, 2), Vec3::ONE, limits.grid_bytes).unwrap();
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(200, 10, 10));
    for (x, y, z) in [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (0, 1, 0), (0, 2, 0), (0, 2, 1)] {
        grid.set(IVec3::new(x, y, z), true);
    }
    let mut top = Brick::EMPTY;
    top.set(0, 2, 0, true);
    top.set(0, 2, 1, true);
    material.paint(UVec3::ZERO, &top, Rgb::new(10, 200, 10));
    let path = folder.join(name);
    let contents = Contents::new(grid, material);
    format::save(&path, &contents, ExportForm::Auto, &()).unwrap();
    path
}

#[test]
fn a_model_is_shown_as_it_is_made_whichever_way_is_up() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["l.vox", "l.qb"] {
        let path = model(folder.path(), name);
        let Study::Model(study) = study(&path) else { panic!("{name}") };
        let palette = [(Rgb::new(200, 10, 10), 5), (Rgb::new(10, 200, 10), 2)];
        assert_eq!((study.voxels, &study.palette[..]), (7, &palette[..]), "{name}");
        assert_eq!(study.surface.len(), 7);
        let usual = if name == "l.vox" { Up::Z } else { Up::Y };
        assert_eq!(study.up(&ImportOptions::default()), usual);
        let ups = Up::NAMED.iter().map(|(up, _)| Some(*up));
        let plain = load(&path, &ImportOptions::default());
        assert_eq!(plain.grid.dims(), UVec3::new(4, 3, 2), "{name}");
        for upright in ups.chain([None]) {
            let options = ImportOptions { upright, ..ImportOptions::default() };
            let made = load(&path, &options);
            let outlook = study.outlook(&options, &Limits::default()).unwrap();
            assert_eq!(outlook.dims, made.grid.dims(), "{name} {upright:?}");
            assert_eq!(made.grid.opaque_count(), 7);
            if upright.is_none_or(|up| up == usual) {
                assert_eq!(made.grid.dims(), plain.grid.dims());
            }
            let in_grid = study.in_grid(&options);
            for voxel in &study.surface {
                let at = in_grid(voxel.at.as_vec3() + 0.5).floor();
                assert!(made.grid.get(at.as_ivec3()), "{name} {upright:?} {at}");
                assert_eq!(made.rgb(at.as_uvec3()), voxel.colour);
                for (side, by) in [Vec3::NEG_X, Vec3::X, Vec3::NEG_Y, Vec3::Y, Vec3::NEG_Z, Vec3::Z]
                    .into_iter()
                    .enumerate()
                {
                    let beside = in_grid(voxel.at.as_vec3() + 0.5 + by).floor().as_ivec3();
                    let is_open = voxel.open_sides >> side & 1 != 0;
                    assert_eq!(is_open, !made.grid.get(beside), "{name} {upright:?} {beside}");
                }
            }
        }
        let half = ImportOptions {
            mesh_size: MeshSize::VoxelMm(0.5),
            upright: Some(Up::X),
            ..ImportOptions::default()
        };
        let outlook = study.outlook(&half, &Limits::default()).unwrap();
        let made = load(&path, &half).grid.voxel_size();
        assert_eq!((outlook.voxel_size, made), (Vec3::splat(0.5), Vec3::splat(0.5)), "{name}");
        let grey = ImportOptions { colouring: Colouring::Grey, ..ImportOptions::default() };
        assert!(study.outlook(&grey, &Limits::default()).is_err());
        let small = Limits { grid_bytes: 8, ..Limits::default() };
        assert!(study.outlook(&ImportOptions::default(), &small).is_err());
    }
}

#[test]
fn the_given_up_axis_is_used_or_the_person_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let patient = "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n";
    let options = ImportOptions { upright: Some(Up::MinusX), ..ImportOptions::default() };
    for (path, is_told) in [
        (scan(folder.path(), "lies.nrrd", patient), true),
        (scan(folder.path(), "open.nrrd", ""), false),
        (model(folder.path(), "l.vox"), false),
        (model(folder.path(), "l.vsc"), true),
    ] {
        let told = |options: &ImportOptions| {
            let loaded = format::load(&path, options, &Limits::default(), &()).unwrap();
            loaded.notes.iter().any(|note| note.contains("`-x`"))
        };
        assert_eq!(told(&options), is_told, "{path:?}");
        assert!(!told(&ImportOptions::default()));
    }
}

#[test]
fn files_that_leave_nothing_open_are_told_apart() {
    for (name, of) in [
        ("a.vsc", None),
        ("a.vox", Some(Family::Model)),
        ("a.txt", None),
        ("a", None),
        ("a.nii.gz", Some(Family::Volume)),
        ("a.PVM", Some(Family::Volume)),
        ("a.tif", Some(Family::Volume)),
        ("a.stl", Some(Family::Mesh)),
    ] {
        assert_eq!(format::family(Path::new(name)), of, "{name}");
    }
    // A volume written by this program describes itself completely.
    let folder = tempfile::tempdir().unwrap();
    let path = scan(folder.path(), "a.nrrd", "");
    let contents = load(&path, &ImportOptions::default());
    let own = folder.path().join("own.pvm");
    format::save(&own, &contents, Default::default(), &()).unwrap();
    assert!(matches!(study(&own), Study::Settled));
}

/// Every file that can be opened can be studied first, and other files are refused alike.
#[test]
fn bad_files_are_refused_as_the_import_refuses_them() {
    let manifest = shared_file("data/bad/MANIFEST.tsv");
    let folder = manifest.parent().unwrap().to_path_buf();
    let mut seen = 0;
    for line in std::fs::read_to_string(&manifest).unwrap().lines() {
        let path = folder.join(line.split('\t').next().unwrap());
        let is_small = std::fs::metadata(&path).is_ok_and(|file| file.len() < 1 << 18);
        if format::family(&path).is_none() || !is_small {
            continue;
        }
        seen += 1;
        let found = format::study(&path, &ImportOptions::default(), &Limits::default(), &());
        let small = ImportOptions { mesh_size: MeshSize::LongestVx(16), ..Default::default() };
        let made = format::load(&path, &small, &Limits::default(), &());
        match (found, made) {
            (Err(error), Ok(_)) => panic!("{path:?} can be opened, but: {error}"),
            (Err(error), Err(_)) => assert!(error.to_string().len() > 16, "{path:?}: {error}"),
            _ => {}
        }
    }
    assert!(seen > 40, "{seen}");
}
