//! The PVM volume format, versions 1 to 3, plain or packed as a DDS stream: bytes <-> [`Volume`].
//!
//! A header of text lines, the voxels, and in version 3 four NUL-terminated texts; the file must end there. The claims
//! of a header are compared with the actual contents of the file or stream, and passed to the caller, before memory is
//! allocated for them.

use glam::{UVec3, Vec3};

use super::budget::check_budget;
use super::dds::{self, Stream};
use super::error::excerpt;
use super::limits::{HEADER_LIMIT, TEXTS_LIMIT};
use super::scan::reading::{Reading, Scan};
use super::spec::{Export, FormatSpec, Import, Sign};
use super::volume::{Samples, Texts, Volume};
use super::{FormatError, go_on};
use crate::progress::Progress;
use crate::refusal::InvalidValue;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[
        Sign::At(0, b"PVM\n"),
        Sign::At(0, b"PVM2\n"),
        Sign::At(0, b"PVM3\n"),
        Sign::At(0, b"DDS v3"),
    ],
    write: Some(Export::Volume(write)),
    exported_as: Some("Volume"),
    ..FormatSpec::new("a PVM volume", &["pvm"], Import::Volume(open))
};

/// Decoded size up to which a stream of several planes is decoded before its header is examined. The header is
/// scattered over the planes, so reading it first costs nearly as much as decoding.
const EAGER_BYTES: u64 = 64 << 20;
/// Exclusive limit of the volume size: sizes in the original programs have 32 bits.
const VOLUME_END: u64 = 1 << 32;

/// The header of a PVM volume.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PvmHeader {
    /// Version, 1 to 3.
    pub version: u8,
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge lengths of a voxel; 1 in version 1.
    pub voxel_size: Vec3,
    /// Bytes per voxel.
    pub components: u32,
    /// Length of the header.
    pub bytes: usize,
}

impl PvmHeader {
    /// Parses the header at the start of `prefix`: the whole file, or at least its first [`HEADER_LIMIT`] bytes.
    pub fn parse(prefix: &[u8]) -> Result<PvmHeader, FormatError> {
        let prefix = &prefix[..prefix.len().min(HEADER_LIMIT)];
        let mut lines = HeaderLines { prefix, at: 0 };
        let version = match prefix {
            [b'P', b'V', b'M', b'\n', ..] => 1,
            [b'P', b'V', b'M', b'2', b'\n', ..] => 2,
            [b'P', b'V', b'M', b'3', b'\n', ..] => 3,
            [b'P', b'V', b'M', b'\r', ..] | [b'P', b'V', b'M', b'2' | b'3', b'\r', ..] => {
                return Err(FormatError::TextCopy);
            }
            _ => return Err(FormatError::NotPvm(excerpt(prefix))),
        };
        lines.next("version")?;
        if version == 1 {
            while prefix.get(lines.at) == Some(&b'#') {
                lines.next("comment")?;
            }
        }
        let dims: [u32; 3] = lines.numbers(
            "size",
            "must be three whole numbers from 1 to 4294967295",
            |text| text.bytes().all(|b| b.is_ascii_digit()),
            |n| *n > 0,
        )?;
        let voxel_size: [f32; 3] = if version == 1 {
            [1.0; 3]
        } else {
            lines.numbers(
                "voxel size",
                "must be three finite numbers above 0, with a point for the fraction",
                |text| text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b)),
                |n: &f32| n.is_finite() && *n > 0.0,
            )?
        };
        let [components] = lines.numbers(
            "components",
            "must be one whole number from 1 to 4294967295",
            |text| text.bytes().all(|b| b.is_ascii_digit()),
            |n| *n > 0,
        )?;
        let header = PvmHeader {
            version,
            dims: dims.into(),
            voxel_size: voxel_size.into(),
            components,
            bytes: lines.at,
        };
        if header.checked_voxel_bytes().is_none_or(|n| n >= VOLUME_END) {
            return Err(FormatError::HeaderTooLarge);
        }
        Ok(header)
    }

    /// Returns the size of all voxels in bytes, below 2^32.
    pub(crate) fn voxel_bytes(&self) -> u64 {
        self.checked_voxel_bytes().unwrap_or(u64::MAX)
    }

    fn checked_voxel_bytes(&self) -> Option<u64> {
        let [x, y, z] = self.dims.to_array().map(u64::from);
        x.checked_mul(y)?.checked_mul(z)?.checked_mul(u64::from(self.components))
    }

    /// Checks that a volume of `total` bytes matches the header.
    fn check_total(&self, total: u64) -> Result<(), FormatError> {
        let behind_header = total.saturating_sub(self.bytes as u64);
        let expected = self.voxel_bytes();
        let Some(behind_voxels) = behind_header.checked_sub(expected) else {
            return Err(FormatError::VoxelsCut { expected, found: behind_header });
        };
        match self.version {
            3 if behind_voxels < 4 => Err(FormatError::TextsCut),
            3 if behind_voxels > TEXTS_LIMIT => Err(FormatError::TextsTooLong),
            1 | 2 if behind_voxels > 0 => Err(FormatError::Trailing(behind_voxels)),
            _ => Ok(()),
        }
    }
}

