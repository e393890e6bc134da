//! VTK image data (`.vti`, docs.vtk.org): the active array of points, or else of cells, as text, base64 or appended,
//! packed with zlib or not.
//!
//! Takes the bytes of a file; gives a volume with spacing and direction.

use std::io::Read;

use flate2::read::ZlibDecoder;
use glam::{DVec3, I64Vec3, UVec3, Vec3};
use roxmltree::{Document, Node};

use super::base64;
use super::frame::AxisFrame;
use super::numbers::{Number, volume};
use super::reading::{Reading, Scan};
use super::unpack::{cut, malformed};
use crate::format::error::printable;
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::format::{FormatError, go_on};

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::Likely(is_vti)],
    ..FormatSpec::new(
        "VTK image data",
        &["vti"],
        Import::Scan(|reading| reading.read_whole(reading.path, |file| read(file, reading))),
    )
};

/// Begins the data after the tags.
const APPENDED: &[u8] = b"<AppendedData";

/// Returns whether an XML file begins like one of VTK.
fn is_vti(start: &[u8]) -> bool {
    let text = start.trim_ascii_start();
    text.starts_with(b"<") && text.windows(8).any(|part| part == b"<VTKFile")
}

fn read(file: Vec<u8>, reading: &Reading) -> Result<Scan, FormatError> {
    // The appended data may be any bytes, which XML does not allow.
    let place = file.windows(APPENDED.len()).position(|window| window == APPENDED);
    let (tags, appended) = file.split_at(place.unwrap_or(file.len()));
    let text = text_of(tags, !appended.is_empty())?;
    let xml = Document::parse(&text)
        .map_err(|error| malformed("the XML", printable(&error.to_string())))?;
    let root = xml.root_element();
    let compressor = checked_compressor(root)?;
    let image = child(root, "ImageData")?;
    let pieces: Vec<Node> = image.children().filter(|n| n.has_tag_name("Piece")).collect();
    let parts = parts(&pieces)?;
    let first = &parts[0];
    let array = first.array;
    let spacing =
        if image.has_attribute("Spacing") { numbers(image, "Spacing")? } else { [1.0; 3] };
    let low = parts.iter().fold(I64Vec3::MAX, |low, part| low.min(part.low));
    let high = parts.iter().fold(I64Vec3::MIN, |high, part| high.max(part.high()));
    let dims = checked_dims(low, high)?;
    let voxel_size = Vec3::from(spacing.map(|n: f64| n.abs() as f32));
    reading.admit(dims, voxel_size)?;

    let components = array.attribute("NumberOfComponents").unwrap_or("1").trim();
    let number = number(array.attribute("type").unwrap_or(""), components)?;
    let bytes = number.check(dims, reading.rest_bytes(2 * file.len() as u64))?;
    let coding = ArrayEncoding {
        is_big: root.attribute("byte_order") == Some("BigEndian"),
        wide: root.attribute("header_type") == Some("UInt64"),
        is_packed: !compressor.is_empty(),
        bytes: bytes as usize,
        reading,
    };
    let format = array.attribute("format").unwrap_or("ascii");
    let is_big = coding.is_big && format != "ascii";
    let mut notes = notes(&parts);
    let data = match &parts[..] {
        [whole] => coding.array(whole.array, number, appended)?,
        parts => {
            let (data, is_whole) = joined(parts, (low, dims), number, &coding, appended)?;
            if !is_whole {
                notes.push("places that are in none of the pieces were taken as 0".to_string());
            }
            data
        }
    };
    let frame = frame(image, spacing)?;
    let name = array.attribute("Name").unwrap_or_default().as_bytes().to_vec();
    let samples = number.into_samples(data, is_big, [1.0, 0.0]);
    let packing = if coding.is_packed && format != "ascii" { ", packed with zlib" } else { "" };
    let pieces = match parts.len() {
        1 => String::new(),
        n => format!(", {n} pieces"),
    };
    let volumes = reading.volumes(1)?;
    Ok(Scan {
        volumes,
        volume: volume(dims, voxel_size, samples, name).into(),
        frame,
        kind: format!("VTK image data, {format}{packing}{pieces}"),
        is_label: false,
        notes,
    })
}

/// Returns the tags of a file as complete XML, also where non-XML data follows.
fn text_of(tags: &[u8], is_cut: bool) -> Result<String, FormatError> {
    let no_text = |_| {
        FormatError::Scan(
            "this is not a VTK file: it is no text; export it as .vti again".to_string(),
        )
    };
    let mut text = std::str::from_utf8(tags).map_err(no_text)?.to_string();
    if is_cut {
        text.push_str("</VTKFile>");
    }
    Ok(text)
}

