//! Parses the header of an NRRD file (teem.sourceforge.net/nrrd/format.html): lines of text -> fields.

use std::collections::HashMap;

use glam::DVec3;

use super::numbers::Number;
use super::unpack::malformed;
use crate::format::FormatError;
use crate::format::error::excerpt;

/// The start of a file, before a digit of its version.
pub const MAGIC: &[u8] = b"NRRD000";
/// Greatest length of a header.
const MOST_BYTES: usize = 1 << 20;
/// Greatest number of voxel files.
const MOST_FILES: i64 = 1 << 16;
/// Greatest number of axes.
const MOST_AXES: usize = 16;

/// The encoding of the voxels.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NrrdEncoding {
    Raw,
    Text,
    Hex,
    Gzip,
    Bzip2,
}

/// An axis of the file.
#[derive(Clone, Debug, Default)]
pub struct NrrdAxis {
    pub size: u64,
    /// Length of a voxel, where it is given without a direction.
    pub spacing: Option<f64>,
    /// The vector from a voxel to the next, in the space of the file.
    pub direction: Option<DVec3>,
    /// Millimetres of its unit of length, where the file names one.
    pub mm_per_unit: f64,
    /// The kind of axis, such as `domain` or `RGB-color`.
    pub kind: String,
}

/// The contents of a header.
#[derive(Debug)]
pub struct NrrdHeader {
    pub number: Number,
    pub axes: Vec<NrrdAxis>,
    pub encoding: NrrdEncoding,
    pub is_big: bool,
    /// The space, in lower case, such as `left-posterior-superior`.
    pub space: Option<String>,
    /// Whether directions are given.
    pub has_directions: bool,
    /// Number of bytes to skip; -1: as many as precede the voxels at the end.
    pub byte_skip: i64,
    pub line_skip: u64,
    /// The files with the voxels, in order; empty where they follow the header.
    pub data_files: Vec<String>,
    /// Pairs of keys and values of other programs.
    pub pairs: HashMap<String, String>,
    /// Unknown units, which are taken for millimetres.
    pub unknown_units: Vec<String>,
    /// The field `content`.
    pub content: Vec<u8>,
    /// Bytes of the header including the empty line after it.
    pub bytes: usize,
}

impl NrrdHeader {
    /// Returns the bytes of all voxels of the file, and a huge number if it states more.
    pub fn total_bytes(&self) -> u64 {
        let total =
            self.axes.iter().try_fold(self.number.bytes(), |n, axis| n.checked_mul(axis.size));
        total.filter(|n| *n < u64::MAX / 8).unwrap_or(u64::MAX / 8)
    }

    pub fn parse(file: &[u8]) -> Result<NrrdHeader, FormatError> {
        if !file.starts_with(MAGIC) {
            return Err(FormatError::Scan(format!(
                "this is not an NRRD file: it begins with `{}`, not with NRRD000; export it as NRRD again",
                excerpt(file)
            )));
        }
        let start = &file[..file.len().min(MOST_BYTES)];
        let mut fields: HashMap<String, String> = HashMap::new();
        let mut pairs: HashMap<String, String> = HashMap::new();
        // The names that follow `data file: LIST`, to the end of the header.
        let mut listed: Option<Vec<String>> = None;
        let mut at = 0;
        for (i, line) in start.split_inclusive(|b| *b == b'\n').enumerate() {
            at += line.len();
            if i == 0 {
                continue;
            }
            let text = String::from_utf8_lossy(line);
            let text = text.trim_end_matches(['\r', '\n']);
            if text.is_empty() {
                break;
            }
            if let Some(names) = &mut listed {
                names.push(text.trim().to_string());
                continue;
            }
            if text.starts_with('#') {
                continue;
            }
            if let Some((key, value)) = text.split_once(":=") {
                pairs.insert(key.to_string(), value.to_string());
                continue;
            }
            let Some((name, value)) = text.split_once(": ").or_else(|| text.split_once(':')) else {
                return Err(malformed(
                    "the header",
                    format!("`{}` is no field", text.escape_debug()),
                ));
            };
            let name = name.trim().to_ascii_lowercase().replace([' ', '_'], "");
            if name == "datafile" && value.split_whitespace().next() == Some("LIST") {
                listed = Some(Vec::new());
                continue;
            }
            fields.insert(name, value.trim().to_string());
        }
        if at == MOST_BYTES {
            return Err(malformed("the header", "it has no end"));
        }
        let data_files = match (listed, fields.get("datafile")) {
            (Some(names), _) if names.is_empty() => {
                return Err(malformed("the header", "its list of files is empty"));
            }
            (Some(names), _) => names,
            (None, Some(name)) => numbered(name)?,
            (None, None) => Vec::new(),
        };
        Ok(NrrdHeader { pairs, ..NrrdHeader::of(&fields, data_files, at)? })
    }

