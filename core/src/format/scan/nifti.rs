//! Reads NIfTI-1 and NIfTI-2 scans (nifti.nimh.nih.gov): `.nii`, packed with gzip or not, and pairs of `.hdr` and
//! `.img`.
//!
//! Takes the bytes of a file; gives one of its volumes with spacing and orientation. Both byte orders are read.

use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use glam::{DMat3, DQuat, DVec3, UVec3, Vec3};

use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan, ScanVolume};
use super::unpack::{cut, exactly, malformed};
use crate::format::layered::{LayeredVolume, PartPacking, StoredNumbers, StoredVoxels, VoxelPart};
use crate::format::spec::{FormatSpec, Import, Packing, Sign};
use crate::format::{FormatError, Volumes};

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
            if reading.in_layers
                && let Some(scan) = layered(path, reading)?
            {
                return Ok((scan, std::fs::metadata(path)?.len()));
            }
            reading.read_whole(path, |file| read(path, file, reading))
        }),
    )
};

/// Position of the magic bytes in version 1, after a header length that shows the byte order; and in version 2.
const MAGIC_AT: [usize; 2] = [344, 4];
/// Header sizes of both versions, in bytes.
const HEADER_BYTES: [usize; 2] = [348, 540];
/// Greatest offset of the voxels: a header and extensions precede them.
const FARTHEST_OFFSET: f64 = 1e9;
/// The intent "each voxel is a label" of a volume.
const INTENT_LABEL: i64 = 1002;

/// The data from the header.
struct NiftiHeader {
    version: u8,
    is_big: bool,
    is_pair: bool,
    dims: UVec3,
    volumes: u64,
    number: Number,
    offset: u64,
    scale: [f64; 2],
    voxel_size: Vec3,
    frame: AxisFrame,
    is_label: bool,
    description: Vec<u8>,
    notes: Vec<String>,
}

/// Returns whether a file that begins with `start` is packed.
fn is_packed(start: &[u8]) -> bool {
    start.starts_with(&[0x1F, 0x8B])
}

/// Returns the header of a file that begins with `start`.
fn header_in(start: &[u8]) -> Result<NiftiHeader, FormatError> {
    let most = HEADER_BYTES[1] as u64;
    if !is_packed(start) {
        return NiftiHeader::parse(&start[..start.len().min(most as usize)]);
    }
    let mut header = Vec::new();
    let read = MultiGzDecoder::new(start).take(most).read_to_end(&mut header);
    read.map_err(|error| malformed("the compressed header", error.to_string()))?;
    NiftiHeader::parse(&header)
}

/// Returns the path of the file with the voxels of a pair.
fn image_of(path: &Path) -> PathBuf {
    partner(path, "hdr", "img").unwrap_or_else(|| path.with_extension("img"))
}

/// Returns the scan of a large volume that stays in its files; `None` for one that is read whole.
fn layered(path: &Path, reading: &Reading) -> Result<Option<Scan>, FormatError> {
    let start = reading.start(path)?;
    let header = header_in(&start)?;
    let bytes = header.number.volume_bytes(header.dims);
    if !reading.is_large(bytes) {
        return Ok(None);
    }
    let volumes = reading.volumes(header.volumes)?;
    reading.admit(header.dims, header.voxel_size)?;
    let image = if header.is_pair { image_of(path) } else { path.to_path_buf() };
    let is_image_packed = match header.is_pair {
        true => is_packed(&reading.start(&image)?),
        false => is_packed(&start),
    };
    let packing = if is_image_packed { PartPacking::Gzip } else { PartPacking::Plain };
    let begin = header.offset.saturating_add(bytes.saturating_mul(volumes.time.index()));
    let part = VoxelPart { path: image, packing, packed_at: 0, begin, bytes };
    let NiftiHeader { number, is_big, scale, .. } = header;
    let stored = StoredVoxels {
        parts: vec![part],
        skip: 0,
        numbers: StoredNumbers { number, is_big, scale },
    };
    let (dims, voxel_size) = (header.dims, header.voxel_size);
    let description = header.description.clone();
    let volume = LayeredVolume::new(stored, dims, voxel_size, description, reading.progress)?;
    Ok(Some(header.scan(volume.into(), volumes, is_packed(&start), reading)))
}

