//! Tests that files are read back, most by small readers of their own, and equal the mesh.

use std::fs;
use std::io::Read;
use std::path::Path;

use glam::Vec3;

use super::save::{MeshSummary, save_mesh};
use super::{MeshOptions, MeshUp, linear};
use crate::format::FormatError;
use crate::format::options::ExportForm;
use crate::mesh::tests::check::{check, welded};
use crate::mesh::{Mesh, MeshKind, VertexColours};
use crate::progress::ProgressReport;
use crate::scenes::grid_of;
use crate::sculpture::history::Contents;
use crate::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};

const RED: Rgb = Rgb::new(250, 20, 40);

/// Returns a cone with a hole, partly painted.
fn subject() -> Contents {
    let grid = grid_of(20, |p| {
        let r = (p.x - 10.0).hypot(p.z - 8.0);
        r < 8.0 - p.y * 0.4 && r > 2.0 && p.y < 15.0
    });
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    material.paint(glam::UVec3::ZERO, &Brick::FULL, RED);
    Contents::new(grid, material)
}

fn write(name: &str, options: &MeshOptions) -> (tempfile::TempDir, MeshSummary) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let summary = save_mesh(&path, &subject(), options, &Limits::default(), &()).unwrap();
    (folder, summary)
}

fn floats<const N: usize>(bytes: &[u8]) -> [f32; N] {
    std::array::from_fn(|i| f32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().unwrap()))
}

/// Returns the mesh in millimetres, for a voxel size of one.
fn expected(kind: MeshKind, up: MeshUp) -> (Vec<Vec3>, Vec<[u32; 3]>, Vec<Rgb>) {
    let mesh = Mesh::of(&subject(), kind, VertexColours::Voxels, &Limits::default(), &()).unwrap();
    let turned = |p: Vec3| match up {
        MeshUp::Y => p,
        MeshUp::Z => Vec3::new(p.x, 20.0 - p.z, p.y),
    };
    (mesh.positions().map(turned).collect(), mesh.triangles().collect(), mesh.colours().collect())
}