    fn of(
        fields: &HashMap<String, String>,
        data_files: Vec<String>,
        bytes: usize,
    ) -> Result<NrrdHeader, FormatError> {
        let fields = NrrdFields(fields);
        let mut axes = fields.axes()?;
        let unknown_units = fields.lengths(&mut axes)?;
        let number = number(fields.required("type")?)?;
        let encoding = encoding(fields.required("encoding")?)?;
        let is_big = fields.is_big(number, encoding)?;
        let or_zero = |name| fields.get(name).map_or(Ok(0), |text| parse(name, text));
        let skip = or_zero("byteskip")?;
        if skip < -1 {
            return Err(malformed("the header", format!("a byte skip of {skip}")));
        }
        Ok(NrrdHeader {
            number,
            has_directions: axes.iter().any(|axis| axis.direction.is_some()),
            axes,
            encoding,
            is_big,
            space: fields.get("space").map(str::to_ascii_lowercase),
            byte_skip: skip,
            line_skip: or_zero("lineskip")?.max(0) as u64,
            data_files,
            pairs: HashMap::new(),
            unknown_units,
            content: fields.get("content").unwrap_or_default().as_bytes().to_vec(),
            bytes,
        })
    }
}

/// The fields of a header, by their names in lower case and without spaces.
struct NrrdFields<'a>(&'a HashMap<String, String>);

