//! NIfTI-1 and NIfTI-2 scans (nifti.nimh.nih.gov): `.nii`, packed with gzip or not, and pairs of `.hdr` and `.img`.
//!
//! Takes the bytes of a file; gives one of its volumes with spacing and orientation. Both byte orders are read.

use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use glam::{DMat3, DQuat, DVec3, UVec3, Vec3};

use super::frame::Frame;
use super::numbers::{Number, volume};
use super::unpack::{cut, exactly, malformed};
use super::{Reading, Scan};
use crate::format::FormatError;
use crate::format::spec::{FormatSpec, Import, Packing, Sign};

pub static SPEC: FormatSpec = FormatSpec {
    parts: &["img", "img.gz"],
    signs: &[Sign::Likely(is_nifti)],
    packing: Some(Packing::Gzip),
    lacks_header: Some(|path| header_of(path).is_err()),
    ..FormatSpec::new(
        "a NIfTI scan",
        &["nii", "nii.gz", "hdr", "hdr.gz"],
        Import::Scan(|reading| {
            let header = header_of(reading.path)?;
            let path = header.as_deref().unwrap_or(reading.path);
            reading.read_whole(path, |file| read(path, file, reading))
        }),
    )
};

/// Where version 1 says what it is, after a length of its header that tells the byte order; and version 2.
const MAGIC_AT: [usize; 2] = [344, 4];
/// Bytes of the headers of both versions.
const HEADER_BYTES: [usize; 2] = [348, 540];
/// The farthest that voxels may begin: there are a header and extensions before them.
const FARTHEST_OFFSET: f64 = 1e9;
/// The meaning "each voxel is a label" of a volume.
const INTENT_LABEL: i64 = 1002;

/// The data from the header.
struct Header {
    version: u8,
    is_big: bool,
    is_pair: bool,
    dims: UVec3,
    volumes: u64,
    number: Number,
    offset: u64,
    scale: [f64; 2],
    voxel_size: Vec3,
    frame: Frame,
    is_label: bool,
    description: Vec<u8>,
    notes: Vec<String>,
}

/// Reads a file whose bytes are `file`, and the `.img` beside `path` if that has the voxels.
fn read(path: &Path, file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let is_packed = file.starts_with(&[0x1F, 0x8B]);
    let mut start = Vec::new();
    let most = HEADER_BYTES[1] as u64;
    match is_packed {
        true => {
            let header = MultiGzDecoder::new(file.as_slice()).take(most).read_to_end(&mut start);
            header.map_err(|error| malformed("the compressed header", error.to_string()))?;
        }
        false => start.extend_from_slice(&file[..file.len().min(most as usize)]),
    }
    let header = Header::parse(&start)?;
    let volumes = reading.volumes(header.volumes)?;
    reading.admit(header.dims, header.voxel_size)?;
    let bytes = header.number.check(header.dims, reading.rest_bytes(file.len() as u64))?;
    let offset = header.offset.saturating_add(bytes.saturating_mul(volumes.time.index()));
    let data = if header.is_pair {
        let image = partner(path, "hdr", "img").unwrap_or_else(|| path.with_extension("img"));
        voxels(reading.read_beside(&image)?, offset, bytes, reading)?
    } else {
        voxels(file, offset, bytes, reading)?
    };
    let samples = header.number.into_samples(data, header.is_big, header.scale);
    let mut notes = header.notes;
    notes.extend(reading.first_of(header.volumes));
    Ok(Scan {
        volume: volume(header.dims, header.voxel_size, samples, header.description),
        frame: header.frame,
        kind: format!(
            "NIfTI-{}{}{}",
            header.version,
            if header.is_pair { ", voxels in a second file" } else { "" },
            if is_packed { ", packed with gzip" } else { "" }
        ),
        is_label: header.is_label,
        volumes,
        notes,
    })
}

/// Whether that is the header of a file of either version and byte order. Older headers say nothing of themselves, and are
/// known by name.
fn is_nifti(start: &[u8]) -> bool {
    let holds = |version: usize, magic: &[u8]| {
        start.get(MAGIC_AT[version]..).is_some_and(|rest| rest.starts_with(magic))
    };
    holds(0, b"n+1\0") || holds(0, b"ni1\0") || holds(1, b"n+2\0") || holds(1, b"ni2\0")
}