/// Returns the compressor of image data, empty if there is none. An error if the file holds something else.
fn checked_compressor<'a>(root: Node<'a, '_>) -> Result<&'a str, FormatError> {
    if root.tag_name().name() != "VTKFile" || root.attribute("type") != Some("ImageData") {
        return Err(FormatError::Scan(
            "this is not VTK image data; only regular grids (ImageData) are read; resample it to one".to_string(),
        ));
    }
    match root.attribute("compressor").unwrap_or("") {
        known @ ("" | "vtkZLibDataCompressor") => Ok(known),
        other => Err(FormatError::Scan(format!(
            "the compressor `{}` is not supported; write it with zlib or without",
            other.escape_debug()
        ))),
    }
}

/// Returns the numbers of all pieces in the box of the file, given by its lowest voxel and its size, and whether they
/// fill it.
fn joined(
    parts: &[VtiPiece],
    (low, dims): (I64Vec3, UVec3),
    number: Number,
    coding: &ArrayEncoding,
    appended: &[u8],
) -> Result<(Vec<u8>, bool), FormatError> {
    let voxel_bytes = number.bytes() as usize;
    let mut data = vec![0; coding.bytes];
    let mut is_held = vec![false; coding.bytes / voxel_bytes];
    for part in parts {
        go_on(coding.reading.progress)?;
        let count = part.dims.as_usizevec3().element_product();
        let coding = ArrayEncoding { bytes: count * voxel_bytes, ..*coding };
        let own = coding.array(part.array, number, appended)?;
        let at = (part.low - low).as_uvec3();
        let row_bytes = part.dims.x as usize * voxel_bytes;
        for (row, own) in own.chunks_exact(row_bytes).enumerate() {
            let (y, z) = (row as u32 % part.dims.y, row as u32 / part.dims.y);
            let (y, z) = ((at.y + y) as usize, (at.z + z) as usize);
            let row = (z * dims.y as usize + y) * dims.x as usize + at.x as usize;
            data[row * voxel_bytes..][..row_bytes].copy_from_slice(own);
            is_held[row..row + part.dims.x as usize].fill(true);
        }
    }
    Ok((data, !is_held.contains(&false)))
}

