//! Scans that other programs cannot read according to public reports, generated here; see `mod.rs`.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::*;

/// Size and value of the voxels in the generated files: reading them in the wrong order changes the values.
const DIMS: UVec3 = UVec3::new(6, 5, 4);

fn value(v: UVec3) -> u16 {
    (v.x + 10 * v.y + 300 * v.z) as u16
}

fn places() -> impl Iterator<Item = UVec3> {
    (0..DIMS.element_product())
        .map(|i| UVec3::new(i % DIMS.x, i / DIMS.x % DIMS.y, i / DIMS.x / DIMS.y))
}

fn values() -> Vec<u8> {
    places().flat_map(|v| value(v).to_le_bytes()).collect()
}

/// Writes files into a folder, and checks the values and the edges of a voxel of the first.
fn checked(files: &[(&str, &[u8])], voxel: Vec3) {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).unwrap());
    let path = folder.path().join(files[0].0);
    let options = ImportOptions::default();
    let volume = format::load_volume(&path, &options, &Limits::default(), &()).unwrap();
    assert_eq!((volume.dims, volume.voxel_size), (DIMS, voxel), "{}", files[0].0);
    for v in places() {
        assert_eq!(volume.density(v), Some(f32::from(value(v))), "{} at {v}", files[0].0);
    }
}

#[test]
fn nrrd_with_bytes_in_front_or_behind() {
    let header = |rest: &str| {
        let fields = "type: ushort\nendian: little\ndimension: 3\nsizes: 6 5 4\nspacings: 1 2 3";
        format!("NRRD0004\n# a comment\n{fields}\nencoding: raw\n{rest}\n")
    };
    let voxel = Vec3::new(1.0, 2.0, 3.0);
    let values = values();
    let behind = [&values[..], b"and a note"].concat();
    checked(&[("a.nrrd", &[header("").as_bytes(), &behind].concat())], voxel);
    checked(&[("a.nhdr", header("data file: b.raw\n").as_bytes()), ("b.raw", &behind)], voxel);
    let before = [b"a header\nof its own\n", &values[..]].concat();
    for skip in ["byte skip: -1", "line skip: 2", "byte skip: 20", "line skip: 1\nbyte skip: 11"] {
        let header = header(&format!("{skip}\ndata file: b.raw\n"));
        checked(&[("a.nhdr", header.as_bytes()), ("b.raw", &before)], voxel);
    }
}

/// Returns a NIfTI file whose orientation is a quaternion: b, c and d, with edges preceded by the sign of the third
/// axis.
fn nifti(quaternion: [f32; 3], edges: [f32; 4]) -> Vec<u8> {
    let mut file = vec![0u8; 352];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    put(40, &[3i16, 6, 5, 4, 1, 1, 1, 1].map(i16::to_le_bytes).concat());
    put(70, &[512i16, 16].map(i16::to_le_bytes).concat());
    put(76, &edges.map(f32::to_le_bytes).concat());
    put(108, &352f32.to_le_bytes());
    put(252, &1i16.to_le_bytes());
    put(256, &quaternion.map(f32::to_le_bytes).concat());
    put(344, b"n+1\0");
    file.extend(values());
    file
}

