//! A mesh as read, and the input of a reader of meshes; also numbers and faults of texts that several formats share.
//! Knows no format.

use std::path::{Component, Path, PathBuf};

use crate::format::options::ImportOptions;
use crate::format::voxel::assemble;
use crate::format::{FormatError, budget_bytes, error, store};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;
use crate::sculpture::orientation::Up;
use crate::voxelise::{Findings, InputMesh, MeshPlacement, to_contents};

/// Greatest memory of a mesh per byte of its file.
const BYTES_PER_BYTE: u64 = 12;

/// A file to be read.
pub struct MeshFile<'a> {
    pub bytes: &'a [u8],
    pub path: &'a Path,
    /// Memory that its parts or neighbouring files may take together.
    pub rest_bytes: u64,
    pub progress: &'a dyn Progress,
}

/// The reading of meshes of a format.
#[derive(Debug)]
pub struct MeshReader {
    pub read: fn(&MeshFile) -> Result<Imported, FormatError>,
    /// The usual up axis of programs that write the format.
    pub usual_up: Up,
    /// Whether the format itself defines it.
    pub knows_up: bool,
    /// Length of a unit in millimetres.
    pub mm_per_unit: f64,
}

impl MeshReader {
    /// Creates a reader of a format that defines neither its unit of length, mostly millimetres, nor the up axis.
    pub const fn new(
        usual_up: Up,
        read: fn(&MeshFile) -> Result<Imported, FormatError>,
    ) -> MeshReader {
        MeshReader { read, usual_up, knows_up: false, mm_per_unit: 1.0 }
    }

    /// Returns the up axis: the chosen one, or the usual one.
    pub fn up(&self, options: &ImportOptions) -> Up {
        options.upright.filter(|_| !self.knows_up).unwrap_or(self.usual_up)
    }
}

/// A mesh, and notes about it.
#[derive(Debug, Default)]
pub struct Imported {
    pub mesh: InputMesh,
    /// The reader of its format; `None` only while the mesh is read.
    pub of: Option<&'static MeshReader>,
    /// Format and encoding, such as `STL, binary`.
    pub kind: String,
    /// Notes on what was left out, for the user.
    pub notes: Vec<String>,
}

/// Reads a file, with materials and textures from its folder.
pub fn load(
    path: &Path,
    reader: &'static MeshReader,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Imported, FormatError> {
    let budget = budget_bytes(limits) / BYTES_PER_BYTE;
    let file = store::read(path, budget, |_| Ok(()), progress)?;
    let rest_bytes = budget - file.len() as u64;
    let mut imported = (reader.read)(&MeshFile { bytes: &file, path, rest_bytes, progress })?;
    if imported.mesh.triangles.is_empty() {
        return Err(FormatError::NoTriangles);
    }
    imported.of = Some(reader);
    Ok(imported)
}

impl Imported {
    /// Returns the grid that the mesh becomes.
    pub fn frame(&self, options: &ImportOptions) -> Result<MeshPlacement, FormatError> {
        let up = self.of.map_or(Up::default(), |reader| reader.up(options));
        let mm_per_unit = self.of.map_or(1.0, |reader| reader.mm_per_unit);
        Ok(MeshPlacement::around(&self.mesh, options.mesh_size, up, mm_per_unit)?)
    }

    /// Makes a sculpture, with notes about the mesh.
    pub(crate) fn into_contents(
        mut self,
        options: &ImportOptions,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<(Contents, Vec<String>), FormatError> {
        let depth = assemble::colour_depth(options)?;
        let frame = self.frame(options)?;
        let (mesh, fill) = (&self.mesh, options.mesh_fill);
        let (contents, findings) = to_contents(mesh, &frame, fill, depth, limits, progress)?;
        self.notes.extend(note_of(&findings));
        Ok((contents, self.notes))
    }
}

/// Returns the note on a voxelised mesh, if there is one.
fn note_of(findings: &Findings) -> Option<String> {
    let percent = 100.0 * findings.open_share;
    match (findings.open_share > 0.0, findings.is_shell) {
        (true, true) => Some(format!(
            "the mesh is open ({percent:.1} % of the rays through it fall through holes), so its surface alone was \
             taken; ask for a solid to fill it"
        )),
        (true, false) => Some(format!(
            "the mesh has holes ({percent:.2} % of the rays through it), which were closed"
        )),
        (false, _) => None,
    }
}

/// Returns an error in a text, at a line counted from 0.
pub(crate) fn at_line(line: usize, what: impl Into<String>) -> FormatError {
    FormatError::Malformed { place: format!("line {}", line + 1), what: what.into() }
}

/// Parses a number of a text.
pub fn number(word: Option<&str>, line: usize) -> Result<f32, FormatError> {
    let word = word.ok_or_else(|| at_line(line, "a number is missing"))?;
    let shown = error::excerpt(word.as_bytes());
    word.parse().map_err(|_| at_line(line, format!("`{shown}` is not a number")))
}

/// Returns the path of a file in the folder of the mesh or below. `None` for any other.
pub fn within(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    let relative = Path::new(&name);
    let is_plain = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
    (!name.is_empty() && relative.components().all(is_plain)).then(|| folder.join(relative))
}
