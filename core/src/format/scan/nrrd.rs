//! Reads NRRD scans (teem.sourceforge.net/nrrd/format.html): `.nrrd` and `.nhdr`, raw, gzip, bzip2, text and
//! hexadecimal, with the voxels after the header, in another file, or in several.
//!
//! Takes the bytes of a file; gives its three spatial axes as a volume, at one position along all others. An axis of
//! red, green, blue and optionally opacity becomes colours.

use bzip2::read::MultiBzDecoder;
use flate2::read::MultiGzDecoder;
use glam::{DVec3, UVec3, Vec3};

use super::frame::AxisFrame;
use super::nrrd_header::{MAGIC, NrrdAxis, NrrdEncoding, NrrdHeader};
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan};
use super::segments::Segments;
use super::unpack::{cut, exactly, malformed};
use crate::format::layered::{LayeredVolume, PartPacking, StoredNumbers, StoredVoxels, VoxelPart};
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::format::volume::Samples;
use crate::format::{FormatError, store};

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC)],
    ..FormatSpec::new("an NRRD scan", &["nrrd", "nhdr"], Import::Scan(open))
};

fn open(reading: &Reading) -> Result<(Scan, u64), FormatError> {
    if reading.in_layers
        && let Some(scan) = layered(reading)?
    {
        return Ok((scan, std::fs::metadata(reading.path)?.len()));
    }
    reading.read_whole(reading.path, |file| read(file, reading))
}

/// Returns the scan of a large volume that stays in its files; `None` for one that must be read whole.
fn layered(reading: &Reading) -> Result<Option<Scan>, FormatError> {
    let header = NrrdHeader::parse(&reading.start(reading.path)?)?;
    let layout = NrrdLayout::of(&header)?;
    let number = layout.number(&header);
    let packing = match header.encoding {
        NrrdEncoding::Raw => PartPacking::Plain,
        NrrdEncoding::Gzip => PartPacking::Gzip,
        NrrdEncoding::Bzip2 => PartPacking::Bzip2,
        NrrdEncoding::Text | NrrdEncoding::Hex => return Ok(None),
    };
    let of_layers = if layout.others.len() == 1 { layout.volumes } else { 1 };
    let has_segments = layout.colours == 1 && Segments::of(&header.pairs, of_layers).is_some();
    let is_plain = layout.is_in_order() && header.line_skip == 0 && !has_segments;
    if !is_plain || !reading.is_large(number.volume_bytes(layout.dims)) {
        return Ok(None);
    }
    let volumes = reading.volumes(layout.volumes)?;
    reading.admit(layout.dims, layout.voxel_size)?;
    let total = header.total_bytes();
    let mut parts = Vec::new();
    let names = header.data_files.as_slice();
    let count = names.len().max(1) as u64;
    if !total.is_multiple_of(count) {
        return Err(unequal(total, count));
    }
    let own = names.is_empty().then(|| Ok(reading.path.to_path_buf()));
    for path in own.into_iter().chain(names.iter().map(|name| reading.beside(name))) {
        let (path, bytes) = (path?, total / count);
        let header_bytes = if names.is_empty() { header.bytes as u64 } else { 0 };
        let begin = match (packing, u64::try_from(header.byte_skip)) {
            (PartPacking::Plain, Ok(skip)) => header_bytes + skip,
            // As many as precede the voxels at the end.
            (PartPacking::Plain, Err(_)) => {
                let found = store::open(&path)?.metadata()?.len();
                found.checked_sub(bytes).ok_or_else(|| cut(bytes, found))?
            }
            // After unpacking.
            (_, skip) => skip.unwrap_or(0),
        };
        let packed_at = if packing == PartPacking::Plain { 0 } else { header_bytes };
        parts.push(VoxelPart { path, packing, packed_at, begin, bytes });
    }
    let skip = layout.begin(volumes.time.index()) * header.number.bytes();
    let (is_big, scale) = (header.is_big, [1.0, 0.0]);
    let stored = StoredVoxels { parts, skip, numbers: StoredNumbers { number, is_big, scale } };
    let kind = kind(&header);
    let mut notes = notes(&header, &layout);
    notes.extend(reading.first_of(layout.volumes));
    let (dims, voxel_size) = (layout.dims, layout.voxel_size);
    let volume =
        LayeredVolume::new(stored, dims, voxel_size, header.content, reading.progress)?.into();
    Ok(Some(Scan { volume, frame: layout.frame, kind, is_label: false, volumes, notes }))
}