/// Iterates over the lines of a header.
struct HeaderLines<'a> {
    prefix: &'a [u8],
    at: usize,
}

impl<'a> HeaderLines<'a> {
    fn next(&mut self, what: &'static str) -> Result<&'a [u8], FormatError> {
        let rest = &self.prefix[self.at..];
        let Some(len) = rest.iter().position(|&b| b == b'\n') else {
            return Err(if self.prefix.len() == HEADER_LIMIT {
                FormatError::HeaderTooLong
            } else {
                FormatError::HeaderCut(what)
            });
        };
        self.at += len + 1;
        Ok(&rest[..len])
    }

    /// Returns the next line as `N` numbers whose text and value are valid.
    fn numbers<T: std::str::FromStr, const N: usize>(
        &mut self,
        what: &'static str,
        rule: &'static str,
        text_ok: impl Fn(&str) -> bool,
        value_ok: impl Fn(&T) -> bool,
    ) -> Result<[T; N], FormatError> {
        let line = self.next(what)?;
        if line.ends_with(b"\r") {
            return Err(FormatError::TextCopy);
        }
        let numbers = std::str::from_utf8(line).ok().and_then(|line| {
            let words = line.split([' ', '\t']).filter(|word| !word.is_empty());
            let number = |word: &str| {
                text_ok(word).then(|| word.parse().ok()).flatten().filter(|n| value_ok(n))
            };
            words.map(number).collect::<Option<Vec<T>>>()?.try_into().ok()
        });
        numbers.ok_or_else(|| FormatError::Header(InvalidValue::new(what, rule, excerpt(line))))
    }
}

/// The packing of a file and its header.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Origin {
    pub header: PvmHeader,
    /// The kind of DDS stream, if packed.
    pub packing: Option<&'static str>,
}

/// Reads the file at a path.
fn open(reading: &Reading) -> Result<(Scan, u64), FormatError> {
    let volumes = reading.volumes(1)?;
    let file = reading.read(reading.path)?;
    let file_bytes = file.len() as u64;
    let admit = |header: &PvmHeader| reading.admit(header.dims, header.voxel_size);
    let (volume, origin) = read(file, &admit, reading.rest_bytes(file_bytes), reading.progress)?;
    let version = match origin.header.version {
        1 => String::new(),
        n => n.to_string(),
    };
    let kind = match origin.packing {
        Some(packing) => format!("PVM{version}, packed as {packing}"),
        None => format!("PVM{version}, not packed"),
    };
    Ok((Scan::bare(volume.into(), kind, volumes), file_bytes))
}

