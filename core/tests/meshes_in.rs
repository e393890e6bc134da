//! Meshes of other programs through the public interface: real ones become the expected shapes, and small ones are the
//! same in all formats.

use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use sculpture_core::format::options::{ImportOptions, MeshFill, MeshSize};
use sculpture_core::format::{self, FormatError, Loaded};
use sculpture_core::sculpture::orientation::Up;
use sculpture_core::sculpture::{Limits, Rgb};
use trials::shared_file;

fn load(path: &Path, options: &ImportOptions) -> Result<Loaded, FormatError> {
    format::load(path, options, &Limits::default(), &())
}

fn sized(longest_vx: u32) -> ImportOptions {
    ImportOptions { mesh_size: MeshSize::LongestVx(longest_vx), ..ImportOptions::default() }
}

fn shared(name: &str, options: &ImportOptions) -> Loaded {
    load(&shared_file(&format!("data/mesh/{name}")), options)
        .unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn real_meshes_become_solids_or_shells() {
    for (name, is_noted) in [
        // Her texture lies beside her, but no file refers to it.
        ("spot_triangulated.obj", true),
        ("spot_control_mesh.obj", true),
        ("teapot.obj", true),
        // Its materials are missing.
        ("vengi_cube.obj", true),
        ("vengi_cube.stl", false),
        ("vengi_cube.ply", false),
        ("vengi_ascii.stl", true),
        ("vengi_ascii.ply", true),
        ("ant.ply", false),
        ("nut.ply", false),
    ] {
        let loaded = shared(name, &sized(64));
        let grid = &loaded.contents.grid;
        assert_eq!(grid.dims().max_element(), 64, "{name}");
        trials::note!("{name}: {} {} {:?}", grid.dims(), grid.opaque_count(), loaded.notes);
        assert_eq!(!loaded.notes.is_empty(), is_noted, "{name}: {:?}", loaded.notes);
        // Open meshes are reported as such.
        let info = format::info_with(
            &shared_file(&format!("data/mesh/{name}")),
            &sized(64),
            &Limits::default(),
            &(),
        );
        assert_eq!(info.unwrap().dims, grid.dims(), "{name}");
    }
}

#[test]
fn spot_is_as_large_as_her_mesh_and_has_her_colours() {
    let options = sized(96);
    let spot = shared("spot_triangulated.obj", &options).contents;
    assert_eq!(spot.grid.dims().z, 96);
    // The volume that the triangles enclose, by the divergence theorem.
    let text = std::fs::read_to_string(shared_file("data/mesh/spot_triangulated.obj")).unwrap();
    let numbers = |line: &str| -> Vec<f64> {
        let first = |word: &str| word.split('/').next().unwrap().parse().unwrap();
        line.split_whitespace().skip(1).map(first).collect()
    };
    let lines = |start: &'static str| text.lines().filter(move |line| line.starts_with(start));
    let points: Vec<Vec<f64>> = lines("v ").map(numbers).collect();
    let volume: f64 = lines("f ")
        .map(|line| {
            let [a, b, c] = [0, 1, 2].map(|i| {
                let p = &points[numbers(line)[i] as usize - 1];
                glam::DVec3::new(p[0], p[1], p[2])
            });
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    let (low, high) =
        points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[2]), h.max(p[2])));
    let expected = volume * (96.0 / (high - low)).powi(3);
    let share = spot.grid.opaque_count() as f64 / expected;
    assert!((share - 1.0).abs() < 0.01, "{share}");
    // White, black, and the pink of her nose.
    let mut kinds = [0; 3];
    for (at, brick) in spot.grid.nonempty_bricks() {
        brick.for_each(|local| {
            let v = at * 8 + UVec3::from(sculpture_core::sculpture::brick::local_coords(local));
            let Rgb([r, g, b]) = spot.rgb(v);
            kinds[0] += u32::from(r.min(g).min(b) > 220);
            kinds[1] += u32::from(r.max(g).max(b) < 60);
            kinds[2] += u32::from(r > 180 && r > g.saturating_add(40));
        });
    }
    assert!(kinds.iter().all(|count| *count > 40), "{kinds:?}");
}