/// The header of a pair whose voxels lie in `path`; none for a file that has both.
fn header_of(path: &Path) -> Result<Option<PathBuf>, FormatError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    if !name.ends_with(".img") && !name.ends_with(".img.gz") {
        return Ok(None);
    }
    partner(path, "img", "hdr").map(Some).ok_or(FormatError::NoScanHeader)
}

/// The other file of a pair that is there, packed or not: with `to` instead of `from` in its ending, in capitals or not.
fn partner(path: &Path, from: &str, to: &str) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let lower = name.to_ascii_lowercase();
    let stem = [format!(".{from}.gz"), format!(".{from}")]
        .into_iter()
        .find_map(|ending| lower.strip_suffix(&ending).map(|stem| &name[..stem.len()]))?;
    let is_packed = lower.ends_with(".gz");
    let packings = if is_packed { [".gz", ""] } else { ["", ".gz"] };
    let endings = packings.map(|gz| format!(".{to}{gz}"));
    let endings = endings.into_iter().flat_map(|own| [own.clone(), own.to_ascii_uppercase()]);
    endings.map(|ending| path.with_file_name(format!("{stem}{ending}"))).find(|path| path.is_file())
}

fn voxels(
    mut file: Vec<u8>,
    offset: u64,
    bytes: u64,
    reading: &Reading,
) -> Result<Vec<u8>, FormatError> {
    if file.starts_with(&[0x1F, 0x8B]) {
        return exactly(&mut MultiGzDecoder::new(file.as_slice()), offset, bytes, reading.progress);
    }
    let found = (file.len() as u64).saturating_sub(offset);
    if found < bytes {
        return Err(cut(bytes, found));
    }
    file.truncate((offset + bytes) as usize);
    file.drain(..offset as usize);
    Ok(file)
}

/// Numbers of a header at their places.
struct Fields<'a> {
    bytes: &'a [u8],
    is_big: bool,
}

impl Fields<'_> {
    fn at<const N: usize>(&self, place: usize) -> [u8; N] {
        let mut own = [0; N];
        own.copy_from_slice(&self.bytes[place..place + N]);
        if self.is_big {
            own.reverse();
        }
        own
    }

    fn i16(&self, place: usize) -> i64 {
        i16::from_le_bytes(self.at(place)).into()
    }

    fn i32(&self, place: usize) -> i64 {
        i32::from_le_bytes(self.at(place)).into()
    }

    fn i64(&self, place: usize) -> i64 {
        i64::from_le_bytes(self.at(place))
    }

    fn f32(&self, place: usize) -> f64 {
        f32::from_le_bytes(self.at(place)).into()
    }

    fn f64(&self, place: usize) -> f64 {
        f64::from_le_bytes(self.at(place))
    }
}

