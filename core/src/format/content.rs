//! Which format a file is of: what its first bytes say, and where they say nothing, its name.
//!
//! Takes a path; gives the format, with a note where the name says another. A file that holds something that is not
//! read, under the name of a format that is, is an error that says what it holds.

use std::io::Read;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::{Format, FormatError, mesh_in, scan, store, voxel};

/// First bytes of a file that are looked at.
const START_BYTES: u64 = 1024;
const GZIP: &[u8] = &[0x1F, 0x8B];
const ZIP: &[u8] = b"PK\x03\x04";
/// A binary `.stl`: a header of any text, the number of triangles, and bytes of each.
const STL_HEADER_BYTES: usize = 80;
const STL_TRIANGLE_BYTES: u64 = 50;
/// Where NIfTI-1 says what it is, after a length of its header that tells the byte order.
const NIFTI_MAGIC_AT: usize = 344;

/// Signatures of the formats that are read: the offset, the bytes there, and the format.
const KNOWN: [(usize, &[u8], Format); 19] = [
    (0, b"\x89VSC\r\n\x1A\n", Format::Vsc),
    (0, b"PVM\n", Format::Pvm),
    (0, b"PVM2\n", Format::Pvm),
    (0, b"PVM3\n", Format::Pvm),
    (0, b"DDS v3", Format::Pvm),
    (128, b"DICM", Format::Scan(scan::Kind::Dicom)),
    (0, b"NRRD000", Format::Scan(scan::Kind::Nrrd)),
    (0, b"II*\0", Format::Scan(scan::Kind::Tiff)),
    (0, b"MM\0*", Format::Scan(scan::Kind::Tiff)),
    (0, b"II+\0", Format::Scan(scan::Kind::Tiff)),
    (0, b"MM\0+", Format::Scan(scan::Kind::Tiff)),
    (0, b"VOX ", Format::Voxel(voxel::Kind::Vox)),
    (0, b"GOX ", Format::Voxel(voxel::Kind::Gox)),
    (0, b"#binvox", Format::Voxel(voxel::Kind::Binvox)),
    (0, b"glTF", Format::Mesh(mesh_in::Kind::Glb)),
    (0, b"ply\n", Format::Mesh(mesh_in::Kind::Ply)),
    (0, b"ply\r", Format::Mesh(mesh_in::Kind::Ply)),
    (0, b"solid ", Format::Mesh(mesh_in::Kind::Stl)),
    (0, b"# vtk DataFile Version", Format::Scan(scan::Kind::Vtk)),
];

/// Signatures of contents that are not read: the offset, the bytes there, and the name for people.
const FOREIGN: [(usize, &[u8], &str); 17] = [
    (0, b"\x89PNG", "a PNG image"),
    (0, b"\xFF\xD8\xFF", "a JPEG image"),
    (0, b"GIF8", "a GIF image"),
    (0, b"#?R", "a Radiance image"),
    (0, b"DDS |", "a texture of DirectDraw"),
    (0, b"%PDF", "a PDF document"),
    (0, b"BZh", "something packed with bzip2; unpack it first"),
    (0, b"\xFD7zXZ", "something packed with xz; unpack it first"),
    (0, b"\x28\xB5\x2F\xFD", "something packed with zstd; unpack it first"),
    (257, b"ustar", "a tar archive; unpack it first"),
    (0, b"7z\xBC\xAF", "a 7z archive; unpack it first"),
    (0, b"\x89HDF", "an HDF5 file"),
    (0, b" BDV", "an OpenVDB volume"),
    (0, b"Kaydara FBX", "an FBX scene"),
    (0, b"BLENDER", "a Blender scene"),
    (0, b"<!DOCTYPE", "a page of the web, perhaps an error of the server that it was loaded from"),
    (
        0,
        b"version https://git-lfs",
        "only a pointer of Git LFS; get the file itself with `git lfs pull`",
    ),
];

/// The content of a file.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Content {
    Known(Format),
    Foreign(&'static str),
    /// Packed with gzip, and no NIfTI file that says so.
    Gzip,
    /// A ZIP archive, which a `.3mf` file is.
    Zip,
    Unknown,
}

