//! Volumes that do not fit into memory: they become the same sculptures as where there is room for them, from every
//! format and packing whose voxels lie in order.

use std::io::Write;
use std::path::{Path, PathBuf};

use bzip2::write::BzEncoder;
use flate2::write::{GzEncoder, ZlibEncoder};
use glam::{UVec3, Vec3};
use sculpture_core::format::options::{
    Colouring, Cubic, Existence, ImportOptions, Ordinal, RawLayout, ScanRegion,
};
use sculpture_core::format::{self, FormatError};
use sculpture_core::sculpture::Limits;
use sculpture_core::sculpture::history::Contents;

const DIMS: UVec3 = UVec3::new(150, 70, 130);

/// Less than the volume and what is made of it need in memory.
const NARROW: Limits = Limits {
    grid_bytes: 512 << 10,
    colour_bytes: 2 << 20,
    history_bytes: 0,
    history_disk_bytes: 0,
};

/// The values of a volume: balls of rising density, with a trace of noise.
fn values() -> Vec<u16> {
    let mut values = Vec::new();
    for z in 0..DIMS.z {
        for y in 0..DIMS.y {
            for x in 0..DIMS.x {
                let at = UVec3::new(x, y, z).as_vec3();
                let balls = [
                    (40.0, 35.0, 30.0, 25.0),
                    (110.0, 30.0, 70.0, 28.0),
                    (60.0, 40.0, 125.0, 20.0),
                ];
                let inside = balls.map(|(x, y, z, r)| r - at.distance(Vec3::new(x, y, z)));
                let depth = inside.into_iter().fold(f32::MIN, f32::max).max(0.0);
                let noise = (x * 7 + y * 31 + z * 17) % 5;
                values.push(if depth > 0.0 { 1000 + (40.0 * depth) as u16 } else { noise as u16 });
            }
        }
    }
    values
}

fn little(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut out = GzEncoder::new(Vec::new(), flate2::Compression::fast());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut out = ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

fn bzip2(bytes: &[u8]) -> Vec<u8> {
    let mut out = BzEncoder::new(Vec::new(), bzip2::Compression::fast());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

/// A folder to which files are written.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, parts: &[&[u8]]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, parts.concat()).unwrap();
        path
    }
}

fn nrrd(fields: &str) -> Vec<u8> {
    format!("NRRD0004\ntype: ushort\nspacings: 1 1 2\n{fields}\n").into_bytes()
}

const SIZES: &str = "dimension: 3\nsizes: 150 70 130\n";

fn load(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
) -> Result<(Contents, Vec<String>), FormatError> {
    format::load(path, options, limits, &()).map(|loaded| (loaded.contents, loaded.notes))
}

/// Checks that a file gives the same sculpture within narrow limits, where it cannot be held, as without them.
fn check(path: &Path, options: &ImportOptions) -> Contents {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let (expected, notes) = load(path, options, &Limits::default()).unwrap();
    let held = format::load_volume(path, options, &NARROW, &());
    assert!(matches!(held, Err(FormatError::OverBudget(_))), "{name} fits into memory");
    let (found, own_notes) = load(path, options, &NARROW).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(found.grid == expected.grid, "{name}: other bits");
    assert!(found.material == expected.material, "{name}: other colours");
    assert_eq!(found.grid.voxel_size(), expected.grid.voxel_size(), "{name}");
    assert_eq!(own_notes, notes, "{name}");
    assert!(found.grid.opaque_count() > 50_000, "{name}");
    let info = format::info_with(path, options, &NARROW, &()).unwrap();
    assert_eq!(info, format::info_with(path, options, &Limits::default(), &()).unwrap(), "{name}");
    found
}