/// The corners and triangles of a box of 4 x 2 x 1 in files of all formats.
struct Files {
    folder: tempfile::TempDir,
}

const SIZE: [f32; 3] = [4.0, 2.0, 1.0];
const QUADS: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn corner(i: u32) -> [f32; 3] {
    std::array::from_fn(|axis| if i >> axis & 1 != 0 { SIZE[axis] } else { 0.0 })
}

fn triangles() -> Vec<[u32; 3]> {
    QUADS.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Returns a `.glb` of a description and the bytes of its buffer.
pub fn glb_file(json: &str, binary: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let (json, binary) = (padded(json.as_bytes(), b' '), padded(binary, 0));
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

impl Files {
    fn new() -> Files {
        Files { folder: tempfile::tempdir().unwrap() }
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn obj(&self) -> PathBuf {
        let points =
            (0..8).map(|i| format!("v {} {} {}\n", corner(i)[0], corner(i)[1], corner(i)[2]));
        let faces = QUADS
            .iter()
            .map(|q| format!("f {} {}//1 -{} {}\n", q[0] + 1, q[1] + 1, 8 - q[2], q[3] + 1));
        self.write("a.obj", points.chain(faces).collect::<String>())
    }

    fn stl(&self, is_text: bool) -> PathBuf {
        if is_text {
            let facet = |t: &[u32; 3]| {
                let lines = t.map(|c| {
                    format!("vertex {} {} {}\n", corner(c)[0], corner(c)[1], corner(c)[2])
                });
                format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", lines.concat())
            };
            let facets: String = triangles().iter().map(facet).collect();
            return self.write("text.stl", format!("solid a\n{facets}endsolid a\n"));
        }
        let mut file = b"solid, but binary".to_vec();
        file.resize(80, 0);
        file.extend(12u32.to_le_bytes());
        for triangle in triangles() {
            file.extend([0; 12]);
            triangle.iter().for_each(|c| file.extend(floats(&corner(*c))));
            file.extend([0; 2]);
        }
        self.write("binary.stl", file)
    }

    fn ply(&self, format: &str) -> PathBuf {
        let mut file = format!(
            "ply\nformat {format} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty double z\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 6\n\
             property uchar flags\nproperty list uchar int vertex_indices\nend_header\n"
        )
        .into_bytes();
        let is_big = format.contains("big");
        for i in 0..8 {
            let [x, y, z] = corner(i);
            match format {
                "ascii" => file.extend(format!("{x} {y} {z} 9 99 199\n").bytes()),
                _ => {
                    [x, y].iter().for_each(|v| {
                        file.extend(if is_big { v.to_be_bytes() } else { v.to_le_bytes() })
                    });
                    let z = f64::from(z);
                    file.extend(if is_big { z.to_be_bytes() } else { z.to_le_bytes() });
                    file.extend([9, 99, 199]);
                }
            }
        }
        for quad in QUADS {
            match format {
                "ascii" => file.extend(
                    format!("7 4 {} {} {} {}\n", quad[0], quad[1], quad[2], quad[3]).bytes(),
                ),
                _ => {
                    file.extend([7, 4]);
                    quad.iter().for_each(|v| {
                        file.extend(if is_big { v.to_be_bytes() } else { v.to_le_bytes() })
                    });
                }
            }
        }
        self.write(&format!("{format}.ply"), file)
    }

    /// Returns a file of half the size in metres, doubled by a node; with a red corner colour, linear, and a factor of
    /// the material.
    fn glb(&self, change: impl Fn(String) -> String) -> PathBuf {
        let points: Vec<f32> = (0..8).flat_map(|i| corner(i).map(|v| v / 2.0)).collect();
        let indices: Vec<u8> =
            triangles().iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()).collect();
        let mut binary = floats(&points);
        binary.extend(&indices);
        binary.extend([255, 0, 0, 255].repeat(8));
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
            "nodes":[{{"children":[1],"scale":[2,2,2]}},{{"mesh":0,"translation":[5,0,0]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":2}},"indices":1,"material":0}}]}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,1,1,1]}}}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}},
            {{"bufferView":2,"componentType":5121,"normalized":true,"count":8,"type":"VEC4"}}],
            "bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":72}},
            {{"buffer":0,"byteOffset":168,"byteLength":32}}],"buffers":[{{"byteLength":{}}}]}}"#,
            binary.len()
        );
        self.write("a.glb", glb_file(&change(json), &binary))
    }
}

