//! Tests TIFF files that are written here, some of them damaged.

use tiff::encoder::colortype::{ColorType as Coding, Gray8, Gray16, Gray32Float, RGB8};
use tiff::encoder::{Rational, TiffEncoder, TiffValue};

use glam::Vec3;

use super::*;
use crate::format::options::ImportOptions;
use crate::format::{Samples, Volume, info, load_volume};
use crate::sculpture::Limits as Memory;

/// Returns a file of pages of 3 x 2 pixels, with a description.
fn file<C: Coding>(pages: &[Vec<C::Inner>], description: &str) -> Vec<u8>
where
    [C::Inner]: TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for page in pages {
        let mut image = encoder.new_image::<C>(3, 2).unwrap();
        image.encoder().write_tag(Tag::ImageDescription, description).unwrap();
        let resolution = Rational { n: 4, d: 1 };
        image.encoder().write_tag(Tag::XResolution, resolution.clone()).unwrap();
        image.encoder().write_tag(Tag::YResolution, resolution).unwrap();
        image.write_data(page).unwrap();
    }
    bytes.into_inner()
}

fn load(path: &Path) -> Result<Volume, FormatError> {
    load_volume(path, &ImportOptions::default(), &Memory::default(), &())
}

#[test]
fn pages_are_layers_of_any_type() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stack.tif");
    let pages = [0u8, 10, 20, 30].map(|z| (z..z + 6).collect::<Vec<u8>>());
    let as_of = |volume: &Volume| {
        let dims = volume.dims;
        assert_eq!(dims, UVec3::new(3, 2, 4));
        let at = |i: u32| UVec3::new(i % 3, i / 3 % 2, i / 6);
        (0..24).map(|i| volume.density(at(i)).unwrap()).collect::<Vec<f32>>()
    };
    let expected: Vec<f32> = pages.concat().into_iter().map(f32::from).collect();
    std::fs::write(&path, file::<Gray8>(&pages, "")).unwrap();
    let volume = load(&path).unwrap();
    assert_eq!((as_of(&volume), volume.samples), (expected.clone(), Samples::U8));
    assert_eq!(volume.voxel_size, Vec3::ONE);

    let wide = pages.clone().map(|page| page.into_iter().map(u16::from).collect());
    let told = "ImageJ=1.54f\nimages=4\nunit=micron\nspacing=2.5\n";
    std::fs::write(&path, file::<Gray16>(&wide, told)).unwrap();
    let volume = load(&path).unwrap();
    assert_eq!((as_of(&volume), volume.samples), (expected.clone(), Samples::U16Le));
    assert_eq!(volume.voxel_size, Vec3::new(0.25e-3, 0.25e-3, 2.5e-3));

    let floats = pages.clone().map(|page| page.into_iter().map(f32::from).collect());
    std::fs::write(&path, file::<Gray32Float>(&floats, "")).unwrap();
    let volume = load(&path).unwrap();
    assert_eq!((as_of(&volume), volume.samples), (expected, Samples::F32Le));
    assert_eq!(info(&path).unwrap().kind, "TIFF, pages: 4");

    std::fs::write(&path, file::<RGB8>(&[vec![7; 18]], "")).unwrap();
    assert_eq!(load(&path).unwrap().samples, Samples::Rgb8);
}

#[test]
fn numbered_files_are_one_stack() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, value: u8| {
        let path = folder.path().join(name);
        std::fs::write(&path, file::<Gray8>(&[vec![value; 6]], "")).unwrap();
        path
    };
    let numbers = [(1, "1"), (2, "2"), (9, "9"), (10, "10")];
    for (value, number) in numbers {
        write(&format!("slice{number}.tif"), value);
    }
    write("other1.tif", 99);
    let path = folder.path().join("slice9.tif");
    let volume = load(&path).unwrap();
    assert_eq!(volume.dims, UVec3::new(3, 2, 4));
    let layers = [0, 1, 2, 3].map(|z| volume.density(UVec3::new(0, 0, z)));
    assert_eq!(layers, [1.0, 2.0, 9.0, 10.0].map(Some));
    let told = info(&path).unwrap();
    assert_eq!(told.kind, "TIFF, series of 4 files");
    assert!(told.notes.iter().any(|note| note.ends_with(": 6")), "{:?}", told.notes);
    std::fs::write(&path, file::<Gray16>(&[vec![0; 6]], "")).unwrap();
    assert!(load(&path).is_err());
    assert_eq!(load(&folder.path().join("other1.tif")).unwrap().dims.z, 1);
}

#[test]
fn a_folder_is_its_longest_series() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, value: u8| {
        std::fs::write(folder.path().join(name), file::<Gray8>(&[vec![value; 6]], "")).unwrap();
    };
    assert_eq!(first_of(folder.path()), None);
    assert_eq!(first_of(&folder.path().join("missing")), None);
    std::fs::write(folder.path().join("1.txt"), "no picture").unwrap();
    std::fs::create_dir(folder.path().join("0.tif")).unwrap();
    assert!(load(folder.path()).is_err());
    write("cover.tif", 77);
    assert_eq!(load(folder.path()).unwrap().dims.z, 1);
    for (value, number) in [(3, "03"), (2, "02"), (10, "10")] {
        write(&format!("head{number}.TIF"), value);
    }
    write("arm1.tif", 50);
    write("arm2.tif", 51);
    let volume = load(folder.path()).unwrap();
    let layers = [0, 1, 2].map(|z| volume.density(UVec3::new(0, 0, z)));
    assert_eq!((volume.dims.z, layers), (3, [2.0, 3.0, 10.0].map(Some)));
    let told = info(folder.path()).unwrap();
    assert_eq!(told.kind, "TIFF, series of 3 files");
    assert!(told.notes.iter().any(|note| note.ends_with(": 6")), "{:?}", told.notes);
}

#[test]
fn damaged_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.tif");
    let whole = file::<Gray16>(&[vec![1; 6], vec![2; 6]], "");
    for end in 0..whole.len() {
        std::fs::write(&path, &whole[..end]).unwrap();
        // The truncated part may be beyond the last pixel.
        let _ = load(&path);
    }
    for at in 0..whole.len() {
        for bit in [0, 7] {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            std::fs::write(&path, &bytes).unwrap();
            let _ = load(&path);
        }
    }
    for (content, told) in [(&b"\x89PNG"[..], "a PNG image"), (b"neither", "the TIFF file")] {
        std::fs::write(&path, content).unwrap();
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert!(load(&path).is_err());
}
