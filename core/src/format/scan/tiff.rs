//! TIFF stacks (TIFF 6.0, BigTIFF): the pages of one file, or the numbered files of a folder, one page each.
//!
//! Takes the bytes of a file; gives a volume whose first page is its lowest layer. The distances of voxels are known
//! where ImageJ noted them. Which way is up no TIFF file says.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use tiff::decoder::ifd::Value;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::frame::Frame;
use super::numbers::{Number, volume};
use super::unpack::malformed;
use super::{Reading, Scan};
use crate::format::{FormatError, go_on};
use crate::sculpture::grid::MAX_AXIS_VX;

/// Digits that number a file.
const MOST_DIGITS: usize = 15;
/// Files of a folder that are looked at.
const MOST_FILES: usize = 1 << 16;

type Pages<'a> = Decoder<Cursor<&'a [u8]>>;

/// What all pages of a stack have in common.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Page {
    width: u32,
    height: u32,
    colours: ColorType,
}

pub fn read(path: &Path, file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let (page, own) = pages_alike(&file)?;
    let mut notes = Vec::new();
    if own.others > 0 {
        notes.push(format!(
            "pages left out, of another size or type than the first: {}",
            own.others
        ));
    }
    let series = if own.alike.len() == 1 { series(path, &mut notes) } else { Vec::new() };
    let depth = own.alike.len().max(series.len());
    let Some(depth) = u32::try_from(depth).ok().filter(|depth| *depth <= MAX_AXIS_VX) else {
        return Err(FormatError::Scan(format!(
            "{depth} pages; at most {MAX_AXIS_VX} are read; leave some out, or scale it down"
        )));
    };
    let dims = UVec3::new(page.width, page.height, depth);
    let voxel_size = spacing(&mut open(&file)?);
    reading.admit(dims, voxel_size)?;
    let mut stack = Stack { page, number: None, data: Vec::new(), dims, reading };

    reading.progress.begin("reading pages");
    let added = match series.is_empty() {
        true => own.alike.iter().try_for_each(|&i| stack.add(&file, i)),
        false => series.iter().try_for_each(|path| stack.add(&reading.read(path)?, 0)),
    };
    reading.progress.end();
    added?;
    let kind = match series.len() {
        0 => format!("TIFF, pages: {depth}"),
        files => format!("TIFF, series of {files} files"),
    };
    let samples = stack.number.unwrap_or(Number::U8).into_samples(stack.data, false, [1.0, 0.0]);
    let volume = volume(dims, voxel_size, samples, Vec::new());
    Ok(Scan { volume, frame: Frame::Unknown, kind, is_label: false, notes })
}

/// The pages of a file.
struct Found {
    /// Those that are as the first.
    alike: Vec<usize>,
    /// The number of all others, such as thumbnails.
    others: usize,
}

fn pages_alike(file: &[u8]) -> Result<(Page, Found), FormatError> {
    let mut pages = open(file)?;
    let first = page_of(&mut pages)?;
    let mut found = Found { alike: vec![0], others: 0 };
    for i in 1.. {
        if !pages.more_images() || i > MAX_AXIS_VX as usize {
            break;
        }
        pages.next_image().map_err(damaged)?;
        match page_of(&mut pages)? == first {
            true => found.alike.push(i),
            false => found.others += 1,
        }
    }
    Ok((first, found))
}

fn open(file: &[u8]) -> Result<Pages<'_>, FormatError> {
    Decoder::new(Cursor::new(file)).map_err(damaged)
}

fn page_of(pages: &mut Pages) -> Result<Page, FormatError> {
    let (width, height) = pages.dimensions().map_err(damaged)?;
    let colours = pages.colortype().map_err(damaged)?;
    match colours {
        ColorType::Gray(8 | 16 | 32 | 64) | ColorType::RGB(8) | ColorType::RGBA(8) => {
            Ok(Page { width, height, colours })
        }
        other => Err(FormatError::Scan(format!(
            "pages of {other:?} are not read; convert them to grey of 8, 16 or 32 bits, or to RGB of 8 bits"
        ))),
    }
}

/// A volume that grows by a page at a time.
struct Stack<'a> {
    page: Page,
    /// The numbers of the first page.
    number: Option<Number>,
    /// Little-endian.
    data: Vec<u8>,
    dims: UVec3,
    reading: &'a Reading<'a>,
}

impl Stack<'_> {
    /// Appends page `i` of a file.
    fn add(&mut self, file: &[u8], i: usize) -> Result<(), FormatError> {
        go_on(self.reading.progress)?;
        let rest_bytes = self.reading.rest_bytes(file.len() as u64);
        // Nothing larger than a page is unpacked.
        let most = u64::from(self.dims.x) * u64::from(self.dims.y) * 8;
        let most = most.min(rest_bytes) as usize;
        let mut limits = Limits::default();
        (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (most, most);
        let mut pages = open(file)?.with_limits(limits);
        if i > 0 {
            pages.seek_to_image(i).map_err(damaged)?;
        }
        if page_of(&mut pages)? != self.page {
            return Err(FormatError::Scan(
                "the files of the series differ in size or type; keep each series in its own folder"
                    .to_string(),
            ));
        }
        let (number, bytes) = bytes_of(pages.read_image().map_err(damaged)?, self.page.colours)?;
        if *self.number.get_or_insert(number) != number {
            return Err(malformed("the TIFF file", "pages of different types of numbers"));
        }
        let whole = number.check(self.dims, rest_bytes)?;
        let layer = u64::from(self.dims.x) * u64::from(self.dims.y) * number.bytes();
        if bytes.len() as u64 != layer {
            return Err(malformed("the TIFF file", "a page without all of its pixels"));
        }
        if self.data.is_empty() {
            self.data.reserve_exact(whole as usize);
        }
        self.data.extend_from_slice(&bytes);
        self.reading.progress.advance(self.data.len() as f32 / whole as f32);
        Ok(())
    }
}

