//! Tests DICOM files that are written here, with all variations that scanners produce.

use std::path::{Path, PathBuf};

use glam::{IVec3, UVec3, Vec3};
use tempfile::TempDir;

use super::tags::{self, Tag};
use crate::format::options::{Existence, ImportOptions};
use crate::format::{self, FormatError, Info, Samples, Volume, info};
use crate::sculpture::Limits;

/// The contents of a file.
#[derive(Clone)]
struct File {
    syntax: &'static str,
    elements: Vec<(Tag, [u8; 2], Vec<u8>)>,
    /// Fragments of packed pixels.
    fragments: Vec<Vec<u8>>,
}

impl File {
    /// Returns a slice of 3 x 2 pixels of 16 bits in explicit little-endian numbers, at a position along z.
    fn slice(z: f64, pixels: [u16; 6]) -> File {
        let file =
            File { syntax: "1.2.840.10008.1.2.1", elements: Vec::new(), fragments: Vec::new() };
        let file = file.text(tags::SERIES, "1.2.3").text(tags::INSTANCE_NUMBER, "1");
        let file =
            file.text(tags::ORIENTATION, r"1\0\0\0\1\0").text(tags::PIXEL_SPACING, r"0.5\0.25");
        let file = file.text(tags::POSITION, &format!(r"10\20\{z}")).text(tags::MODALITY, "CT");
        let file = file.text(tags::PHOTOMETRIC, "MONOCHROME2").u16(tags::SAMPLES_PER_PIXEL, 1);
        let file = file.u16(tags::ROWS, 2).u16(tags::COLUMNS, 3).u16(tags::BITS_ALLOCATED, 16);
        let file = file.u16(tags::BITS_STORED, 16).u16(tags::HIGH_BIT, 15).u16(tags::IS_SIGNED, 0);
        file.pixels(&pixels.map(u16::to_le_bytes).concat())
    }

    fn with(mut self, tag: Tag, vr: &[u8; 2], bytes: &[u8]) -> File {
        self.elements.retain(|(own, ..)| *own != tag);
        let mut bytes = bytes.to_vec();
        if bytes.len() % 2 == 1 {
            bytes.push(if vr == b"OB" { 0 } else { b' ' });
        }
        self.elements.push((tag, *vr, bytes));
        self.elements.sort_by_key(|(tag, ..)| *tag);
        self
    }

    fn text(self, tag: Tag, text: &str) -> File {
        self.with(tag, b"DS", text.as_bytes())
    }

    fn u16(self, tag: Tag, value: u16) -> File {
        self.with(tag, b"US", &value.to_le_bytes())
    }

    fn pixels(self, bytes: &[u8]) -> File {
        self.with(tags::WHOLE_PIXELS, b"OW", bytes)
    }

    fn bits(self, allocated: u16, stored: u16, high: u16, is_signed: bool) -> File {
        let file = self.u16(tags::BITS_ALLOCATED, allocated).u16(tags::BITS_STORED, stored);
        file.u16(tags::HIGH_BIT, high).u16(tags::IS_SIGNED, is_signed.into())
    }

    fn packed(mut self, syntax: &'static str, fragments: Vec<Vec<u8>>) -> File {
        (self.syntax, self.fragments) = (syntax, fragments);
        self
    }

    fn bytes(&self) -> Vec<u8> {
        let mut out = vec![0; 128];
        out.extend_from_slice(b"DICM");
        let mut uid = self.syntax.as_bytes().to_vec();
        uid.resize(uid.len().next_multiple_of(2), 0);
        element(&mut out, tags::TRANSFER_SYNTAX, Some(b"UI"), &uid);
        let is_explicit = self.syntax != "1.2.840.10008.1.2";
        for (tag, vr, bytes) in &self.elements {
            if *tag == tags::WHOLE_PIXELS && !self.fragments.is_empty() {
                out.extend([0xE0, 0x7F, 0x10, 0, b'O', b'B', 0, 0, 255, 255, 255, 255]);
                element(&mut out, tags::ITEM, None, &[]);
                self.fragments.iter().for_each(|bytes| element(&mut out, tags::ITEM, None, bytes));
                element(&mut out, tags::SEQUENCE_END, None, &[]);
                continue;
            }
            element(&mut out, *tag, is_explicit.then_some(vr), bytes);
        }
        out
    }
}