/// Returns notes on the header.
fn notes(header: &NrrdHeader, layout: &NrrdLayout) -> Vec<String> {
    let mut notes = layout.notes.clone();
    if !header.unknown_units.is_empty() {
        let units = header.unknown_units.join("`, `");
        notes.push(format!("lengths in the unknown unit `{units}` were taken as millimetres"));
    }
    notes
}

/// Returns the display name of the packing.
fn kind(header: &NrrdHeader) -> String {
    let packing = match header.encoding {
        NrrdEncoding::Raw => "not packed",
        NrrdEncoding::Text => "as text",
        NrrdEncoding::Hex => "hexadecimal",
        NrrdEncoding::Gzip => "packed with gzip",
        NrrdEncoding::Bzip2 => "packed with bzip2",
    };
    let elsewhere = match header.data_files.len() {
        0 => String::new(),
        1 => ", voxels in a second file".to_string(),
        n => format!(", voxels in {n} other files"),
    };
    format!("NRRD, {packing}{elsewhere}")
}

/// Returns the error of voxels that do not fill their files.
fn unequal(total: u64, count: u64) -> FormatError {
    malformed("the header", format!("{total} bytes of voxels cannot lie in {count} files alike"))
}

fn read(file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let header = NrrdHeader::parse(&file)?;
    let layout = NrrdLayout::of(&header)?;
    let of_layers = if layout.others.len() == 1 { layout.volumes } else { 1 };
    let segments = Segments::of(&header.pairs, of_layers).filter(|_| layout.colours == 1);
    // The layers of a segmentation are read together.
    let volumes = reading.volumes(if segments.is_some() { 1 } else { layout.volumes })?;
    reading.admit(layout.dims, layout.voxel_size)?;
    // All unpacked data, and the result made from it.
    let total = header.total_bytes();
    let file_bytes = file.len() as u64;
    crate::format::budget::check_budget(total, reading.rest_bytes(file_bytes))?;
    header.number.check(layout.dims, reading.rest_bytes(file_bytes + total))?;

    let data = match header.data_files.as_slice() {
        [] => unpack(&file[header.bytes..], &header, total, reading)?,
        [name] => unpack(&reading.read_beside(&reading.beside(name)?)?, &header, total, reading)?,
        names => join(names, &header, total, reading)?,
    };
    let number = layout.number(&header);
    let mut notes = notes(&header, &layout);
    let samples = match &segments {
        Some(segments) => {
            notes.push(segments.note());
            let coloured = header.number.check(layout.dims, u64::MAX)? / header.number.bytes();
            let layers = coloured.saturating_mul(4 * (of_layers + 2));
            let rest_bytes = reading.rest_bytes(file_bytes + total);
            crate::format::budget::check_budget(layers, rest_bytes)?;
            let layers = layout.layers(&data, of_layers, number, header.is_big);
            (Samples::Rgba8, segments.colours(&layers))
        }
        None => {
            notes.extend(reading.first_of(layout.volumes));
            let begin = layout.begin(volumes.time.index()) * header.number.bytes();
            let mut data = data;
            data.drain(..begin as usize);
            let data = layout.gather(data, number.bytes() as usize);
            number.into_samples(data, header.is_big, [1.0, 0.0])
        }
    };
    let kind = kind(&header);
    Ok(Scan {
        volume: volume(layout.dims, layout.voxel_size, samples, header.content).into(),
        frame: layout.frame,
        kind,
        is_label: segments.is_some(),
        volumes,
        notes,
    })
}

