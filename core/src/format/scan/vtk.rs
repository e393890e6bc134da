//! Legacy files of VTK (docs.vtk.org, "VTK legacy file format"): structured points, as text or binary.
//!
//! Takes the bytes of a file; gives the first array of scalars of its points, or else of its cells. Binary numbers are
//! big-endian. A large binary array may stay in the file.

use glam::{UVec3, Vec3};

use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan, ScanVolume};
use super::unpack::{cut, malformed};
use crate::format::error::excerpt;
use crate::format::layered::{LayeredVolume, PartPacking, StoredNumbers, StoredVoxels, VoxelPart};
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::format::{FormatError, Volumes};

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC.as_bytes())],
    ..FormatSpec::new("legacy VTK data", &["vtk"], Import::Scan(open))
};

fn open(reading: &Reading) -> Result<(Scan, u64), FormatError> {
    if reading.in_layers
        && let Some(scan) = layered(reading)?
    {
        return Ok((scan, std::fs::metadata(reading.path)?.len()));
    }
    reading.read_whole(reading.path, |file| read(file, reading))
}

const MAGIC: &str = "# vtk DataFile Version";
/// Greatest number of header lines, and of characters in one, that are examined.
const MOST_LINES: usize = 1 << 10;
const MOST_LETTERS: usize = 1 << 12;

/// The lines of a file, and the data after them.
struct VtkLines<'a> {
    rest: &'a [u8],
}

impl<'a> VtkLines<'a> {
    /// Returns the next non-empty line.
    fn next(&mut self) -> Option<String> {
        loop {
            let most = self.rest.len().min(MOST_LETTERS);
            let end = self.rest[..most].iter().position(|byte| *byte == b'\n').unwrap_or(most);
            if self.rest.is_empty() {
                return None;
            }
            let line = String::from_utf8_lossy(&self.rest[..end]).trim().to_string();
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }
}

/// An array of scalars.
struct VtkArray {
    head: VtkHeader,
    number: Number,
    dims: UVec3,
    /// Where its values begin in the file.
    begin: usize,
}

impl VtkArray {
    /// Finds the array in a file, of which only the beginning need be there.
    fn of(file: &[u8]) -> Result<VtkArray, FormatError> {
        let refused =
            |what: String| FormatError::Scan(format!("{what}; write it as .vti or .nrrd"));
        let mut lines = VtkLines { rest: file };
        let first = lines.next().unwrap_or_default();
        if !first.starts_with(MAGIC) {
            return Err(refused(format!(
                "this is not a file of VTK: it begins with `{}`",
                excerpt(first.as_bytes())
            )));
        }
        // A title, which may be empty.
        let end = lines.rest.iter().position(|byte| *byte == b'\n').unwrap_or(lines.rest.len());
        let title = lines.rest[..end.min(256)].trim_ascii().to_vec();
        lines.rest = lines.rest.get(end + 1..).unwrap_or_default();
        let mut head = VtkHeader { title, voxel_size: [1.0; 3], ..VtkHeader::default() };
        let mut array = None;
        for _ in 0..MOST_LINES {
            let Some(line) = lines.next() else { break };
            if let Some(found) = head.take(&line, &mut lines)? {
                array = Some(found);
                break;
            }
        }
        let Some(number) = array else {
            return Err(refused("it holds no array of scalars".to_string()));
        };
        let sizes = head.sizes.map(|size| match head.is_of_cells {
            true => size.saturating_sub(1).max(1),
            false => size,
        });
        if sizes.contains(&0) {
            return Err(malformed("the header", "its size is missing, or 0"));
        }
        let begin = file.len() - lines.rest.len();
        Ok(VtkArray { head, number, dims: UVec3::from(sizes), begin })
    }

    fn voxel_size(&self) -> Vec3 {
        Vec3::from(self.head.voxel_size)
    }