fn element(out: &mut Vec<u8>, tag: Tag, vr: Option<&[u8; 2]>, bytes: &[u8]) {
    out.extend(((tag >> 16) as u16).to_le_bytes());
    out.extend((tag as u16).to_le_bytes());
    let length = bytes.len() as u32;
    match vr {
        None => out.extend(length.to_le_bytes()),
        Some(vr) if matches!(vr, b"OB" | b"OW" | b"SQ") => {
            out.extend(vr);
            out.extend([0, 0]);
            out.extend(length.to_le_bytes());
        }
        Some(vr) => {
            out.extend(vr);
            out.extend((length as u16).to_le_bytes());
        }
    }
    out.extend(bytes);
}

fn item(elements: &[(Tag, &[u8; 2], &[u8])]) -> Vec<u8> {
    let mut inner = Vec::new();
    elements.iter().for_each(|(tag, vr, bytes)| element(&mut inner, *tag, Some(*vr), bytes));
    let mut out = Vec::new();
    element(&mut out, tags::ITEM, None, &inner);
    out
}

fn write(folder: &TempDir, name: &str, file: &File) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, file.bytes()).unwrap();
    path
}

fn load(path: &Path) -> Result<Volume, FormatError> {
    format::load_volume(path, &ImportOptions::default(), &Limits::default(), &())
}

/// Returns the volume of a single file, with its description.
fn alone(file: &File) -> (Vec<f32>, Volume, Info) {
    let folder = tempfile::tempdir().unwrap();
    let path = write(&folder, "one.dcm", file);
    let volume = load(&path).unwrap();
    (values(&volume), volume, info(&path).unwrap())
}

fn values(volume: &Volume) -> Vec<f32> {
    let UVec3 { x, y, z } = volume.dims;
    let at = |i: u32| UVec3::new(i % x, i / x % y, i / (x * y));
    (0..x * y * z).filter_map(|i| volume.density(at(i))).collect()
}

/// Writes the files of a series whose slices hold their number everywhere.
fn series(folder: &TempDir, places: &[f64]) -> PathBuf {
    for (i, z) in places.iter().enumerate() {
        write(folder, &format!("IM{}", 90 - i), &File::slice(*z, [i as u16; 6]));
    }
    folder.path().join("IM90")
}

fn layers(volume: &Volume) -> Vec<f32> {
    (0..volume.dims.z).filter_map(|z| volume.density(UVec3::new(0, 0, z))).collect()
}

#[test]
fn a_series_is_sorted_by_place_whatever_its_names_and_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = series(&folder, &[7.0, 1.0, 4.0, -2.0]);
    std::fs::write(folder.path().join("notes.txt"), "not DICOM").unwrap();
    for path in [path.as_path(), folder.path()] {
        let volume = load(path).unwrap();
        assert_eq!((volume.dims, layers(&volume)), (UVec3::new(3, 2, 4), vec![3.0, 1.0, 2.0, 0.0]));
        assert_eq!(volume.voxel_size, Vec3::new(0.25, 0.5, 3.0));
        let told = info(path).unwrap();
        assert_eq!(told.kind, "DICOM CT, series of 4 files");
        assert_eq!(told.orientation.as_deref(), Some("x to left, y to back, z to head"));
        assert!(told.notes.is_empty(), "{:?}", told.notes);
    }
    // Another series, and pictures of another size.
    let other =
        File::slice(9.0, [9; 6]).text(tags::SERIES, "1.2.4").text(tags::SERIES_DESCRIPTION, "legs");
    let other = write(&folder, "other", &other);
    write(&folder, "scout", &File::slice(9.0, [9; 6]).u16(tags::ROWS, 1));
    assert_eq!(load(&other).unwrap().dims.z, 1);
    assert_eq!(load(&path).unwrap().dims.z, 4);
    assert!(info(&path).unwrap().notes[0].ends_with("direction: 1"));
    let error = load(folder.path()).unwrap_err().to_string();
    assert!(error.contains("2 series") && error.contains("legs (1 files, other)"), "{error}");
}

