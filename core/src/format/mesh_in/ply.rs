//! Reads `.ply`: polygons with colours of corners or faces, as text or binary in either byte order.

use glam::Vec3;

use super::imported::{Imported, MeshReader, at_line};
use super::ply_header::{self, Element, PlyEncoding, PlyHeader, Scalar};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::error::excerpt;
use crate::format::mesh_out::{self, MeshTraits, MeshWriter};
use crate::format::options::MeshUp;
use crate::format::spec::{Export, FormatSpec, Import, Sign};
use crate::sculpture::Rgb;
use crate::sculpture::orientation::Up;
use crate::voxelise::InputMesh;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, b"ply\n"), Sign::At(0, b"ply\r")],
    write: Some(Export::Mesh(MeshWriter {
        write: mesh_out::ply::write,
        traits: MeshTraits { holds_points: true, ..MeshTraits::new(MeshUp::Z) },
    })),
    exported_as: Some("Mesh (PLY)"),
    ..FormatSpec::new(
        "a mesh",
        &["ply"],
        Import::Mesh(MeshReader::new(Up::Z, |file| read(file.bytes))),
    )
};

/// Names of the three channels of a colour.
const CHANNELS: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

/// Reads a file.
fn read(file: &[u8]) -> Result<Imported, FormatError> {
    let header = ply_header::read(file)?;
    let mut values = Values::new(&header, file);
    values.find_lines(&header);
    let mut mesh = InputMesh::default();
    let mut corner_colours = Vec::new();
    let mut face_colours = Vec::new();
    for element in &header.elements {
        // Each element takes at least a byte; otherwise the number would be unbounded.
        if element.count > values.bytes.rest().len() as u64 {
            let (count, name) = (element.count, &element.name);
            return Err(values.bytes.fault(format!("{count} times {name:?} cannot follow")));
        }
        match element.name.as_str() {
            "vertex" => vertices(element, &mut values, &mut mesh, &mut corner_colours)?,
            "face" => faces(element, &mut values, &mut mesh, &mut face_colours)?,
            "tristrips" => strips(element, &mut values, &mut mesh)?,
            _ => (0..element.count).try_for_each(|_| values.skip(element))?,
        }
    }
    let count = mesh.positions.len();
    if let Some(corner) = mesh.triangles.iter().flatten().find(|c| **c as usize >= count) {
        return Err(values.bytes.fault(format!("a face names corner {corner} of {count}")));
    }
    if !face_colours.is_empty() {
        mesh.corner_colours = face_colours.into_iter().map(|rgb| [rgb; 3]).collect();
    } else if !corner_colours.is_empty() {
        let rgb = |corner: u32| corner_colours[corner as usize];
        mesh.corner_colours = mesh.triangles.iter().map(|t| t.map(rgb)).collect();
    }
    let encoding = match header.encoding {
        PlyEncoding::Text => "text",
        PlyEncoding::Little => "binary, little-endian",
        PlyEncoding::Big => "binary, big-endian",
    };
    let undeclared = values.undeclared;
    let note =
        format!("values that the header does not declare, which were left out: {undeclared}");
    let notes = if undeclared > 0 { vec![note] } else { Vec::new() };
    Ok(Imported { mesh, kind: format!("PLY, {encoding}"), notes, ..Imported::default() })
}

/// Returns the positions of the properties with these names.
fn places<const N: usize>(element: &Element, names: [&str; N]) -> Option<[usize; N]> {
    let of =
        |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
    let places = names.map(of);
    places.iter().all(Option::is_some).then(|| places.map(Option::unwrap_or_default))
}

/// Returns a function that reads the colour among the values of an element.
fn colour_of(element: &Element) -> Option<impl Fn(&[f64]) -> Rgb + use<>> {
    let places = CHANNELS.iter().find_map(|names| places(element, *names))?;
    let full = places.map(|place| element.properties[place].scalar.full());
    Some(move |values: &[f64]| {
        Rgb([0, 1, 2].map(|c| (values[places[c]] / full[c] * 255.0).round() as u8))
    })
}

fn vertices(
    element: &Element,
    values: &mut Values<'_>,
    mesh: &mut InputMesh,
    colours: &mut Vec<Rgb>,
) -> Result<(), FormatError> {
    let missing = || values.bytes.fault("the vertices have no x, y and z");
    let [x, y, z] = places(element, ["x", "y", "z"]).ok_or_else(missing)?;
    let colour = colour_of(element);
    let mut row = Vec::new();
    for _ in 0..element.count {
        values.element(element, &mut row, None)?;
        mesh.positions.push(Vec3::new(row[x] as f32, row[y] as f32, row[z] as f32));
        colours.extend(colour.as_ref().map(|colour| colour(&row)));
    }
    Ok(())
}

fn faces(
    element: &Element,
    values: &mut Values<'_>,
    mesh: &mut InputMesh,
    colours: &mut Vec<Rgb>,
) -> Result<(), FormatError> {
    let is_corners = |name: &str| name == "vertex_indices" || name == "vertex_index";
    let list = element.properties.iter().position(|p| is_corners(&p.name) && p.length.is_some());
    let list = list.ok_or_else(|| values.bytes.fault("the faces have no list of corners"))?;
    let colour = colour_of(element);
    let (mut row, mut corners) = (Vec::new(), Vec::new());
    for _ in 0..element.count {
        corners.clear();
        values.element(element, &mut row, Some((list, &mut corners)))?;
        let numbers = corners.iter().map(|corner| (*corner >= 0.0).then_some(*corner as u32));
        let Some(numbers) = numbers.collect::<Option<Vec<u32>>>() else {
            return Err(values.bytes.fault("a face names a corner below 0"));
        };
        for pair in numbers.get(1..).unwrap_or_default().windows(2) {
            mesh.triangles.push([numbers[0], pair[0], pair[1]]);
            colours.extend(colour.as_ref().map(|colour| colour(&row)));
        }
    }
    Ok(())
}

