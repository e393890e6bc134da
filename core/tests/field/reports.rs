//! Meshes and models that other programs cannot read according to public reports, generated here; see `mod.rs`.

use std::io::{Cursor, Write};

use super::made::{CORNERS, FACES};
use super::*;
use crate::meshes_in::glb_file;

/// Checks a file of this name.
fn checked(name: &str, bytes: impl AsRef<[u8]>, right: Right) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    check(path, right);
}

/// Returns the two triangles of a face.
fn halves([a, b, c, d]: [i32; 4]) -> [[i32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

#[test]
fn stl_numbers_of_three_digits_words_apart_and_several_solids() {
    // SolidWorks writes exponents of three digits, and inexact zeros.
    let number = |value: i32| match value {
        0 => "-1.971277e-016".to_string(),
        _ => {
            let text = format!("{:.6e}", f64::from(value));
            let (mantissa, exponent) = text.split_once('e').unwrap();
            format!("{mantissa}e+{:03}", exponent.parse::<u32>().unwrap())
        }
    };
    let facet = |corners: [i32; 3]| {
        let vertex = |corner: i32| {
            let [x, y, z] = CORNERS[corner as usize - 1].map(number);
            format!("      vertex   {x}  {y}  {z}\n")
        };
        let corners = corners.map(vertex).concat();
        format!("   facet normal 0 0 0\n    outer loop\n{corners}    end loop\n   end facet\n")
    };
    let part = |(i, face): (usize, &[i32; 4])| {
        let facets = halves(*face).map(facet).concat();
        format!("solid Part {i}-1 of 6\n{facets}end solid\n")
    };
    let text: String = FACES.iter().enumerate().map(part).collect();
    checked("a.stl", text, Right { is_silent: true, ..a_box([10, 30, 20]) });
}

#[test]
fn ply_of_doubles_whose_lists_are_counted_in_shorts_and_whose_faces_have_colours() {
    let header = "ply\nformat binary_big_endian 1.0\ncomment\nobj_info a scan\nelement vertex 8\nproperty double x\n\
                  property double y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
                  element face 6\nproperty list ushort uint vertex_index\nproperty list uchar float texcoord\n\
                  property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    let mut file = header.as_bytes().to_vec();
    for corner in CORNERS {
        corner.iter().for_each(|at| file.extend(f64::from(*at).to_be_bytes()));
        file.extend([9, 99, 199]);
    }
    for face in FACES {
        file.extend(4u16.to_be_bytes());
        face.iter().for_each(|corner| file.extend((corner - 1).to_be_bytes()));
        file.push(2);
        [0.25f32, 0.5].iter().for_each(|at| file.extend(at.to_be_bytes()));
        file.extend([1, 2, 3]);
    }
    checked("a.ply", file, Right { shown: &[[1, 2, 3]], ..a_box([10, 30, 20]) });
}

/// Returns a `.glb` with one mesh, of this description and buffer.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],{json},
        "buffers":[{{"byteLength":{}}}]}}"#,
        binary.len()
    );
    glb_file(&json, binary)
}

/// Returns a corner in metres.
fn metres(corner: [i32; 3]) -> Vec<u8> {
    corner.iter().flat_map(|at| (*at as f32 / 1000.0).to_le_bytes()).collect()
}

#[test]
fn gltf_values_that_are_sparse_over_nothing_or_over_others() {
    // There are no values below the sparse ones: omitted values are 0, as is the first corner.
    let mut binary: Vec<u8> = (1..8).collect();
    binary.push(0);
    CORNERS[1..].iter().for_each(|corner| binary.extend(metres(*corner)));
    let corners = FACES.iter().flat_map(|face| halves(*face)).flatten();
    corners.for_each(|corner| binary.extend((corner as u16 - 1).to_le_bytes()));
    // Base values, all but the first of which are replaced.
    binary.extend([metres(CORNERS[0]), metres([9000; 3]).repeat(7)].concat());
    for base in ["", r#""bufferView":3,"#] {
        let json = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "accessors":[{BASE"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[0.01,0.02,0.03],
        "sparse":{"count":7,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1}}},
        {"bufferView":2,"componentType":5123,"count":36,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteLength":7},{"buffer":0,"byteOffset":8,"byteLength":84},
        {"buffer":0,"byteOffset":92,"byteLength":72},
        {"buffer":0,"byteOffset":164,"byteLength":96}]"#;
        let json = json.replace("BASE", base);
        checked("a.glb", glb(&json, &binary), a_box([10, 20, 30]));
    }
}

