//! Scans of NIfTI, NRRD and VTK: voxels, spacing and orientation as other programs read them.

use std::path::{Path, PathBuf};

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::format::options::{Colouring, Existence, ImportOptions};
use sculpture_core::format::{self, FormatError, Info, Samples, Volume};
use sculpture_core::sculpture::Limits;
use sculpture_core::sculpture::history::Contents;
use trials::shared_file;

fn volume(path: &Path) -> Volume {
    format::load_volume(path, &ImportOptions::default(), &Limits::default(), &())
        .unwrap_or_else(|error| panic!("{path:?}: {error}"))
}

fn load(path: &Path, threshold: f64) -> Result<Contents, FormatError> {
    let existence = Existence::Threshold(threshold);
    let options = ImportOptions { existence, ..ImportOptions::default() };
    format::load(path, &options, &Limits::default(), &()).map(|loaded| loaded.contents)
}

fn info(name: &str) -> Info {
    format::info(&shared_file(&format!("data/{name}"))).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn all_forms_of_nrrd_hold_the_same_ball() {
    let folder = shared_file("data/nrrd/BallBinary30x30x30.nrrd").parent().unwrap().to_path_buf();
    let expected = std::fs::read(folder.join("BallBinary30x30x30.raw")).unwrap();
    for name in ["", "_byteskip_minus_one", "_bz2", "_gz", "_gz_byteskip_minus_one", "_gz_lineskip"]
    {
        for ending in ["nrrd", "nhdr"] {
            let path = folder.join(format!("BallBinary30x30x30{name}.{ending}"));
            if !path.exists() {
                continue;
            }
            let ball = volume(&path);
            assert_eq!((ball.dims, ball.samples), (UVec3::splat(30), Samples::I16Le), "{path:?}");
            assert!(ball.data == expected, "{path:?}");
            let info = format::info(&path).unwrap();
            assert_eq!(info.orientation.as_deref(), Some("x to left, y to back, z to head"));
        }
    }
    let text = volume(&folder.join("test2d_ascii.nrrd"));
    assert_eq!((text.dims, text.samples), (UVec3::new(3, 9, 1), Samples::U16Le));
    assert_eq!(text.voxel_size, Vec3::new(1.0458, 2.0, 1.0));
    assert_eq!(text.density(UVec3::new(2, 4, 0)), Some(15.0));
    let four = info("nrrd/test_simple4d_raw.nrrd");
    assert_eq!((four.dims, four.voxel_size), (UVec3::ONE, Vec3::new(1.5, 1.5, 1.0)));
}

#[test]
fn nrrd_is_read_from_a_list_of_files_or_from_numbered_ones() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let voxels: Vec<u8> = (0..24).collect();
    let header = |rest: &str| {
        let fields = "type: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: raw\nspacings: 1 1 2\n";
        std::fs::write(at("a.nhdr"), format!("NRRD0004\n{fields}data file: {rest}")).unwrap();
        at("a.nhdr")
    };
    std::fs::create_dir(at("in")).unwrap();
    for (i, part) in voxels.chunks(6).enumerate() {
        std::fs::write(at(&format!("in/s{:03}.raw", 9 + i)), part).unwrap();
        std::fs::write(at(&format!("t{}.raw", 20 - 2 * i)), part).unwrap();
    }
    let listed = "LIST\nin/s009.raw\nin/s010.raw\nin/s011.raw\nin/s012.raw";
    for rest in [
        listed.to_string(),
        format!("{}\n\n", listed.replace("LIST", "LIST 2")),
        "in/s%03d.raw 9 12 1\n".to_string(),
        "t%d.raw 20 14 -2 2\n\n".to_string(),
    ] {
        let found = volume(&header(&rest));
        assert_eq!((found.dims, found.data), (UVec3::new(2, 3, 4), voxels.clone()), "{rest}");
        assert_eq!(found.voxel_size, Vec3::new(1.0, 1.0, 2.0));
    }
    for (rest, part) in [
        ("LIST", "list of files is empty"),
        ("LIST\nin/s009.raw\n../b.raw\nin/s011.raw\n", "own folder"),
        ("LIST\nin/s009.raw\nin/s010.raw\nin/s011.raw\ngone.raw", "gone.raw"),
        ("LIST\nin/s009.raw\nin/s010.raw", "12 bytes were expected"),
        ("LIST\na\na\na\na\na", "5 files alike"),
        ("in/s%03d.raw 9 12 0", "numbers no files"),
        ("in/s%03d.raw 9 12 -1", "numbers no files"),
        ("in/s%03d.raw 0 99999999 1", "numbers no files"),
        ("in/s%03d.raw -9223372036854775808 9223372036854775807 1", "numbers no files"),
        ("in/s%99d.raw 9 12 1", "numbers no files"),
        ("in/s%s.raw 9 12 1", "numbers no files"),
    ] {
        let path = header(rest);
        let error = format::info(&path).unwrap_err().to_string();
        assert!(error.contains(part), "{rest}: {error}");
    }
}

