//! Files from practice: typical output of exporters, and files from public bug reports. A table of files with their
//! correct values, which were computed by programs that share no code with this one (trimesh, tifffile, nibabel,
//! pynrrd, pydicom).
//!
//! Files that were made for these tests lie in `fixtures/field`; those of other projects are in the shared folder, and
//! are skipped if it is missing.

mod made;
mod reports;
mod reports_scans;
mod scans;
mod volumes;
mod zstd;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use sculpture_core::format::options::{Colouring, Existence, ImportOptions, MeshSize, RawLayout};
use sculpture_core::format::{self, Loaded};
use sculpture_core::sculpture::brick::local_coords;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{Limits, Rgb};
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::Gray8;
use tiff::tags::Tag;
use trials::shared_file;

/// The size of a mesh in the table.
const MILLIMETRE: MeshSize = MeshSize::VoxelMm(1.0);
/// The density from which on voxels of the scans in the table are counted.
#[allow(dead_code)]
const DENSE: Existence = Existence::Threshold(500.0);

/// The correct values of a file; unset values are not checked.
#[derive(Default)]
struct Right {
    existence: Existence,
    size: Option<MeshSize>,
    /// Size of the sculpture, y up.
    dims: Option<[u32; 3]>,
    /// Size and edges of a voxel in the file.
    file_dims: Option<[u32; 3]>,
    voxel: Option<[f32; 3]>,
    count: Option<u64>,
    /// The number of voxels of each colour; all of them if any are listed.
    colours: &'static [([u8; 3], u64)],
    /// Colours that occur.
    shown: &'static [[u8; 3]],
    /// Voxels of each layer of the file, its third axis.
    layers: &'static [u64],
    /// Number of triangles in the file.
    triangles: Option<&'static str>,
    /// Parts of the messages.
    notes: &'static [&'static str],
    /// Whether there must be no message.
    is_silent: bool,
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/field").join(name)
}

fn foreign(name: &str) -> PathBuf {
    shared_file(&format!("data/field/{name}"))
}

fn options(right: &Right) -> ImportOptions {
    let mesh_size = right.size.unwrap_or(MILLIMETRE);
    ImportOptions { existence: right.existence, mesh_size, ..ImportOptions::default() }
}

fn load(path: &Path, options: &ImportOptions) -> Result<Loaded, String> {
    format::load(path, options, &Limits::default(), &()).map_err(|error| error.to_string())
}

fn voxels(contents: &Contents) -> Vec<(UVec3, Rgb)> {
    let mut all = Vec::new();
    for (at, brick) in contents.grid.nonempty_bricks() {
        brick.for_each(|local| all.push(at * 8 + UVec3::from(local_coords(local))));
    }
    all.into_iter().map(|v| (v, contents.rgb(v))).collect()
}

/// Checks a file. Returns all errors.
fn wrong(path: &Path, right: &Right) -> Vec<String> {
    let loaded = match load(path, &options(right)) {
        Ok(loaded) => loaded,
        Err(error) => return vec![error],
    };
    let (grid, all) = (&loaded.contents.grid, voxels(&loaded.contents));
    let mut wrong = Vec::new();
    let mut check = |what: &str, found: String, expected: String| {
        if found != expected {
            wrong.push(format!("{what} {found} instead of {expected}"));
        }
    };
    if let Some(dims) = right.dims {
        check("size", grid.dims().to_string(), UVec3::from(dims).to_string());
    }
    let volume = || format::load_volume(path, &options(right), &Limits::default(), &()).unwrap();
    if let Some(dims) = right.file_dims {
        check("size in the file", volume().dims.to_string(), UVec3::from(dims).to_string());
    }
    if let Some(voxel) = right.voxel {
        let found = volume().voxel_size;
        let is_near = (found - Vec3::from(voxel)).abs().max_element() < 1e-5;
        check(&format!("voxel {found}"), is_near.to_string(), "true".to_string());
    }
    if let Some(count) = right.count {
        check("voxels", all.len().to_string(), count.to_string());
    }
    let mut colours: BTreeMap<[u8; 3], u64> = BTreeMap::new();
    all.iter().for_each(|(_, rgb)| *colours.entry(rgb.0).or_default() += 1);
    if !right.colours.is_empty() {
        let expected: BTreeMap<[u8; 3], u64> = right.colours.iter().copied().collect();
        check("colours", format!("{colours:?}"), format!("{expected:?}"));
    }
    for shown in right.shown {
        check("colours with", format!("{:?}", colours.contains_key(shown)), "true".to_string());
    }
    if !right.layers.is_empty() {
        let volume = volume();
        let dense = |v: UVec3| volume.density(v).is_some_and(|density| density >= 500.0);
        let (width, height) = (volume.dims.x, volume.dims.y);
        let of = |z: u32| {
            let places = (0..width * height).map(|i| UVec3::new(i % width, i / width, z));
            places.filter(|v| dense(*v)).count() as u64
        };
        let layers: Vec<u64> = (0..volume.dims.z).map(of).collect();
        check("layers", format!("{layers:?}"), format!("{:?}", right.layers));
    }
    if let Some(triangles) = right.triangles {
        let info = format::info_with(path, &options(right), &Limits::default(), &()).unwrap();
        let kind = info.kind.rsplit(' ').next().unwrap_or_default();
        check("triangles", kind.to_string(), triangles.to_string());
    }
    for note in right.notes {
        let is_told = loaded.notes.iter().any(|told| told.contains(note));
        check(&format!("notes {:?} with {note}", loaded.notes), is_told.to_string(), "true".into());
    }
    if right.is_silent {
        check("notes", format!("{:?}", loaded.notes), "[]".to_string());
    }
    wrong
}