#[test]
fn gltf_strips_and_fans_without_indices() {
    let mut binary = Vec::new();
    for (i, [a, b, c, d]) in FACES.into_iter().enumerate() {
        let order = if i % 2 == 0 { [a, b, d, c] } else { [a, b, c, d] };
        order.iter().for_each(|corner| binary.extend(metres(CORNERS[*corner as usize - 1])));
    }
    let each = |of: &dyn Fn(usize) -> String| (0..6).map(of).collect::<Vec<_>>().join(",");
    let primitive =
        |i: usize| format!(r#"{{"attributes":{{"POSITION":{i}}},"mode":{}}}"#, 5 + i % 2);
    let accessor = |i: usize| {
        format!(
            r#"{{"bufferView":0,"byteOffset":{},"componentType":5126,"count":4,"type":"VEC3"}}"#,
            48 * i
        )
    };
    let json = format!(
        r#""meshes":[{{"primitives":[{}]}}],"accessors":[{}],"bufferViews":[{{"buffer":0,"byteLength":{}}}]"#,
        each(&primitive),
        each(&accessor),
        binary.len()
    );
    checked("a.glb", glb(&json, &binary), a_box([10, 20, 30]));
}

#[test]
fn three_mf_units_are_those_of_placements_too() {
    let vertices: String =
        CORNERS.iter().map(|[x, y, z]| format!("<vertex x='{x}' y='{y}' z='{z}'/>")).collect();
    let triangle = |t: [i32; 3]| {
        let [a, b, c] = t.map(|corner| corner - 1);
        format!("<triangle v1='{a}' v2='{b}' v3='{c}'/>")
    };
    let triangles: String = FACES.iter().flat_map(|face| halves(*face).map(triangle)).collect();
    // A box of 10 x 20 x 30 hundredths of an inch; its copy is moved by two of its edges.
    let model = format!(
        "<model unit='inch' xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02'><resources>\
         <object id='1'><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>\
         <object id='2'><components><component objectid='1'/>\
         <component objectid='1' transform='1 0 0 0 1 0 0 0 1 20 0 0'/></components></object></resources>\
         <build><item objectid='2' transform='0.01 0 0 0 0.01 0 0 0 0.01 5 6 7'/></build></model>"
    );
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("3D/3dmodel.model", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(model.as_bytes()).unwrap();
    let size = Some(MeshSize::VoxelMm(0.254));
    let right = Right { size, dims: Some([30, 30, 20]), count: Some(12_000), ..Right::default() };
    checked("a.3mf", zip.finish().unwrap().into_inner(), right);
}

#[test]
fn obj_colours_of_corners_and_corners_counted_from_0() {
    let corners: String =
        CORNERS.iter().map(|[x, y, z]| format!("v {x} {y} {z} 1.0 0.5 0.0\n")).collect();
    let faces: String = FACES.iter().map(|[a, b, c, d]| format!("f {a} {b} {c} {d} \n")).collect();
    checked(
        "a.obj",
        format!("{corners}{faces}"),
        Right { shown: &[[255, 128, 0]], is_silent: true, ..a_box([10, 20, 30]) },
    );
    // Corners are counted from 1.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("{corners}f 0/0/0 1/1/0 3/3/0\n")).unwrap();
    let error = load(&path, &ImportOptions::default()).unwrap_err();
    assert!(error.contains("line 9"), "{error}");
}

/// Returns a chunk of a `.vox` file.
fn chunk(id: &[u8; 4], content: &[u8], children: &[u8]) -> Vec<u8> {
    let lengths = [content.len(), children.len()].map(|length| (length as u32).to_le_bytes());
    [&id[..], &lengths.concat(), content, children].concat()
}

fn numbers(numbers: &[i32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Returns a model of a `.vox` file.
fn model(dims: [i32; 3], voxels: &[[u8; 4]]) -> Vec<u8> {
    let content = [numbers(&[voxels.len() as i32]), voxels.concat()].concat();
    [chunk(b"SIZE", &numbers(&dims), &[]), chunk(b"XYZI", &content, &[])].concat()
}

/// Returns a `.vox` file whose colour 1 is red, and 255 blue.
fn vox(version: i32, chunks: &[Vec<u8>]) -> Vec<u8> {
    let mut palette = vec![[9, 9, 9, 255]; 256];
    (palette[0], palette[254]) = ([200, 10, 20, 255], [0, 0, 250, 255]);
    let children = [chunks.concat(), chunk(b"RGBA", &palette.concat(), &[])].concat();
    [b"VOX ", &version.to_le_bytes()[..], &chunk(b"MAIN", &[], &children)].concat()
}

/// Returns a text preceded by its length.
fn text(text: &str) -> Vec<u8> {
    [numbers(&[text.len() as i32]), text.as_bytes().to_vec()].concat()
}

#[test]
fn vox_of_version_200_with_several_models_and_unknown_chunks() {
    let full: Vec<[u8; 4]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2, 1]).collect();
    let moved = |id: i32, child: i32, to: &str| {
        let ids = numbers(&[child, -1, 0, 1]);
        let frame = match to {
            "" => numbers(&[0]),
            _ => [numbers(&[1]), text("_t"), text(to)].concat(),
        };
        chunk(b"nTRN", &[numbers(&[id, 0]), ids, frame].concat(), &[])
    };
    let shape = |id: i32, model: i32| chunk(b"nSHP", &numbers(&[id, 0, 1, model, 0]), &[]);
    let file = vox(
        200,
        &[
            model([2, 2, 2], &full),
            chunk(b"zzzz", &[1, 2, 3], &[]),
            model([2, 2, 2], &full),
            moved(0, 1, ""),
            chunk(b"nGRP", &numbers(&[1, 0, 2, 2, 4]), &[]),
            moved(2, 3, "1 1 1"),
            shape(3, 0),
            moved(4, 5, "5 1 1"),
            shape(5, 1),
            chunk(b"NOTE", &[0; 4], &[]),
        ],
    );
    let colours = &[([200, 10, 20], 16)];
    checked("a.vox", file, Right { dims: Some([6, 2, 2]), colours, ..Right::default() });
}

#[test]
fn vox_models_as_large_as_there_can_be() {
    let file = vox(150, &[model([256; 3], &[[0, 0, 0, 1], [255, 255, 255, 255]])]);
    let colours = &[([0, 0, 250], 1), ([200, 10, 20], 1)];
    checked("a.vox", file, Right { dims: Some([256; 3]), colours, ..Right::default() });
}

#[test]
fn vox_colours_are_those_of_the_palette_however_it_is_shown() {
    // The order in which the palette is displayed.
    let order: Vec<u8> = (0..=255).rev().collect();
    let voxels = [[0, 0, 0, 1], [1, 0, 0, 255], [2, 0, 0, 7]];
    let file = vox(150, &[model([3, 1, 1], &voxels), chunk(b"IMAP", &order, &[])]);
    let colours = &[([0, 0, 250], 1), ([9, 9, 9], 1), ([200, 10, 20], 1)];
    checked("a.vox", file, Right { dims: Some([3, 1, 1]), colours, ..Right::default() });
}

#[test]
fn vox_colour_0_is_none() {
    let file = vox(150, &[model([3, 1, 1], &[[0, 0, 0, 1], [1, 0, 0, 0], [2, 0, 0, 1]])]);
    checked("a.vox", file, Right { count: Some(2), ..Right::default() });
}

#[test]
fn qb_packed_with_its_colours_turned_and_to_either_hand() {
    let [red, none, blue] = [[255, 0, 0, 255], [7, 7, 7, 0], [0, 0, 255, 255]];
    let rows = [red, red, red, red, blue, none];
    // Two layers of 3 x 2, the second without its first three voxels.
    let mut back = rows;
    back[..3].fill(none);
    let header = |order: u32, hand: u32, is_packed: u32| {
        let fields = [order, hand, is_packed, 0, 1].map(u32::to_le_bytes).concat();
        let place = numbers(&[3, 2, 2, 0, 0, 0]);
        [&[1, 1, 0, 0], &fields[..], &[1], b"a", &place].concat()
    };
    let plain = [header(0, 0, 0), rows.concat(), back.concat()].concat();
    // Blue, green, red; a run is 2, the count, and the colour; 6 ends a layer.
    let turned = |[r, g, b, a]: [u8; 4]| [b, g, r, a];
    let run =
        |count: i32, colour: [u8; 4]| [numbers(&[2, count]), turned(colour).to_vec()].concat();
    let one = |colour: [u8; 4]| turned(colour).to_vec();
    let front = [run(4, red), one(blue), one(none), numbers(&[6])].concat();
    let last = [run(3, none), one(red), one(blue), one(none), numbers(&[6])].concat();
    let packed = [header(1, 0, 1), front, last].concat();
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, bytes: Vec<u8>| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let contents = load(&path, &ImportOptions::default()).unwrap().contents;
        (contents.grid.dims(), voxels(&contents))
    };
    let (dims, expected) = read("plain.qb", plain.clone());
    assert_eq!((dims, expected.len()), (UVec3::new(3, 2, 2), 5 + 2));
    assert_eq!(read("packed.qb", packed), (dims, expected.clone()));
    // With the other handedness: the same object, mirrored.
    let mut other = plain;
    other[8] = 1;
    let (_, mirrored) = read("other.qb", other);
    let sorted = |mut all: Vec<(UVec3, Rgb)>| {
        all.sort_by_key(|(v, _)| v.to_array());
        all
    };
    let flip = |(v, rgb): (UVec3, Rgb)| (UVec3 { x: dims.x - 1 - v.x, ..v }, rgb);
    let flipped = mirrored.iter().copied().map(flip).collect();
    assert_ne!(sorted(mirrored), sorted(expected.clone()));
    assert_eq!(sorted(flipped), sorted(expected));
}