#[test]
fn nifti_of_both_versions_and_byte_orders() {
    let anatomical = info("nifti/anatomical.nii");
    assert_eq!(anatomical.dims, UVec3::new(33, 41, 25));
    assert_eq!(anatomical.samples, Some(Samples::I16Be));
    let four = info("nifti/example4d.nii.gz");
    assert_eq!(four.dims, UVec3::new(128, 96, 24));
    let note = "first of 2 volumes taken; the option `time` takes another";
    assert!(four.notes.iter().any(|own| own == note), "{:?}", four.notes);
    let second = info("nifti/example_nifti2.nii.gz");
    assert!(second.kind.starts_with("NIfTI-2"), "{}", second.kind);
    assert_eq!(second.dims, UVec3::new(32, 20, 12));
    let brain = info("nifti/ch2bet.nii.gz");
    assert_eq!((brain.dims, brain.samples), (UVec3::new(181, 217, 181), Some(Samples::U8)));
    assert!(brain.orientation.is_some_and(|text| text.contains("z to head")));
    let labels = shared_file("data/nifti/JHU-WhiteMatter-labels-2mm.nii.gz");
    let options = ImportOptions { colouring: Colouring::Labels, ..ImportOptions::default() };
    let contents = format::load(&labels, &options, &Limits::default(), &()).unwrap().contents;
    assert!(contents.material.page_count() > 0 && contents.grid.opaque_count() > 1000);
}

#[test]
fn a_vti_packed_with_zlib_has_all_its_labels() {
    let frog = volume(&shared_file("data/vti/frog_tissues.vti"));
    assert_eq!((frog.dims, frog.samples), (UVec3::new(500, 470, 136), Samples::U8));
    let other = volume(&shared_file("data/derived/frog_labels_500x470x136.nrrd"));
    assert!(frog.data == other.data, "the same voxels as in the NRRD file made of it");
}