/// Reads a .pvm file. `admit` gets the header before memory is allocated for the voxels, and may refuse it; unpacking
/// takes at most `budget_bytes`.
fn read(
    file: Vec<u8>,
    admit: &dyn Fn(&PvmHeader) -> Result<(), FormatError>,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<(Volume, Origin), FormatError> {
    let check = |prefix: &[u8], total: u64| {
        let header = PvmHeader::parse(prefix)?;
        header.check_total(total)?;
        admit(&header)?;
        Ok(header)
    };
    let Some(stream) = Stream::open(&file)? else {
        let header = check(&file, file.len() as u64)?;
        return Ok((split_plain(file, &header)?, Origin { header, packing: None }));
    };
    let packing = Some(stream.version());
    let total = stream.decoded_bytes();
    if total == 0 {
        return Err(FormatError::DdsEmpty);
    }
    let inside = |error| match error {
        FormatError::NotPvm(found) => FormatError::NotPvmInside(found),
        other => other,
    };
    let planes = if stream.header_is_scattered() { 2 } else { 1 };
    let fits = check_budget(planes * total, budget_bytes);
    if planes == 1 || total > EAGER_BYTES {
        // The header's own faults are the better message for a false size.
        check(&stream.prefix(HEADER_LIMIT), total).map_err(inside)?;
    }
    fits?;
    let plain = stream.decode(progress);
    go_on(progress)?;
    drop(file);
    let header = check(&plain, total).map_err(inside)?;
    Ok((split_plain(plain, &header)?, Origin { header, packing }))
}

/// Splits a plain volume whose length has been checked.
fn split_plain(mut plain: Vec<u8>, header: &PvmHeader) -> Result<Volume, FormatError> {
    let voxels_end = header.bytes + header.voxel_bytes() as usize;
    let texts =
        if header.version == 3 { split_texts(&plain[voxels_end..])? } else { Texts::default() };
    plain.truncate(voxels_end);
    plain.drain(..header.bytes);
    Ok(Volume {
        dims: header.dims,
        voxel_size: header.voxel_size,
        samples: Samples::of_components(header.components),
        data: plain,
        texts,
    })
}

fn split_texts(bytes: &[u8]) -> Result<Texts, FormatError> {
    let mut pieces = bytes.split(|&b| b == 0);
    let mut next = || pieces.next().map(<[u8]>::to_vec).ok_or(FormatError::TextsCut);
    let texts =
        Texts { description: next()?, courtesy: next()?, parameter: next()?, comment: next()? };
    // After the fourth NUL there is one more piece, the empty one.
    let behind = next()?.len() + pieces.map(|p| p.len() + 1).sum::<usize>();
    if behind > 0 { Err(FormatError::Trailing(behind as u64)) } else { Ok(texts) }
}

/// Writes a volume as a .pvm file, packed as a DDS stream as the original programs do: version 3 if it has texts, else
/// 2 if its voxels are not unit cubes, else 1.
fn write(volume: Volume, progress: &dyn Progress) -> Result<Vec<u8>, FormatError> {
    let components = volume.samples.bytes() as usize;
    let strip = volume.dims.x as usize;
    let plain = to_plain(volume)?;
    let skip = if components <= dds::MAX_SKIP { components } else { 1 };
    let strip = if strip <= dds::MAX_STRIP { strip } else { 1 };
    let packed = dds::encode(&plain, skip, strip, progress);
    go_on(progress)?;
    Ok(packed)
}

/// Returns the unpacked bytes of a volume.
pub(crate) fn to_plain(volume: Volume) -> Result<Vec<u8>, FormatError> {
    let Volume { dims, voxel_size, samples, data, texts } = volume;
    if Samples::of_components(samples.bytes()) != samples {
        return Err(FormatError::NotInPvm(samples));
    }
    if let Some((name, _)) = texts.named().into_iter().find(|(_, text)| text.contains(&0)) {
        return Err(FormatError::NulInText(name));
    }
    let size = format!("{} {} {}\n", dims.x, dims.y, dims.z);
    let components = format!("{}\n", samples.bytes());
    let spacing = voxel_size.to_array().map(shortest).join(" ") + "\n";
    let header = match (texts.is_empty(), voxel_size == Vec3::ONE) {
        (true, true) => format!("PVM\n{size}{components}"),
        (true, false) => format!("PVM2\n{size}{spacing}{components}"),
        (false, _) => format!("PVM3\n{size}{spacing}{components}"),
    };
    let texts_len: usize = texts.named().iter().map(|(_, text)| text.len() + 1).sum();
    let total = header.len() + data.len() + texts_len;
    if total as u64 >= VOLUME_END {
        return Err(FormatError::TooLargeForPvm(total as u64));
    }
    let mut plain = data;
    plain.reserve_exact(header.len() + texts_len);
    plain.splice(0..0, header.bytes());
    if !texts.is_empty() {
        for (_, text) in texts.named() {
            plain.extend_from_slice(text);
            plain.push(0);
        }
    }
    Ok(plain)
}

/// Returns an error if a volume is too large for PVM.
pub fn check_size(dims: UVec3, samples: Samples) -> Result<(), FormatError> {
    let [x, y, z] = dims.to_array().map(u64::from);
    let bytes = x.saturating_mul(y).saturating_mul(z).saturating_mul(u64::from(samples.bytes()));
    if bytes >= VOLUME_END { Err(FormatError::TooLargeForPvm(bytes)) } else { Ok(()) }
}

/// Returns the shortest text that reads back to the same number. (The original writes 6 significant digits, which would
/// lose some; it reads any number of them.)
fn shortest(value: f32) -> String {
    if (1e-4..1e9).contains(&value) { format!("{value}") } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read_any(file: &[u8]) -> Result<Volume, FormatError> {
        read(file.to_vec(), &|_| Ok(()), 1 << 30, &()).map(|(volume, _)| volume)
    }

    prop_compose! {
        fn volumes()(
            dims in prop::array::uniform3(1u32..12),
            components in 1u32..7,
            size in prop::option::of(prop::array::uniform3(
                any::<f32>().prop_filter("a length", |v| v.is_finite() && *v > 0.0))),
            texts in prop::option::of(prop::array::uniform4(prop::collection::vec(1u8.., 0..40))),
        )(
            data in prop::collection::vec(any::<u8>(),
                (dims[0] * dims[1] * dims[2] * components) as usize),
            dims in Just(dims), components in Just(components),
            size in Just(size), texts in Just(texts),
        ) -> Volume {
            let [description, courtesy, parameter, comment] = texts.unwrap_or_default();
            Volume {
                dims: dims.into(),
                voxel_size: size.map_or(Vec3::ONE, Vec3::from),
                samples: Samples::of_components(components),
                data,
                texts: Texts { description, courtesy, parameter, comment },
            }
        }
    }

    proptest! {
        #[test]
        fn a_written_volume_reads_back(volume in volumes()) {
            let packed = write(volume.clone(), &()).unwrap();
            prop_assert!(packed.starts_with(b"DDS v3d\n"));
            prop_assert_eq!(&read_any(&packed).unwrap(), &volume);
            let plain = to_plain(volume.clone()).unwrap();
            let magic: &[u8] = match (volume.texts.is_empty(), volume.voxel_size == Vec3::ONE) {
                (true, true) => b"PVM\n",
                (true, false) => b"PVM2\n",
                _ => b"PVM3\n",
            };
            prop_assert!(plain.starts_with(magic));
            prop_assert_eq!(&read_any(&plain).unwrap(), &volume);
        }

        #[test]
        fn cutting_or_lengthening_a_plain_file_is_noticed(volume in volumes(), by in 1usize..40) {
            let plain = to_plain(volume).unwrap();
            prop_assert!(read_any(&plain[..plain.len().saturating_sub(by)]).is_err());
            let longer = [&plain[..], &vec![b'x'; by]].concat();
            prop_assert!(read_any(&longer).is_err());
        }
    }

    #[test]
    fn the_header_is_shown_before_memory_is_taken() {
        // 2^30 voxels in 10 MiB: runs of 127 zeros after a header.
        let header = b"PVM\n1024 1024 1023\n1\n";
        let mut plain = vec![0u8; 3 << 20];
        plain[..header.len()].copy_from_slice(header);
        let file = dds::encode(&plain, 1, 1024, &());
        let seen = std::cell::Cell::new(None);
        let admit = |header: &PvmHeader| {
            seen.set(Some(header.dims));
            Ok(())
        };
        let error = read(file.clone(), &admit, 1 << 30, &()).unwrap_err();
        assert!(matches!(error, FormatError::VoxelsCut { .. }), "{error}");
        assert_eq!(seen.get(), None, "the claim is compared with the stream first");
        let error = read(file, &|_| Ok(()), 1 << 20, &()).unwrap_err();
        assert!(matches!(error, FormatError::VoxelsCut { .. }), "{error}");

        let volume = Volume {
            dims: UVec3::splat(128),
            voxel_size: Vec3::ONE,
            samples: Samples::U8,
            data: vec![0; 1 << 21],
            texts: Texts::default(),
        };
        let file = write(volume, &()).unwrap();
        let error = read(file, &|_| Ok(()), 1 << 20, &()).unwrap_err();
        let FormatError::OverBudget(over) = error else { panic!("{error}") };
        assert_eq!((over.needed_mib, over.budget_mib), (3, 1));
    }

    #[test]
    fn messages_name_the_line() {
        for (file, parts) in [
            (&b"PVM\n5 4\n1\n"[..], ["size", "5 4"]),
            (b"PVM2\n1 1 1\n1 1 0,5\n1\n_", ["voxel size", "0,5"]),
            (b"PVM\n1 1 1\n0\n_", ["components", "`0`"]),
            (b"PVM\r\n1 1 1\r\n1\r\n_", ["CR LF", "binary"]),
            (b"PNG\n", ["not a PVM volume", "PNG\\n"]),
        ] {
            let message = read_any(file).unwrap_err().to_string();
            assert!(parts.iter().all(|p| message.contains(p)), "{message}");
        }
    }
}