impl<'a> NrrdFields<'a> {
    fn get(&self, name: &str) -> Option<&'a str> {
        self.0.get(name).map(String::as_str)
    }

    fn required(&self, name: &str) -> Result<&'a str, FormatError> {
        let missing = || malformed("the header", format!("the field `{name}` is missing"));
        self.get(name).ok_or_else(missing)
    }

    /// Returns the axes, with only their sizes.
    fn axes(&self) -> Result<Vec<NrrdAxis>, FormatError> {
        let count = parse::<usize>("dimension", self.required("dimension")?)?;
        let sizes: Vec<u64> = words("sizes", self.required("sizes")?)?;
        if !(1..=MOST_AXES).contains(&count) || sizes.len() != count {
            return Err(malformed(
                "the header",
                format!(
                    "{count} dimensions, but {} sizes; 1 to {MOST_AXES} are possible",
                    sizes.len()
                ),
            ));
        }
        if sizes.contains(&0) {
            return Err(malformed("the header", "an axis has no voxels"));
        }
        let axes = sizes.into_iter();
        Ok(axes.map(|size| NrrdAxis { size, mm_per_unit: 1.0, ..NrrdAxis::default() }).collect())
    }

    /// Adds the meanings and voxel lengths to the axes. Returns the unknown units.
    fn lengths(&self, axes: &mut [NrrdAxis]) -> Result<Vec<String>, FormatError> {
        extents(|name| self.get(name), axes)?;
        if let Some(text) = self.get("spacings") {
            let spacings: Vec<f64> = words("spacings", text)?;
            axes.iter_mut().zip(spacings).for_each(|(axis, n)| axis.spacing = Some(n));
        }
        if let Some(text) = self.get("kinds") {
            let kinds = text.split_whitespace();
            axes.iter_mut().zip(kinds).for_each(|(axis, kind)| axis.kind = kind.to_string());
        }
        let mut unknown_units = Vec::new();
        let mut mm = |unit: &str| {
            mm_per_unit(unit).unwrap_or_else(|| {
                unknown_units.push(excerpt(unit.as_bytes()));
                1.0
            })
        };
        if let Some(text) = self.get("units") {
            let units = quoted(text).into_iter();
            axes.iter_mut().zip(units).for_each(|(axis, unit)| axis.mm_per_unit = mm(unit));
        }
        if let Some(text) = self.get("spacedirections") {
            let units = self.get("spaceunits").map(quoted).unwrap_or_default();
            let unit = |i: usize| units.get(i).copied().unwrap_or("");
            // The axes of the space, not of the file.
            let to_mm = DVec3::from_array([0, 1, 2].map(|i| mm(unit(i))));
            let vectors = directions(text)?.into_iter().map(|v| v.map(|v| v * to_mm));
            axes.iter_mut().zip(vectors).for_each(|(axis, v)| axis.direction = v);
        }
        Ok(unknown_units)
    }

    /// Returns whether numbers are big-endian.
    fn is_big(&self, number: Number, encoding: NrrdEncoding) -> Result<bool, FormatError> {
        match self.get("endian").map(str::to_ascii_lowercase).as_deref() {
            // Text has no byte order.
            Some("big") => Ok(encoding != NrrdEncoding::Text),
            Some("little") => Ok(false),
            None if number.bytes() == 1 || encoding == NrrdEncoding::Text => Ok(false),
            _ => Err(malformed("the header", "`endian` must be little or big")),
        }
    }
}

fn encoding(name: &str) -> Result<NrrdEncoding, FormatError> {
    match name.to_ascii_lowercase().as_str() {
        "raw" => Ok(NrrdEncoding::Raw),
        "txt" | "text" | "ascii" => Ok(NrrdEncoding::Text),
        "hex" => Ok(NrrdEncoding::Hex),
        "gz" | "gzip" => Ok(NrrdEncoding::Gzip),
        "bz2" | "bzip2" => Ok(NrrdEncoding::Bzip2),
        other => Err(FormatError::Scan(format!(
            "the NRRD encoding `{}` is not supported; use raw, gzip, bzip2, text or hex",
            other.escape_debug()
        ))),
    }
}

/// Returns the voxel lengths of axes that state the positions of their first and last voxel instead.
fn extents<'a>(
    field: impl Fn(&str) -> Option<&'a str>,
    axes: &mut [NrrdAxis],
) -> Result<(), FormatError> {
    let (Some(mins), Some(maxs)) = (field("axismins"), field("axismaxs")) else { return Ok(()) };
    let (mins, maxs) = (words::<f64>("axis mins", mins)?, words::<f64>("axis maxs", maxs)?);
    let centers = field("centers").or(field("centerings")).unwrap_or_default();
    let mut centers = centers.split_whitespace();
    for (axis, (min, max)) in axes.iter_mut().zip(mins.into_iter().zip(maxs)) {
        // From the centre of the first voxel to that of the last, or from edge to edge.
        let is_node = centers.next().is_some_and(|center| center.eq_ignore_ascii_case("node"));
        let steps = if is_node { axis.size.saturating_sub(1) } else { axis.size };
        axis.spacing = Some((max - min) / steps as f64).filter(|n| n.is_finite());
    }
    Ok(())
}

/// Splits words that may be quoted.
fn quoted(text: &str) -> Vec<&str> {
    if text.contains('"') {
        text.split('"').skip(1).step_by(2).collect()
    } else {
        text.split_whitespace().collect()
    }
}