#[test]
fn missing_doubled_and_unequal_slices_are_told() {
    let of = |places: &[f64]| {
        let folder = tempfile::tempdir().unwrap();
        let path = series(&folder, places);
        (
            layers(&load(&path).unwrap()),
            load(&path).unwrap().voxel_size.z,
            info(&path).unwrap().notes,
        )
    };
    let (layers, step, notes) = of(&[0.0, 2.0, 8.0, 10.0]);
    assert_eq!((layers, step), (vec![0.0, 1.0, 1.0, 2.0, 2.0, 3.0], 2.0));
    assert_eq!(notes, ["slices missing: 2; the nearest ones stand for them"]);
    let (layers, _, notes) = of(&[0.0, 2.0, 2.0, 4.0]);
    assert_eq!((layers.len(), notes.len()), (3, 1));
    assert!(notes[0].ends_with("echo: 1"), "{notes:?}");
    let (layers, step, notes) = of(&[0.0, 1.0, 2.5, 4.0]);
    assert_eq!((layers, step), (vec![0.0, 1.0, 2.0, 2.0, 3.0], 1.0));
    assert!(notes[0].contains("from 1.00 to 1.50 mm"), "{notes:?}");
    let folder = tempfile::tempdir().unwrap();
    let error = load(&series(&folder, &[0.0, 1.0, 2.0, 90.0])).unwrap_err().to_string();
    assert!(error.contains("gaps as large as 88 mm"), "{error}");
}

#[test]
fn oblique_slices_stand_upright_and_are_not_mirrored() {
    let folder = tempfile::tempdir().unwrap();
    // Rows from front to back, columns from head to feet, slightly rotated; slices from left to right.
    let axes = r"0\0.995\-0.0998\0\-0.0998\-0.995";
    for (i, x) in [5.0, 2.0, -1.0].into_iter().enumerate() {
        let file = File::slice(0.0, [i as u16; 6]).text(tags::ORIENTATION, axes);
        write(&folder, &format!("{i}.dcm"), &file.text(tags::POSITION, &format!(r"{x}\0\0")));
    }
    let path = folder.path().join("0.dcm");
    let volume = load(&path).unwrap();
    // The normal is row x column, to the right here.
    assert_eq!((layers(&volume), volume.voxel_size.z), (vec![0.0, 1.0, 2.0], 3.0));
    let told = info(&path).unwrap().orientation.unwrap();
    assert_eq!(told, "x to back, y to feet, z to right, up to 6 degrees oblique");
    // The rightmost slice, at the viewer's left, is the only one that exists.
    let options =
        ImportOptions { existence: Existence::Threshold(2.0), ..ImportOptions::default() };
    let loaded = format::load(&path, &options, &Limits::default(), &()).unwrap();
    assert_eq!(loaded.assumed_up, None);
    let grid = loaded.contents.grid;
    assert_eq!((grid.dims(), grid.opaque_count()), (UVec3::new(3, 2, 3), 6));
    assert!(grid.get(IVec3::new(0, 1, 2)) && !grid.get(IVec3::new(2, 1, 2)));
}

