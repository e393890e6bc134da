//! Binary .stl: triangles with their normals, and nothing else. The header says so, and the unit.

use std::io::Write;
use std::path::Path;

use super::{MeshExport, count_of, create, finish};
use crate::format::FormatError;

/// Must not begin with "solid", as text files do.
const HEADER: &[u8] = b"Binary STL of Virtual Sculpture, millimetres";

pub fn write(job: &MeshExport, path: &Path) -> Result<(), FormatError> {
    let mut header = [b' '; 80];
    header[..HEADER.len()].copy_from_slice(HEADER);
    let count = count_of(job.mesh.triangle_count(), u64::from(u32::MAX))?;
    let mut file = create(path)?;
    file.write_all(&header)?;
    file.write_all(&count.to_le_bytes())?;
    let mut steps = job.steps(0, 1);
    for triangle in job.mesh.triangles() {
        let corners = triangle.map(|vertex| job.space.place(job.mesh.position(vertex)));
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let mut bytes = [0; 50];
        let vectors = [normal, a, b, c];
        let coordinates = vectors.iter().flat_map(|v| v.to_array());
        for (to, coordinate) in bytes.chunks_exact_mut(4).zip(coordinates) {
            to.copy_from_slice(&coordinate.to_le_bytes());
        }
        file.write_all(&bytes)?;
        steps.step()?;
    }
    finish(file)
}
