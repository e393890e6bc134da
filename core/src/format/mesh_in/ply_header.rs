//! Parses the header of a `.ply`: the elements that follow, their number, and their properties.

use super::imported::at_line;
use crate::format::FormatError;

/// Greatest length of a header.
const LIMIT_BYTES: usize = 1 << 20;

/// The encoding of numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PlyEncoding {
    Text,
    Little,
    Big,
}

/// The type of a number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Scalar> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// Returns the value of this type that represents full colour.
    pub fn full(self) -> f64 {
        match self {
            Scalar::I8 | Scalar::U8 => 255.0,
            Scalar::I16 | Scalar::U16 => 65535.0,
            Scalar::I32 | Scalar::U32 => 255.0,
            Scalar::F32 | Scalar::F64 => 1.0,
        }
    }
}

/// A property of an element.
#[derive(Clone, PartialEq, Debug)]
pub struct Property {
    pub name: String,
    pub scalar: Scalar,
    /// The type of its length, if it is a list.
    pub length: Option<Scalar>,
}

/// A kind of element.
#[derive(Clone, PartialEq, Debug)]
pub struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// A header.
#[derive(Debug)]
pub struct PlyHeader {
    pub encoding: PlyEncoding,
    pub elements: Vec<Element>,
    /// Length in bytes and in lines.
    pub bytes: usize,
    pub lines: usize,
}

/// Reads the header at the start of a file.
pub fn read(file: &[u8]) -> Result<PlyHeader, FormatError> {
    if !file.starts_with(b"ply") {
        return Err(at_line(0, "a PLY file begins with `ply`"));
    }
    let mut header =
        PlyHeader { encoding: PlyEncoding::Text, elements: Vec::new(), bytes: 0, lines: 0 };
    loop {
        let rest = &file[header.bytes..];
        let line = header.lines;
        let end = rest.iter().take(LIMIT_BYTES).position(|byte| *byte == b'\n');
        let end = end.ok_or_else(|| at_line(line, "the header has no line end_header"))?;
        header.bytes += end + 1;
        header.lines += 1;
        let text = String::from_utf8_lossy(&rest[..end]);
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let scalar = |name: &str| {
            let unknown = || at_line(line, format!("the type {name:?} is not known"));
            Scalar::named(name).ok_or_else(unknown)
        };
        match words[..] {
            ["end_header"] => return Ok(header),
            ["format", encoding, ..] => {
                header.encoding = match encoding {
                    "ascii" => PlyEncoding::Text,
                    "binary_little_endian" => PlyEncoding::Little,
                    "binary_big_endian" => PlyEncoding::Big,
                    _ => {
                        return Err(at_line(line, format!("the format {encoding:?} is not known")));
                    }
                };
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| at_line(line, "the number is not one"))?;
                let (name, properties) = (name.to_string(), Vec::new());
                header.elements.push(Element { name, count, properties });
            }
            ["property", "list", length, kind, name] => {
                let (length, scalar) = (Some(scalar(length)?), scalar(kind)?);
                push(&mut header, Property { name: name.to_string(), scalar, length }, line)?;
            }
            ["property", kind, name] => {
                let scalar = scalar(kind)?;
                push(&mut header, Property { name: name.to_string(), scalar, length: None }, line)?;
            }
            ["element" | "property", ..] => return Err(at_line(line, "the line is incomplete")),
            _ => {}
        }
    }
}

fn push(header: &mut PlyHeader, property: Property, line: usize) -> Result<(), FormatError> {
    let element = header.elements.last_mut();
    let element = element.ok_or_else(|| at_line(line, "a property before the first element"))?;
    element.properties.push(property);
    Ok(())
}