/// Returns the directions of the axes; a backward axis is reversed.
fn frame(image: Node, spacing: [f64; 3]) -> Result<AxisFrame, FormatError> {
    let direction = match image.has_attribute("Direction") {
        true => numbers::<f64, 9>(image, "Direction")?,
        false => [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    };
    let column = |i: usize| {
        DVec3::new(direction[i], direction[3 + i], direction[6 + i]) * spacing[i].signum()
    };
    Ok(AxisFrame::World([0, 1, 2].map(column)))
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Result<Node<'a, 'b>, FormatError> {
    let found = node.children().find(|child| child.has_tag_name(name));
    found.ok_or_else(|| malformed("the XML", format!("<{name}> is missing")))
}

/// Returns the array to read, and whether it belongs to cells.
fn array<'a, 'b>(piece: Node<'a, 'b>) -> Result<(Node<'a, 'b>, bool), FormatError> {
    for (group, is_of_cells) in [("PointData", false), ("CellData", true)] {
        let Some(group) = piece.children().find(|node| node.has_tag_name(group)) else { continue };
        let arrays = || group.children().filter(|node| node.has_tag_name("DataArray"));
        let active = group.attribute("Scalars");
        let named = arrays().find(|array| active.is_some() && array.attribute("Name") == active);
        if let Some(array) = named.or_else(|| arrays().next()) {
            return Ok((array, is_of_cells));
        }
    }
    Err(FormatError::Scan(
        "the file holds no array of points or cells; export it with its scalars".to_string(),
    ))
}

/// A piece of the grid, with the array to read.
struct VtiPiece<'a, 'b> {
    piece: Node<'a, 'b>,
    array: Node<'a, 'b>,
    is_of_cells: bool,
    /// Its lowest voxel, in the grid of the file.
    low: I64Vec3,
    /// Its size in voxels.
    dims: UVec3,
}

impl VtiPiece<'_, '_> {
    /// Returns one past its highest voxel.
    fn high(&self) -> I64Vec3 {
        self.low.saturating_add(self.dims.as_i64vec3())
    }

    /// Returns whether another piece has the same array, with the same number type.
    fn is_like(&self, other: &VtiPiece) -> bool {
        let is_same = |name| self.array.attribute(name) == other.array.attribute(name);
        // Text has no order of bytes.
        let is_text =
            |part: &VtiPiece| matches!(part.array.attribute("format"), None | Some("ascii"));
        self.is_of_cells == other.is_of_cells
            && ["Name", "type", "NumberOfComponents"].into_iter().all(is_same)
            && is_text(self) == is_text(other)
    }
}

/// Returns the non-empty pieces, at least one; all have the same array.
fn parts<'a, 'b>(pieces: &[Node<'a, 'b>]) -> Result<Vec<VtiPiece<'a, 'b>>, FormatError> {
    let mut parts: Vec<VtiPiece> = Vec::new();
    for piece in pieces {
        let extent: [i64; 6] = numbers(*piece, "Extent")?;
        let [low, high] =
            [0, 1].map(|end| I64Vec3::new(extent[end], extent[2 + end], extent[4 + end]));
        // Parallel programs write empty pieces, too.
        if pieces.len() > 1 && high.cmplt(low).any() {
            continue;
        }
        let (array, is_of_cells) = array(*piece)?;
        let over = if is_of_cells {
            high.max(low.saturating_add(I64Vec3::ONE))
        } else {
            high.saturating_add(I64Vec3::ONE)
        };
        let dims = checked_dims(low, over)?;
        let part = VtiPiece { piece: *piece, array, is_of_cells, low, dims };
        if parts.first().is_some_and(|first| !first.is_like(&part)) {
            return Err(FormatError::Scan(
                "its pieces hold different arrays; write it as one piece".to_string(),
            ));
        }
        parts.push(part);
    }
    match parts.is_empty() {
        true => Err(malformed("the XML", "an extent without points")),
        false => Ok(parts),
    }
}

/// Returns the size of a box, given by its lowest voxel and one past its highest.
fn checked_dims(low: I64Vec3, high: I64Vec3) -> Result<UVec3, FormatError> {
    let sides = [0, 1, 2].map(|i| {
        let side = high[i].checked_sub(low[i]).and_then(|side| u32::try_from(side).ok());
        side.filter(|side| *side > 0)
    });
    match sides {
        [Some(x), Some(y), Some(z)] => Ok(UVec3::new(x, y, z)),
        _ => Err(malformed("the XML", "an extent without points")),
    }
}

/// Returns notes on the other arrays, which are left out.
fn notes(parts: &[VtiPiece]) -> Vec<String> {
    let Some(VtiPiece { piece, array: taken, .. }) = parts.first() else { return Vec::new() };
    let arrays = piece.descendants().filter(|node| node.has_tag_name("DataArray") && node != taken);
    let names: Vec<&str> = arrays.filter_map(|array| array.attribute("Name")).collect();
    if names.is_empty() { Vec::new() } else { vec![format!("left out: {}", names.join(", "))] }
}

fn numbers<T: std::str::FromStr, const N: usize>(
    node: Node,
    name: &str,
) -> Result<[T; N], FormatError> {
    let text = node.attribute(name).unwrap_or_default();
    let values: Option<Vec<T>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    values.and_then(|values| values.try_into().ok()).ok_or_else(|| {
        malformed("the XML", format!("{name} `{}` must be {N} numbers", text.escape_debug()))
    })
}

fn number(name: &str, components: &str) -> Result<Number, FormatError> {
    Ok(match (name, components) {
        ("UInt8", "3") => Number::Rgb,
        ("UInt8", "4") => Number::Rgba,
        ("Int8", "1") => Number::I8,
        ("UInt8", "1") => Number::U8,
        ("Int16", "1") => Number::I16,
        ("UInt16", "1") => Number::U16,
        ("Int32", "1") => Number::I32,
        ("UInt32", "1") => Number::U32,
        ("Int64", "1") => Number::I64,
        ("UInt64", "1") => Number::U64,
        ("Float32", "1") => Number::F32,
        ("Float64", "1") => Number::F64,
        _ => {
            return Err(FormatError::Scan(format!(
                "an array of {} x {} is not supported; write one number a point, or 3 or 4 of type UInt8",
                components.escape_debug(),
                name.escape_debug()
            )));
        }
    })
}

fn of_text(text: &[u8], number: Number, bytes: usize) -> Result<Vec<u8>, FormatError> {
    super::nrrd::text(text, number, bytes as u64)
}

/// The encoding of binary arrays.
#[derive(Clone, Copy)]
struct ArrayEncoding<'a> {
    is_big: bool,
    /// Whether lengths have 8 bytes instead of 4.
    wide: bool,
    is_packed: bool,
    /// Bytes of the array.
    bytes: usize,
    reading: &'a Reading<'a>,
}

impl ArrayEncoding<'_> {
    /// Returns the bytes of an array.
    fn array(&self, array: Node, number: Number, appended: &[u8]) -> Result<Vec<u8>, FormatError> {
        let inline = || array.text().unwrap_or_default().as_bytes();
        match array.attribute("format").unwrap_or("ascii") {
            "ascii" => of_text(inline(), number, self.bytes),
            "binary" => self.of_base64(inline()),
            "appended" => self.of_appended(appended, array.attribute("offset")),
            other => Err(malformed("the XML", format!("the format `{}`", other.escape_debug()))),
        }
    }

    fn of_appended(&self, appended: &[u8], offset: Option<&str>) -> Result<Vec<u8>, FormatError> {
        let faulty = |what: &str| malformed("the appended data", what);
        let end =
            appended.iter().position(|b| *b == b'>').ok_or_else(|| faulty("it is missing"))?;
        let tag = String::from_utf8_lossy(&appended[..end]);
        let data = &appended[end + 1..];
        let begin =
            data.iter().position(|b| !b.is_ascii_whitespace()).filter(|at| data[*at] == b'_');
        let data = &data[begin.ok_or_else(|| faulty("it does not begin with `_`"))? + 1..];
        let offset = offset.unwrap_or("0").trim().parse::<usize>().ok();
        let data = offset.and_then(|offset| data.get(offset..));
        let data = data.ok_or_else(|| faulty("the array begins behind its end"))?;
        match tag.contains("\"base64\"") || tag.contains("'base64'") {
            true => {
                let end = data.iter().position(|b| *b == b'<').unwrap_or(data.len());
                self.of_base64(&data[..end])
            }
            false => self.of_bytes(data),
        }
    }

    fn of_base64(&self, text: &[u8]) -> Result<Vec<u8>, FormatError> {
        let wrong = || malformed("the array", "a character is not base64");
        let text: Vec<u8> = text.iter().copied().filter(|c| !c.is_ascii_whitespace()).collect();
        let word = if self.wide { 8 } else { 4 };
        if !self.is_packed {
            // Some writers encode the length separately, which padding after it shows.
            let own = base64::characters(word);
            let (length, rest) = match text.get(own - 1) {
                Some(b'=') => text.split_at(own),
                _ => (&[][..], &text[..]),
            };
            let mut data = base64::decode(length, word).ok_or_else(wrong)?;
            data.extend(base64::decode(rest, self.bytes + word).ok_or_else(wrong)?);
            return self.of_bytes(&data);
        }
        // The lengths of the blocks are encoded separately.
        let count = self.length(&base64::decode(&text, word).ok_or_else(wrong)?, 0)?;
        let lengths = count.checked_add(3).and_then(|n| n.checked_mul(word));
        let lengths =
            lengths.filter(|n| *n <= text.len()).ok_or_else(|| cut(self.bytes as u64, 0))?;
        let mut data = base64::decode(&text, lengths).ok_or_else(wrong)?;
        let behind = text.get(base64::characters(lengths)..).unwrap_or_default();
        data.extend(base64::decode(behind, usize::MAX).ok_or_else(wrong)?);
        self.of_bytes(&data)
    }

    /// Returns the length at a position, counted in lengths.
    fn length(&self, data: &[u8], place: usize) -> Result<usize, FormatError> {
        let word = if self.wide { 8 } else { 4 };
        let bytes = place.checked_mul(word).and_then(|at| data.get(at..)?.get(..word));
        let bytes =
            bytes.ok_or_else(|| malformed("the array", "it ends in the lengths of its blocks"))?;
        let mut own = [0; 8];
        own[..word].copy_from_slice(bytes);
        if self.is_big {
            own[..word].reverse();
        }
        usize::try_from(u64::from_le_bytes(own))
            .map_err(|_| malformed("the array", "a length of over 2^64"))
    }

    fn of_bytes(&self, data: &[u8]) -> Result<Vec<u8>, FormatError> {
        let word = if self.wide { 8 } else { 4 };
        if !self.is_packed {
            let found = data.len().saturating_sub(word);
            let said = self.length(data, 0)?;
            if said != self.bytes || found < self.bytes {
                return Err(cut(self.bytes as u64, said.min(found) as u64));
            }
            return Ok(data[word..word + self.bytes].to_vec());
        }
        let count = self.length(data, 0)?;
        let mut at = count.checked_add(3).and_then(|n| n.checked_mul(word)).unwrap_or(usize::MAX);
        let mut out = Vec::new();
        self.reading.progress.begin("unpacking");
        for block in 0..count {
            if out.len() >= self.bytes {
                break;
            }
            let length = self.length(data, 3 + block)?;
            let packed = data.get(at..).and_then(|rest| rest.get(..length));
            let packed = packed.ok_or_else(|| malformed("the array", "it ends in a block"))?;
            // Never more than the array has.
            let most = (self.bytes - out.len()) as u64;
            let unpacked = ZlibDecoder::new(packed).take(most).read_to_end(&mut out);
            unpacked.map_err(|error| malformed("a block of the array", error.to_string()))?;
            at += length;
            self.reading.progress.advance(out.len() as f32 / self.bytes.max(1) as f32);
            go_on(self.reading.progress)?;
        }
        self.reading.progress.end();
        if out.len() != self.bytes {
            return Err(cut(self.bytes as u64, out.len() as u64));
        }
        Ok(out)
    }
}