#[test]
fn numbers_of_all_kinds() {
    let pixels = [0u16, 1, 2, 3, 0xFFF, 0xF800];
    let plain = File::slice(0.0, pixels);
    assert_eq!(alone(&plain).0, pixels.map(f32::from));
    let twelve = plain.clone().bits(16, 12, 11, true);
    let (signed, volume, _) = alone(&twelve);
    assert_eq!(
        (signed.as_slice(), volume.samples),
        (&[0.0, 1.0, 2.0, 3.0, -1.0, -2048.0][..], Samples::I16Le)
    );
    let scaled =
        plain.clone().bits(16, 12, 11, false).text(tags::SLOPE, "2").text(tags::INTERCEPT, "-1024");
    assert_eq!(alone(&scaled).0, [-1024.0, -1022.0, -1020.0, -1018.0, 7166.0, 3072.0]);
    let negative = plain.clone().bits(16, 12, 11, false).text(tags::PHOTOMETRIC, "MONOCHROME1");
    let (values, _, told) = alone(&negative);
    assert_eq!(values, [4095.0, 4094.0, 4093.0, 4092.0, 0.0, 2047.0]);
    assert!(told.notes.iter().any(|note| note.contains("MONOCHROME1")));
    let bytes = plain.clone().bits(8, 8, 7, true).pixels(&[0, 1, 127, 128, 255, 4]);
    assert_eq!(alone(&bytes).0, [0.0, 1.0, 127.0, -128.0, -1.0, 4.0]);
    let wide = [0u32, 70_000, 5, 6, 7, u32::MAX].map(u32::to_le_bytes).concat();
    let wide = plain.clone().bits(32, 32, 31, false).pixels(&wide);
    assert_eq!(alone(&wide).0, [0.0, 70_000.0, 5.0, 6.0, 7.0, u32::MAX as f32]);
    let colours: Vec<u8> = (0..18).collect();
    let rgb =
        plain.bits(8, 8, 7, false).u16(tags::SAMPLES_PER_PIXEL, 3).text(tags::PHOTOMETRIC, "RGB");
    let (_, volume, _) = alone(&rgb.clone().pixels(&colours));
    assert_eq!((volume.samples, &volume.data), (Samples::Rgb8, &colours));
    let (_, volume, _) = alone(&rgb.u16(tags::PLANAR, 1).pixels(&colours));
    assert_eq!(volume.data[..6], [0, 6, 12, 1, 7, 13]);
    let mut implicit = File::slice(0.0, pixels);
    implicit.syntax = "1.2.840.10008.1.2";
    assert_eq!(alone(&implicit).0, pixels.map(f32::from));
}

#[test]
fn slices_that_are_scaled_each_on_its_own_keep_their_meaning() {
    let folder = tempfile::tempdir().unwrap();
    for (i, slope) in ["1", "0.5", "4"].into_iter().enumerate() {
        let file =
            File::slice(i as f64, [10; 6]).text(tags::SLOPE, slope).text(tags::INTERCEPT, "1");
        write(&folder, &format!("{i}.dcm"), &file);
    }
    let volume = load(folder.path()).unwrap();
    assert_eq!((volume.samples, layers(&volume)), (Samples::F32Le, vec![11.0, 6.0, 41.0]));
}

#[test]
fn frames_of_one_file_lie_where_their_groups_say() {
    let groups = [4.0, 2.0, 0.0].map(|z| {
        let position = format!(r"1\2\{z} ");
        let position = item(&[(tags::POSITION, b"DS", position.as_bytes())]);
        item(&[(tags::POSITION_GROUP, b"SQ", &position)])
    });
    let measures = item(&[(tags::PIXEL_SPACING, b"DS", br"0.7\0.7 ")]);
    let axes = item(&[(tags::ORIENTATION, b"DS", br"1\0\0\0\1\0 ")]);
    let shared =
        item(&[(tags::ORIENTATION_GROUP, b"SQ", &axes), (tags::MEASURES_GROUP, b"SQ", &measures)]);
    let pixels: Vec<u8> =
        (0..3u16).flat_map(|frame| [frame; 6]).flat_map(u16::to_le_bytes).collect();
    let mut file = File::slice(0.0, [0; 6]).pixels(&pixels).text(tags::FRAMES, "3");
    let moved = [tags::POSITION, tags::ORIENTATION, tags::PIXEL_SPACING];
    file.elements.retain(|(tag, ..)| !moved.contains(tag));
    let file = file.with(tags::SHARED_GROUPS, b"SQ", &shared).with(
        tags::FRAME_GROUPS,
        b"SQ",
        &groups.concat(),
    );
    let (_, volume, told) = alone(&file);
    assert_eq!(
        (layers(&volume), volume.voxel_size),
        (vec![2.0, 1.0, 0.0], Vec3::new(0.7, 0.7, 2.0))
    );
    assert_eq!(told.kind, "DICOM CT, frames: 3");
    assert!(told.notes.is_empty() && told.orientation.is_some(), "{:?}", told.notes);
}

/// Packs 16-bit pixels in RLE: high bytes as a run, low bytes unchanged.
fn rle(low: [u8; 6]) -> Vec<u8> {
    let mut out = [2u32, 64, 66].map(u32::to_le_bytes).concat();
    out.resize(64, 0);
    out.extend([251, 1, 5]);
    out.extend(low);
    out[8] = 66;
    out
}