    /// Returns the scan. `rest_bytes`: what follows the header in the file.
    fn scan(&self, volume: ScanVolume, volumes: Volumes, rest_bytes: u64) -> Scan {
        let VtkHeader { is_binary, has_others, .. } = self.head;
        let coding = if is_binary { "binary" } else { "text" };
        let bytes = self.number.volume_bytes(self.dims);
        let has_others = has_others || (is_binary && rest_bytes > bytes.saturating_add(2));
        let note = "other arrays of the file, if it has some, were left out".to_string();
        Scan {
            volumes,
            volume,
            frame: AxisFrame::Unknown,
            kind: format!("VTK structured points, {coding}"),
            is_label: false,
            notes: has_others.then_some(note).into_iter().collect(),
        }
    }
}

/// Returns the scan of a large array that stays in its file; `None` for one that must be read whole.
fn layered(reading: &Reading) -> Result<Option<Scan>, FormatError> {
    let start = reading.start(reading.path)?;
    // All that can be wrong is told by the other reader.
    let Ok(array) = VtkArray::of(&start) else { return Ok(None) };
    let (number, dims, voxel_size) = (array.number, array.dims, array.voxel_size());
    let bytes = number.volume_bytes(dims);
    if !array.head.is_binary || !reading.is_large(bytes) {
        return Ok(None);
    }
    reading.admit(dims, voxel_size)?;
    let volumes = reading.volumes(1)?;
    let (path, begin) = (reading.path.to_path_buf(), array.begin as u64);
    let rest_bytes = std::fs::metadata(&path)?.len().saturating_sub(begin);
    let part = VoxelPart { path, packing: PartPacking::Plain, packed_at: 0, begin, bytes };
    let (is_big, scale) = (true, [1.0, 0.0]);
    let stored = StoredVoxels {
        parts: vec![part],
        skip: 0,
        numbers: StoredNumbers { number, is_big, scale },
    };
    let title = array.head.title.clone();
    let volume = LayeredVolume::new(stored, dims, voxel_size, title, reading.progress)?;
    Ok(Some(array.scan(volume.into(), volumes, rest_bytes)))
}

fn read(file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let array = VtkArray::of(&file)?;
    let (number, dims, voxel_size) = (array.number, array.dims, array.voxel_size());
    reading.admit(dims, voxel_size)?;
    let bytes = number.check(dims, reading.rest_bytes(file.len() as u64))?;
    let rest = &file[array.begin..];
    let found = rest.len() as u64;
    let is_binary = array.head.is_binary;
    let data = match is_binary {
        true => {
            let data = usize::try_from(bytes).ok().and_then(|bytes| rest.get(..bytes));
            data.ok_or_else(|| cut(bytes, found))?.to_vec()
        }
        false => super::nrrd::text(rest, number, bytes)?,
    };
    let samples = number.into_samples(data, is_binary, [1.0, 0.0]);
    let volumes = reading.volumes(1)?;
    let volume = volume(dims, voxel_size, samples, array.head.title.clone());
    Ok(array.scan(volume.into(), volumes, found))
}

/// The values of the lines before the array.
#[derive(Default)]
struct VtkHeader {
    title: Vec<u8>,
    is_binary: bool,
    is_of_cells: bool,
    has_others: bool,
    sizes: [u32; 3],
    voxel_size: [f32; 3],
}

impl VtkHeader {
    /// Takes a line. Returns the number type of an array whose values follow.
    fn take(&mut self, line: &str, lines: &mut VtkLines) -> Result<Option<Number>, FormatError> {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let upper = words[0].to_ascii_uppercase();
        match (upper.as_str(), &words[1..]) {
            ("ASCII", _) => self.is_binary = false,
            ("BINARY", _) => self.is_binary = true,
            ("DATASET", [kind, ..]) if kind.eq_ignore_ascii_case("STRUCTURED_POINTS") => {}
            ("DATASET", rest) => {
                let kind = excerpt(rest.first().unwrap_or(&"").as_bytes());
                return Err(FormatError::Scan(format!(
                    "it holds `{kind}`, where only STRUCTURED_POINTS are read; write volumes as .vti, and meshes as .ply or .stl"
                )));
            }
            ("DIMENSIONS", rest) => self.sizes = three(line, rest)?,
            ("SPACING" | "ASPECT_RATIO", rest) => {
                self.voxel_size = three::<f32>(line, rest)?.map(f32::abs);
            }
            ("POINT_DATA", _) => self.is_of_cells = false,
            ("CELL_DATA", _) => self.is_of_cells = true,
            ("SCALARS", [_, kind, rest @ ..]) => {
                let number = number(kind, rest.first().copied().unwrap_or("1"))?;
                let before = lines.rest;
                // A lookup table is named, or not.
                let is_table = lines
                    .next()
                    .is_some_and(|line| line.to_ascii_uppercase().starts_with("LOOKUP_TABLE"));
                if !is_table {
                    lines.rest = before;
                }
                return Ok(Some(number));
            }
            ("COLOR_SCALARS", [_, "3"]) if self.is_binary => return Ok(Some(Number::Rgb)),
            ("COLOR_SCALARS", [_, "4"]) if self.is_binary => return Ok(Some(Number::Rgba)),
            (
                "FIELD"
                | "VECTORS"
                | "NORMALS"
                | "TENSORS"
                | "COLOR_SCALARS"
                | "TEXTURE_COORDINATES",
                _,
            ) => {
                return Err(FormatError::Scan(format!(
                    "its first array is of the kind `{}`, where only SCALARS are read; write it as .vti or .nrrd",
                    excerpt(upper.as_bytes())
                )));
            }
            _ => {}
        }
        Ok(None)
    }
}

fn three<T: std::str::FromStr>(line: &str, words: &[&str]) -> Result<[T; 3], FormatError> {
    let numbers: Option<Vec<T>> = words.iter().map(|word| word.parse().ok()).collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        malformed("the header", format!("`{}` must give three numbers", excerpt(line.as_bytes())))
    })
}

fn number(name: &str, components: &str) -> Result<Number, FormatError> {
    Ok(match (name.to_ascii_lowercase().as_str(), components) {
        ("unsigned_char", "3") => Number::Rgb,
        ("unsigned_char", "4") => Number::Rgba,
        ("char", "1") => Number::I8,
        ("unsigned_char", "1") => Number::U8,
        ("short", "1") => Number::I16,
        ("unsigned_short", "1") => Number::U16,
        ("int", "1") => Number::I32,
        ("unsigned_int", "1") => Number::U32,
        ("long" | "vtktypeint64", "1") => Number::I64,
        ("unsigned_long" | "vtktypeuint64", "1") => Number::U64,
        ("float", "1") => Number::F32,
        ("double", "1") => Number::F64,
        (name, components) => {
            return Err(FormatError::Scan(format!(
                "an array of {} x `{}` is not read; write one number a point, or 3 or 4 of unsigned_char",
                excerpt(components.as_bytes()),
                excerpt(name.as_bytes())
            )));
        }
    })
}
