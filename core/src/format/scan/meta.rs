//! Reads MetaImage scans (itk.org/Wiki/MetaIO): `.mha` with the voxels after the header, and `.mhd` with the voxels in
//! another file or in several; raw, packed with zlib, or as text.
//!
//! Takes the bytes of a file; gives one of its volumes with spacing and orientation.

use std::collections::HashMap;
use std::path::PathBuf;

use flate2::read::ZlibDecoder;
use glam::{DVec3, UVec3, Vec3};

use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan, ScanVolume};
use super::unpack::{cut, exactly, malformed};
use crate::format::error::excerpt;
use crate::format::layered::{LayeredVolume, PartPacking, StoredNumbers, StoredVoxels, VoxelPart};
use crate::format::spec::{FormatSpec, Import};
use crate::format::{FormatError, Volumes, store};

pub static SPEC: FormatSpec = FormatSpec::new(
    "a MetaImage",
    &["mha", "mhd"],
    Import::Scan(|reading| {
        if reading.in_layers
            && let Some(scan) = layered(reading)?
        {
            return Ok((scan, std::fs::metadata(reading.path)?.len()));
        }
        reading.read_whole(reading.path, |file| read(file, reading))
    }),
);

/// Greatest length of a header.
const MOST_BYTES: usize = 1 << 20;
/// The field that ends a header: the location of the voxels.
const DATA_FILE: &str = "ElementDataFile";
const MOST_AXES: usize = 8;

struct MetaImageHeader {
    fields: HashMap<String, String>,
    /// The lines after the last field, up to an empty one.
    listed: Vec<String>,
    bytes: usize,
}

impl MetaImageHeader {
    fn parse(file: &[u8]) -> Result<MetaImageHeader, FormatError> {
        let start = &file[..file.len().min(MOST_BYTES)];
        let mut header = MetaImageHeader { fields: HashMap::new(), listed: Vec::new(), bytes: 0 };
        let mut lines = start.split_inclusive(|byte| *byte == b'\n');
        for line in lines.by_ref() {
            header.bytes += line.len();
            let text = String::from_utf8_lossy(line);
            let text = text.trim();
            if text.is_empty() {
                continue;
            }
            let (name, value) = text.split_once('=').ok_or_else(|| {
                FormatError::Scan(format!(
                    "this is not a MetaImage: its header has the line `{}`; export it again as .mha",
                    excerpt(text.as_bytes())
                ))
            })?;
            let name = name.trim();
            header.fields.insert(name.to_string(), value.trim().to_string());
            if name == DATA_FILE {
                if value.trim() == "LIST" {
                    let names = lines.map(|line| String::from_utf8_lossy(line).trim().to_string());
                    header.listed = names.filter(|name| !name.is_empty()).collect();
                }
                return Ok(header);
            }
        }
        Err(malformed("the header", format!("the field `{DATA_FILE}` is missing")))
    }

    fn field(&self, names: &[&str]) -> Option<&str> {
        names.iter().find_map(|name| self.fields.get(*name)).map(String::as_str)
    }

    fn numbers(&self, names: &[&str]) -> Result<Option<Vec<f64>>, FormatError> {
        let Some(text) = self.field(names) else { return Ok(None) };
        let numbers = text.split_whitespace().map(|word| word.parse().ok()).collect();
        let wrong =
            || malformed("the header", format!("`{}` is `{}`", names[0], excerpt(text.as_bytes())));
        Option::ok_or_else(numbers, wrong).map(Some)
    }

    fn is(&self, names: &[&str]) -> bool {
        self.field(names).is_some_and(|value| value.eq_ignore_ascii_case("true"))
    }
}

/// One of the volumes that a header describes.
struct MetaImageVolume {
    dims: UVec3,
    voxel_size: Vec3,
    number: Number,
    /// How many volumes there are.
    count: u64,
    volumes: Volumes,
    is_text: bool,
    is_packed: bool,
    is_big: bool,
    /// Number of bytes before the voxels; -1: as many as precede those at the end.
    skip: f64,
    notes: Vec<String>,
}

/// Returns the volume of a header that is to be read.
fn described(header: &MetaImageHeader, reading: &Reading) -> Result<MetaImageVolume, FormatError> {
    let sizes = header.numbers(&["DimSize"])?.unwrap_or_default();
    let is_size = |size: &f64| (1.0..=f64::from(u32::MAX)).contains(size) && size.fract() == 0.0;
    if sizes.is_empty() || sizes.len() > MOST_AXES || !sizes.iter().all(is_size) {
        return Err(malformed("the header", "DimSize is no size of a volume"));
    }
    let size = |axis: usize| sizes.get(axis).map_or(1, |size| *size as u32);
    let dims = UVec3::new(size(0), size(1), size(2));
    let count = sizes.iter().skip(3).product::<f64>() as u64;
    let volumes = reading.volumes(count)?;
    let spacing = header.numbers(&["ElementSpacing", "ElementSize"])?;
    let mut notes = Vec::new();
    if spacing.is_none() {
        notes.push("the file does not say how large a voxel is; 1 mm was taken".to_string());
    }
    let edge = |axis: usize| {
        let edge = spacing.as_ref().and_then(|edges| edges.get(axis)).map(|edge| edge.abs() as f32);
        edge.filter(|edge| edge.is_finite() && *edge > 0.0).unwrap_or(1.0)
    };
    let voxel_size = Vec3::new(edge(0), edge(1), edge(2));
    reading.admit(dims, voxel_size)?;
    let number = number(header)?;
    notes.extend(reading.first_of(count));
    let is_text = header.field(&["BinaryData"]).is_some_and(|is| is.eq_ignore_ascii_case("false"));
    let is_packed = header.is(&["CompressedData"]);
    let skip = header.numbers(&["HeaderSize"])?.and_then(|all| all.first().copied()).unwrap_or(0.0);
    let is_big = header.is(&["BinaryDataByteOrderMSB", "ElementByteOrderMSB"]) && !is_text;
    Ok(MetaImageVolume {
        dims,
        voxel_size,
        number,
        count,
        volumes,
        is_text,
        is_packed,
        is_big,
        skip,
        notes,
    })
}