#[test]
fn nrrd_stays_in_its_files() {
    let folder = Folder::new();
    let (values, plain) = (values(), ImportOptions::default());
    let bytes = little(&values);
    let raw = nrrd(&format!("{SIZES}encoding: raw\nendian: little\n"));
    let first = check(&folder.write("raw.nrrd", &[&raw, &bytes]), &plain);
    let same = |path: PathBuf, options: &ImportOptions| {
        let found = check(&path, options);
        assert!(found.grid == first.grid, "{path:?}");
    };
    let big: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    let header = nrrd(&format!("{SIZES}encoding: raw\nendian: big\n"));
    same(folder.write("big.nrrd", &[&header, &big]), &plain);
    let header = nrrd(&format!("{SIZES}encoding: gzip\nendian: little\n"));
    same(folder.write("gzip.nrrd", &[&header, &gzip(&bytes)]), &plain);
    let header = nrrd(&format!("{SIZES}encoding: bzip2\nendian: little\n"));
    same(folder.write("bzip2.nrrd", &[&header, &bzip2(&bytes)]), &plain);
    folder.write("skipped.raw", &[&[9; 7], &bytes]);
    let beside = |skip: &str| {
        let fields =
            format!("{SIZES}encoding: raw\nendian: little\n{skip}data file: skipped.raw\n");
        nrrd(&fields)
    };
    same(folder.write("skip.nhdr", &[&beside("byte skip: 7\n")]), &plain);
    same(folder.write("end.nhdr", &[&beside("byte skip: -1\n")]), &plain);
    let (low, high) = bytes.split_at(bytes.len() / 2);
    folder.write("low.gz", &[&gzip(low)]);
    folder.write("high.gz", &[&gzip(high)]);
    let fields =
        format!("{SIZES}encoding: gzip\nendian: little\ndata file: LIST\nlow.gz\nhigh.gz\n");
    same(folder.write("two.nhdr", &[nrrd(&fields).trim_ascii_end()]), &plain);
    // The second of two times.
    let fields = "dimension: 4\nsizes: 150 70 130 2\nkinds: space space space time\nencoding: raw\nendian: little\n";
    let time = Ordinal::new(2);
    let path = folder.write("times.nrrd", &[&nrrd(fields), &vec![0; bytes.len()], &bytes]);
    same(path, &ImportOptions { time, ..plain });
}

#[test]
fn nifti_and_metaimage_stay_in_their_files() {
    let folder = Folder::new();
    let (bytes, plain) = (little(&values()), ImportOptions::default());
    for (slope, intercept) in [(1.0f32, -1024.0f32), (0.5, 3.0), (1.0, 0.0)] {
        let mut header = vec![0; 352];
        header[..4].copy_from_slice(&348i32.to_le_bytes());
        for (i, size) in [3, 150, 70, 130, 1, 1, 1, 1].into_iter().enumerate() {
            header[40 + 2 * i..42 + 2 * i].copy_from_slice(&(size as i16).to_le_bytes());
            header[76 + 4 * i..80 + 4 * i].copy_from_slice(&1f32.to_le_bytes());
        }
        header[70..72].copy_from_slice(&512i16.to_le_bytes());
        header[72..74].copy_from_slice(&16i16.to_le_bytes());
        header[108..112].copy_from_slice(&352f32.to_le_bytes());
        header[112..116].copy_from_slice(&slope.to_le_bytes());
        header[116..120].copy_from_slice(&intercept.to_le_bytes());
        header[123] = 2;
        header[344..348].copy_from_slice(b"n+1\0");
        check(&folder.write("a.nii", &[&header, &bytes]), &plain);
        let packed = gzip(&[&header[..], &bytes].concat());
        check(&folder.write("a.nii.gz", &[&packed]), &plain);
        header[344..348].copy_from_slice(b"ni1\0");
        header[108..112].copy_from_slice(&0f32.to_le_bytes());
        folder.write("pair.img", &[&bytes]);
        check(&folder.write("pair.hdr", &[&header[..348]]), &plain);
    }
    let meta = |fields: &str, file: &str| {
        format!("ObjectType = Image\nNDims = 3\nDimSize = 150 70 130\nElementSpacing = 1 1 2\nElementType = MET_USHORT\n{fields}ElementDataFile = {file}\n").into_bytes()
    };
    check(&folder.write("local.mha", &[&meta("", "LOCAL"), &bytes]), &plain);
    let packed = zlib(&bytes);
    check(
        &folder.write("packed.mha", &[&meta("CompressedData = True\n", "LOCAL"), &packed]),
        &plain,
    );
    folder.write("voxels.zraw", &[&packed]);
    check(&folder.write("packed.mhd", &[&meta("CompressedData = True\n", "voxels.zraw")]), &plain);
    folder.write("voxels.raw", &[&[1; 11], &bytes]);
    check(&folder.write("skip.mhd", &[&meta("HeaderSize = 11\n", "voxels.raw")]), &plain);
    check(&folder.write("end.mhd", &[&meta("HeaderSize = -1\n", "voxels.raw")]), &plain);
    let mut list = meta("", "LIST");
    for (z, layer) in bytes.chunks(150 * 70 * 2).enumerate() {
        let name = format!("layer{z}.raw");
        folder.write(&name, &[layer]);
        list.extend_from_slice(format!("{name}\n").as_bytes());
    }
    check(&folder.write("list.mhd", &[&list]), &plain);
}

