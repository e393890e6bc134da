//! Reads Wavefront `.obj`: polygons with texture coordinates, colours of corners, and materials.
//!
//! Lines of other kinds (normals, groups, curves) are skipped; invalid faces and texture coordinates are left out, with
//! a note.

use std::borrow::Cow;
use std::path::Path;

use glam::{Vec2, Vec3};

use super::imported::{Imported, MeshReader, at_line, number};
use super::mtl::Materials;
use crate::format::FormatError;
use crate::format::error::excerpt;
use crate::format::mesh_out::{self, MeshTraits, MeshWriter};
use crate::format::options::MeshUp;
use crate::format::spec::{Export, FormatSpec, Import};
use crate::sculpture::Rgb;
use crate::sculpture::orientation::Up;

pub static SPEC: FormatSpec = FormatSpec {
    write: Some(Export::Mesh(MeshWriter {
        write: mesh_out::obj::write,
        traits: MeshTraits::new(MeshUp::Y),
    })),
    exported_as: Some("Mesh (OBJ)"),
    ..FormatSpec::new(
        "a mesh",
        &["obj"],
        Import::Mesh(MeshReader::new(Up::Y, |file| read(file.bytes, file.path))),
    )
};

/// No material.
const NONE: u32 = u32::MAX;

#[derive(Default)]
struct ObjReader {
    out: Imported,
    uvs: Vec<Vec2>,
    /// Colours of positions; none is white.
    colours: Vec<[f32; 3]>,
    has_colours: bool,
    has_uvs: bool,
    materials: Materials,
    material: u32,
    /// Number of faces with fewer than three corners, and of corners whose texture coordinate is missing.
    flat_faces: usize,
    missing_uvs: usize,
}

/// Reads the file of `path`, with materials and textures from its folder or below only.
fn read(file: &[u8], path: &Path) -> Result<Imported, FormatError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut reader = ObjReader { material: NONE, ..ObjReader::default() };
    let text = String::from_utf8_lossy(file);
    for (line, words) in whole_lines(&text) {
        let mut words = words.split_ascii_whitespace();
        match words.next() {
            Some("v") => reader.position(words, line)?,
            Some("vt") => {
                let uv = Vec2::new(
                    number(words.next(), line)?,
                    number(words.next().or(Some("0")), line)?,
                );
                reader.uvs.push(uv);
            }
            Some("f") => reader.face(words, line)?,
            Some("mtllib") => {
                reader.materials.load_all(&words.collect::<Vec<_>>().join(" "), folder);
            }
            Some("usemtl") => {
                let name = words.collect::<Vec<_>>().join(" ");
                reader.material = reader.materials.number(&name).unwrap_or(NONE);
            }
            _ => {}
        }
    }
    if reader.has_uvs && reader.materials.is_unasked() && reader.materials.beside(path) {
        // The only skin is that of all faces.
        reader.out.mesh.skin_of.fill(0);
    }
    Ok(reader.finish())
}

impl ObjReader {
    fn position<'a>(
        &mut self,
        mut words: impl Iterator<Item = &'a str>,
        line: usize,
    ) -> Result<(), FormatError> {
        let mut next = || number(words.next(), line);
        self.out.mesh.positions.push(Vec3::new(next()?, next()?, next()?));
        // The position is followed by a weight, or a colour.
        let rest: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
        let colour = match rest[..] {
            [r, g, b] | [_, r, g, b] => {
                self.has_colours = true;
                [r, g, b]
            }
            _ => [1.0; 3],
        };
        self.colours.push(colour);
        Ok(())
    }

    fn face<'a>(
        &mut self,
        words: impl Iterator<Item = &'a str>,
        line: usize,
    ) -> Result<(), FormatError> {
        let mut corners = Vec::new();
        for word in words {
            let mut parts = word.split('/');
            let position = index(parts.next(), self.out.mesh.positions.len(), line)?;
            let uv = match parts.next().filter(|part| !part.is_empty()) {
                Some(part) => match index(Some(part), self.uvs.len(), line) {
                    Ok(at) => {
                        self.has_uvs = true;
                        self.uvs[at as usize]
                    }
                    // The shape does not depend on it.
                    Err(_) => {
                        self.missing_uvs += 1;
                        Vec2::ZERO
                    }
                },
                None => Vec2::ZERO,
            };
            corners.push((position, uv));
        }
        if corners.len() < 3 {
            self.flat_faces += 1;
            return Ok(());
        }
        let mesh = &mut self.out.mesh;
        for pair in corners[1..].windows(2) {
            let [a, b, c] = [corners[0], pair[0], pair[1]];
            mesh.triangles.push([a.0, b.0, c.0]);
            mesh.corner_uvs.push([a.1, b.1, c.1]);
            mesh.skin_of.push(self.material);
        }
        Ok(())
    }

    fn finish(self) -> Imported {
        let Imported { mut mesh, mut notes, .. } = self.out;
        mesh.skins = self.materials.skins;
        notes.extend(self.materials.notes);
        if self.flat_faces > 0 {
            let count = self.flat_faces;
            notes.push(format!("faces of fewer than three corners, which were left out: {count}"));
        }
        if self.missing_uvs > 0 {
            let count = self.missing_uvs;
            notes.push(format!(
                "corners whose place in the texture is not in the file, and whose colours were left out: {count}"
            ));
        }
        if self.has_colours {
            // Some programs write levels of 0 to 255.
            let levels = self.colours.iter().flatten().any(|level| *level > 1.0);
            let scale = if levels { 1.0 } else { 255.0 };
            let rgb = |corner: u32| {
                Rgb(self.colours[corner as usize].map(|level| (level * scale).round() as u8))
            };
            mesh.corner_colours = mesh.triangles.iter().map(|t| t.map(rgb)).collect();
            // The colour of a material without a texture is then only a default.
            mesh.skins.iter_mut().for_each(|skin| skin.colour = Rgb::new(255, 255, 255));
        }
        if mesh.skin_of.iter().all(|skin| *skin == NONE) {
            mesh.skin_of = Vec::new();
        }
        if !self.has_uvs && mesh.skins.iter().all(|skin| skin.texture.is_none()) {
            mesh.corner_uvs = Vec::new();
        }
        Imported { mesh, kind: "Wavefront OBJ".to_string(), notes, of: None }
    }
}

/// Returns the lines of a text with their numbers from 0. A line that ends with `\` continues in the next.
fn whole_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut lines = text.strip_prefix('\u{FEFF}').unwrap_or(text).lines().enumerate();
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut whole = Cow::Borrowed(line);
        while let Some(before) = whole.trim_end().strip_suffix('\\') {
            let mut before = before.to_string();
            let Some((_, next)) = lines.next() else {
                whole = Cow::Owned(before);
                break;
            };
            before.push(' ');
            before.push_str(next);
            whole = Cow::Owned(before);
        }
        Some((number, whole))
    })
}

/// Returns a zero-based index: files count from 1, or backwards from -1.
fn index(text: Option<&str>, count: usize, line: usize) -> Result<u32, FormatError> {
    let text = text.unwrap_or("");
    let at = text.parse::<i64>().ok().and_then(|n| match n {
        1.. => Some(n - 1),
        0 => None,
        _ => Some(n + count as i64),
    });
    let at = at.filter(|at| (0..count as i64).contains(at)).and_then(|at| u32::try_from(at).ok());
    at.ok_or_else(|| {
        let shown = excerpt(text.as_bytes());
        at_line(line, format!("`{shown}` names none of the {count} that stand before"))
    })
}
