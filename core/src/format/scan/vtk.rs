//! Legacy files of VTK (docs.vtk.org, "VTK legacy file format"): structured points, as text or binary.
//!
//! Takes the bytes of a file; gives the first array of scalars of its points, or else of its cells. Binary numbers are
//! big-endian.

use glam::{UVec3, Vec3};

use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan};
use super::unpack::{cut, malformed};
use crate::format::FormatError;
use crate::format::error::excerpt;
use crate::format::spec::{FormatSpec, Import, Sign};

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC.as_bytes())],
    ..FormatSpec::new(
        "legacy VTK data",
        &["vtk"],
        Import::Scan(|reading| reading.read_whole(reading.path, |file| read(file, reading))),
    )
};

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

fn read(file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    let refused = |what: String| FormatError::Scan(format!("{what}; write it as .vti or .nrrd"));
    let mut lines = VtkLines { rest: &file };
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
    let dims = UVec3::from(sizes);
    let voxel_size = Vec3::from(head.voxel_size);
    if sizes.contains(&0) {
        return Err(malformed("the header", "its size is missing, or 0"));
    }
    reading.admit(dims, voxel_size)?;
    let bytes = number.check(dims, reading.rest_bytes(file.len() as u64))?;
    let found = lines.rest.len() as u64;
    let data = match head.is_binary {
        true => {
            let data = usize::try_from(bytes).ok().and_then(|bytes| lines.rest.get(..bytes));
            data.ok_or_else(|| cut(bytes, found))?.to_vec()
        }
        false => super::nrrd::text(lines.rest, number, bytes)?,
    };
    let samples = number.into_samples(data, head.is_binary, [1.0, 0.0]);
    let coding = if head.is_binary { "binary" } else { "text" };
    let volumes = reading.volumes(1)?;
    Ok(Scan {
        volumes,
        volume: volume(dims, voxel_size, samples, head.title).into(),
        frame: AxisFrame::Unknown,
        kind: format!("VTK structured points, {coding}"),
        is_label: false,
        notes: vec!["other arrays of the file, if it has some, were left out".to_string()]
            .into_iter()
            .filter(|_| head.has_others || (head.is_binary && found > bytes + 2))
            .collect(),
    })
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