#[test]
fn the_same_box_in_all_formats() {
    let files = Files::new();
    let ply = ["ascii", "binary_little_endian", "binary_big_endian"];
    let mut paths = vec![files.obj(), files.stl(true), files.stl(false), files.glb(|json| json)];
    paths.extend(ply.map(|format| files.ply(format)));
    for path in &paths {
        let loaded = load(path, &sized(16)).unwrap_or_else(|e| panic!("{path:?}: {e}"));
        let grid = &loaded.contents.grid;
        let ending = path.extension().unwrap().to_str().unwrap();
        // z points up in the files of most printing programs, y in others; glTF specifies y.
        let (lying, standing) = (UVec3::new(16, 8, 4), UVec3::new(16, 4, 8));
        let usual = if ["stl", "ply"].contains(&ending) { standing } else { lying };
        assert_eq!((grid.dims(), grid.opaque_count()), (usual, 512), "{path:?}");
        assert_eq!(loaded.notes, Vec::<String>::new(), "{path:?}");
        let is_glb = ending == "glb";
        assert_eq!(loaded.assumed_up.is_none(), is_glb, "{path:?}");
        let size = if is_glb { 250.0 } else { 0.25 };
        assert_eq!(grid.voxel_size(), Vec3::splat(size), "{path:?}");
        let expected = match ending {
            "ply" => Rgb::new(9, 99, 199),
            "glb" => Rgb::new(188, 0, 0),
            _ => Rgb::STONE,
        };
        assert_eq!(loaded.contents.rgb(UVec3::new(0, 3, 2)), expected, "{path:?}");
        for (up, size) in [(Up::Y, lying), (Up::Z, standing)] {
            let options = ImportOptions { upright: Some(up), ..sized(16) };
            let turned = load(path, &options).unwrap().contents.grid.dims();
            assert_eq!(turned, if is_glb { lying } else { size }, "{path:?}");
        }
        let hollow = ImportOptions { mesh_fill: MeshFill::Shell, ..sized(32) };
        let shell = load(path, &hollow).unwrap().contents.grid;
        assert!(!shell.get(shell.dims().as_ivec3() / 2), "{path:?}");
    }
    let millimetres =
        ImportOptions { mesh_size: MeshSize::VoxelMm(0.5), ..ImportOptions::default() };
    assert_eq!(load(&paths[0], &millimetres).unwrap().contents.grid.dims(), UVec3::new(8, 4, 2));
}