#[test]
fn all_options_hold_for_volumes_in_their_files() {
    let folder = Folder::new();
    let bytes = little(&values());
    let path = folder.write("a.raw", &[&[5; 3], &bytes]);
    let raw: RawLayout = "150x70x130:u16le:skip=3".parse().unwrap();
    let plain = ImportOptions { raw: Some(raw), ..ImportOptions::default() };
    let whole = check(&path, &plain);
    let region = ScanRegion { low: UVec3::new(9, 2, 5), high: UVec3::new(140, 66, 128) };
    let cut = check(&path, &ImportOptions { region: Some(region), ..plain });
    assert_eq!(cut.grid.dims(), UVec3::new(132, 65, 124));
    let between = Existence::Range(1000.0, 1500.0);
    let hollow = check(&path, &ImportOptions { existence: between, ..plain });
    assert!(hollow.grid.opaque_count() < whole.grid.opaque_count());
    for colouring in [Colouring::Grey, Colouring::Tissue, Colouring::Labels] {
        let options = ImportOptions { colouring, existence: Existence::Threshold(900.0), ..plain };
        check(&path, &options);
    }
    let cleaned = ImportOptions { largest_piece: true, fill_holes: true, ..plain };
    check(&path, &cleaned);
    // Resampled, a volume is held: here there is no room for it.
    let cubic = ImportOptions { cubic: Cubic::EdgeMm(0.7), ..plain };
    assert!(matches!(load(&path, &cubic, &NARROW), Err(FormatError::OverBudget(_))));
}

#[test]
fn volumes_in_their_files_are_refused_when_they_are_cut_short_or_too_rugged() {
    let folder = Folder::new();
    let (bytes, plain) = (little(&values()), ImportOptions::default());
    let half = &bytes[..bytes.len() / 2];
    let header = nrrd(&format!("{SIZES}encoding: raw\nendian: little\n"));
    let short = folder.write("short.nrrd", &[&header, half]);
    let message = load(&short, &plain, &NARROW).unwrap_err().to_string();
    assert!(message.contains(&format!("{} bytes were expected", bytes.len())), "{message}");
    let header = nrrd(&format!("{SIZES}encoding: gzip\nendian: little\n"));
    let short = folder.write("short_packed.nrrd", &[&header, &gzip(half)]);
    let message = load(&short, &plain, &NARROW).unwrap_err().to_string();
    assert!(message.contains(&format!("there are {}", half.len())), "{message}");
    let packed = gzip(&bytes);
    let torn = folder.write("torn.nrrd", &[&header, &packed[..packed.len() / 2]]);
    assert!(matches!(load(&torn, &plain, &NARROW), Err(FormatError::Malformed { .. })));
    // Every brick is mixed.
    let noise: Vec<u16> =
        (0..DIMS.element_product()).map(|i| (i.wrapping_mul(7919) % 13 % 2) as u16).collect();
    let header = nrrd(&format!("{SIZES}encoding: raw\nendian: little\n"));
    let rugged = folder.write("rugged.nrrd", &[&header, &little(&noise)]);
    let options = ImportOptions { existence: Existence::Threshold(1.0), ..plain };
    let narrower = Limits { grid_bytes: 100 << 10, ..NARROW };
    let message = load(&rugged, &options, &narrower).unwrap_err().to_string();
    assert!(message.contains("voxels of this volume need about"), "{message}");
}
