//! Describes a file format: the names of its files, the bytes that identify it, and how it is read and written.
//!
//! Each format has one description, `SPEC`, in its own file, and an entry in the list of its folder (`FORMATS`);
//! `list.rs` joins these lists. Everything else that depends on the format is derived from it. The options of an import
//! or an export follow from the kind of reader and writer. Knows no format.

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
    /// Display name of the content, such as `a NIfTI scan`.
    pub name: &'static str,
    /// Extensions of its files, in lower case and without the dot. Files are written under the first.
    pub extensions: &'static [&'static str],
    /// Extensions of files that belong to another one and can be opened in its place. They are not proposed.
    pub parts: &'static [&'static str],
    /// Signatures, each of which identifies a file.
    pub signs: &'static [Sign],
    /// The packing of whole files, if some are packed.
    pub packing: Option<Packing>,
    /// Tests whether a folder holds files of the format that are opened together.
    pub folder: Option<fn(&Path) -> bool>,
    /// Tests whether the file to which one of `parts` belongs is missing.
    pub lacks_header: Option<fn(&Path) -> bool>,
    /// The reader.
    pub read: Import,
    /// The writer, if it is written.
    pub write: Option<Export>,
    /// Its name in the list of export formats. `None` if it is not exported to.
    pub exported_as: Option<&'static str>,
}

impl FormatSpec {
    /// Returns a format that is only read, and identified only by its extensions.
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

    /// Returns the display name with its extension: `a NIfTI scan (.nii)`.
    pub fn title(&self) -> String {
        format!("{} (.{})", self.name, self.extension())
    }

    /// Returns the extension under which it is written.
    pub const fn extension(&self) -> &'static str {
        self.extensions[0]
    }

    /// Returns whether a file may have such a name.
    pub(crate) fn is_named(&self, path: &Path) -> bool {
        self.extensions.iter().chain(self.parts).any(|ending| has_ending(path, ending))
    }
}

/// Descriptions are equal if they are the same object.
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

/// A property of the first bytes that identifies a file.
pub enum Sign {
    /// The header matches the length of the file, so that its first bytes may be anything, even those of another
    /// format.
    Exact(fn(start: &[u8], length: u64) -> bool),
    /// These bytes at this offset.
    At(usize, &'static [u8]),
    /// This word at the start, case-insensitive.
    Word(&'static [u8]),
    /// The first bytes look like it. This counts if no format matches exact bytes.
    Likely(fn(start: &[u8]) -> bool),
}

impl Sign {
    /// Returns whether a file of `length` bytes that begins with `start` has the signature.
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

    /// Returns the rank; of the signatures of a file, one of the lowest rank counts.
    pub fn rank(&self) -> u8 {
        match self {
            Sign::Exact(_) => 0,
            Sign::At(..) | Sign::Word(_) => 1,
            Sign::Likely(_) => 2,
        }
    }
}

/// The packing of a whole file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Packing {
    /// One file, packed.
    Gzip,
    /// An archive of several.
    Zip,
}

impl Packing {
    /// Returns the display name of packed contents.
    pub fn name(self) -> &'static str {
        match self {
            Packing::Gzip => "something packed with gzip",
            Packing::Zip => "a ZIP archive",
        }
    }
}

/// Reads voxels, and returns them with the length of the file, or of all files of a series.
pub type ReadVolume = fn(&Reading) -> Result<(Scan, u64), FormatError>;

/// The reader of a format.
pub enum Import {
    /// The program's own sculptures, which `vsc` also reads from memory.
    Sculpture,
    /// Voxels in a box, without information on their orientation and the meaning of their numbers.
    Volume(ReadVolume),
    /// Voxels in a box, from a scanner or a simulation.
    Scan(ReadVolume),
    /// Coloured voxels of another voxel editor.
    Model(ModelReader),
    /// Triangles.
    Mesh(MeshReader),
}

/// The writer of a format.
pub enum Export {
    /// The program's own sculptures, which `vsc` also writes to memory.
    Sculpture,
    /// Voxels in a box, in the requested form.
    Volume(fn(Volume, &dyn Progress) -> Result<Vec<u8>, FormatError>),
    /// Coloured voxels.
    Model(ModelWriter),
    /// Triangles.
    Mesh(MeshWriter),
}

/// Returns whether the name of a file ends in a dot and `ending`, case-insensitive.
fn has_ending(path: &Path, ending: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    name.strip_suffix(ending).is_some_and(|rest| rest.ends_with('.') && rest.len() > 1)
}