/// Reads a file whose bytes are `file`, and the `.img` beside `path` if that has the voxels.
fn read(path: &Path, file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let is_packed = is_packed(&file);
    let header = header_in(&file)?;
    let volumes = reading.volumes(header.volumes)?;
    reading.admit(header.dims, header.voxel_size)?;
    let bytes = header.number.check(header.dims, reading.rest_bytes(file.len() as u64))?;
    let offset = header.offset.saturating_add(bytes.saturating_mul(volumes.time.index()));
    let data = if header.is_pair {
        voxels(reading.read_beside(&image_of(path))?, offset, bytes, reading)?
    } else {
        voxels(file, offset, bytes, reading)?
    };
    let samples = header.number.into_samples(data, header.is_big, header.scale);
    let description = header.description.clone();
    let volume = volume(header.dims, header.voxel_size, samples, description);
    Ok(header.scan(volume.into(), volumes, is_packed, reading))
}

/// Returns whether `start` is the header of a file of either version and byte order. Older headers carry no signature,
/// and are recognised by name.
fn is_nifti(start: &[u8]) -> bool {
    let holds = |version: usize, magic: &[u8]| {
        start.get(MAGIC_AT[version]..).is_some_and(|rest| rest.starts_with(magic))
    };
    holds(0, b"n+1\0") || holds(0, b"ni1\0") || holds(1, b"n+2\0") || holds(1, b"ni2\0")
}

/// Returns the header of a pair whose voxels are in `path`; `None` for a file that has both.
fn header_of(path: &Path) -> Result<Option<PathBuf>, FormatError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    if !name.ends_with(".img") && !name.ends_with(".img.gz") {
        return Ok(None);
    }
    partner(path, "img", "hdr").map(Some).ok_or(FormatError::NoScanHeader)
}

/// Returns the other existing file of a pair, packed or not: with `to` instead of `from` in its ending,
/// case-insensitive.
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
    if is_packed(&file) {
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

/// Access to the numbers of a header by position.
struct NiftiFields<'a> {
    bytes: &'a [u8],
    is_big: bool,
    /// Whether it is version 2, which has other positions.
    is_second: bool,
}

impl NiftiFields<'_> {
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