impl Header {
    fn parse(start: &[u8]) -> Result<Header, FormatError> {
        let size: [u8; 4] = start
            .first_chunk()
            .copied()
            .ok_or_else(|| malformed("the header", "the file ends in it"))?;
        let sizes = [i32::from_le_bytes(size), i32::from_be_bytes(size)];
        let known = sizes.map(|size| HEADER_BYTES.iter().position(|n| *n as i32 == size));
        let (version, is_big) = match known {
            [Some(version), _] => (version, false),
            [None, Some(version)] => (version, true),
            [None, None] => {
                return Err(FormatError::Scan(
                    "this is not a NIfTI file: its header has neither 348 nor 540 bytes; export it as NIfTI again"
                        .to_string(),
                ));
            }
        };
        if start.len() < HEADER_BYTES[version] {
            return Err(malformed("the header", "the file ends in it"));
        }
        let f = Fields { bytes: start, is_big };
        let is_pair = match version {
            0 => start[344..].starts_with(b"ni1\0") || start[344..].starts_with(&[0; 4]),
            _ => start[4..].starts_with(b"ni2\0"),
        };
        // Places of the fields in both versions.
        let dim = |i| if version == 0 { f.i16(40 + 2 * i) } else { f.i64(16 + 8 * i) };
        let pixdim = |i| if version == 0 { f.f32(76 + 4 * i) } else { f.f64(104 + 8 * i) };
        let real = |one, two| if version == 0 { f.f32(one) } else { f.f64(two) };
        let code = |one, two| if version == 0 { f.i16(one) } else { f.i32(two) };

        let axes = dim(0);
        if !(1..=7).contains(&axes) {
            return Err(malformed(
                "the header",
                format!("{axes} dimensions, where 1 to 7 are possible"),
            ));
        }
        let sizes: Vec<i64> = (1..=axes as usize).map(dim).collect();
        if let Some(size) = sizes.iter().find(|size| !(1..=i64::from(u32::MAX)).contains(*size)) {
            return Err(malformed("the header", format!("an axis of {size} voxels")));
        }
        let size = |axis: usize| sizes.get(axis).map_or(1, |size| *size as u32);
        let volumes = sizes.iter().skip(3).fold(1u64, |n, size| n.saturating_mul(*size as u64));
        let offset = if version == 0 { f.f32(108) } else { f.i64(168) as f64 };
        if !(0.0..=FARTHEST_OFFSET).contains(&offset) {
            return Err(malformed("the header", format!("voxels that begin at byte {offset}")));
        }
        let least = if is_pair { 0 } else { HEADER_BYTES[version] as u64 + 4 };
        let units = if version == 0 { i64::from(start[123]) } else { f.i32(500) };
        let unit = match units & 7 {
            1 => 1000.0,
            3 => 0.001,
            _ => 1.0,
        };
        let mut notes = Vec::new();
        let (frame, columns) = match (code(254, 348), code(252, 344)) {
            (sform, _) if sform > 0 => {
                let row = |i: usize| {
                    DVec3::from([0, 1, 2].map(|j| real(280 + 16 * i + 4 * j, 400 + 32 * i + 8 * j)))
                };
                let rows = [0, 1, 2].map(row);
                let columns = [0, 1, 2].map(|j| DVec3::new(rows[0][j], rows[1][j], rows[2][j]));
                (Frame::Patient(columns), Some(columns))
            }
            (_, qform) if qform > 0 => {
                let [b, c, d] = [0, 1, 2].map(|i| real(256 + 4 * i, 352 + 8 * i));
                let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
                let turn = DMat3::from_quat(DQuat::from_xyzw(b, c, d, a).normalize());
                // The sign of the first pixdim says whether the third axis is reversed.
                let hand = if pixdim(0) < 0.0 { -1.0 } else { 1.0 };
                (Frame::Patient([turn.x_axis, turn.y_axis, turn.z_axis * hand]), None)
            }
            _ => (Frame::Unknown, None),
        };
        let length = |axis: usize| {
            let stored = pixdim(axis + 1).abs();
            let of_column = columns.map_or(f64::NAN, |columns| columns[axis].length());
            [stored, of_column].into_iter().find(|length| length.is_finite() && *length > 0.0)
        };
        let lengths = [0, 1, 2].map(length);
        if lengths.iter().take(axes as usize).any(Option::is_none) {
            notes.push("the file does not say how large a voxel is; 1 mm was taken".to_string());
        }
        let voxel_size = lengths.map(|length| length.map_or(1.0, |length| (length * unit) as f32));
        let (slope, intercept) = (real(112, 176), real(116, 184));
        let is_scaled = slope.is_finite() && slope != 0.0;
        let text = &start[if version == 0 { 148 } else { 240 }..][..80];
        Ok(Header {
            version: version as u8 + 1,
            is_big,
            is_pair,
            dims: UVec3::new(size(0), size(1), size(2)),
            volumes,
            number: number(f.i16(if version == 0 { 70 } else { 12 }))?,
            offset: (offset as u64).max(least),
            scale: if is_scaled {
                [slope, if intercept.is_finite() { intercept } else { 0.0 }]
            } else {
                [1.0, 0.0]
            },
            voxel_size: voxel_size.into(),
            frame,
            is_label: code(68, 504) == INTENT_LABEL,
            description: text.split(|b| *b == 0).next().unwrap_or_default().to_vec(),
            notes,
        })
    }
}

/// The type of voxels of a data type's code.
fn number(code: i64) -> Result<Number, FormatError> {
    Ok(match code {
        2 => Number::U8,
        4 => Number::I16,
        8 => Number::I32,
        16 => Number::F32,
        64 => Number::F64,
        128 => Number::Rgb,
        256 => Number::I8,
        512 => Number::U16,
        768 => Number::U32,
        1024 => Number::I64,
        1280 => Number::U64,
        2304 => Number::Rgba,
        _ => {
            return Err(FormatError::Scan(format!(
                "voxels of the NIfTI data type {code} are not supported; convert them to whole or \
                 floating-point numbers of 8 to 64 bits"
            )));
        }
    })
}