/// The format of a file that is to be read, or of a folder with the slices of a scan; and what to say where name and
/// content disagree.
///
/// With a layout for raw voxels (`is_described`) a file of an unknown name holds such.
pub fn format_of(path: &Path, is_described: bool) -> Result<(Format, Option<String>), FormatError> {
    if path.is_dir() {
        let kind = scan::kind_of_folder(path).ok_or(FormatError::NoScanInFolder)?;
        return Ok((Format::Scan(kind), None));
    }
    let by_name = Format::of(path);
    // Raw voxels may begin with anything; their layout is what counts.
    let is_open = by_name.is_err() || scan::lacks_header(path);
    if matches!(by_name, Ok(Format::Raw)) || is_described && is_open {
        return Ok((Format::Raw, None));
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
            let note = format!(
                "the file is named as {}, but holds {}; that was read",
                name_of(named),
                name_of(held)
            );
            Ok((held, Some(note)))
        }
        // Older headers say nothing of themselves.
        (Ok(Format::Scan(scan::Kind::Nifti)), Content::Gzip) => {
            Ok((Format::Scan(scan::Kind::Nifti), None))
        }
        (Ok(Format::Mesh(mesh_in::Kind::ThreeMf)), Content::Zip) => {
            Ok((Format::Mesh(mesh_in::Kind::ThreeMf), None))
        }
        (Ok(_), Content::Zip) => Err(FormatError::Packed("a ZIP archive")),
        (Ok(_), Content::Gzip) => Err(FormatError::Packed("something packed with gzip")),
        (Ok(_), Content::Foreign(what)) => Err(FormatError::OtherContent(what)),
        (Ok(named), _) => Ok((named, None)),
        (Err(_), Content::Known(held)) => Ok((held, None)),
        (Err(_), Content::Zip) => Err(FormatError::Packed("a ZIP archive")),
        (Err(_), Content::Gzip) => Err(FormatError::Packed("something packed with gzip")),
        (Err(_), Content::Foreign(what)) => Err(FormatError::OtherContent(what)),
        (Err(error), _) => Err(error),
    }
}

/// Whether a file must be described before it can be read, since it may hold voxels alone: its name is that of raw voxels,
/// or it is unknown by name and content, and no text.
pub fn needs_layout(path: &Path) -> bool {
    match format_of(path, false) {
        Ok((format, _)) => format == Format::Raw,
        Err(FormatError::UnknownEnding(_) | FormatError::NoEnding) => {
            let mut start = Vec::new();
            let file = store::open(path).map(|file| file.take(START_BYTES).read_to_end(&mut start));
            let is_text = |byte: &u8| !byte.is_ascii_control() || byte.is_ascii_whitespace();
            matches!(file, Ok(Ok(_))) && !start.iter().all(is_text)
        }
        Err(_) => false,
    }
}

/// The content of a file that begins with `start` and has `length` bytes.
fn content_of(start: &[u8], length: u64) -> Content {
    let begins =
        |at: usize, magic: &[u8]| start.get(at..).is_some_and(|rest| rest.starts_with(magic));
    // The header of a binary STL file may begin as anything does.
    let triangles = start.get(STL_HEADER_BYTES..).and_then(|rest| rest.first_chunk());
    let triangles = triangles.map(|count| u64::from(u32::from_le_bytes(*count)));
    let stl_bytes = |count| STL_HEADER_BYTES as u64 + 4 + count * STL_TRIANGLE_BYTES;
    if triangles.is_some_and(|count| count > 0 && stl_bytes(count) == length) {
        return Content::Known(Format::Mesh(mesh_in::Kind::Stl));
    }
    if let Some((.., format)) = KNOWN.iter().find(|(at, magic, _)| begins(*at, magic)) {
        return Content::Known(*format);
    }
    if start.get(..6).is_some_and(|word| word.eq_ignore_ascii_case(b"solid ")) {
        return Content::Known(Format::Mesh(mesh_in::Kind::Stl));
    }
    if scan::is_dicom(start) {
        return Content::Known(Format::Scan(scan::Kind::Dicom));
    }
    if is_nifti(start) {
        return Content::Known(Format::Scan(scan::Kind::Nifti));
    }
    if begins(0, ZIP) {
        return Content::Zip;
    }
    if begins(0, GZIP) {
        let mut inside = Vec::new();
        // The rest is not there; what was unpacked before counts.
        let _ = MultiGzDecoder::new(start).take(START_BYTES).read_to_end(&mut inside);
        return match is_nifti(&inside) {
            true => Content::Known(Format::Scan(scan::Kind::Nifti)),
            false => Content::Gzip,
        };
    }
    let text = start.trim_ascii_start();
    let is_vtk = text.windows(8).any(|part| part == b"<VTKFile");
    if text.starts_with(b"<") && is_vtk {
        return Content::Known(Format::Scan(scan::Kind::Vti));
    }
    match FOREIGN.iter().find(|(at, magic, _)| begins(*at, magic)) {
        Some((.., what)) => Content::Foreign(what),
        None => Content::Unknown,
    }
}

