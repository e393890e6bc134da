//! More files of the kinds in the table, generated here; see `mod.rs`.

use std::io::Write;

use super::*;

/// Returns a box from the origin as an object of a `.3mf`.
fn object(id: u32, edge: u32) -> String {
    let vertex = |i: u32| {
        let [x, y, z] = [4, 2, 1].map(|bit| if i & bit == 0 { 0 } else { edge });
        format!("<vertex x='{x}' y='{y}' z='{z}'/>")
    };
    let triangles = [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ];
    let triangles =
        triangles.map(|[a, b, c]| format!("<triangle v1='{a}' v2='{b}' v3='{c}'/>")).concat();
    let vertices: String = (0..8).map(vertex).collect();
    format!(
        "<object id='{id}'><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>"
    )
}

#[test]
fn parts_that_bambu_studio_does_not_print_are_left_out() {
    let model = format!(
        "<model unit='millimeter' xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02'><resources>{}{}\
         <object id='3'><components><component objectid='1'/>\
         <component objectid='2' transform='1 0 0 0 1 0 0 0 1 30 0 0'/></components></object></resources>\
         <build><item objectid='3'/></build></model>",
        object(1, 4),
        object(2, 6)
    );
    let folder = tempfile::tempdir().unwrap();
    for (kind, told, count) in [
        ("normal_part", None, 64 + 216),
        ("negative_part", Some("negative volume"), 64),
        ("modifier_part", Some("modifier"), 64),
        ("support_blocker", Some("support blocker"), 64),
    ] {
        let settings = format!(
            "<config><object id='3'><part id='1' subtype='normal_part'/><part id='2' subtype='{kind}'/></object></config>"
        );
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in
            [("3D/3dmodel.model", &model), ("Metadata/model_settings.config", &settings)]
        {
            zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            zip.write_all(text.as_bytes()).unwrap();
        }
        let path = folder.path().join("a.3mf");
        std::fs::write(&path, zip.finish().unwrap().into_inner()).unwrap();
        check(path.clone(), Right { count: Some(count), ..Right::default() });
        let notes = load(&path, &options(&Right::default())).unwrap().notes;
        assert_eq!(notes.len(), usize::from(told.is_some()), "{notes:?}");
        assert!(told.is_none_or(|told| notes[0].contains(told)), "{notes:?}");
    }
}

/// Returns the first voxels of the layers that are read from pages 0 to `pages`, each of which holds its index.
fn layers_of(pages: u8, description: &str) -> (Vec<f32>, Vec3) {
    let folder = tempfile::tempdir().unwrap();
    let path = numbered_pages(folder.path(), pages, description);
    let options = ImportOptions::default();
    let volume = format::load_volume(&path, &options, &Limits::default(), &()).unwrap();
    let at = |z: u32| volume.density(UVec3::new(0, 0, z)).unwrap();
    ((0..volume.dims.z).map(at).collect(), volume.voxel_size)
}

#[test]
fn the_order_of_an_ome_tiff_is_its_own() {
    let of = |order: &str, blocks: &str| {
        layers_of(
            8,
            &format!(
                "<OME UUID='urn:uuid:1'><Image><Pixels DimensionOrder='{order}' SizeX='3' SizeY='2' SizeZ='2' SizeC='2' \
                 SizeT='2' PhysicalSizeX='500' PhysicalSizeY='500' PhysicalSizeZ='2'  PhysicalSizeZUnit='mm'>{blocks}\
                 </Pixels></Image></OME>"
            ),
        )
    };
    // Micrometres, if no unit is given.
    assert_eq!(of("XYCZT", ""), (vec![0.0, 2.0], Vec3::new(0.5, 0.5, 2.0)));
    assert_eq!(of("XYZCT", "").0, [0.0, 1.0]);
    assert_eq!(of("XYTCZ", "").0, [0.0, 4.0]);
    assert_eq!(of("XYCZT", "<TiffData/>").0, [0.0, 2.0]);
    let blocks = "<TiffData IFD='5' FirstZ='0'/><TiffData IFD='3' FirstZ='1' PlaneCount='1'/>";
    assert_eq!(of("XYCZT", blocks).0, [5.0, 3.0]);
    // Other channels and files are ignored; missing ones cannot be read.
    let blocks = "<TiffData IFD='1' FirstC='1'/><TiffData IFD='0'><UUID FileName='b'>urn:uuid:2</UUID></TiffData>\
                  <TiffData IFD='6'/><TiffData IFD='7' FirstZ='1'/>";
    assert_eq!(of("XYCZT", blocks).0, [6.0, 7.0]);
    assert_eq!(layers_of(3, "<OME><Image><Pixels").0, [0.0, 1.0, 2.0]);
}

#[test]
fn the_pages_of_imagej_are_taken_as_they_are_where_its_note_is_wrong() {
    let note = "ImageJ=1.5\nimages=8\nchannels=2\nslices=4\n";
    assert_eq!(layers_of(8, note).0, [0.0, 2.0, 4.0, 6.0]);
    assert_eq!(layers_of(3, note).0, [0.0, 1.0, 2.0]);
    // Times without layers are layers.
    assert_eq!(layers_of(3, "ImageJ=1.5\nimages=3\nframes=3\n").0, [0.0, 1.0, 2.0]);
}

