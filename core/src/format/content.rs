//! Detects the format of a file by its first bytes, or, where they do not identify one, by its name.
//!
//! Takes a path; gives the format, with a note where the name indicates another. Content that cannot be read, under the
//! name of a readable format, is an error that names the content.

use std::io::Read;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::spec::{Format, Packing, Sign};
use super::{FormatError, list, store};

/// Number of bytes examined at the start of a file.
const START_BYTES: u64 = 1024;
const GZIP: &[u8] = &[0x1F, 0x8B];
const ZIP: &[u8] = b"PK\x03\x04";

/// Signatures of contents that are not read, and their display names.
const FOREIGN: [(Sign, &str); 17] = [
    (Sign::At(0, b"\x89PNG"), "a PNG image"),
    (Sign::At(0, b"\xFF\xD8\xFF"), "a JPEG image"),
    (Sign::At(0, b"GIF8"), "a GIF image"),
    (Sign::At(0, b"#?R"), "a Radiance image"),
    (Sign::At(0, b"DDS |"), "a texture of DirectDraw"),
    (Sign::At(0, b"%PDF"), "a PDF document"),
    (Sign::At(0, b"BZh"), "something packed with bzip2; unpack it first"),
    (Sign::At(0, b"\xFD7zXZ"), "something packed with xz; unpack it first"),
    (Sign::At(0, b"\x28\xB5\x2F\xFD"), "something packed with zstd; unpack it first"),
    (Sign::At(257, b"ustar"), "a tar archive; unpack it first"),
    (Sign::At(0, b"7z\xBC\xAF"), "a 7z archive; unpack it first"),
    (Sign::At(0, b"\x89HDF"), "an HDF5 file"),
    (Sign::At(0, b" BDV"), "an OpenVDB volume"),
    (Sign::At(0, b"Kaydara FBX"), "an FBX scene"),
    (Sign::At(0, b"BLENDER"), "a Blender scene"),
    (
        Sign::At(0, b"<!DOCTYPE"),
        "a page of the web, perhaps an error of the server that it was loaded from",
    ),
    (
        Sign::At(0, b"version https://git-lfs"),
        "only a pointer of Git LFS; get the file itself with `git lfs pull`",
    ),
];

/// The content of a file.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Content {
    Known(Format),
    Foreign(&'static str),
    /// Packed, without the signature of a format inside.
    Packed(Packing),
    Unknown,
}

/// Returns the format of a file to be read, or of a folder with the slices of a scan, and a note where name and content
/// disagree.
///
/// With a layout for raw voxels (`is_described`), a file of an unknown name holds raw voxels.
pub(crate) fn format_of(
    path: &Path,
    is_described: bool,
) -> Result<(Format, Option<String>), FormatError> {
    if path.is_dir() {
        let format = list::of_folder(path).ok_or(FormatError::NoScanInFolder)?;
        return Ok((format, None));
    }
    let by_name = list::named(path);
    // Raw voxels may begin with anything; their layout decides.
    let is_open = match &by_name {
        Ok(named) => named.lacks_header.is_some_and(|lacks| lacks(path)),
        Err(_) => true,
    };
    if list::is_raw(path) || is_described && is_open {
        return Ok((list::raw(), None));
    }
    let content = store::open(path).map_or(Content::Unknown, |file| {
        let length = file.metadata().map_or(0, |file| file.len());
        let mut start = Vec::new();
        match file.take(START_BYTES).read_to_end(&mut start) {
            Ok(_) => content_of(&start, length),
            Err(_) => Content::Unknown,
        }
    });
    match (by_name, content) {
        (Ok(named), Content::Known(held)) if named != held => {
            let (name, content) = (named.title(), held.title());
            let note = format!("the file is named as {name}, but holds {content}; that was read");
            Ok((held, Some(note)))
        }
        // Packed files may carry no signature of their own.
        (Ok(named), Content::Packed(packing)) if named.packing == Some(packing) => {
            Ok((named, None))
        }
        (_, Content::Packed(packing)) => Err(FormatError::Packed(packing.name())),
        (_, Content::Foreign(what)) => Err(FormatError::OtherContent(what)),
        (Ok(named), Content::Known(_) | Content::Unknown) => Ok((named, None)),
        (Err(_), Content::Known(held)) => Ok((held, None)),
        (Err(error), Content::Unknown) => Err(error),
    }
}

/// Returns whether a file must be described before it can be read, since it may hold raw voxels: its name is that of
/// raw voxels, or it is unknown by name and content and is not text.
pub fn needs_layout(path: &Path) -> bool {
    match format_of(path, false) {
        Ok((format, _)) => format == list::raw(),
        Err(FormatError::UnknownEnding { .. } | FormatError::NoEnding(_)) => {
            let mut start = Vec::new();
            let file = store::open(path).map(|file| file.take(START_BYTES).read_to_end(&mut start));
            let is_text = |byte: &u8| !byte.is_ascii_control() || byte.is_ascii_whitespace();
            matches!(file, Ok(Ok(_))) && !start.iter().all(is_text)
        }
        Err(_) => false,
    }
}

/// Returns the content of a file that begins with `start` and has `length` bytes.
fn content_of(start: &[u8], length: u64) -> Content {
    if let Some(format) = list::identified(start, length) {
        return Content::Known(format);
    }
    if start.starts_with(ZIP) {
        return Content::Packed(Packing::Zip);
    }
    if start.starts_with(GZIP) {
        let mut inside = Vec::new();
        // The rest is missing; only the bytes unpacked so far matter.
        let _ = MultiGzDecoder::new(start).take(START_BYTES).read_to_end(&mut inside);
        let held = list::identified(&inside, inside.len() as u64);
        let held = held.filter(|held| held.packing == Some(Packing::Gzip));
        return held.map_or(Content::Packed(Packing::Gzip), Content::Known);
    }
    let foreign = FOREIGN.iter().find(|(sign, _)| sign.is_in(start, length));
    foreign.map_or(Content::Unknown, |(_, what)| Content::Foreign(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::pvm;

    #[test]
    fn contents_are_told_by_their_first_bytes() {
        for (sign, what) in FOREIGN {
            let Sign::At(at, magic) = sign else { panic!("{what}") };
            assert_eq!(content_of(&[&vec![0; at], magic].concat(), 900), Content::Foreign(what));
        }
        for nothing in [&b""[..], b"v 1 2 3\n", b"\x1F", &[0; 1024]] {
            assert_eq!(content_of(nothing, nothing.len() as u64), Content::Unknown);
        }
        let mut stl = b"PVM\n ply\n and whatever a program writes".to_vec();
        stl.resize(80, b' ');
        stl.extend([1, 0, 0, 0]);
        assert_eq!(content_of(&stl, 134), Content::Known(list::named(Path::new("a.stl")).unwrap()));
        assert_eq!(content_of(&stl, 135), Content::Known(&pvm::SPEC));
    }
}
