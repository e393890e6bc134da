//! Reads `.stl`, as text and binary: triangles without colours.

use glam::Vec3;

use super::imported::{Imported, MeshReader, at_line, number};
use crate::format::FormatError;
use crate::format::mesh_out::{self, MeshTraits, MeshWriter};
use crate::format::options::MeshUp;
use crate::format::spec::{Export, FormatSpec, Import, Sign};
use crate::sculpture::orientation::Up;
use crate::voxelise::InputMesh;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::Exact(has_length_of_binary), Sign::Word(b"solid ")],
    write: Some(Export::Mesh(MeshWriter {
        write: mesh_out::stl::write,
        traits: MeshTraits { has_colours: false, ..MeshTraits::new(MeshUp::Z) },
    })),
    exported_as: Some("Print (STL)"),
    ..FormatSpec::new(
        "a mesh",
        &["stl"],
        Import::Mesh(MeshReader::new(Up::Z, |file| read(file.bytes))),
    )
};

/// Size of the start of a binary file: a header of any text and the number of triangles.
const HEADER_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

/// Number of bytes within which a text must have a facet, or its end.
const BEGINNING_BYTES: usize = 1 << 12;
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Reads a file. A binary one may begin with the word of text files, so its length decides first, and then whether
/// words of a text follow. Words are case-insensitive.
fn read(file: &[u8]) -> Result<Imported, FormatError> {
    let count = file.get(HEADER_BYTES - 4..HEADER_BYTES);
    let count = count.map(|n| u64::from(u32::from_le_bytes([n[0], n[1], n[2], n[3]])));
    let expected = count.map(|count| HEADER_BYTES as u64 + count * TRIANGLE_BYTES as u64);
    let is_text = is_text(file);
    let length = file.len() as u64;
    match (count, expected) {
        (Some(_), Some(expected)) if expected == length || !is_text && expected < length => {
            let mut imported = binary(&file[HEADER_BYTES..expected as usize]);
            if expected < length {
                let behind = length - expected;
                imported
                    .notes
                    .push(format!("{behind} bytes behind the last triangle were left out"));
            }
            Ok(imported)
        }
        _ if is_text => text(file),
        (Some(count), _) => Err(FormatError::Malformed {
            place: format!("byte {}", HEADER_BYTES - 4),
            what: format!("{count} triangles should follow, but the file has only {length} bytes"),
        }),
        _ => Err(FormatError::Malformed {
            place: "byte 0".to_string(),
            what: "this is neither a binary STL file nor one that begins with `solid`".to_string(),
        }),
    }
}

/// Returns whether the length is that of a binary file with the number of triangles that it states. Its header may
/// begin with anything.
fn has_length_of_binary(start: &[u8], length: u64) -> bool {
    let count = start.get(HEADER_BYTES - 4..).and_then(|rest| rest.first_chunk());
    let count = count.map_or(0, |count| u64::from(u32::from_le_bytes(*count)));
    count > 0 && HEADER_BYTES as u64 + count * TRIANGLE_BYTES as u64 == length
}

/// Returns whether a file begins as a text does: with its first word, followed soon by one that no header of a binary
/// file has, or by text only.
fn is_text(file: &[u8]) -> bool {
    let text = file.strip_prefix(BYTE_ORDER_MARK).unwrap_or(file).trim_ascii_start();
    let begins = text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let start = text[..text.len().min(BEGINNING_BYTES)].to_ascii_lowercase();
    let holds = |word: &[u8]| start.windows(word.len()).any(|part| part == word);
    let is_printable = || start.iter().all(|byte| *byte >= b' ' || byte.is_ascii_whitespace());
    begins && (holds(b"facet") || holds(b"endsolid") || is_printable())
}

fn binary(triangles: &[u8]) -> Imported {
    let mut mesh = InputMesh::default();
    for triangle in triangles.as_chunks::<TRIANGLE_BYTES>().0 {
        // The normal comes first, and two bytes without an agreed meaning last.
        let (numbers, _) = triangle[12..48].as_chunks::<4>();
        let at = |i: usize| f32::from_le_bytes(numbers[i]);
        push(&mut mesh, [0, 3, 6].map(|i| Vec3::new(at(i), at(i + 1), at(i + 2))));
    }
    Imported { mesh, kind: "STL, binary".to_string(), ..Imported::default() }
}

fn push(mesh: &mut InputMesh, corners: [Vec3; 3]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}

fn text(file: &[u8]) -> Result<Imported, FormatError> {
    let mut mesh = InputMesh::default();
    let mut corners = Vec::new();
    let mut is_ended = false;
    let text = String::from_utf8_lossy(file.strip_prefix(BYTE_ORDER_MARK).unwrap_or(file));
    for (line, words) in text.lines().enumerate() {
        let mut words = words.split_ascii_whitespace();
        let mut word = words.next().unwrap_or("").to_ascii_lowercase();
        if word == "end" {
            word.push_str(&words.next().unwrap_or("").to_ascii_lowercase());
        }
        match word.as_str() {
            "vertex" => {
                let mut next = || number(words.next(), line);
                corners.push(Vec3::new(next()?, next()?, next()?));
            }
            "endfacet" => match corners[..] {
                [a, b, c] => {
                    push(&mut mesh, [a, b, c]);
                    corners.clear();
                }
                _ => {
                    let found = corners.len();
                    return Err(at_line(line, format!("a facet has {found} corners, not three")));
                }
            },
            "endsolid" => is_ended = true,
            _ => {}
        }
    }
    if !is_ended || !corners.is_empty() {
        return Err(at_line(
            text.lines().count().saturating_sub(1),
            "the file ends before its solid",
        ));
    }
    Ok(Imported { mesh, kind: "STL, text".to_string(), ..Imported::default() })
}