/// Reads triangle strips, concatenated in a list; -1 ends a strip. Each triangle shares an edge with the previous one.
fn strips(
    element: &Element,
    values: &mut Values<'_>,
    mesh: &mut InputMesh,
) -> Result<(), FormatError> {
    let list = element.properties.iter().position(|p| p.length.is_some());
    let list = list.ok_or_else(|| values.bytes.fault("the strips have no list of corners"))?;
    let (mut row, mut corners) = (Vec::new(), Vec::new());
    for _ in 0..element.count {
        corners.clear();
        values.element(element, &mut row, Some((list, &mut corners)))?;
        for strip in corners.split(|corner| *corner < 0.0) {
            for (i, own) in strip.windows(3).enumerate() {
                let [a, b, c] = [own[0], own[1], own[2]].map(|corner| corner as u32);
                // A degenerate triangle only connects two strips.
                if a != b && b != c && a != c {
                    mesh.triangles.push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
    }
    Ok(())
}

/// The numbers after the header.
struct Values<'a> {
    bytes: Bytes<'a>,
    encoding: PlyEncoding,
    line: usize,
    /// Whether each element of a text has its own line, as it should; otherwise values are read as a stream.
    has_lines: bool,
    /// Number of extra values after those of an element on its line.
    undeclared: usize,
}

impl<'a> Values<'a> {
    fn new(header: &PlyHeader, file: &'a [u8]) -> Values<'a> {
        let mut bytes = Bytes::new(file);
        // The header is present, so that this cannot fail.
        let _ = bytes.take(header.bytes);
        let (encoding, line) = (header.encoding, header.lines);
        Values { bytes, encoding, line, has_lines: false, undeclared: 0 }
    }

    /// Determines whether the text has a line for each element.
    fn find_lines(&mut self, header: &PlyHeader) {
        if self.encoding == PlyEncoding::Text {
            let lines = self.bytes.rest().split(|byte| *byte == b'\n');
            let filled = lines.filter(|line| !line.trim_ascii().is_empty()).count() as u64;
            let elements = header.elements.iter().fold(0u64, |n, own| n.saturating_add(own.count));
            self.has_lines = filled >= elements;
        }
    }

    /// Skips the rest of the line.
    fn end_line(&mut self) {
        let rest = self.bytes.rest();
        let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        let behind = &rest[..end];
        let words = behind.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        self.undeclared += words.count();
        // At least as many bytes remain.
        let _ = self.bytes.take(end);
    }

    /// Returns the values of the next element, with 0 for lists; those of the list `wanted` are written to its vector.
    fn element(
        &mut self,
        element: &Element,
        row: &mut Vec<f64>,
        mut wanted: Option<(usize, &mut Vec<f64>)>,
    ) -> Result<(), FormatError> {
        row.clear();
        for (place, property) in element.properties.iter().enumerate() {
            let Some(length) = property.length else {
                row.push(self.value(property.scalar)?);
                continue;
            };
            let count = self.value(length)?;
            let left = self.bytes.rest().len();
            let least =
                if self.encoding == PlyEncoding::Text { 1 } else { property.scalar.bytes() };
            if !(count >= 0.0 && count * least as f64 <= left as f64) {
                return Err(self.bytes.fault(format!("a list of {count} cannot follow")));
            }
            for _ in 0..count as usize {
                let value = self.value(property.scalar)?;
                if let Some((_, list)) = wanted.as_mut().filter(|(wanted, _)| *wanted == place) {
                    list.push(value);
                }
            }
            row.push(0.0);
        }
        if self.has_lines {
            self.end_line();
        }
        Ok(())
    }

    fn skip(&mut self, element: &Element) -> Result<(), FormatError> {
        self.element(element, &mut Vec::new(), None)
    }

    fn value(&mut self, scalar: Scalar) -> Result<f64, FormatError> {
        let is_big = match self.encoding {
            PlyEncoding::Text => return self.word(),
            encoding => encoding == PlyEncoding::Big,
        };
        let mut raw = [0; 8];
        let count = scalar.bytes();
        raw[..count].copy_from_slice(self.bytes.take(count)?);
        if is_big {
            raw[..count].reverse();
        }
        let [a, b, c, d, ..] = raw;
        Ok(match scalar {
            Scalar::I8 => f64::from(a as i8),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(raw),
        })
    }

    /// Parses the next word of a text as a number.
    fn word(&mut self) -> Result<f64, FormatError> {
        let rest = self.bytes.rest();
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
        self.line += self.bytes.take(start)?.iter().filter(|byte| **byte == b'\n').count();
        let rest = self.bytes.rest();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = self.bytes.take(end)?;
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        let line = self.line;
        value.ok_or_else(|| match word {
            [] => at_line(line, "the file ends before its last element"),
            word => at_line(line, format!("`{}` is not a number", excerpt(word))),
        })
    }
}
