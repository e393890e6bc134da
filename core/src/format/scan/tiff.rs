//! Reads TIFF stacks (TIFF 6.0, BigTIFF): the pages of one file, or the numbered files of a folder, one page each.
//!
//! Takes the bytes of a file; gives a volume whose first page is its lowest layer. Large stacks may stay in their files
//! (`tiff/layered.rs`). Metadata of ImageJ or OME-TIFF (`tiff/told.rs`), where present, gives the voxel spacing, and the
//! pages that are the layers of the channel and time to read. No TIFF file defines its up axis.

mod layered;
mod palette;
#[cfg(test)]
mod tests;
mod told;
mod zstd;

use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};

use glam::{UVec3, Vec3};
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use self::told::Told;
use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan};
use super::unpack::{cut, malformed};
use crate::format::error::printable;
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::format::volume::Samples;
use crate::format::{FormatError, Volumes, go_on};
use crate::sculpture::grid::MAX_AXIS_VX;

pub static SPEC: FormatSpec = FormatSpec {
    // In either byte order, and of BigTIFF.
    signs: &[
        Sign::At(0, b"II*\0"),
        Sign::At(0, b"MM\0*"),
        Sign::At(0, b"II+\0"),
        Sign::At(0, b"MM\0+"),
    ],
    folder: Some(|folder| first_of(folder).is_some()),
    ..FormatSpec::new(
        "a TIFF stack",
        &["tif", "tiff"],
        Import::Scan(|reading| {
            let first = if reading.path.is_dir() { first_of(reading.path) } else { None };
            let path = first.as_deref().unwrap_or(reading.path);
            if let Some(scan) = layered::scan(path, reading)? {
                return Ok((scan, std::fs::metadata(path)?.len()));
            }
            reading.read_whole(path, |file| read(path, file, reading))
        }),
    )
};

/// Greatest number of digits that number a file.
const MOST_DIGITS: usize = 15;
/// Greatest number of files of a folder that are examined.
const MOST_FILES: usize = 1 << 16;

/// The pages of a file in memory.
type Pages<'a> = Decoder<Cursor<&'a [u8]>>;

/// The properties common to all pages of a stack.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Page {
    width: u32,
    height: u32,
    colours: ColorType,
}

/// A stack, described by its first file.
struct TiffStack {
    page: Page,
    dims: UVec3,
    voxel_size: Vec3,
    /// The pages of the file that are its layers.
    pages: Vec<usize>,
    /// The files that are its layers instead, if there are several.
    series: Vec<PathBuf>,
    /// Where the first page begins, if the others follow it without directories of their own.
    behind: Option<u64>,
    is_of_imagej: bool,
    volumes: Volumes,
    notes: Vec<String>,
}

impl TiffStack {
    /// Describes the stack to read from the file at `path`.
    fn of<R: Read + Seek>(
        decoder: &mut Decoder<R>,
        path: &Path,
        reading: &Reading,
    ) -> Result<TiffStack, FormatError> {
        let (page, own) = pages_alike(decoder)?;
        decoder.seek_to_image(0).map_err(damaged)?;
        let mut notes = Vec::new();
        if own.others > 0 {
            notes.push(format!(
                "pages left out, of another size or type than the first: {}",
                own.others
            ));
        }
        let told = Told::of(decoder);
        let behind = if own.alike.len() == 1 { behind_first(decoder, &told) } else { None };
        let pages = if behind.is_some() { (0..told.images).collect() } else { own.alike };
        let is_one = pages.len() == 1;
        let (pages, volumes) = told.one_volume(pages, reading, &mut notes)?;
        let series = if is_one { series(path, &mut notes) } else { Vec::new() };
        let depth = pages.len().max(series.len());
        let Some(depth) = u32::try_from(depth).ok().filter(|depth| *depth <= MAX_AXIS_VX) else {
            return Err(FormatError::Scan(format!(
                "{depth} pages; at most {MAX_AXIS_VX} are read; leave some out, or scale it down"
            )));
        };
        let dims = UVec3::new(page.width, page.height, depth);
        let Told { voxel_size, is_of_imagej, .. } = told;
        reading.admit(dims, voxel_size)?;
        Ok(TiffStack {
            page,
            dims,
            voxel_size,
            pages,
            series,
            behind,
            is_of_imagej,
            volumes,
            notes,
        })
    }