const RLE: &str = "1.2.840.10008.1.2.5";
const JPEG: &str = "1.2.840.10008.1.2.4.50";

#[test]
fn packed_pixels_are_unpacked() {
    let low = [0, 1, 2, 3, 4, 255];
    let file = File::slice(0.0, [0; 6]).packed(RLE, vec![rle(low)]);
    assert_eq!(alone(&file).0, low.map(|low| 256.0 + f32::from(low)));
    let two = file.text(tags::FRAMES, "2").packed(RLE, vec![rle(low), rle([9; 6])]);
    assert_eq!(alone(&two).0[6..], [265.0; 6]);

    let mut jpeg = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut jpeg, 100);
    let picture = image::GrayImage::from_fn(16, 8, |x, y| image::Luma([(x * 12 + y * 4) as u8]));
    picture.write_with_encoder(encoder).unwrap();
    let file =
        File::slice(0.0, [0; 6]).bits(8, 8, 7, false).u16(tags::COLUMNS, 16).u16(tags::ROWS, 8);
    let file = file.packed(JPEG, vec![jpeg[..100].to_vec(), jpeg[100..].to_vec()]);
    let far = |(read, meant): (f32, &u8)| (read - f32::from(*meant)).abs() > 2.0;
    assert!(!alone(&file).0.into_iter().zip(picture.as_raw()).any(far));
    let (_, _, told) = alone(&file);
    assert_eq!(told.kind, "DICOM CT, one file, packed as JPEG");
}

const JPEG_2000: &str = "1.2.840.10008.1.2.4.90";

/// Returns a codestream of 24x20 pixels, written by OpenJPEG.
fn codestream(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/jpeg2000");
    std::fs::read(folder.join(name)).unwrap()
}

fn large(file: File) -> File {
    file.u16(tags::COLUMNS, 24).u16(tags::ROWS, 20)
}

#[test]
fn jpeg_2000_is_unpacked() {
    let places = || (0..24 * 20u32).map(|i| (i % 24, i / 24));
    let ramp: Vec<f32> = places().map(|(x, y)| (1000 + 37 * x + 101 * y) as f32).collect();
    let plain = || large(File::slice(0.0, [0; 6]));
    let grey = plain().bits(16, 16, 15, false).packed(JPEG_2000, vec![codestream("grey16.j2k")]);
    let (found, _, told) = alone(&grey);
    assert_eq!(found, ramp);
    assert_eq!(told.kind, "DICOM CT, one file, packed as JPEG 2000");
    // In two fragments and signed; above half of the range; with unused bits.
    let signed = codestream("signed16.j2k");
    let parts = vec![signed[..100].to_vec(), signed[100..].to_vec()];
    assert_eq!(alone(&plain().bits(16, 16, 15, true).packed(JPEG_2000, parts)).0, ramp);
    let high: Vec<f32> = ramp.iter().map(|value| value * 17.0).collect();
    let above = vec![codestream("high16.j2k")];
    assert_eq!(alone(&plain().bits(16, 16, 15, false).packed(JPEG_2000, above)).0, high);
    let few = plain().bits(16, 12, 11, false).packed(JPEG_2000, vec![codestream("grey16.j2k")]);
    assert_eq!(alone(&few).0, ramp);
    // Several frames, and with loss.
    let two = plain().bits(16, 16, 15, false).text(tags::FRAMES, "2");
    let two = two.packed(JPEG_2000, vec![codestream("grey16.j2k"), codestream("high16.j2k")]);
    assert_eq!(alone(&two).0, [ramp, high].concat());
    let lossy = plain().bits(8, 8, 7, false);
    let lossy = lossy.packed("1.2.840.10008.1.2.4.91", vec![codestream("lossy8.j2k")]);
    let far = |(found, (x, y)): (f32, (u32, u32))| (found - (x * 10 + y) as f32).abs() > 2.0;
    assert!(!alone(&lossy).0.into_iter().zip(places()).any(far));
    // Colours, from colour differences.
    let rgb = plain().bits(8, 8, 7, false).u16(tags::SAMPLES_PER_PIXEL, 3);
    let rgb =
        rgb.text(tags::PHOTOMETRIC, "YBR_RCT").packed(JPEG_2000, vec![codestream("rgb8.j2k")]);
    let (_, volume, _) = alone(&rgb);
    for (x, y) in places() {
        let rgb = [x * 10, y * 12, (x + y) * 5].map(|value| value as u8);
        assert_eq!(volume.data[volume.offset(x, y, 0)..][..3], rgb);
    }
}