/// Returns the millimetres of a unit of length; 1 if none is named.
fn mm_per_unit(unit: &str) -> Option<f64> {
    match unit.trim().to_ascii_lowercase().as_str() {
        "???" | "none" => Some(1.0),
        unit => super::unit::mm_per_unit(unit),
    }
}

/// Returns the files that `slice%03d.raw 1 12 1` names (a pattern with its first number, its last, and the step), or
/// the single file of that name.
fn numbered(field: &str) -> Result<Vec<String>, FormatError> {
    let words: Vec<&str> = field.split_whitespace().collect();
    let [pattern, first, last, step, ..] = words[..] else { return Ok(vec![field.to_string()]) };
    let Some((before, rest)) = pattern.split_once('%') else { return Ok(vec![field.to_string()]) };
    let wrong = || malformed("the header", format!("`{}` numbers no files", field.escape_debug()));
    let (digits, after) = rest.split_once('d').ok_or_else(wrong)?;
    let width = match digits {
        "" => 0,
        digits => digits.parse::<usize>().ok().filter(|n| *n <= 20).ok_or_else(wrong)?,
    };
    let number = |word: &str| word.parse::<i64>().map_err(|_| wrong());
    let (first, last, step) = (number(first)?, number(last)?, number(step)?);
    // Towards the last one.
    let span = last.checked_sub(first).ok_or_else(wrong)?;
    let steps = span.checked_div(step).filter(|n| (0..MOST_FILES).contains(n)).ok_or_else(wrong)?;
    let is_padded = digits.starts_with('0');
    Ok((0..=steps)
        .map(|i| first + i * step)
        .map(|n| match is_padded {
            true => format!("{before}{n:0width$}{after}"),
            false => format!("{before}{n:width$}{after}"),
        })
        .collect())
}

fn parse<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, FormatError> {
    text.trim().parse().map_err(|_| {
        malformed("the header", format!("`{}` is not possible for `{name}`", text.escape_debug()))
    })
}

fn words<T: std::str::FromStr>(name: &str, text: &str) -> Result<Vec<T>, FormatError> {
    text.split_whitespace().map(|word| parse(name, word)).collect()
}

/// Parses vectors such as `none (1,0,0) (0,1,0)`; those of two numbers lie in a plane.
fn directions(text: &str) -> Result<Vec<Option<DVec3>>, FormatError> {
    let wrong =
        || malformed("the header", format!("`{}` are no space directions", text.escape_debug()));
    let mut found = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(behind) = rest.strip_prefix("none") {
            found.push(None);
            rest = behind.trim_start();
            continue;
        }
        let (vector, behind) =
            rest.strip_prefix('(').and_then(|rest| rest.split_once(')')).ok_or_else(wrong)?;
        let numbers: Vec<f64> = vector
            .split(',')
            .map(|n| n.trim().parse())
            .collect::<Result<_, _>>()
            .map_err(|_| wrong())?;
        let at = |i: usize| numbers.get(i).copied().unwrap_or(0.0);
        let v = DVec3::new(at(0), at(1), at(2));
        // Some programs write vectors of NaN for `none`.
        found.push((numbers.len() <= 3 && v.is_finite()).then_some(v));
        rest = behind.trim_start();
    }
    Ok(found)
}

/// Returns the number type of a name.
fn number(name: &str) -> Result<Number, FormatError> {
    Ok(match name.to_ascii_lowercase().as_str() {
        "signed char" | "int8" | "int8_t" => Number::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Number::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
            Number::I16
        }
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => Number::U16,
        "int" | "signed int" | "int32" | "int32_t" => Number::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => Number::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => Number::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            Number::U64
        }
        "float" => Number::F32,
        "double" => Number::F64,
        other => {
            return Err(FormatError::Scan(format!(
                "the NRRD type `{}` is not supported; use whole or floating-point numbers",
                other.escape_debug()
            )));
        }
    })
}