/// Returns the bytes of all voxels, `total` in number, from files that hold equal shares of them.
fn join(
    names: &[String],
    header: &NrrdHeader,
    total: u64,
    reading: &Reading,
) -> Result<Vec<u8>, FormatError> {
    let count = names.len() as u64;
    if !total.is_multiple_of(count) {
        return Err(unequal(total, count));
    }
    // All names are checked first: a refusal should not wait until the preceding files are read.
    let paths: Vec<_> = names.iter().map(|name| reading.beside(name)).collect::<Result<_, _>>()?;
    let mut data = Vec::with_capacity(total as usize);
    for path in paths {
        data.extend(unpack(&reading.read_beside(&path)?, header, total / count, reading)?);
    }
    Ok(data)
}

/// Returns the bytes of voxels, `total` in number.
fn unpack(
    file: &[u8],
    header: &NrrdHeader,
    total: u64,
    reading: &Reading,
) -> Result<Vec<u8>, FormatError> {
    let mut rest = file;
    for _ in 0..header.line_skip {
        let end = rest.iter().position(|b| *b == b'\n');
        let end = end.ok_or_else(|| {
            malformed("the voxels", "there are fewer lines than are to be skipped")
        })?;
        rest = &rest[end + 1..];
    }
    let found = rest.len() as u64;
    let from_end = header.byte_skip < 0;
    // -1 has a meaning only for raw voxels; for packed ones, it is written for "no others before them".
    let skip = header.byte_skip.max(0) as u64;
    let after_skip = |rest: &'_ [u8]| -> Result<usize, FormatError> {
        usize::try_from(skip).ok().filter(|n| *n <= rest.len()).ok_or_else(|| cut(skip, found))
    };
    match header.encoding {
        NrrdEncoding::Gzip => {
            exactly(&mut MultiGzDecoder::new(rest), skip, total, reading.progress)
        }
        NrrdEncoding::Bzip2 => {
            exactly(&mut MultiBzDecoder::new(rest), skip, total, reading.progress)
        }
        NrrdEncoding::Raw => {
            let begin = if from_end { found.checked_sub(total) } else { Some(skip) };
            let begin =
                begin.filter(|begin| begin.checked_add(total).is_some_and(|end| end <= found));
            let begin = begin.ok_or_else(|| cut(total, found.saturating_sub(skip)))? as usize;
            Ok(rest[begin..begin + total as usize].to_vec())
        }
        NrrdEncoding::Hex => {
            let digits = rest[after_skip(rest)?..].iter().filter(|b| !b.is_ascii_whitespace());
            let nibbles: Option<Vec<u8>> = digits
                .take(2 * total as usize)
                .map(|b| Some((*b as char).to_digit(16)? as u8))
                .collect();
            let nibbles =
                nibbles.ok_or_else(|| malformed("the voxels", "a digit is not hexadecimal"))?;
            let data: Vec<u8> =
                nibbles.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect();
            if data.len() as u64 == total { Ok(data) } else { Err(cut(total, data.len() as u64)) }
        }
        NrrdEncoding::Text => text(&rest[after_skip(rest)?..], header.number, total),
    }
}

/// Returns whether a byte separates words.
fn is_between(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b','
}

/// Returns the text after its first `count` words.
pub(crate) fn after_words(text: &[u8], count: u64) -> &[u8] {
    let mut rest = text;
    for _ in 0..count {
        let begin = rest.iter().position(|byte| !is_between(byte)).unwrap_or(rest.len());
        let length = rest[begin..].iter().position(is_between).unwrap_or(rest.len() - begin);
        rest = &rest[begin + length..];
        if rest.is_empty() {
            break;
        }
    }
    rest
}

