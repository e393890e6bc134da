//! 3MF, the format of printers: a zip archive with the mesh as XML, in millimetres. Colours of vertices are a colour
//! group of the materials extension, which programs that do not support it skip.

use std::collections::HashMap;
use std::io::{BufWriter, Error, ErrorKind, Result, Seek, SeekFrom, Write};
use std::path::Path;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::{BUFFER_BYTES, MeshExport, create, finish};
use crate::format::FormatError;
use crate::sculpture::Rgb;

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;
const MODEL: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<metadata name="Application">Virtual Sculpture</metadata>
<resources>
"#;
const END: &str = r#"</triangles></mesh></object>
</resources>
<build><item objectid="1"/></build>
</model>
"#;
/// Id of the colours; 1 is the object.
const COLOURS_ID: u32 = 2;
/// Upper bound of the bytes of a vertex or triangle in XML, to determine whether the archive needs 64-bit sizes.
const ELEMENT_BYTES: u64 = 96;

/// A writer that accepts everything and stores nothing after its first error. An archive abandoned because of the error
/// is finished when it is dropped, and a failure then would be printed.
struct UntilError<W> {
    file: W,
    /// Position of the next byte, written or discarded.
    at: u64,
    has_failed: bool,
}

impl<W> UntilError<W> {
    fn new(file: W) -> UntilError<W> {
        UntilError { file, at: 0, has_failed: false }
    }

    /// Performs `action` on the file, or returns `pretended` after an error.
    fn with<T>(&mut self, pretended: T, action: impl FnOnce(&mut W) -> Result<T>) -> Result<T> {
        if self.has_failed {
            return Ok(pretended);
        }
        let result = action(&mut self.file);
        let is_error = |error: &Error| error.kind() != ErrorKind::Interrupted;
        self.has_failed = result.as_ref().err().is_some_and(is_error);
        result
    }
}

impl<W: Write> Write for UntilError<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let taken = self.with(bytes.len(), |file| file.write(bytes))?;
        self.at += taken as u64;
        Ok(taken)
    }

    fn flush(&mut self) -> Result<()> {
        self.with((), |file| file.flush())
    }
}

impl<W: Seek> Seek for UntilError<W> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let pretended = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(by) | SeekFrom::End(by) => self.at.saturating_add_signed(by),
        };
        self.at = self.with(pretended, |file| file.seek(to))?;
        Ok(self.at)
    }
}

pub fn write(job: &MeshExport, path: &Path) -> std::result::Result<(), FormatError> {
    let mesh = job.mesh;
    let elements = mesh.vertex_count() + mesh.triangle_count();
    let options = SimpleFileOptions::default()
        .large_file(elements.saturating_mul(ELEMENT_BYTES) > u64::from(u32::MAX) / 2);
    let mut zip = ZipWriter::new(UntilError::new(create(path)?));
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(name, options).map_err(Error::from)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options).map_err(Error::from)?;
    // Compressed in large pieces.
    let mut model = BufWriter::with_capacity(BUFFER_BYTES, &mut zip);
    model.write_all(MODEL.as_bytes())?;

    let mut steps = job.steps(1 + u64::from(mesh.is_coloured()), 1);
    // The number of each vertex's colour, among the distinct ones.
    let mut numbers: HashMap<Rgb, u32> = HashMap::new();
    let mut colours = Vec::new();
    if mesh.is_coloured() {
        // As if all colours were distinct.
        job.need_bytes_a_vertex(size_of::<u32>() + 2 * size_of::<(Rgb, u32)>())?;
        write!(model, "<m:colorgroup id=\"{COLOURS_ID}\">")?;
        colours.reserve_exact(mesh.vertex_count() as usize);
        for colour in mesh.colours() {
            let next = numbers.len() as u32;
            let number = *numbers.entry(colour).or_insert(next);
            if number == next {
                let Rgb([r, g, b]) = colour;
                write!(model, "<m:color color=\"#{r:02X}{g:02X}{b:02X}FF\"/>")?;
            }
            colours.push(number);
            steps.step()?;
        }
        writeln!(model, "</m:colorgroup>")?;
    }
    write!(model, "<object id=\"1\" type=\"model\" name=\"sculpture\"><mesh><vertices>")?;
    for position in job.positions() {
        let [x, y, z] = position.to_array();
        writeln!(model, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")?;
        steps.step()?;
    }
    write!(model, "</vertices><triangles>")?;
    for [a, b, c] in mesh.triangles() {
        write!(model, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"")?;
        if !colours.is_empty() {
            let [p, q, r] = [a, b, c].map(|vertex| colours[vertex as usize]);
            write!(model, " pid=\"{COLOURS_ID}\" p1=\"{p}\" p2=\"{q}\" p3=\"{r}\"")?;
        }
        writeln!(model, "/>")?;
        steps.step()?;
    }
    model.write_all(END.as_bytes())?;
    model.flush()?;
    drop(model);
    let end = zip.finish().map_err(Error::from)?;
    match end.has_failed {
        true => Err(Error::other("a part of the archive could not be written").into()),
        false => finish(end.file),
    }
}