impl<'a> NiftiFields<'a> {
    /// Reads a header, whose length shows version and byte order.
    fn of(start: &'a [u8]) -> Result<NiftiFields<'a>, FormatError> {
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
        Ok(NiftiFields { bytes: start, is_big, is_second: version == 1 })
    }

    /// Returns whether the voxels lie in a second file.
    fn is_pair(&self) -> bool {
        let begins = |place: usize, magic: &[u8]| self.bytes[place..].starts_with(magic);
        let [first, second] = MAGIC_AT;
        match self.is_second {
            false => begins(first, b"ni1\0") || begins(first, &[0; 4]),
            true => begins(second, b"ni2\0"),
        }
    }

    /// Returns the number of axes, or the size of one counted from 1.
    fn dim(&self, i: usize) -> i64 {
        if self.is_second { self.i64(16 + 8 * i) } else { self.i16(40 + 2 * i) }
    }

    /// Returns the length of a voxel along an axis counted from 1, or the sense of the third axis.
    fn pixdim(&self, i: usize) -> f64 {
        if self.is_second { self.f64(104 + 8 * i) } else { self.f32(76 + 4 * i) }
    }

    /// Returns a number, given its positions in the first and in the second version.
    fn real(&self, first: usize, second: usize) -> f64 {
        if self.is_second { self.f64(second) } else { self.f32(first) }
    }

    /// Returns a code, given its positions in the first and in the second version.
    fn code(&self, first: usize, second: usize) -> i64 {
        if self.is_second { self.i32(second) } else { self.i16(first) }
    }

    /// Returns the sizes of all axes.
    fn sizes(&self) -> Result<Vec<i64>, FormatError> {
        let axes = self.dim(0);
        if !(1..=7).contains(&axes) {
            return Err(malformed(
                "the header",
                format!("{axes} dimensions, where 1 to 7 are possible"),
            ));
        }
        let sizes: Vec<i64> = (1..=axes as usize).map(|axis| self.dim(axis)).collect();
        match sizes.iter().find(|size| !(1..=i64::from(u32::MAX)).contains(*size)) {
            Some(size) => Err(malformed("the header", format!("an axis of {size} voxels"))),
            None => Ok(sizes),
        }
    }

    /// Returns the offset of the voxels.
    fn offset(&self) -> Result<u64, FormatError> {
        let offset = if self.is_second { self.i64(168) as f64 } else { self.f32(108) };
        if !(0.0..=FARTHEST_OFFSET).contains(&offset) {
            return Err(malformed("the header", format!("voxels that begin at byte {offset}")));
        }
        let version = usize::from(self.is_second);
        let least = if self.is_pair() { 0 } else { HEADER_BYTES[version] as u64 + 4 };
        Ok((offset as u64).max(least))
    }

    /// Returns the millimetres of the unit of length.
    fn mm_per_unit(&self) -> f64 {
        let units = if self.is_second { self.i32(500) } else { i64::from(self.bytes[123]) };
        match units & 7 {
            1 => 1000.0,
            3 => 0.001,
            _ => 1.0,
        }
    }

    /// Returns the directions of the axes in the patient, and the columns of the matrix that defines them, if there is
    /// one.
    fn frame(&self) -> (AxisFrame, Option<[DVec3; 3]>) {
        match (self.code(254, 348), self.code(252, 344)) {
            (sform, _) if sform > 0 => {
                let real =
                    |i: usize, j: usize| self.real(280 + 16 * i + 4 * j, 400 + 32 * i + 8 * j);
                let columns = [0, 1, 2].map(|j| DVec3::from([0, 1, 2].map(|i| real(i, j))));
                (AxisFrame::Patient(columns), Some(columns))
            }
            (_, qform) if qform > 0 => {
                let [b, c, d] = [0, 1, 2].map(|i| self.real(256 + 4 * i, 352 + 8 * i));
                let a = (1.0 - b * b - c * c - d * d).max(0.0).sqrt();
                let turn = DMat3::from_quat(DQuat::from_xyzw(b, c, d, a).normalize());
                // The sign of the first pixdim states whether the third axis is reversed.
                let hand = if self.pixdim(0) < 0.0 { -1.0 } else { 1.0 };
                (AxisFrame::Patient([turn.x_axis, turn.y_axis, turn.z_axis * hand]), None)
            }
            _ => (AxisFrame::Unknown, None),
        }
    }

    /// Returns slope and intercept of the numbers.
    fn scale(&self) -> [f64; 2] {
        let (slope, intercept) = (self.real(112, 176), self.real(116, 184));
        match slope.is_finite() && slope != 0.0 {
            true => [slope, if intercept.is_finite() { intercept } else { 0.0 }],
            false => [1.0, 0.0],
        }
    }

    fn description(&self) -> Vec<u8> {
        let text = &self.bytes[if self.is_second { 240 } else { 148 }..][..80];
        text.split(|b| *b == 0).next().unwrap_or_default().to_vec()
    }
}

impl NiftiHeader {
    /// Returns the scan of one of its volumes.
    fn scan(
        self,
        volume: ScanVolume,
        volumes: Volumes,
        is_packed: bool,
        reading: &Reading,
    ) -> Scan {
        let mut notes = self.notes;
        notes.extend(reading.first_of(self.volumes));
        Scan {
            volume,
            frame: self.frame,
            kind: format!(
                "NIfTI-{}{}{}",
                self.version,
                if self.is_pair { ", voxels in a second file" } else { "" },
                if is_packed { ", packed with gzip" } else { "" }
            ),
            is_label: self.is_label,
            volumes,
            notes,
        }
    }

    fn parse(start: &[u8]) -> Result<NiftiHeader, FormatError> {
        let fields = NiftiFields::of(start)?;
        let sizes = fields.sizes()?;
        let size = |axis: usize| sizes.get(axis).map_or(1, |size| *size as u32);
        let volumes = sizes.iter().skip(3).fold(1u64, |n, size| n.saturating_mul(*size as u64));
        let offset = fields.offset()?;
        let (frame, columns) = fields.frame();
        let length = |axis: usize| {
            let stored = fields.pixdim(axis + 1).abs();
            let of_column = columns.map_or(f64::NAN, |columns| columns[axis].length());
            [stored, of_column].into_iter().find(|length| length.is_finite() && *length > 0.0)
        };
        let lengths = [0, 1, 2].map(length);
        let mut notes = Vec::new();
        if lengths.iter().take(sizes.len()).any(Option::is_none) {
            notes.push("the file does not say how large a voxel is; 1 mm was taken".to_string());
        }
        let unit = fields.mm_per_unit();
        let voxel_size = lengths.map(|length| length.map_or(1.0, |length| (length * unit) as f32));
        Ok(NiftiHeader {
            version: u8::from(fields.is_second) + 1,
            is_big: fields.is_big,
            is_pair: fields.is_pair(),
            dims: UVec3::new(size(0), size(1), size(2)),
            volumes,
            number: number(fields.i16(if fields.is_second { 12 } else { 70 }))?,
            offset,
            scale: fields.scale(),
            voxel_size: voxel_size.into(),
            frame,
            is_label: fields.code(68, 504) == INTENT_LABEL,
            description: fields.description(),
            notes,
        })
    }
}

/// Returns the number type of a data type code.
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