#[test]
fn an_stl_file_holds_closed_triangles_with_their_normals() {
    for kind in [MeshKind::Faces, MeshKind::Smooth] {
        let (folder, summary) = write("a.stl", &MeshOptions { kind, ..Default::default() });
        let bytes = fs::read(folder.path().join("a.stl")).unwrap();
        let (positions, triangles, _) = expected(kind, MeshUp::Z);
        assert_eq!(bytes.len(), 84 + 50 * triangles.len());
        assert_eq!(&bytes[80..84], (triangles.len() as u32).to_le_bytes());
        assert!(!bytes.starts_with(b"solid"));
        let mut corners = Vec::new();
        for (record, triangle) in bytes[84..].chunks_exact(50).zip(&triangles) {
            let [nx, ny, nz, rest @ ..] = floats::<12>(record);
            let own: Vec<Vec3> = rest.chunks(3).map(Vec3::from_slice).collect();
            assert_eq!(own, triangle.map(|vertex| positions[vertex as usize]));
            let out = (own[1] - own[0]).cross(own[2] - own[0]).normalize();
            assert!(out.distance(Vec3::new(nx, ny, nz)) < 1e-5);
            corners.extend(own);
        }
        let soup: Vec<[u32; 3]> =
            (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let (positions, soup) = welded(&corners, &soup);
        let sound = check(&positions, &soup).unwrap();
        assert_eq!((sound.surfaces, sound.handles), (1, 1));
        assert_eq!(positions.len() as u64, summary.vertices);
        let size = |axis: usize| {
            let all = positions.iter().map(|p| p[axis]);
            all.clone().fold(f32::MIN, f32::max) - all.fold(f32::MAX, f32::min)
        };
        assert!((summary.size_mm - Vec3::new(size(0), size(1), size(2))).length() < 1e-4);
    }
}

#[test]
fn a_ply_file_holds_vertices_with_colours() {
    for points_only in [false, true] {
        let options = MeshOptions { points_only, up: Some(MeshUp::Y), ..Default::default() };
        let (folder, _) = write("a.PLY", &options);
        let bytes = fs::read(folder.path().join("a.PLY")).unwrap();
        let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
        let header = std::str::from_utf8(&bytes[..end]).unwrap();
        let (positions, triangles, colours) = expected(MeshKind::Smooth, MeshUp::Y);
        assert!(header.contains(&format!("element vertex {}\n", positions.len())));
        assert_eq!(header.contains("element face"), !points_only);
        let (vertices, faces) = bytes[end..].split_at(15 * positions.len());
        for ((record, position), colour) in vertices.chunks_exact(15).zip(&positions).zip(&colours)
        {
            assert_eq!(Vec3::from(floats::<3>(record)), *position);
            assert_eq!(record[12..], colour.0);
        }
        assert!(colours.contains(&RED) && colours.contains(&Rgb::STONE));
        let expected_faces = if points_only { 0 } else { 13 * triangles.len() };
        assert_eq!(faces.len(), expected_faces);
        for (record, triangle) in faces.chunks_exact(13).zip(&triangles) {
            assert_eq!(record[0], 3);
            let index = |i: usize| u32::from_le_bytes(record[i..i + 4].try_into().unwrap());
            assert_eq!([index(1), index(5), index(9)], *triangle);
        }
    }
}

#[test]
fn an_obj_file_names_its_material_and_has_colours() {
    let kind = MeshKind::Faces;
    let (folder, _) = write("a b.obj", &MeshOptions { kind, ..Default::default() });
    let text = fs::read_to_string(folder.path().join("a b.obj")).unwrap();
    assert!(text.contains("mtllib a b.mtl\n"));
    assert!(
        fs::read_to_string(folder.path().join("a b.mtl")).unwrap().contains("newmtl sculpture\n")
    );
    let (positions, triangles, colours) = expected(kind, MeshUp::Y);
    let numbers = |line: &str| -> Vec<f32> {
        line.split(' ').skip(1).map(|number| number.parse().unwrap()).collect()
    };
    let vertices: Vec<Vec<f32>> =
        text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
    assert_eq!(vertices.len(), positions.len());
    for ((vertex, position), Rgb(colour)) in vertices.iter().zip(&positions).zip(&colours) {
        assert_eq!(Vec3::from_slice(vertex), *position);
        let own = [3, 4, 5].map(|i| (vertex[i] * 255.0).round() as u8);
        assert_eq!(own, *colour);
    }
    let faces = text.lines().filter(|line| line.starts_with("f ")).map(numbers);
    assert!(faces.eq(triangles.iter().map(|t| t.map(|vertex| vertex as f32 + 1.0).to_vec())));
}

#[test]
fn a_glb_file_is_valid_and_in_metres() {
    for kind in [MeshKind::Faces, MeshKind::Smooth] {
        let (folder, _) = write("a.glb", &MeshOptions { kind, ..Default::default() });
        let bytes = fs::read(folder.path().join("a.glb")).unwrap();
        let file = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = file.blob.clone().unwrap();
        let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(&blob));
        let (positions, triangles, colours) = expected(kind, MeshUp::Y);
        let read: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
        assert_eq!(read.len(), positions.len());
        let far = read.iter().zip(&positions).any(|(a, b)| a.distance(*b * 1e-3) > 1e-8);
        assert!(!far);
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        assert_eq!(indices, triangles.concat());
        let read = reader.read_colors(0).unwrap().into_rgb_f32();
        for (own, Rgb(colour)) in read.zip(&colours) {
            for (own, channel) in own.iter().zip(*colour) {
                assert!((own - linear(channel)).abs() < 1e-4);
            }
        }
        let normals = reader.read_normals();
        assert_eq!(normals.is_some(), kind == MeshKind::Smooth);
        assert!(normals.into_iter().flatten().all(|n| (Vec3::from(n).length() - 1.0).abs() < 1e-4));
        let bounds = primitive.bounding_box();
        let low = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        assert!(Vec3::from(bounds.min).distance(low * 1e-3) < 1e-8);
    }
}