#[test]
fn pieces_of_a_vti_are_put_together() {
    let folder = tempfile::tempdir().unwrap();
    let value = |x: u32, y: u32, z: u32| x + 10 * y + 100 * z;
    // Points at the border of two pieces are in both; cells are not.
    for (group, last) in [("PointData", 0), ("CellData", 1)] {
        let piece = |x: [u32; 2], z: [u32; 2], name: &str| {
            let mut text = String::new();
            for z in z[0]..=z[1] - last {
                for y in 0..=3 - last {
                    (x[0]..=x[1] - last).for_each(|x| text += &format!("{} ", value(x, y, z)));
                }
            }
            format!(
                "<Piece Extent=\"{} {} 0 3 {} {}\"><{group}><DataArray Name=\"{name}\" type=\"UInt16\" \
                 format=\"ascii\">{text}</DataArray></{group}></Piece>",
                x[0], x[1], z[0], z[1]
            )
        };
        let file = |pieces: &[String]| {
            let path = folder.path().join("a.vti");
            let text = format!(
                "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 5 0 3 0 4\" Spacing=\"1 1 2\">{}\
                 </ImageData></VTKFile>",
                pieces.concat()
            );
            std::fs::write(&path, text).unwrap();
            path
        };
        let [left, low, high] =
            [([0, 2], [0, 4]), ([2, 5], [0, 1]), ([2, 5], [1, 4])].map(|(x, z)| piece(x, z, "a"));
        let empty = "<Piece Extent=\"0 -1 0 -1 0 -1\"/>".to_string();
        let path = file(&[high.clone(), empty, left.clone(), low]);
        let whole = volume(&path);
        let dims = UVec3::new(6 - last, 4 - last, 5 - last);
        assert_eq!((whole.dims, whole.voxel_size), (dims, Vec3::new(1.0, 1.0, 2.0)), "{group}");
        for z in 0..dims.z {
            for (x, y) in (0..dims.y).flat_map(|y| (0..dims.x).map(move |x| (x, y))) {
                let found = whole.density(UVec3::new(x, y, z));
                assert_eq!(found, Some(value(x, y, z) as f32), "{group} {x} {y} {z}");
            }
        }
        assert_eq!(format::info(&path).unwrap().notes, Vec::<String>::new());
        let notes = format::info(&file(&[high.clone(), left])).unwrap().notes;
        assert!(notes.len() == 1 && notes[0].contains("none of the pieces"), "{notes:?}");
        for (pieces, part) in [
            (vec![high.clone(), piece([0, 2], [0, 4], "b")], "different arrays"),
            (vec![], "without points"),
            (vec![high.replace("2 5 0 3", "2 9223372036854775807 0 3"), high.clone()], ""),
            (vec![high.replace("2 5", "-9223372036854775808 -9223372036854775807"), high], ""),
        ] {
            let error = format::info(&file(&pieces)).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}

/// Returns a NIfTI-1 header of i16 voxels, little-endian, with a matrix in its sform.
fn nifti(dims: [i16; 3], rows: [[f32; 4]; 3], data: &[i16]) -> Vec<u8> {
    let mut file = vec![0u8; 352];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    for (i, n) in [3, dims[0], dims[1], dims[2], 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * i, &n.to_le_bytes());
    }
    put(70, &4i16.to_le_bytes());
    for (i, n) in [1.0f32, 0.0, 0.0, 0.0].into_iter().enumerate() {
        put(76 + 4 * i, &n.to_le_bytes());
    }
    put(108, &352f32.to_le_bytes());
    put(254, &1i16.to_le_bytes());
    for (i, n) in rows.concat().into_iter().enumerate() {
        put(280 + 4 * i, &n.to_le_bytes());
    }
    put(344, b"n+1\0");
    file.extend(data.iter().flat_map(|n| n.to_le_bytes()));
    file
}

#[test]
fn patients_stand_upright_and_are_not_mirrored() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("head.nii");
    // Voxels at the left, front and head of a patient of 5 x 6 x 7 mm, whichever direction the axes have.
    for flip in [[1.0f32, 1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0]] {
        let dims = [5, 6, 7];
        let mut data = vec![0i16; 5 * 6 * 7];
        // The far end of an axis relative to the patient: right, front, head.
        let end = |axis: usize, far: bool| {
            if (flip[axis] > 0.0) == far { dims[axis] as usize - 1 } else { 0 }
        };
        let middle = [2, 3, 3];
        for (axis, far, value) in [(0, false, 10), (1, true, 20), (2, true, 30)] {
            let mut at = middle;
            at[axis] = end(axis, far);
            data[at[0] + 5 * (at[1] + 6 * at[2])] = value;
        }
        let row = |i: usize| {
            let mut row = [0.0; 4];
            row[i] = flip[i];
            row
        };
        std::fs::write(&path, nifti(dims, [row(0), row(1), row(2)], &data)).unwrap();
        let grid = load(&path, 5.0).unwrap().grid;
        // x to the patient's left, y to the head, z to the front.
        assert_eq!(grid.dims(), UVec3::new(5, 7, 6), "{flip:?}");
        let bounds = load(&path, 25.0).unwrap().grid.opaque_bounds().unwrap().0;
        assert_eq!(bounds.y, 6, "{flip:?}: the head is up");
        let front = [load(&path, 15.0).unwrap(), load(&path, 25.0).unwrap()]
            .map(|contents| contents.grid.opaque_count());
        assert_eq!(front, [2, 1]);
        assert!(
            (0..7).any(|y| (0..6).any(|z| grid.get(IVec3::new(4, y, z)))),
            "{flip:?}: the left"
        );
        assert!(
            (0..7).any(|y| (0..5).any(|x| grid.get(IVec3::new(x, y, 5)))),
            "{flip:?}: the front"
        );
        assert_eq!(grid.opaque_count(), 3);
    }
}