/// Returns whether the voxels follow the header.
fn is_local(data_file: &str) -> bool {
    matches!(data_file, "LOCAL" | "Local" | "local")
}

/// Returns the names of the files with the layers of a volume.
fn listed_layers(
    header: &MetaImageHeader,
    dims: UVec3,
    volume: u64,
) -> Result<&[String], FormatError> {
    let mut volumes = header.listed.chunks_exact(dims.z as usize);
    volumes
        .nth(volume as usize)
        .ok_or_else(|| malformed("the header", "it lists fewer files than there are layers"))
}

/// Returns the scan of a large volume that stays in its files; `None` for one that is read whole.
fn layered(reading: &Reading) -> Result<Option<Scan>, FormatError> {
    let header = MetaImageHeader::parse(&reading.start(reading.path)?)?;
    let of = described(&header, reading)?;
    let bytes = of.number.volume_bytes(of.dims);
    let data_file = header.field(&[DATA_FILE]).unwrap_or_default();
    if of.is_text || data_file.contains('%') || !reading.is_large(bytes) {
        return Ok(None);
    }
    let packing = if of.is_packed { PartPacking::Zlib } else { PartPacking::Plain };
    // A part of `bytes` after `before` others, of `all` in the file.
    let part = |path: PathBuf, header_bytes: u64, [bytes, before, all]: [u64; 3]| {
        let begin = match of.skip {
            _ if of.is_packed => before,
            -1.0 if header_bytes == 0 => {
                let found = store::open(&path)?.metadata()?.len();
                found.checked_sub(all).ok_or_else(|| cut(all, found))?.saturating_add(before)
            }
            skip if header_bytes == 0 => before.saturating_add(skip.max(0.0) as u64),
            _ => before.saturating_add(header_bytes),
        };
        let packed_at = if of.is_packed { header_bytes } else { 0 };
        Ok::<VoxelPart, FormatError>(VoxelPart { path, packing, packed_at, begin, bytes })
    };
    let index = of.volumes.time.index();
    let whole = [bytes, bytes.saturating_mul(index), bytes.saturating_mul(of.count)];
    let (parts, elsewhere) = match data_file {
        name if is_local(name) => {
            (vec![part(reading.path.to_path_buf(), header.bytes as u64, whole)?], "")
        }
        "LIST" => {
            let own = bytes / u64::from(of.dims.z);
            let names = listed_layers(&header, of.dims, index)?.iter();
            let parts = names.map(|name| part(reading.beside(name)?, 0, [own, 0, own]));
            (parts.collect::<Result<_, _>>()?, IN_SEVERAL)
        }
        name => (vec![part(reading.beside(name)?, 0, whole)?], IN_A_SECOND),
    };
    let MetaImageVolume { dims, voxel_size, number, is_big, .. } = of;
    let stored = StoredVoxels {
        parts,
        skip: 0,
        numbers: StoredNumbers { number, is_big, scale: [1.0, 0.0] },
    };
    let volume = LayeredVolume::new(stored, dims, voxel_size, Vec::new(), reading.progress)?;
    Ok(Some(scan(volume.into(), &header, of, elsewhere)?))
}

/// Where voxels lie, as the kind of a scan names it.
const IN_SEVERAL: &str = ", voxels in several files";
const IN_A_SECOND: &str = ", voxels in a second file";

/// Returns the scan of a volume.
fn scan(
    volume: ScanVolume,
    header: &MetaImageHeader,
    of: MetaImageVolume,
    elsewhere: &str,
) -> Result<Scan, FormatError> {
    let packing = if of.is_packed { ", packed with zlib" } else { "" };
    Ok(Scan {
        volume,
        frame: frame(header)?,
        kind: format!("MetaImage{packing}{elsewhere}"),
        is_label: false,
        volumes: of.volumes,
        notes: of.notes,
    })
}