#[test]
fn jpeg_2000_that_is_no_such_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |file: File| {
        let path = write(&folder, "bad.dcm", &file);
        load(&path).unwrap_err().to_string()
    };
    let plain = || large(File::slice(0.0, [0; 6])).bits(16, 16, 15, false);
    let whole = codestream("grey16.j2k");
    let other = plain().u16(tags::ROWS, 21).packed(JPEG_2000, vec![whole.clone()]);
    assert!(refused(other).contains("24x20 pixels, where the header says 24x21"));
    let colours = plain().packed(JPEG_2000, vec![codestream("rgb8.j2k")]);
    assert!(refused(colours).contains("3 samples a pixel"));
    assert!(refused(plain().packed(JPEG_2000, vec![vec![0; 8]])).contains("JPEG 2000"));
    // A header that claims more than memory allows.
    let mut huge = whole;
    huge[8..16].copy_from_slice(&[0x7F; 8]);
    huge[24..32].copy_from_slice(&[0x7F; 8]);
    assert!(refused(plain().packed(JPEG_2000, vec![huge])).contains("pixels, where"));
}

#[test]
fn errors_name_the_feature_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |file: File| {
        let path = write(&folder, "bad.dcm", &file);
        let error = load(&path).unwrap_err().to_string();
        assert!(error.len() < 300 && !error.chars().any(char::is_control), "{error:?}");
        error
    };
    let plain = || File::slice(0.0, [1; 6]);
    assert!(
        refused(plain().packed("1.2.840.10008.1.2.4.92", vec![vec![0; 8]])).contains("JPEG 2000")
    );
    assert!(
        refused(plain().packed("1.2.840.10008.1.2.4.80", vec![vec![0; 8]])).contains("JPEG-LS")
    );
    assert!(refused(plain().packed("1.2.3.4", vec![vec![0; 8]])).contains("1.2.3.4"));
    assert!(refused(plain().text(tags::PHOTOMETRIC, "PALETTE COLOR")).contains("PALETTE"));
    assert!(refused(plain().bits(1, 1, 0, false)).contains("1 x 1 bits"));
    assert!(refused(plain().bits(16, 12, 9, false)).contains("12 bits up to bit 9"));
    assert!(refused(plain().u16(tags::ROWS, 0)).contains("3x0"));
    assert!(refused(plain().u16(tags::ROWS, u16::MAX).u16(tags::COLUMNS, u16::MAX)).len() > 20);
    assert!(refused(plain().text(tags::FRAMES, "1e12")).contains("frames"));
    assert!(refused(plain().text(tags::FRAMES, "200")).contains("bytes were expected"));
    let mut empty = plain();
    empty.elements.clear();
    assert!(refused(empty).contains("no picture"));
    let path = folder.path().join("bad.dcm");
    std::fs::write(&path, "no DICOM at all").unwrap();
    assert!(load(&path).unwrap_err().to_string().contains("`DICM`"));
    let nothing = tempfile::tempdir().unwrap();
    assert!(matches!(load(nothing.path()), Err(FormatError::NoScanInFolder)));
}