fn refusal(path: &PathBuf, file: &[u8]) -> String {
    std::fs::write(path, file).unwrap();
    load(path, 1.0).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn packed_and_paired_files_and_those_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let identity = [[2.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, 4.0, 0.0]];
    let data: Vec<i16> = (0..24).collect();
    let plain = nifti([4, 3, 2], identity, &data);
    std::fs::write(at("a.nii"), &plain).unwrap();
    let expected = volume(&at("a.nii"));
    assert_eq!(
        expected.voxel_size,
        Vec3::new(2.0, 3.0, 4.0),
        "lengths of the matrix where pixdim has none"
    );
    // Packed without a name that says so; and plain under the name of a packed file.
    use std::io::Write;
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gz.write_all(&plain).unwrap();
    std::fs::write(at("b.nii"), gz.finish().unwrap()).unwrap();
    std::fs::write(at("c.NII.GZ"), &plain).unwrap();
    assert_eq!(volume(&at("b.nii")), expected);
    assert_eq!(volume(&at("c.NII.GZ")), expected);
    // A pair of files.
    let mut header = plain[..348].to_vec();
    header[344..348].copy_from_slice(b"ni1\0");
    header[108..112].copy_from_slice(&0f32.to_le_bytes());
    let alone = refusal(&at("d.hdr"), &header);
    assert!(alone.contains("d.img") && alone.contains("one folder"), "{alone}");
    std::fs::write(at("d.img"), &plain[352..]).unwrap();
    assert_eq!(volume(&at("d.hdr")), expected);

    for (name, file, part) in [
        ("x.nii", &b"no scan at all"[..], "not a NIfTI file"),
        ("x.nii.gz", b"\x1f\x8b\x08\x00cut", "header"),
        ("x.nrrd", b"BM bitmap", "not an NRRD file"),
        ("x.nrrd", b"NRRD0004\ntype: uchar\nencoding: raw\n\n", "dimension"),
        ("x.nrrd", b"NRRD0004\ntype: short\ndimension: 1\nsizes: 2\nencoding: raw\n\n1234", "endian"),
        ("x.nrrd", b"NRRD0004\ntype: uchar\ndimension: 1\nsizes: 9\nencoding: raw\n\n1234", "9 bytes"),
        ("x.nhdr", b"NRRD0004\ntype: uchar\ndimension: 1\nsizes: 1\nencoding: raw\ndata file: ../a\n\n", "own folder"),
        ("x.nhdr", b"NRRD0004\ntype: uchar\ndimension: 1\nsizes: 1\nencoding: raw\ndata file: gone.raw\n\n", "gone.raw"),
        ("x.vti", b"<VTKFile type=\"PolyData\"/>", "ImageData"),
        ("x.vti", b"<VTKFile type=", "XML"),
    ] {
        let message = refusal(&at(name), file);
        assert!(message.contains(part), "{name}: {message}");
    }
    assert!(
        format::can_be_read(Path::new("a/b.nii.gz")) && !format::can_be_read(Path::new("b.gz"))
    );
}

#[test]
fn image_data_of_every_coding() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vti");
    let read = |head: &str, array: &str, appended: &str| {
        let file = format!(
            "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" {head}>\
             <ImageData WholeExtent=\"0 2 0 1 0 0\" Origin=\"0 0 0\" Spacing=\"1 2 3\">\
             <Piece Extent=\"0 2 0 1 0 0\"><PointData Scalars=\"d\">{array}</PointData></Piece>\
             </ImageData>{appended}</VTKFile>"
        );
        std::fs::write(&path, file).unwrap();
        let volume = volume(&path);
        assert_eq!(
            (volume.dims, volume.voxel_size),
            (UVec3::new(3, 2, 1), Vec3::new(1.0, 2.0, 3.0))
        );
        (0..6).map(|i| volume.density(UVec3::new(i % 3, i / 3, 0)).unwrap()).collect::<Vec<f32>>()
    };
    let other = "<DataArray type=\"UInt8\" Name=\"e\" format=\"ascii\">9 9 9 9 9 9</DataArray>";
    let text =
        "<DataArray type=\"Float64\" Name=\"d\" format=\"ascii\"> 1 2 3\n4.5 5 -6 </DataArray>";
    assert_eq!(read("", &format!("{other}{text}"), ""), [1.0, 2.0, 3.0, 4.5, 5.0, -6.0]);
    assert_eq!(format::info(&path).unwrap().notes, ["left out: e"]);
    // The bytes 6 0 0 0, 1 2 3 4 5 6.
    let coded = "BgAAAAECAwQFBg==";
    let inline =
        format!("<DataArray type=\"UInt8\" Name=\"d\" format=\"binary\">\n {coded} </DataArray>");
    let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    assert_eq!(read("header_type=\"UInt32\"", &inline, ""), expected);
    let array = "<DataArray type=\"UInt8\" Name=\"d\" format=\"appended\" offset=\"0\"/>";
    let appended = format!("<AppendedData encoding=\"base64\">\n _{coded}\n</AppendedData>");
    assert_eq!(read("", array, &appended), expected);
    let raw =
        "<AppendedData encoding=\"raw\">_\u{6}\0\0\0\u{1}\u{2}\u{3}\u{4}\u{5}\u{6}</AppendedData>";
    assert_eq!(read("", array, raw), expected);
}