/// Parses numbers written as text to `total` bytes, little-endian.
pub fn text(rest: &[u8], number: Number, total: u64) -> Result<Vec<u8>, FormatError> {
    let mut data = Vec::new();
    let words = rest.split(is_between).filter(|word| !word.is_empty());
    for word in words {
        if data.len() as u64 == total {
            break;
        }
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
        let value = value.ok_or_else(|| {
            malformed("the voxels", format!("`{}` is no number", word.escape_ascii()))
        })?;
        match number {
            Number::I8 => data.push(value as i8 as u8),
            Number::U8 | Number::Rgb | Number::Rgba => data.push(value as u8),
            Number::I16 => data.extend((value as i16).to_le_bytes()),
            Number::U16 => data.extend((value as u16).to_le_bytes()),
            Number::I32 => data.extend((value as i32).to_le_bytes()),
            Number::U32 => data.extend((value as u32).to_le_bytes()),
            Number::I64 => data.extend((value as i64).to_le_bytes()),
            Number::U64 => data.extend((value as u64).to_le_bytes()),
            Number::F32 => data.extend((value as f32).to_le_bytes()),
            Number::F64 => data.extend(value.to_le_bytes()),
        }
    }
    if data.len() as u64 == total { Ok(data) } else { Err(cut(total, data.len() as u64)) }
}

/// The assignment of the axes of the file to the volume.
struct NrrdLayout {
    dims: UVec3,
    /// Distance from a voxel to the next along each axis, in numbers of the file.
    strides: [u64; 3],
    /// How many numbers of the first axis form one colour; 1 for densities.
    colours: u64,
    /// Number of volumes along all other axes.
    volumes: u64,
    /// Sizes of the other axes, and distances from one volume to the next along them, in numbers of the file.
    others: Vec<[u64; 2]>,
    voxel_size: Vec3,
    frame: AxisFrame,
    notes: Vec<String>,
}

impl NrrdLayout {
    fn of(header: &NrrdHeader) -> Result<NrrdLayout, FormatError> {
        let first = &header.axes[0];
        let is_colour = header.number == Number::U8
            && match first.kind.to_ascii_lowercase().as_str() {
                "rgb-color" | "3-color" => first.size == 3,
                "rgba-color" | "4-color" => first.size == 4,
                // As ITK writes colours.
                "vector" | "3-vector" | "4-vector" => matches!(first.size, 3 | 4),
                _ => false,
            };
        let is_space = |axis: &NrrdAxis| {
            let kind = axis.kind.to_ascii_lowercase();
            let spatial = matches!(kind.as_str(), "" | "???" | "none" | "domain" | "space");
            if header.has_directions { axis.direction.is_some() } else { spatial }
        };
        let mut strides = Vec::new();
        let mut stride = 1u64;
        for axis in &header.axes {
            strides.push(stride);
            stride = stride.saturating_mul(axis.size);
        }
        let mut chosen: Vec<usize> = (0..header.axes.len())
            .filter(|i| is_space(&header.axes[*i]) && !(is_colour && *i == 0))
            .collect();
        chosen.truncate(3);
        let others: Vec<usize> = (0..header.axes.len())
            .filter(|i| !(chosen.contains(i) || is_colour && *i == 0))
            .collect();
        let others = others.into_iter().map(|i| [header.axes[i].size, strides[i]]);
        let others: Vec<[u64; 2]> = others.filter(|[size, _]| *size > 1).collect();
        let mut notes = Vec::new();
        if chosen.is_empty() {
            return Err(malformed("the header", "no axis lies in space"));
        }
        let axis = |i: usize| chosen.get(i).map(|place| &header.axes[*place]);
        let size =
            |i: usize| axis(i).map_or(1, |axis| u32::try_from(axis.size).unwrap_or(u32::MAX));
        let length = |i: usize| {
            let spaced = |axis: &NrrdAxis| axis.spacing.map(|length| length * axis.mm_per_unit);
            let length = axis(i).and_then(|a| a.direction.map(DVec3::length).or(spaced(a)));
            length.filter(|n| n.is_finite() && *n != 0.0).map(f64::abs)
        };
        let lengths = [0, 1, 2].map(length);
        if lengths.iter().take(chosen.len()).all(Option::is_none) {
            notes.push("the file does not say how large a voxel is; 1 mm was taken".to_string());
        }
        Ok(NrrdLayout {
            dims: UVec3::new(size(0), size(1), size(2)),
            strides: [0, 1, 2].map(|i| chosen.get(i).map_or(0, |place| strides[*place])),
            colours: if is_colour { first.size } else { 1 },
            volumes: others.iter().fold(1, |n: u64, [size, _]| n.saturating_mul(*size)),
            others,
            voxel_size: lengths.map(|length| length.unwrap_or(1.0) as f32).into(),
            frame: frame(header, [0, 1, 2].map(|i| axis(i).and_then(|axis| axis.direction))),
            notes,
        })
    }