#[test]
fn nifti_whose_quaternion_is_rounded_beyond_1_or_whose_edges_are_negative() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    // The densest voxels: the last of the file, wherever that is in the patient.
    let read = |quaternion: [f32; 3], edges: [f32; 4]| {
        std::fs::write(&path, nifti(quaternion, edges)).unwrap();
        let volume =
            format::load_volume(&path, &options(&Right::default()), &Limits::default(), &());
        assert_eq!(volume.unwrap().voxel_size, Vec3::new(1.0, 2.0, 3.0));
        let existence = Existence::Threshold(f64::from(value(DIMS - 1)));
        let contents = load(&path, &ImportOptions { existence, ..ImportOptions::default() });
        let contents = contents.unwrap().contents;
        assert_eq!(contents.grid.dims(), UVec3::new(6, 4, 5));
        voxels(&contents).iter().map(|(v, _)| v.to_array()).collect::<Vec<_>>()
    };
    let edges = [1.0, 1.0, 2.0, 3.0];
    // x to the right of the patient, y to the front, z to the head: the last voxel is at the right, front and head.
    let upright = read([0.0; 3], edges);
    assert_eq!(upright, [[0, 3, 4]]);
    // The sign of the third axis is 1 even if it is 0; -1 mirrors it.
    assert_eq!(read([0.0; 3], [0.0, 1.0, 2.0, 3.0]), upright);
    assert_eq!(read([0.0; 3], [-1.0, 1.0, 2.0, 3.0]), [[0, 0, 4]]);
    // Half a turn about x: y to the back, z to the feet.
    for length in [1.0, 1.000_000_2, 0.999_999_9] {
        assert_eq!(read([length, 0.0, 0.0], edges), [[0, 0, 0]], "{length}");
    }
    // An edge has no sign.
    assert_eq!(read([0.0; 3], [1.0, 1.0, -2.0, 3.0]), upright);
}

/// Returns a page of a TIFF file in big-endian numbers, packed with Deflate: its offset in the file, and its bytes,
/// with the next page's.
fn page(
    at: u32,
    rows: &[Vec<u8>],
    bits: u16,
    format: u16,
    predictor: u16,
    is_last: bool,
) -> Vec<u8> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::best());
    rows.iter().for_each(|row| packed.write_all(row).unwrap());
    let packed = packed.finish().unwrap();
    let fields: [(u16, u16, u32); 11] = [
        (256, 3, DIMS.x),
        (257, 3, DIMS.y),
        (258, 3, bits.into()),
        (259, 3, 8),
        (262, 3, 1),
        (273, 4, at + 2 + 11 * 12 + 4),
        (277, 3, 1),
        (278, 3, DIMS.y),
        (279, 4, packed.len() as u32),
        (317, 3, predictor.into()),
        (339, 3, format.into()),
    ];
    let mut page = (fields.len() as u16).to_be_bytes().to_vec();
    for (tag, kind, value) in fields {
        page.extend([tag, kind].map(u16::to_be_bytes).concat());
        page.extend(1u32.to_be_bytes());
        let short = [(value as u16).to_be_bytes(), [0; 2]].concat();
        page.extend(if kind == 3 { short } else { value.to_be_bytes().to_vec() });
    }
    let end = at + page.len() as u32 + 4 + packed.len() as u32;
    page.extend((if is_last { 0 } else { end }).to_be_bytes());
    page.extend(packed);
    page
}

#[test]
fn tiff_of_big_endian_numbers_that_are_told_as_differences() {
    let file = |row: &dyn Fn(u32, u32) -> Vec<u8>, bits: u16, format: u16, predictor: u16| {
        let mut file = b"MM\0\x2A\0\0\0\x08".to_vec();
        for z in 0..DIMS.z {
            let rows: Vec<Vec<u8>> = (0..DIMS.y).map(|y| row(y, z)).collect();
            let is_last = z + 1 == DIMS.z;
            file.extend(page(file.len() as u32, &rows, bits, format, predictor, is_last));
        }
        file
    };
    let of_row = |y: u32, z: u32| (0..DIMS.x).map(move |x| value(UVec3::new(x, y, z)));
    let differences = |y: u32, z: u32| {
        let mut before = 0u16;
        let step = |value: u16| {
            let step = value.wrapping_sub(before);
            before = value;
            step.to_be_bytes()
        };
        of_row(y, z).flat_map(step).collect::<Vec<u8>>()
    };
    checked(&[("a.tif", &file(&differences, 16, 1, 2))], Vec3::ONE);
    // For floats: the highest bytes of a row, then the next and so on, as differences of bytes.
    let planes = |y: u32, z: u32| {
        let floats: Vec<[u8; 4]> = of_row(y, z).map(|v| f32::from(v).to_be_bytes()).collect();
        let bytes = (0..4).flat_map(|i| floats.iter().map(move |float| float[i]));
        let mut before = 0u8;
        let step = |byte: u8| {
            let step = byte.wrapping_sub(before);
            before = byte;
            step
        };
        bytes.map(step).collect::<Vec<u8>>()
    };
    checked(&[("a.tif", &file(&planes, 32, 3, 3))], Vec3::ONE);
}