#[test]
fn the_shapes_of_goxel_are_filled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gox");
    for (shape, count) in [("sphere", 280), ("cube", 512), ("cylinder", 416)] {
        let mut layer = 0i32.to_le_bytes().to_vec();
        let matrix = [4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 8, 30, 8, 1];
        let matrix: Vec<u8> = matrix.iter().flat_map(|n| (*n as f32).to_le_bytes()).collect();
        for (name, value) in [
            ("shape", shape.as_bytes()),
            ("mat", &matrix),
            ("color", &[0, 200, 0, 255]),
            ("visible", &[1]),
        ] {
            for text in [name.as_bytes(), value] {
                layer.extend((text.len() as i32).to_le_bytes());
                layer.extend(text);
            }
        }
        let length = (layer.len() as i32).to_le_bytes();
        let file = [b"GOX ", &2u32.to_le_bytes()[..], b"LAYR", &length, &layer, &[0; 4]].concat();
        std::fs::write(&path, file).unwrap();
        let dims = Some([8, 8, 8]);
        let colours = &[[0, 200, 0]];
        check(path.clone(), Right { count: Some(count), dims, shown: colours, ..Right::default() });
    }
}

#[test]
fn the_extents_of_an_nrrd_reach_from_middle_to_middle_of_nodes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\naxis mins: 0 0 3\naxis maxs: 1 1 0\n\
                  centers: node node node\nunits: \"cm\" \"cm\" \"mm\"\nencoding: raw\n\n";
    std::fs::write(&path, [header.as_bytes(), &[9; 8]].concat()).unwrap();
    check(path, Right { voxel: Some([10.0, 10.0, 3.0]), ..Right::default() });
}

#[test]
fn text_ply_whose_values_are_not_in_lines_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let text = std::fs::read_to_string(fixture("02_ply_ascii_undeclared_box.ply")).unwrap();
    let (header, values) = text.split_once("end_header\n").unwrap();
    let own = values.lines().map(|line| match line.starts_with("3 ") {
        true => line.split(' ').take(4).collect::<Vec<_>>().join(" "),
        false => line.to_string(),
    });
    let values = own.collect::<Vec<_>>().join(" ");
    std::fs::write(&path, format!("{header}end_header\n{values}\n")).unwrap();
    check(path, Right { is_silent: true, ..a_box([10, 30, 20]) });
}

/// The corners and faces of a box of 10 x 20 x 30.
pub(super) const CORNERS: [[i32; 3]; 8] = [
    [0, 0, 0],
    [0, 0, 30],
    [0, 20, 0],
    [0, 20, 30],
    [10, 0, 0],
    [10, 0, 30],
    [10, 20, 0],
    [10, 20, 30],
];
pub(super) const FACES: [[i32; 4]; 6] =
    [[1, 2, 4, 3], [5, 7, 8, 6], [1, 5, 6, 2], [3, 4, 8, 7], [1, 3, 7, 5], [2, 6, 8, 4]];

fn ply_header(format: &str, faces: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
         {faces}end_header\n"
    )
}

/// Returns two triangles of each face as a strip.
fn strips() -> Vec<i32> {
    FACES.iter().flat_map(|[a, b, c, d]| [a - 1, b - 1, d - 1, c - 1, -1]).collect()
}

#[test]
fn ply_strips_of_triangles_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let header = ply_header(
        "binary_little_endian",
        "element tristrips 1\nproperty list int int vertex_indices\n",
    );
    let mut file = header.into_bytes();
    CORNERS.iter().flatten().for_each(|at| file.extend((*at as f32).to_le_bytes()));
    file.extend((strips().len() as i32).to_le_bytes());
    strips().iter().for_each(|corner| file.extend(corner.to_le_bytes()));
    std::fs::write(&path, file).unwrap();
    check(path, Right { is_silent: true, ..a_box([10, 30, 20]) });
}

#[test]
fn ply_headers_with_windows_line_ends_and_numbers_on_lines_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let faces = "element face 7\nproperty list uchar int vertex_index\n";
    let header = ply_header("binary_little_endian", &faces.replace('7', "6")).replace('\n', "\r\n");
    let mut file = header.into_bytes();
    CORNERS.iter().flatten().for_each(|at| file.extend((*at as f32).to_le_bytes()));
    for face in FACES {
        file.push(4);
        face.iter().for_each(|corner| file.extend((corner - 1).to_le_bytes()));
    }
    std::fs::write(&path, file).unwrap();
    check(path.clone(), Right { is_silent: true, ..a_box([10, 30, 20]) });
    // Each number on a line; then a face without corners whose line continues with the next face.
    let of = |face: [i32; 4]| {
        format!("4 {} {} {} {}\n", face[0] - 1, face[1] - 1, face[2] - 1, face[3] - 1)
    };
    let all: String = FACES.map(of).concat();
    for separator in ["\n", " "] {
        let corners: Vec<String> =
            CORNERS.iter().map(|[x, y, z]| format!("{x}{separator}{y}{separator}{z}\n")).collect();
        let text = format!("{}{}0 {all}", ply_header("ascii", faces), corners.concat());
        let text = if separator == "\n" { text.replace("0 4 ", "0\n4 ") } else { text };
        std::fs::write(&path, text).unwrap();
        check(path.clone(), Right { is_silent: true, ..a_box([10, 30, 20]) });
    }
}

#[test]
fn obj_faces_that_count_backwards_count_from_where_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    // Each face after its own corners.
    let of = |face: [i32; 4]| {
        let corners = face.map(|corner| CORNERS[corner as usize - 1]);
        let corners = corners.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
        format!("{corners}f -4 -3//-3 -2 -1\n")
    };
    std::fs::write(&path, FACES.map(of).concat()).unwrap();
    check(path, Right { is_silent: true, ..a_box([10, 20, 30]) });
}
