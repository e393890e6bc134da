//! The description of a file format: the names of its files, the bytes that identify it, and how it is read and written.
//!
//! Each format has one, `SPEC`, in its own file, and a row in the list of its folder (`FORMATS`), of which `list.rs` makes
//! one; everything else that depends on the format follows from it. What an import or an export asks follows from the kind of reader and writer. Knows no format.

use std::fmt;
use std::path::Path;

use super::FormatError;
use super::mesh_in::imported::MeshReader;
use super::mesh_out::MeshWriter;
use super::scan::reading::{Reading, Scan};
use super::volume::Volume;
use super::voxel::model::{ModelReader, ModelWriter};
use crate::progress::Progress;

/// A format, as the list holds it.
pub type Format = &'static FormatSpec;

/// The description of a format.
pub struct FormatSpec {
    /// What a file holds, for people, such as `a NIfTI scan`.
    pub name: &'static str,
    /// Extensions of its files, in lower case and without the dot. Files are written under the first.
    pub extensions: &'static [&'static str],
    /// Extensions of files that belong to another one, in whose place they can be opened. They are not proposed.
    pub parts: &'static [&'static str],
    /// Each of them identifies a file.
    pub signs: &'static [Sign],
    /// How files are packed as a whole, if some are.
    pub packing: Option<Packing>,
    /// Whether a folder holds files of the format that are opened together.
    pub folder: Option<fn(&Path) -> bool>,
    /// Whether the file that one of `parts` belongs to is missing.
    pub lacks_header: Option<fn(&Path) -> bool>,
    /// How it is read.
    pub read: Import,
    /// How it is written, if it is.
    pub write: Option<Export>,
    /// Its name in the list of formats to export to. None if it is not exported to.
    pub exported_as: Option<&'static str>,
}

impl FormatSpec {
    /// Returns a format that is only read, and that nothing but its extensions identifies.
    pub const fn new(
        name: &'static str,
        extensions: &'static [&'static str],
        read: Import,
    ) -> FormatSpec {
        FormatSpec {
            name,
            extensions,
            parts: &[],
            signs: &[],
            packing: None,
            folder: None,
            lacks_header: None,
            read,
            write: None,
            exported_as: None,
        }
    }

    /// For people, with its extension: `a NIfTI scan (.nii)`.
    pub fn title(&self) -> String {
        format!("{} (.{})", self.name, self.extension())
    }

    /// Returns the extension under which it is written.
    pub const fn extension(&self) -> &'static str {
        self.extensions[0]
    }

    /// Returns whether a file may have such a name.
    pub fn is_named(&self, path: &Path) -> bool {
        self.extensions.iter().chain(self.parts).any(|ending| has_ending(path, ending))
    }
}

/// Descriptions are equal if they are the same one.
impl PartialEq for FormatSpec {
    fn eq(&self, other: &FormatSpec) -> bool {
        std::ptr::eq(self, other)
    }
}

impl fmt::Debug for FormatSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// A property of the first bytes by which a file is known.
pub enum Sign {
    /// The header fits the length of the file, so that its first bytes may be anything, even those of another format.
    Exact(fn(start: &[u8], length: u64) -> bool),
    /// These bytes at this offset.
    At(usize, &'static [u8]),
    /// This word at the start, in capitals or not.
    Word(&'static [u8]),
    /// The first bytes look like it. This counts if no format has its bytes there.
    Likely(fn(start: &[u8]) -> bool),
}

impl Sign {
    /// Returns whether a file that begins with `start` and has `length` bytes has the sign.
    pub fn is_in(&self, start: &[u8], length: u64) -> bool {
        match self {
            Sign::Exact(fits) => fits(start, length),
            Sign::At(at, magic) => start.get(*at..).is_some_and(|rest| rest.starts_with(magic)),
            Sign::Word(word) => {
                start.get(..word.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(word))
            }
            Sign::Likely(is_like) => is_like(start),
        }
    }

    /// Of the signs that a file has, one of the lowest rank counts.
    pub fn rank(&self) -> u8 {
        match self {
            Sign::Exact(_) => 0,
            Sign::At(..) | Sign::Word(_) => 1,
            Sign::Likely(_) => 2,
        }
    }
}

/// How a whole file is packed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Packing {
    /// One file, packed.
    Gzip,
    /// An archive of several.
    Zip,
}

impl Packing {
    /// Packed contents, for people.
    pub fn name(self) -> &'static str {
        match self {
            Packing::Gzip => "something packed with gzip",
            Packing::Zip => "a ZIP archive",
        }
    }
}

/// Reads voxels, and returns them with the length of the file, or of all files of a series.
pub type ReadVolume = fn(&Reading) -> Result<(Scan, u64), FormatError>;

/// How a format is read.
pub enum Import {
    /// The program's own sculptures, which `vsc` also reads without a file.
    Sculpture,
    /// Voxels in a box, without a word on how they lie and what their numbers are.
    Volume(ReadVolume),
    /// Voxels in a box, as a scanner or a simulation gives them.
    Scan(ReadVolume),
    /// Coloured voxels of another voxel editor.
    Model(ModelReader),
    /// Triangles.
    Mesh(MeshReader),
}

/// How a format is written.
pub enum Export {
    /// The program's own sculptures, which `vsc` also writes without a file.
    Sculpture,
    /// Voxels in a box, in the form that is asked for.
    Volume(fn(Volume, &dyn Progress) -> Result<Vec<u8>, FormatError>),
    /// Coloured voxels.
    Model(ModelWriter),
    /// Triangles.
    Mesh(MeshWriter),
}

/// Returns whether the name of a file ends in a dot and `ending`, in capitals or not.
fn has_ending(path: &Path, ending: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    name.strip_suffix(ending).is_some_and(|rest| rest.ends_with('.') && rest.len() > 1)
}