    /// Returns the display name.
    fn kind(&self) -> String {
        match self.series.len() {
            0 => format!("TIFF, pages: {}", self.dims.z),
            files => format!("TIFF, series of {files} files"),
        }
    }
}

fn read(path: &Path, mut file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let palette = palette::taken(&mut file);
    let mut stack = TiffStack::of(&mut open(&file)?, path, reading)?;
    let (page, dims) = (stack.page, stack.dims);
    let mut layers = PageStack { page, number: None, data: Vec::new(), dims, reading };

    reading.progress.begin("reading pages");
    let added = match (stack.series.is_empty(), stack.behind) {
        (true, Some(begin)) => layers.add_behind(&file, begin as usize, &stack.pages),
        (true, None) => stack.pages.iter().try_for_each(|&i| layers.add(&file, i)),
        (false, _) => stack.series.iter().try_for_each(|path| {
            let mut file = reading.read(path)?;
            palette::taken(&mut file);
            layers.add(&file, 0)
        }),
    };
    reading.progress.end();
    added?;
    let number = layers.number.unwrap_or(Number::U8);
    let samples = match palette.filter(|_| number == Number::U8) {
        Some(_) if stack.is_of_imagej => {
            let note = "its palette, by which ImageJ shows densities, was left out";
            stack.notes.push(note.to_string());
            number.into_samples(layers.data, false, [1.0, 0.0])
        }
        Some(palette) => {
            (Samples::Rgb8, layers.data.iter().flat_map(|i| palette[usize::from(*i)]).collect())
        }
        None => number.into_samples(layers.data, false, [1.0, 0.0]),
    };
    Ok(Scan {
        volume: volume(dims, stack.voxel_size, samples, Vec::new()).into(),
        frame: AxisFrame::Unknown,
        kind: stack.kind(),
        is_label: false,
        volumes: stack.volumes,
        notes: stack.notes,
    })
}

/// Returns the start of the first page if the others follow it without directories of their own, as ImageJ writes large
/// files. `None` otherwise.
fn behind_first<R: Read + Seek>(first: &mut Decoder<R>, told: &Told) -> Option<u64> {
    let is_packed = !matches!(first.get_tag_u32(Tag::Compression), Ok(1) | Err(_));
    if !told.is_of_imagej || told.images < 2 || is_packed {
        return None;
    }
    first.get_tag_u64_vec(Tag::StripOffsets).ok()?.first().copied()
}

/// The pages of a file.
struct TiffPages {
    /// The pages like the first.
    alike: Vec<usize>,
    /// The number of all others, such as thumbnails.
    others: usize,
}

fn pages_alike<R: Read + Seek>(pages: &mut Decoder<R>) -> Result<(Page, TiffPages), FormatError> {
    let first = page_of(pages)?;
    let mut found = TiffPages { alike: vec![0], others: 0 };
    for i in 1.. {
        if !pages.more_images() || i > MAX_AXIS_VX as usize {
            break;
        }
        pages.next_image().map_err(damaged)?;
        match page_of(pages)? == first {
            true => found.alike.push(i),
            false => found.others += 1,
        }
    }
    Ok((first, found))
}

fn open(file: &[u8]) -> Result<Pages<'_>, FormatError> {
    Decoder::new(Cursor::new(file)).map_err(damaged)
}

fn page_of<R: Read + Seek>(pages: &mut Decoder<R>) -> Result<Page, FormatError> {
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
struct PageStack<'a> {
    page: Page,
    /// The number type of the first page.
    number: Option<Number>,
    /// The pixels, little-endian.
    data: Vec<u8>,
    dims: UVec3,
    reading: &'a Reading<'a>,
}