#[test]
fn a_3mf_file_is_a_zip_archive_with_the_mesh_and_its_colours() {
    let (folder, _) = write("a.3mf", &MeshOptions::default());
    let file = fs::File::open(folder.path().join("a.3mf")).unwrap();
    let mut zip = zip::ZipArchive::new(file).unwrap();
    let mut text = |name: &str| {
        let mut text = String::new();
        zip.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    };
    for name in ["[Content_Types].xml", "_rels/.rels"] {
        roxmltree::Document::parse(&text(name)).unwrap();
    }
    let model = text("3D/3dmodel.model");
    let model = roxmltree::Document::parse(&model).unwrap();
    assert_eq!(model.root_element().attribute("unit"), Some("millimeter"));
    let all = |name: &'static str| {
        model.descendants().filter(move |node| node.tag_name().name() == name).collect::<Vec<_>>()
    };
    let (positions, triangles, colours) = expected(MeshKind::Smooth, MeshUp::Z);
    let palette: Vec<String> =
        all("color").iter().map(|node| node.attribute("color").unwrap().to_string()).collect();
    let number = |node: &roxmltree::Node, name: &str| -> f32 {
        node.attribute(name).unwrap().parse().unwrap()
    };
    let vertices = all("vertex");
    assert_eq!(vertices.len(), positions.len());
    for (node, position) in vertices.iter().zip(&positions) {
        assert_eq!(Vec3::from(["x", "y", "z"].map(|name| number(node, name))), *position);
    }
    let faces = all("triangle");
    assert_eq!(faces.len(), triangles.len());
    for (node, triangle) in faces.iter().zip(&triangles) {
        for (i, vertex) in triangle.iter().enumerate() {
            assert_eq!(number(node, ["v1", "v2", "v3"][i]) as u32, *vertex);
            let Rgb([r, g, b]) = colours[*vertex as usize];
            let colour = &palette[number(node, ["p1", "p2", "p3"][i]) as usize];
            assert_eq!(*colour, format!("#{r:02X}{g:02X}{b:02X}FF"));
        }
    }
}

#[test]
fn a_voxel_has_the_length_that_is_asked_for_and_the_sculptures_proportions() {
    let mut grid = Grid::new(glam::UVec3::splat(4), Vec3::new(0.5, 1.0, 2.0), 1 << 20).unwrap();
    grid.set(glam::IVec3::ONE, true);
    let material = Material::for_grid(&grid, ColourDepth::None, RED);
    let contents = Contents::new(grid, material);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    let size = |up, voxel_mm| {
        let options = MeshOptions { kind: MeshKind::Faces, up, voxel_mm, ..Default::default() };
        save_mesh(&path, &contents, &options, &Limits::default(), &()).unwrap().size_mm
    };
    assert_eq!(size(Some(MeshUp::Y), None), Vec3::new(0.5, 1.0, 2.0));
    assert_eq!(size(None, None), Vec3::new(0.5, 2.0, 1.0));
    assert_eq!(size(Some(MeshUp::Y), Some(3.0)), Vec3::new(3.0, 6.0, 12.0));
}

#[test]
fn impossible_exports_are_refused_with_a_remedy_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let refuse = |name: &str, options: MeshOptions, remedy: &str| {
        let path = folder.path().join(name);
        let error = save_mesh(&path, &subject(), &options, &Limits::default(), &()).unwrap_err();
        assert!(error.to_string().contains(remedy), "{error}");
    };
    let plain = MeshOptions::default();
    refuse("a.pvm", plain, ".stl");
    refuse("a.glb", MeshOptions { up: Some(MeshUp::Z), ..plain }, "leave out the axis");
    refuse("a.stl", MeshOptions { points_only: true, ..plain }, ".ply");
    for length in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        refuse("a.stl", MeshOptions { voxel_mm: Some(length), ..plain }, "positive");
    }
    let path = folder.path().join("a.stl");
    let mut empty = subject();
    empty.grid.fill_bricks(|_| Brick::EMPTY);
    let made = save_mesh(&path, &empty, &plain, &Limits::default(), &());
    assert!(matches!(made, Err(FormatError::NoSurface)));
    let report = ProgressReport::default();
    report.cancel();
    let made = save_mesh(&path, &subject(), &plain, &Limits::default(), &report);
    assert!(matches!(made, Err(FormatError::Cancelled)));
    let made = crate::format::save(&path, &subject(), ExportForm::Rgba, &());
    assert!(matches!(made, Err(FormatError::FormOfMesh { form: ExportForm::Rgba, .. })));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    crate::format::save(&path, &subject(), ExportForm::Auto, &()).unwrap();
    assert!(Path::exists(&path));
}