/// The numbers of a page, little-endian.
fn bytes_of(pixels: DecodingResult, colours: ColorType) -> Result<(Number, Vec<u8>), FormatError> {
    macro_rules! bytes {
        ($number:expr, $values:expr) => {
            ($number, $values.iter().flat_map(|value| value.to_le_bytes()).collect())
        };
    }
    Ok(match pixels {
        DecodingResult::U8(values) => {
            let number = match colours {
                ColorType::RGB(_) => Number::Rgb,
                ColorType::RGBA(_) => Number::Rgba,
                _ => Number::U8,
            };
            (number, values)
        }
        DecodingResult::I8(values) => bytes!(Number::I8, values),
        DecodingResult::U16(values) => bytes!(Number::U16, values),
        DecodingResult::I16(values) => bytes!(Number::I16, values),
        DecodingResult::U32(values) => bytes!(Number::U32, values),
        DecodingResult::I32(values) => bytes!(Number::I32, values),
        DecodingResult::U64(values) => bytes!(Number::U64, values),
        DecodingResult::I64(values) => bytes!(Number::I64, values),
        DecodingResult::F32(values) => bytes!(Number::F32, values),
        DecodingResult::F64(values) => bytes!(Number::F64, values),
        _ => {
            return Err(FormatError::Scan(
                "floating-point numbers of 16 bits are not read; convert them to 32 bits"
                    .to_string(),
            ));
        }
    })
}

/// The files that are numbered as `path`, in order, if there are several: the same name but for its last number.
fn series(path: &Path, notes: &mut Vec<String>) -> Vec<PathBuf> {
    let Some((prefix, ending, _)) = numbered(path) else { return Vec::new() };
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<(u64, PathBuf)> = entries
        .filter_map(|entry| {
            let other = entry.ok()?.path();
            let (own_prefix, own_ending, number) = numbered(&other)?;
            (own_prefix == prefix && own_ending == ending).then_some((number, other))
        })
        .collect();
    files.sort();
    let [(first, _), .., (last, _)] = &files[..] else { return Vec::new() };
    let missing = (last - first + 1).saturating_sub(files.len() as u64);
    if missing > 0 {
        notes.push(format!("numbers missing in the series, whose layers close up: {missing}"));
    }
    files.into_iter().map(|(_, path)| path).collect()
}

/// The file of a folder that stands for it: the first of the longest series of numbered TIFF files, or the first TIFF
/// file. None if there is no TIFF file.
pub fn first_of(folder: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.take(MOST_FILES);
    let is_tiff = |path: &PathBuf| {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        ["tif", "tiff"].iter().any(|tiff| ending.eq_ignore_ascii_case(tiff)) && path.is_file()
    };
    let mut files: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(is_tiff)
        .map(|path| (numbered(&path), path))
        .collect();
    files.sort();
    let name = |own: &Option<(String, String, u64)>| {
        own.as_ref().map(|(prefix, ending, _)| (prefix.clone(), ending.clone()))
    };
    let series = files.chunk_by(|(a, _), (b, _)| a.is_some() && name(a) == name(b));
    // The first of those that are equally long.
    let longest = series.rev().max_by_key(|series| series.len())?;
    longest.first().map(|(_, path)| path.clone())
}

/// A name as what stands before its last number, its ending, and that number.
fn numbered(path: &Path) -> Option<(String, String, u64)> {
    let stem = path.file_stem()?.to_str()?;
    let prefix = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &stem[prefix.len()..];
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    let number = (digits.len() <= MOST_DIGITS).then(|| digits.parse().ok())??;
    Some((prefix.to_string(), ending, number))
}

/// Edges of a voxel in millimetres, as ImageJ writes them; 1 where nothing is known.
fn spacing(pages: &mut Pages) -> Vec3 {
    let text = pages.get_tag_ascii_string(Tag::ImageDescription).unwrap_or_default();
    if !text.starts_with("ImageJ=") {
        return Vec3::ONE;
    }
    let of = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
    let unit_mm = match of("unit=") {
        Some("mm" | "millimeter") => 1.0,
        Some("cm") => 10.0,
        Some("micron" | "um" | "µm" | "\\u00B5m") => 1e-3,
        Some("nm") => 1e-6,
        Some("inch") => 25.4,
        _ => return Vec3::ONE,
    };
    let edge = |value: Option<f64>| {
        let edge_mm = value.unwrap_or(1.0) * unit_mm;
        if edge_mm.is_finite() && edge_mm > 0.0 { edge_mm as f32 } else { 1.0 }
    };
    let mut per_unit = |tag| match pages.get_tag(tag) {
        Ok(Value::Rational(count, units)) => Some(f64::from(units) / f64::from(count)),
        _ => None,
    };
    let (x, y) = (per_unit(Tag::XResolution), per_unit(Tag::YResolution));
    Vec3::new(edge(x), edge(y), edge(of("spacing=").and_then(|text| text.parse().ok()).or(x)))
}

fn damaged(error: TiffError) -> FormatError {
    match error {
        TiffError::LimitsExceeded => malformed("the TIFF file", "more pixels than its header says"),
        error => malformed("the TIFF file", error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use tiff::encoder::colortype::{ColorType as Coding, Gray8, Gray16, Gray32Float, RGB8};
    use tiff::encoder::{Rational, TiffEncoder, TiffValue};

    use super::*;
    use crate::format::options::ImportOptions;
    use crate::format::{Samples, Volume, info, load_volume};
    use crate::sculpture::Limits as Memory;

    /// A file of pages of 3 x 2 pixels, with a description.
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
            // What is cut off may be beyond the last pixel.
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
}