impl PageStack<'_> {
    /// Appends pages that follow the first one, which begins at byte `begin`.
    fn add_behind(&mut self, file: &[u8], begin: usize, all: &[usize]) -> Result<(), FormatError> {
        // The first page determines the number type.
        let mut first = PageStack { data: Vec::new(), dims: self.dims, ..*self };
        first.add(file, 0)?;
        let number = first.number.unwrap_or(Number::U8);
        let layer = first.data.len();
        let width = if matches!(number, Number::Rgb | Number::Rgba) { 1 } else { number.bytes() };
        let is_big = file.starts_with(b"MM");
        let whole = number.check(self.dims, self.reading.rest_bytes(file.len() as u64))?;
        self.number = Some(number);
        self.data.reserve_exact(whole as usize);
        for i in all {
            go_on(self.reading.progress)?;
            let at = i.checked_mul(layer).and_then(|at| at.checked_add(begin));
            let bytes = at.and_then(|at| file.get(at..)?.get(..layer));
            let bytes = bytes.ok_or_else(|| {
                cut((layer * (i + 1)) as u64, file.len().saturating_sub(begin) as u64)
            })?;
            let start = self.data.len();
            self.data.extend_from_slice(bytes);
            if is_big {
                self.data[start..].chunks_exact_mut(width as usize).for_each(<[u8]>::reverse);
            }
            self.reading.progress.advance(self.data.len() as f32 / whole as f32);
        }
        Ok(())
    }

    /// Appends page `i` of a file.
    fn add(&mut self, file: &[u8], i: usize) -> Result<(), FormatError> {
        go_on(self.reading.progress)?;
        let rest_bytes = self.reading.rest_bytes(file.len() as u64);
        // Nothing larger than a page is unpacked.
        let most = u64::from(self.dims.x) * u64::from(self.dims.y) * 8;
        let most = most.min(rest_bytes) as usize;
        let mut limits = Limits::default();
        // Tiles may extend beyond the page.
        let most_in_file = usize::try_from(rest_bytes).unwrap_or(usize::MAX);
        (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (most, most_in_file);
        let mut pages = open(file)?.with_limits(limits.clone());
        if i > 0 {
            pages.seek_to_image(i).map_err(damaged)?;
        }
        if page_of(&mut pages)? != self.page {
            return Err(FormatError::Scan(
                "the files of the series differ in size or type; keep each series in its own folder"
                    .to_string(),
            ));
        }
        let pixels = match zstd::unpacked(file, &mut pages, rest_bytes)? {
            Some(plain) => open(&plain)?.with_limits(limits).read_image(),
            None => pages.read_image(),
        };
        let (number, bytes) = bytes_of(pixels.map_err(damaged)?, self.page.colours)?;
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

/// Returns the numbers of a page, little-endian.
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

/// Returns the files numbered like `path`, in order, if there are several: the same name except for its last number.
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

/// Returns the file that represents a folder: the first of the longest series of numbered TIFF files, or the first TIFF
/// file. `None` if there is no TIFF file.
fn first_of(folder: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.take(MOST_FILES);
    let is_tiff = |path: &PathBuf| SPEC.is_named(path) && path.is_file();
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
    // The first of those of equal length.
    let longest = series.rev().max_by_key(|series| series.len())?;
    longest.first().map(|(_, path)| path.clone())
}

/// Splits a name into the part before its last number, its ending, and that number.
fn numbered(path: &Path) -> Option<(String, String, u64)> {
    let stem = path.file_stem()?.to_str()?;
    let prefix = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &stem[prefix.len()..];
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    let number = (digits.len() <= MOST_DIGITS).then(|| digits.parse().ok())??;
    Some((prefix.to_string(), ending, number))
}

/// Converts the error of a library about a file that it cannot read.
fn damaged(error: TiffError) -> FormatError {
    match error {
        TiffError::LimitsExceeded => malformed("the TIFF file", "more pixels than its header says"),
        TiffError::UnsupportedError(error) => FormatError::Scan(format!(
            "this kind of TIFF file is not read ({}); save it without compression, or with LZW, Deflate or ZSTD, as grey or RGB",
            printable(&error.to_string())
        )),
        error => malformed("the TIFF file", printable(&error.to_string())),
    }
}