#[test]
fn gltf_takes_its_numbers_from_files_beside_it_and_from_itself() {
    let files = Files::new();
    let whole = std::fs::read(files.glb(|json| json)).unwrap();
    let json_end = 20 + u32::from_le_bytes(whole[12..16].try_into().unwrap()) as usize;
    let json = std::str::from_utf8(&whole[20..json_end]).unwrap();
    let binary = whole[json_end + 8..].to_vec();
    let with =
        |uri: &str| json.replace(r#""buffers":[{"#, &format!(r#""buffers":[{{"uri":"{uri}","#));
    std::fs::create_dir(files.write("a.bin", binary.clone()).with_file_name("deeper")).unwrap();
    files.write("deeper/a b.bin", binary.clone());
    let data = format!("data:application/octet-stream;base64,{}", format::base64::encode(&binary));
    let expected = load(&files.write("b.glb", &whole), &sized(16)).unwrap().contents;
    for uri in ["a.bin", "./deeper/a%20b.bin", data.as_str()] {
        let loaded = load(&files.write("a.gltf", with(uri)), &sized(16)).unwrap();
        assert_eq!(loaded.notes, Vec::<String>::new(), "{uri}");
        assert!(loaded.assumed_up.is_none() && loaded.contents.grid.opaque_count() == 512);
        let at = UVec3::new(0, 3, 2);
        assert_eq!(loaded.contents.rgb(at), expected.rgb(at), "{uri}");
    }
    for (text, part) in [
        (with("../a.bin"), "outside the folder"),
        (with("none.bin"), "none.bin"),
        (json.to_string(), "does not have its buffer"),
        (with("a.bin").replace(r#""version":"2.0""#, r#""version":"1.0""#), "only 2"),
        (with("a.bin").replace("asset", "nothing"), "asset"),
        (with("a.bin")[..300].to_string(), "description"),
    ] {
        let error = load(&files.write("bad.gltf", text), &sized(16)).unwrap_err().to_string();
        assert!(error.contains(part), "{part}: {error}");
    }
    files.write("a.bin", &binary[..199]);
    let error = load(&files.write("cut.gltf", with("a.bin")), &sized(16)).unwrap_err().to_string();
    assert!(error.contains("bufferViews 2"), "{error}");
    // A missing texture costs only the colours.
    let textured = with("deeper/a b.bin")
        .replace(r#""baseColorFactor""#, r#""baseColorTexture":{"index":0},"baseColorFactor""#);
    let textured =
        textured.replacen('{', r#"{"textures":[{"source":0}],"images":[{"uri":"/etc/a.png"}],"#, 1);
    let loaded = load(&files.write("textured.gltf", textured), &sized(16)).unwrap();
    assert!(loaded.notes[0].contains("outside the folder"), "{:?}", loaded.notes);
}

#[test]
fn damaged_glb_files_are_refused_with_a_place() {
    let files = Files::new();
    for (from, to, part) in [
        (r#""count":8,"type":"VEC3""#, r#""count":9,"type":"VEC3""#, "accessors 0"),
        (r#""count":36"#, r#""count":18446744073709551615"#, "accessors 1"),
        (r#""byteLength":96"#, r#""byteLength":999999"#, "bufferViews 0"),
        (r#""children":[1]"#, r#""children":[0]"#, "nodes 0"),
        (r#""mesh":0"#, r#""mesh":7"#, "meshes 7"),
        (r#""indices":1"#, r#""indices":2"#, "accessors 2"),
        (r#""asset""#, r#""extensionsRequired":["KHR_draco_mesh_compression"],"asset""#, "draco"),
        (r#""asset""#, r#"asset"#, "byte 20"),
        (r#""componentType":5123"#, r#""componentType":5121"#, ""),
    ] {
        let error = load(&files.glb(|json| json.replacen(from, to, 1)), &sized(16));
        match error {
            Err(error) => assert!(error.to_string().contains(part), "{to}: {error}"),
            Ok(_) => assert!(part.is_empty(), "{to} was accepted"),
        }
    }
    let file = std::fs::read(files.glb(|json| json)).unwrap();
    for end in (0..file.len()).step_by(7) {
        let cut = files.write("cut.glb", &file[..end]);
        assert!(load(&cut, &sized(16)).is_err(), "{end}");
    }
}

#[test]
fn textures_come_from_the_folder_of_the_mesh_alone() {
    let files = Files::new();
    image::RgbImage::from_pixel(2, 2, image::Rgb([7, 77, 177]))
        .save(files.folder.path().join("a b.png"))
        .unwrap();
    files.write("a.mtl", "newmtl sky\nKd 0.1 0.2 0.3\nmap_Kd a b.png\nnewmtl red\nKd 1 0 0\n");
    let with = |head: &str| {
        let obj = std::fs::read_to_string(files.obj()).unwrap();
        load(&files.write("b.obj", obj.replacen("f ", &format!("{head}\nf "), 1)), &sized(16))
            .unwrap()
    };
    let colour = |loaded: &Loaded| loaded.contents.rgb(UVec3::new(0, 3, 2));
    assert_eq!(colour(&with("mtllib a.mtl\nusemtl sky")), Rgb::new(7, 77, 177));
    assert_eq!(colour(&with("mtllib a.mtl\nusemtl red")), Rgb::new(255, 0, 0));
    for outside in ["../a.mtl", "/etc/passwd", "missing.mtl"] {
        let loaded = with(&format!("mtllib {outside}\nusemtl sky"));
        assert!(loaded.notes[0].contains("materials"), "{:?}", loaded.notes);
        assert_eq!(colour(&loaded), Rgb::STONE);
    }
}