fn check(path: PathBuf, right: Right) {
    let wrong = wrong(&path, &right);
    assert!(wrong.is_empty(), "{}: {wrong:#?}", path.display());
}

/// Checks that a file is refused: the message has these parts, and does not call it damaged.
fn refused(path: PathBuf, parts: &[&str]) {
    let error = load(&path, &ImportOptions::default()).unwrap_err();
    for part in parts {
        assert!(error.contains(part), "{}: {error}", path.display());
    }
    assert!(!error.contains("damaged"), "{}: {error}", path.display());
}

/// The layers of the block that most scans of the table hold.
const LAYERS: [u64; 10] = [24, 36, 48, 60, 72, 84, 96, 108, 120, 132];

/// Returns the values of a box of 10 x 20 x 30 in the file.
fn a_box(dims: [u32; 3]) -> Right {
    Right { dims: Some(dims), count: Some(6000), triangles: Some("12"), ..Right::default() }
}

/// Returns the values of the scan of 24 x 20 x 10 in the file.
fn scan() -> Right {
    let (file_dims, count) = (Some([24, 20, 10]), Some(780));
    Right { existence: DENSE, file_dims, count, layers: &LAYERS, ..Right::default() }
}

const FINE: Option<[f32; 3]> = Some([0.5, 0.5, 2.0]);

#[test]
fn obj_lines_that_go_on_in_the_next() {
    check(fixture("01_obj_backslash_box.obj"), Right { is_silent: true, ..a_box([10, 20, 30]) });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tight.obj");
    let text = std::fs::read_to_string(fixture("01_obj_backslash_box.obj")).unwrap();
    std::fs::write(&path, format!("\u{FEFF}{}", text.replace(" \\\n  ", "\\\r\n"))).unwrap();
    check(path, a_box([10, 20, 30]));
}

#[test]
fn obj_lines_of_other_programs_that_go_on() {
    let right = Right { triangles: Some("66"), dims: Some([10, 15, 10]), ..Right::default() };
    check(foreign("01_obj_backslash_wallhole.obj"), right);
}

#[test]
fn obj_faces_of_two_corners_are_left_out() {
    let notes = &["fewer than three corners, which were left out: 1"];
    check(fixture("22_obj_two_corner_face.obj"), Right { notes, ..a_box([10, 20, 30]) });
}

#[test]
fn obj_faces_of_two_corners_of_other_programs() {
    let right = Right {
        triangles: Some("1"),
        size: Some(MeshSize::LongestVx(32)),
        notes: &["fewer than three corners, which were left out: 1", "surface.mtl"],
        ..Right::default()
    };
    check(foreign("22_obj_real_notenoughindices.obj"), right);
}

#[test]
fn obj_with_several_libraries_on_a_line() {
    let shown = &[[255, 0, 0], [0, 0, 255]];
    check(
        fixture("23_obj_two_mtllibs.obj"),
        Right { shown, is_silent: true, ..a_box([10, 20, 30]) },
    );
}