#[test]
fn faces_are_merged_across_colours_where_a_file_has_none() {
    let greedy = MeshOptions { kind: MeshKind::Greedy, ..MeshOptions::default() };
    let [stl, ply] = ["cone.stl", "cone.ply"].map(|name| write(name, &greedy).1.triangles);
    let plain = Contents {
        material: Material::for_grid(&subject().grid, ColourDepth::None, RED),
        ..subject()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plain.stl");
    let one_colour = save_mesh(&path, &plain, &greedy, &Limits::default(), &()).unwrap();
    assert_eq!(stl, one_colour.triangles);
    assert!(ply > stl, "{ply} {stl}: the cone is painted in part");
}

/// Notes the last progress that each piece of work reported.
#[derive(Default)]
struct LastShares(std::sync::Mutex<Vec<(String, f32)>>);

impl crate::progress::Progress for LastShares {
    fn begin(&self, what: &str) {
        self.0.lock().unwrap().push((what.to_string(), 0.0));
    }

    fn advance(&self, done: f32) {
        let mut shares = self.0.lock().unwrap();
        let (_, last) = shares.last_mut().unwrap();
        assert!(done >= *last && done <= 1.0, "{done} after {last}");
        *last = done;
    }

    fn end(&self) {}
}

#[test]
fn the_progress_of_writing_ends_near_the_whole() {
    // Some hundred thousand faces: a comb of walls.
    let grid = grid_of(80, |p| p.x as u32 % 4 < 2 && p.x > 2.0);
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    material.paint(glam::UVec3::ZERO, &Brick::FULL, RED);
    let contents = Contents::new(grid, material);
    let folder = tempfile::tempdir().unwrap();
    for (name, kind) in [
        ("a.stl", MeshKind::Faces),
        ("a.ply", MeshKind::Faces),
        ("a.obj", MeshKind::Faces),
        ("a.glb", MeshKind::Faces),
        ("a.3mf", MeshKind::Faces),
        ("b.glb", MeshKind::Smooth),
        ("c.3mf", MeshKind::Greedy),
    ] {
        let options = MeshOptions { kind, ..MeshOptions::default() };
        let shares = LastShares::default();
        let path = folder.path().join(name);
        save_mesh(&path, &contents, &options, &Limits::default(), &shares).unwrap();
        let shares = shares.0.into_inner().unwrap();
        assert_eq!(shares.last().unwrap().0, "writing");
        for (what, last) in &shares {
            // There are too few merged faces for a report.
            let is_short = kind == MeshKind::Greedy && what == "writing";
            assert!(*last > 0.85 || is_short, "{name}: {what} {last}");
        }
    }
}

/// Is cancelled after a given number of checks.
struct CancelledAfter(std::sync::atomic::AtomicI64);

impl crate::progress::Progress for CancelledAfter {
    fn begin(&self, _: &str) {}
    fn advance(&self, _: f32) {}
    fn end(&self) {}

    fn is_cancelled(&self) -> bool {
        self.0.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) <= 0
    }
}

#[test]
fn work_that_is_cancelled_at_any_moment_leaves_no_file() {
    let grid = grid_of(48, |p| p.x as u32 % 4 < 2 && p.x > 2.0);
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    material.paint(glam::UVec3::ZERO, &Brick::FULL, RED);
    let contents = Contents::new(grid, material);
    let folder = tempfile::tempdir().unwrap();
    for (name, kind) in
        [("a.glb", MeshKind::Smooth), ("a.3mf", MeshKind::Greedy), ("a.stl", MeshKind::Faces)]
    {
        let options = MeshOptions { kind, ..MeshOptions::default() };
        let path = folder.path().join(name);
        let (mut asked, mut next) = (0, 1);
        loop {
            let progress = CancelledAfter(asked.into());
            match save_mesh(&path, &contents, &options, &Limits::default(), &progress) {
                Err(FormatError::Cancelled) => {}
                made => {
                    made.unwrap();
                    break;
                }
            }
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{name} {asked}");
            (asked, next) = (asked + next, asked.max(1));
        }
        assert!(asked > 3, "{name}: {asked}");
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn the_memory_that_a_file_takes_beside_its_mesh_is_counted() {
    let count = |kind| {
        let mesh = Mesh::of(&subject(), kind, VertexColours::Voxels, &Limits::default(), &());
        mesh.unwrap().heap_bytes()
    };
    let folder = tempfile::tempdir().unwrap();
    for (name, kind) in [("a.glb", MeshKind::Smooth), ("a.3mf", MeshKind::Faces)] {
        let options = MeshOptions { kind, ..MeshOptions::default() };
        // Memory for the mesh, and nothing else.
        let grid_bytes = count(kind) + 4096;
        let limits = Limits { grid_bytes, colour_bytes: 0, ..Limits::default() };
        Mesh::of(&subject(), kind, VertexColours::Voxels, &limits, &()).unwrap();
        let path = folder.path().join(name);
        let error = save_mesh(&path, &subject(), &options, &limits, &()).unwrap_err();
        assert!(error.to_string().contains("the mesh needs at least"), "{name}: {error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
