//! Wavefront .obj with its .mtl. Colours of vertices are three further numbers of their `v` lines (`v x y z r g b`, 0
//! to 1, sRGB), which MeshLab and Blender read; others use the one colour of the material.

use std::io::Write;
use std::path::Path;

use super::{MeshExport, create, finish};
use crate::format::{FormatError, store};
use crate::sculpture::Rgb;

pub fn write(job: &MeshExport, path: &Path) -> Result<(), FormatError> {
    let mesh = job.mesh;
    let library = path.with_extension("mtl");
    let mut file = create(path)?;
    let name = library.file_name().map(|name| name.to_string_lossy().into_owned());
    writeln!(file, "# Virtual Sculpture, millimetres")?;
    writeln!(file, "mtllib {}", name.unwrap_or_default())?;
    writeln!(file, "o sculpture")?;
    let mut steps = job.steps(1, 1);
    let is_coloured = mesh.is_coloured();
    for (position, Rgb(colour)) in job.positions().zip(mesh.colours()) {
        let [x, y, z] = position.to_array();
        match is_coloured {
            true => {
                let [r, g, b] = colour.map(|channel| f32::from(channel) / 255.0);
                writeln!(file, "v {x} {y} {z} {r:.4} {g:.4} {b:.4}")?;
            }
            false => writeln!(file, "v {x} {y} {z}")?,
        }
        steps.step()?;
    }
    writeln!(file, "usemtl sculpture")?;
    for triangle in mesh.triangles() {
        // Indices count from 1.
        let [a, b, c] = triangle.map(|vertex| u64::from(vertex) + 1);
        writeln!(file, "f {a} {b} {c}")?;
        steps.step()?;
    }
    // Written first, so that a complete .obj has its colours.
    let base = if is_coloured { Rgb::new(255, 255, 255) } else { mesh.base };
    let [r, g, b] = base.0.map(|channel| f32::from(channel) / 255.0);
    let material = format!("# Virtual Sculpture\nnewmtl sculpture\nKd {r:.4} {g:.4} {b:.4}\n");
    store::write_atomically(&library, material.as_bytes())?;
    finish(file)
}