#[test]
fn obj_whose_places_in_the_texture_are_missing() {
    let text = std::fs::read_to_string(fixture("01_obj_backslash_box.obj")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.obj");
    std::fs::write(&path, text.replace("f 1 2 \\\n4 3", "f 1/1 2/2 4/4 3/3")).unwrap();
    check(path, Right { notes: &["colours were left out: 4"], ..a_box([10, 20, 30]) });
}

#[test]
fn obj_of_other_programs_whose_places_in_the_texture_are_missing() {
    let right = Right {
        triangles: Some("12"),
        size: Some(MeshSize::LongestVx(16)),
        dims: Some([16, 16, 16]),
        notes: &["colours were left out"],
        ..Right::default()
    };
    check(foreign("24_obj_real_cubevt_missing_vt.obj"), right);
}

#[test]
fn ply_texts_with_values_that_are_not_declared() {
    let notes = &["does not declare, which were left out: 120"];
    check(fixture("02_ply_ascii_undeclared_box.ply"), Right { notes, ..a_box([10, 30, 20]) });
}

#[test]
fn ply_texts_of_other_programs_with_values_that_are_not_declared() {
    let path = foreign("02_ply_ascii_undeclared_fuze.ply");
    // From -0.036391, -0.036711, 0.004016 to 0.036221, 0.036803, 0.219144: 72.6 x 73.5 x 215.1 thousandths.
    let right = Right {
        triangles: Some("1000"),
        size: Some(MeshSize::VoxelMm(0.001)),
        dims: Some([73, 216, 74]),
        ..Right::default()
    };
    check(path, right);
}

#[test]
fn stl_in_any_case_and_binary_ones_that_begin_as_texts() {
    for name in ["03_stl_titlecase_box.stl", "03_stl_uppercase_box.stl"] {
        check(fixture(name), Right { is_silent: true, ..a_box([10, 30, 20]) });
    }
    let notes = &["bytes behind the last triangle were left out"];
    check(fixture("03_stl_binary_solid_trailing_box.stl"), Right { notes, ..a_box([10, 30, 20]) });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("marked.stl");
    let text = std::fs::read_to_string(fixture("03_stl_titlecase_box.stl")).unwrap();
    let text = text.replace("EndSolid", "End Solid").replace("Endsolid", "End Solid");
    std::fs::write(&path, format!("\u{FEFF}{text}")).unwrap();
    check(path, a_box([10, 30, 20]));
}

#[test]
fn stl_of_other_programs_in_capitals() {
    let right = Right {
        triangles: Some("12"),
        size: Some(MeshSize::VoxelMm(0.5)),
        dims: Some([8, 8, 8]),
        ..Right::default()
    };
    check(foreign("03_stl_uppercase_admesh_block.stl"), right);
}

#[test]
fn gltf_extensions_are_read_or_refused_by_their_names() {
    let blue = || Right {
        size: Some(MeshSize::VoxelMm(100.0)),
        dims: Some([10, 10, 10]),
        shown: &[[0, 0, 255]],
        ..Right::default()
    };
    check(fixture("14_glb_texture_transform.glb"), blue());
    check(fixture("16_glb_specgloss.glb"), blue());
    let copies = Right { dims: Some([50, 10, 10]), count: Some(3000), shown: &[], ..blue() };
    check(fixture("15_glb_required_instancing.glb"), copies);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("unknown.glb");
    let mut file = std::fs::read(fixture("15_glb_required_instancing.glb")).unwrap();
    let name = b"EXT_mesh_gpu_instancing";
    let all = file.windows(name.len()).enumerate().filter(|(_, part)| part == name);
    all.map(|(at, _)| at).collect::<Vec<_>>().into_iter().for_each(|at| file[at] = b'X');
    std::fs::write(&path, file).unwrap();
    refused(path, &["XXT_mesh_gpu_instancing", "not read"]);
}

#[test]
fn three_mf_parts_in_several_models_and_those_that_are_not_printed() {
    let cube = || Right { dims: Some([20, 20, 20]), count: Some(8000), ..Right::default() };
    check(fixture("17_3mf_production_orca.3mf"), Right { is_silent: true, ..cube() });
    let notes = &["support enforcer: 1"];
    check(fixture("18_3mf_prusa_support_enforcer.3mf"), Right { notes, ..cube() });
}

#[test]
fn three_mf_of_other_programs_in_several_models() {
    // Two tetrahedra; z points up in the file.
    let right = Right { dims: Some([25, 10, 10]), triangles: Some("8"), ..Right::default() };
    check(foreign("17_3mf_production_real_assimp.3mf"), right);
}

#[test]
fn goxel_layers_that_copy_others() {
    let right = Right { count: Some(1024), dims: Some([28, 8, 8]), ..Right::default() };
    check(fixture("19_gox_clone_layer.gox"), right);
}

#[test]
fn goxel_layers_that_are_shapes() {
    check(foreign("19_gox_real_shape_layers.gox"), Right { count: Some(1208), ..Right::default() });
}

#[test]
fn vox_with_short_palettes_and_voxels_outside() {
    for name in ["20_vox_16_palette.vox", "20_vox_255_palette.vox"] {
        let right = Right {
            count: Some(4),
            dims: Some([4, 6, 5]),
            shown: &[[0, 255, 40]],
            is_silent: true,
            ..Right::default()
        };
        check(fixture(name), right);
    }
    let notes = &["outside of their model, which were left out: 1"];
    check(fixture("20_vox_outside.vox"), Right { count: Some(1), notes, ..Right::default() });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trailing.vox");
    let file = std::fs::read(fixture("20_vox_16_palette.vox")).unwrap();
    for behind in [&b"\0\0\0"[..], b"and a long text behind it"] {
        std::fs::write(&path, [&file, behind].concat()).unwrap();
        check(path.clone(), Right { count: Some(4), notes: &["bytes behind"], ..Right::default() });
    }
}

#[test]
fn vox_of_teardown_is_refused_by_its_name() {
    refused(foreign("20_vox_real_teardown.vox"), &["TDCZ", "Teardown"]);
}

/// Returns a TIFF file of pages that hold their index, counted from 0.
fn numbered_pages(folder: &Path, pages: u8, description: &str) -> PathBuf {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for page in 0..pages {
        let mut image = encoder.new_image::<Gray8>(3, 2).unwrap();
        image.encoder().write_tag(Tag::ImageDescription, description).unwrap();
        image.write_data(&[page; 6]).unwrap();
    }
    let path = folder.join("a.ome.tif");
    std::fs::write(&path, bytes.into_inner()).unwrap();
    path
}