    /// Returns the start of a volume, in numbers of the file. The first of the other axes varies fastest.
    fn begin(&self, volume: u64) -> u64 {
        let mut rest = volume;
        let of_axis = |[size, stride]: &[u64; 2]| {
            let at = rest % size * stride;
            rest /= size;
            at
        };
        self.others.iter().map(of_axis).sum()
    }

    /// Returns the numbers of `count` volumes.
    fn layers(&self, data: &[u8], count: u64, number: Number, is_big: bool) -> Vec<Vec<f32>> {
        let bytes = number.bytes() as usize;
        let of = |volume: u64| {
            let own = data[self.begin(volume) as usize * bytes..].to_vec();
            let floats = number.to_floats(&self.gather(own, bytes), is_big, [1.0, 0.0]);
            floats.as_chunks().0.iter().map(|number| f32::from_le_bytes(*number)).collect()
        };
        (0..count).map(of).collect()
    }

    /// Returns the type of a voxel.
    fn number(&self, header: &NrrdHeader) -> Number {
        match self.colours {
            3 => Number::Rgb,
            4 => Number::Rgba,
            _ => header.number,
        }
    }

    /// Returns whether the voxels of the volume follow one another, x fastest, then y, then z.
    fn is_in_order(&self) -> bool {
        let [width, height, depth] = self.dims.to_array().map(u64::from);
        let [x, y, z] = self.strides.map(|stride| stride / self.colours);
        (x == 1 || width == 1)
            && (y == width || height == 1)
            && (z == width.saturating_mul(height) || depth == 1)
    }

    /// Returns the voxels of the volume, x fastest, of `bytes` each.
    fn gather(&self, data: Vec<u8>, bytes: usize) -> Vec<u8> {
        let UVec3 { x: width, y: height, z: depth } = self.dims;
        let [x, y, z] = self.strides.map(|stride| (stride / self.colours) as usize * bytes);
        let row = width as usize * bytes;
        if self.is_in_order() {
            let mut data = data;
            data.truncate(row * height as usize * depth as usize);
            return data;
        }
        let mut out = Vec::with_capacity(row * height as usize * depth as usize);
        for k in 0..depth as usize {
            for j in 0..height as usize {
                for i in 0..width as usize {
                    let from = i * x + j * y + k * z;
                    out.extend_from_slice(&data[from..from + bytes]);
                }
            }
        }
        out
    }
}

/// Returns the directions of the axes, interpreted by the named space.
fn frame(header: &NrrdHeader, directions: [Option<DVec3>; 3]) -> AxisFrame {
    let [Some(x), Some(y), third] = directions else { return AxisFrame::Unknown };
    // A single slice has no third axis.
    let axes = [x, y, third.unwrap_or_else(|| x.cross(y))];
    let Some(space) = &header.space else { return AxisFrame::World(axes) };
    let space = space.trim_end_matches("-time").trim_end_matches('t');
    let signs = match space {
        "right-anterior-superior" | "ras" => DVec3::new(1.0, 1.0, 1.0),
        "left-anterior-superior" | "las" => DVec3::new(-1.0, 1.0, 1.0),
        "left-posterior-superior" | "lps" => DVec3::new(-1.0, -1.0, 1.0),
        "3d-left-handed" => return AxisFrame::World(axes.map(|v| v * DVec3::new(1.0, 1.0, -1.0))),
        _ => return AxisFrame::World(axes),
    };
    AxisFrame::Patient(axes.map(|v| v * signs))
}