fn read(file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let header = MetaImageHeader::parse(&file)?;
    let of = described(&header, reading)?;
    let file_bytes = file.len() as u64;
    let bytes = of.number.check(of.dims, reading.rest_bytes(2 * file_bytes))?;
    let MetaImageVolume { dims, count, is_text, is_packed, skip, number, volumes, .. } = of;
    let place = [volumes.time.index(), count];
    let coding = MetaImageEncoding { is_text, is_packed, skip, number, place, reading };
    let (data, elsewhere) = match header.field(&[DATA_FILE]).unwrap_or_default() {
        name if is_local(name) => {
            let own = MetaImageEncoding { skip: 0.0, ..coding };
            (own.voxels(&file[header.bytes..], bytes)?, "")
        }
        "LIST" => {
            let per_file = bytes / u64::from(dims.z);
            let names = listed_layers(&header, dims, place[0])?;
            let coding = MetaImageEncoding { place: [0, 1], ..coding };
            let mut data = Vec::with_capacity(bytes as usize);
            for name in names {
                data.extend(
                    coding.voxels(&reading.read_beside(&reading.beside(name)?)?, per_file)?,
                );
            }
            (data, IN_SEVERAL)
        }
        pattern if pattern.contains('%') => {
            return Err(FormatError::Scan(
                "its voxels lie in numbered files (a pattern with %), which are not read; write it as .mha".to_string(),
            ));
        }
        name => {
            let file = reading.read_beside(&reading.beside(name)?)?;
            (coding.voxels(&file, bytes)?, IN_A_SECOND)
        }
    };
    let samples = number.into_samples(data, of.is_big, [1.0, 0.0]);
    let volume = volume(dims, of.voxel_size, samples, Vec::new());
    scan(volume.into(), &header, of, elsewhere)
}

/// The encoding of the voxels of a file.
#[derive(Clone, Copy)]
struct MetaImageEncoding<'a> {
    is_text: bool,
    is_packed: bool,
    /// Number of bytes before them; -1: as many as precede those at the end.
    skip: f64,
    number: Number,
    /// The volume of a file to read, counted from 0, and the number of volumes.
    place: [u64; 2],
    reading: &'a Reading<'a>,
}

impl MetaImageEncoding<'_> {
    fn voxels(&self, file: &[u8], bytes: u64) -> Result<Vec<u8>, FormatError> {
        let found = file.len() as u64;
        let [before, all] = self.place.map(|volumes| bytes.saturating_mul(volumes));
        if self.is_text {
            let word_bytes = match self.number {
                Number::Rgb | Number::Rgba => 1,
                number => number.bytes(),
            };
            let rest = super::nrrd::after_words(file, before / word_bytes);
            return super::nrrd::text(rest, self.number, bytes);
        }
        if self.is_packed {
            return exactly(&mut ZlibDecoder::new(file), before, bytes, self.reading.progress);
        }
        let begin = match self.skip {
            -1.0 => found.checked_sub(all),
            skip if (0.0..=found as f64).contains(&skip) => Some(skip as u64),
            _ => None,
        };
        let begin = begin.and_then(|begin| begin.checked_add(before)).filter(|at| *at <= found);
        let voxels = begin.and_then(|begin| file.get(begin as usize..)?.get(..bytes as usize));
        voxels.map(<[u8]>::to_vec).ok_or_else(|| cut(bytes, found))
    }
}

fn number(header: &MetaImageHeader) -> Result<Number, FormatError> {
    let channels = header.numbers(&["ElementNumberOfChannels"])?;
    let channels = channels.and_then(|all| all.first().copied()).unwrap_or(1.0);
    let name = header.field(&["ElementType"]).unwrap_or_default();
    Ok(match (name.strip_suffix("_ARRAY").unwrap_or(name), channels) {
        ("MET_UCHAR", 3.0) => Number::Rgb,
        ("MET_UCHAR", 4.0) => Number::Rgba,
        ("MET_CHAR", 1.0) => Number::I8,
        ("MET_UCHAR", 1.0) => Number::U8,
        ("MET_SHORT", 1.0) => Number::I16,
        ("MET_USHORT", 1.0) => Number::U16,
        ("MET_INT" | "MET_LONG", 1.0) => Number::I32,
        ("MET_UINT" | "MET_ULONG", 1.0) => Number::U32,
        ("MET_LONG_LONG", 1.0) => Number::I64,
        ("MET_ULONG_LONG", 1.0) => Number::U64,
        ("MET_FLOAT", 1.0) => Number::F32,
        ("MET_DOUBLE", 1.0) => Number::F64,
        _ => {
            return Err(FormatError::Scan(format!(
                "voxels of {channels} x `{}` are not read; write one number a voxel, or 3 or 4 of MET_UCHAR",
                excerpt(name.as_bytes())
            )));
        }
    })
}

/// Returns the directions of the axes: x to the left, y to the back, z to the head.
fn frame(header: &MetaImageHeader) -> Result<AxisFrame, FormatError> {
    let matrix = header.numbers(&["TransformMatrix", "Rotation", "Orientation"])?;
    let matrix: Option<[f64; 9]> = matrix.and_then(|all| all.try_into().ok());
    Ok(match matrix {
        Some(m) => AxisFrame::Patient([0, 3, 6].map(|i| DVec3::new(-m[i], -m[i + 1], m[i + 2]))),
        None => AxisFrame::Unknown,
    })
}