/// Encodes bytes as base 64 (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |bytes: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(*bytes.get(i).unwrap_or(&0)));
        let letter = |i: usize| match i <= bytes.len() {
            true => char::from(letters[(bits >> (18 - 6 * i) & 63) as usize]),
            false => '=',
        };
        (0..4).map(letter).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

#[test]
fn vti_of_base_64_whose_lengths_are_coded_apart() {
    let file = |head: &str, coded: &str| {
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" {head}>\n\
             <ImageData WholeExtent=\"3 8 -2 2 10 13\" Origin=\"5 0 0\" Spacing=\"1 2 3\">\n\
             <Piece Extent=\"3 8 -2 2 10 13\"><CellData/><PointData Scalars=\"d\">\n\
             <DataArray type=\"UInt16\" Name=\"d\" format=\"appended\" offset=\"0\" RangeMin=\"0\" RangeMax=\"999\"/>\n\
             </PointData></Piece></ImageData>\n<AppendedData encoding=\"base64\">\n   _{coded}\n  </AppendedData>\n</VTKFile>\n"
        )
    };
    let voxel = Vec3::new(1.0, 2.0, 3.0);
    let values = values();
    let apart = base64(&(values.len() as u32).to_le_bytes()) + &base64(&values);
    checked(&[("a.vti", file("header_type=\"UInt32\"", &apart).as_bytes())], voxel);
    let long = (values.len() as u64).to_le_bytes();
    let apart = base64(&long) + &base64(&values);
    checked(&[("a.vti", file("header_type=\"UInt64\"", &apart).as_bytes())], voxel);
    let joined = base64(&[&long[..], &values].concat());
    checked(&[("a.vti", file("header_type=\"UInt64\"", &joined).as_bytes())], voxel);
    // In blocks of 100 bytes, the last of which is shorter.
    let blocks: Vec<Vec<u8>> = values
        .chunks(100)
        .map(|block| {
            let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
            packed.write_all(block).unwrap();
            packed.finish().unwrap()
        })
        .collect();
    let lengths = [blocks.len(), 100, values.len() % 100].into_iter();
    let lengths: Vec<u8> = lengths
        .chain(blocks.iter().map(Vec::len))
        .flat_map(|length| (length as u64).to_le_bytes())
        .collect();
    let coded = base64(&lengths) + &base64(&blocks.concat());
    let head = "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"";
    checked(&[("a.vti", file(head, &coded).as_bytes())], voxel);
}

#[test]
fn dicom_slices_are_in_order_without_their_numbers() {
    let files = std::fs::read_dir(fixture("11_dicom_no_preamble")).unwrap();
    let files: Vec<(PathBuf, Vec<u8>)> = files
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect();
    let number = [0x20, 0, 0x13, 0, 2, 0, 0, 0];
    let read = |change: &dyn Fn(&mut [u8], usize)| {
        let folder = tempfile::tempdir().unwrap();
        for (i, (path, bytes)) in files.iter().enumerate() {
            let mut bytes = bytes.clone();
            let at = bytes.windows(8).position(|window| window == number).unwrap();
            change(&mut bytes[at..], i);
            std::fs::write(folder.path().join(path.file_name().unwrap()), bytes).unwrap();
        }
        let options = ImportOptions::default();
        format::load_volume(folder.path(), &options, &Limits::default(), &()).unwrap()
    };
    let whole = read(&|_, _| ());
    assert_eq!(whole.dims, UVec3::new(24, 20, 6));
    let is_same = |change: &dyn Fn(&mut [u8], usize)| assert!(read(change).data == whole.data);
    // All slices have the same number; none has any, under an unknown tag; numbers run backwards.
    is_same(&|element, _| element[8] = b'7');
    is_same(&|element, _| element[2] = 0x15);
    is_same(&|element, i| element[8] = b'9' - i as u8);
}