/// Whether that is the header of a NIfTI file of either version and byte order. Older headers say nothing of
/// themselves, and are known by name.
fn is_nifti(start: &[u8]) -> bool {
    let at =
        |place: usize, magic: &[u8]| start.get(place..).is_some_and(|rest| rest.starts_with(magic));
    let is_first = at(NIFTI_MAGIC_AT, b"n+1\0") || at(NIFTI_MAGIC_AT, b"ni1\0");
    is_first || at(4, b"n+2\0") || at(4, b"ni2\0")
}

/// For people.
fn name_of(format: Format) -> &'static str {
    match format {
        Format::Vsc => "a sculpture (.vsc)",
        Format::Pvm => "a PVM volume (.pvm)",
        Format::Raw => "raw voxels (.raw)",
        Format::Scan(scan::Kind::Nifti) => "a NIfTI scan (.nii)",
        Format::Scan(scan::Kind::Nrrd) => "an NRRD scan (.nrrd)",
        Format::Scan(scan::Kind::Vti) => "VTK image data (.vti)",
        Format::Scan(scan::Kind::Vtk) => "legacy VTK data (.vtk)",
        Format::Scan(scan::Kind::Meta) => "a MetaImage (.mha)",
        Format::Scan(scan::Kind::Tiff) => "a TIFF stack (.tif)",
        Format::Scan(scan::Kind::Dicom) => "DICOM (.dcm)",
        Format::Voxel(voxel::Kind::Vox) => "a MagicaVoxel model (.vox)",
        Format::Voxel(voxel::Kind::Qb) => "a Qubicle model (.qb)",
        Format::Voxel(voxel::Kind::Gox) => "a Goxel model (.gox)",
        Format::Voxel(voxel::Kind::Binvox) => "voxels of binvox (.binvox)",
        Format::Mesh(mesh_in::Kind::Obj) => "a mesh (.obj)",
        Format::Mesh(mesh_in::Kind::Stl) => "a mesh (.stl)",
        Format::Mesh(mesh_in::Kind::Ply) => "a mesh (.ply)",
        Format::Mesh(mesh_in::Kind::Glb) => "a mesh (.glb)",
        Format::Mesh(mesh_in::Kind::ThreeMf) => "a mesh (.3mf)",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_told_by_their_first_bytes() {
        for (at, magic, format) in KNOWN {
            let mut start = vec![0; at];
            start.extend_from_slice(magic);
            start.extend_from_slice(b" and more");
            assert_eq!(content_of(&start, 900), Content::Known(format));
            assert_ne!(content_of(&start[..at + magic.len() - 1], 900), Content::Known(format));
        }
        for (at, magic, what) in FOREIGN {
            assert_eq!(content_of(&[&vec![0; at], magic].concat(), 900), Content::Foreign(what));
        }
        for nothing in [&b""[..], b"v 1 2 3\n", b"\x1F", &[0; 1024]] {
            assert_eq!(content_of(nothing, nothing.len() as u64), Content::Unknown);
        }
        let mut stl = b"PVM\n ply\n and whatever a program writes".to_vec();
        stl.resize(STL_HEADER_BYTES, b' ');
        stl.extend([1, 0, 0, 0]);
        let held = content_of(&stl, 134);
        assert_eq!(held, Content::Known(Format::Mesh(mesh_in::Kind::Stl)));
        assert_eq!(content_of(&stl, 135), Content::Known(Format::Pvm));
    }
}
