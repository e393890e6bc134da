//! Binary .ply: vertices with colours, and triangles; or the vertices alone.

use std::io::Write;
use std::path::Path;

use super::{MeshExport, count_of, create, finish, put_vector};
use crate::format::FormatError;
use crate::sculpture::Rgb;

pub fn write(job: &MeshExport, path: &Path) -> Result<(), FormatError> {
    let mesh = job.mesh;
    // Indices are signed, as readers expect.
    let vertices = count_of(mesh.vertex_count(), i32::MAX as u64)?;
    let mut file = create(path)?;
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment Virtual Sculpture, millimetres\n\
         element vertex {vertices}\n\
         property float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n"
    )?;
    if !job.options.points_only {
        let triangles = mesh.triangle_count();
        write!(file, "element face {triangles}\nproperty list uchar int vertex_indices\n")?;
    }
    writeln!(file, "end_header")?;
    let mut steps = job.steps(1, u64::from(!job.options.points_only));
    for (position, Rgb(colour)) in job.positions().zip(mesh.colours()) {
        put_vector(&mut file, position)?;
        file.write_all(&colour)?;
        steps.step()?;
    }
    if !job.options.points_only {
        for triangle in mesh.triangles() {
            let mut bytes = [3; 13];
            for (to, vertex) in bytes[1..].chunks_exact_mut(4).zip(triangle) {
                to.copy_from_slice(&vertex.to_le_bytes());
            }
            file.write_all(&bytes)?;
            steps.step()?;
        }
    }
    finish(file)
}