#[test]
fn damaged_files_never_cause_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.dcm");
    let limits = Limits { grid_bytes: 1 << 20, colour_bytes: 8 << 20, ..Limits::default() };
    let load = || format::load_volume(&path, &ImportOptions::default(), &limits, &());
    let mut jpeg = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new(&mut jpeg);
    image::GrayImage::new(3, 2).write_with_encoder(encoder).unwrap();
    let narrow = File::slice(0.0, [7; 6]).bits(8, 8, 7, false);
    let files = [
        File::slice(0.0, [7; 6]).with(tags::SHARED_GROUPS, b"SQ", &item(&[])),
        File::slice(0.0, [7; 6]).packed(RLE, vec![rle([1; 6])]),
        narrow.packed(JPEG, vec![jpeg]),
        large(File::slice(0.0, [7; 6])).packed(JPEG_2000, vec![codestream("rgb8.j2k")]),
        large(File::slice(0.0, [7; 6])).packed(JPEG_2000, vec![codestream("high16.j2k")]),
    ];
    for file in files {
        let whole = file.bytes();
        let end = if file.fragments.is_empty() { whole.len() } else { whole.len() - 8 };
        for cut in (0..end).step_by(3) {
            std::fs::write(&path, &whole[..cut]).unwrap();
            if file.fragments.is_empty() {
                assert!(load().is_err(), "{cut}");
            } else {
                let _ = load();
            }
        }
        for at in 128..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] = [0, 0xFF, whole[at] ^ 0x40][at % 3];
            std::fs::write(&path, bytes).unwrap();
            let _ = load();
        }
    }
}

/// Within narrow limits, a series becomes the same sculpture slice by slice as otherwise in memory: with one scale for all,
/// a scale for each, padding, or unused bits; the files lie in another order than the slices.
#[test]
fn a_large_series_stays_in_its_files() {
    let (columns, rows, count) = (48u16, 40u16, 24u16);
    let narrow = Limits { grid_bytes: 64 << 10, colour_bytes: 128 << 10, ..Limits::default() };
    let number = |x: u16, y: u16, z: u16| {
        let [x, y, z] = [(x, columns), (y, rows), (z, count)]
            .map(|(at, size)| f32::from(at) + 0.5 - 0.5 * f32::from(size));
        let depth = 11.0 - Vec3::new(x, y, z).length();
        // Pixels outside of a cylinder were not scanned.
        if Vec3::new(x, y, 0.0).length() > 19.0 { 9 } else { 100 + (20.0 * depth.max(0.0)) as u16 }
    };
    let variants: [fn(File, u16) -> File; 5] = [
        |file, _| file,
        |file, _| file.text(tags::SLOPE, "0.5").text(tags::INTERCEPT, "-1024"),
        |file, z| file.text(tags::INTERCEPT, &format!("{}", 40 + z)),
        |file, _| file.u16(tags::PADDING, 9),
        |file, _| file.bits(16, 12, 11, true).text(tags::INTERCEPT, "-1000"),
    ];
    for (which, variant) in variants.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        for z in 0..count {
            let pixel = |i: u16| number(i % columns, i / columns, z);
            let pixels: Vec<u8> =
                (0..columns * rows).flat_map(|i| pixel(i).to_le_bytes()).collect();
            let file = File::slice(f64::from(z), [0; 6]).u16(tags::COLUMNS, columns);
            let file = variant(file.u16(tags::ROWS, rows).pixels(&pixels), z);
            write(&folder, &format!("{}.dcm", 99 - z), &file);
        }
        let path = folder.path().join("99.dcm");
        let plain = ImportOptions::default();
        let held = format::load_volume(&path, &plain, &narrow, &());
        assert!(matches!(held, Err(FormatError::OverBudget(_))), "{which} fits into memory");
        let expected = format::load(&path, &plain, &Limits::default(), &()).unwrap();
        let found = format::load(&path, &plain, &narrow, &()).unwrap();
        assert!(found.contents.grid == expected.contents.grid, "{which}");
        assert!(found.contents.material == expected.contents.material, "{which}");
        assert_eq!(found.notes, expected.notes, "{which}");
        assert!(found.contents.grid.opaque_count() > 500, "{which}");
        let told = |limits| format::info_with(&path, &plain, limits, &()).unwrap();
        assert_eq!(told(&narrow), told(&Limits::default()), "{which}");
        // A slice whose pixels are cut.
        let cut = std::fs::read(folder.path().join("90.dcm")).unwrap();
        std::fs::write(folder.path().join("90.dcm"), &cut[..cut.len() - 99]).unwrap();
        let error = format::load(&path, &plain, &narrow, &()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("cut"), "{which}: {error}");
    }
}
