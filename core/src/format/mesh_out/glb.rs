//! Binary glTF 2.0: one mesh in metres, y up, with colours of vertices in linear light (`COLOR_0`, 16 bits a channel)
//! and, on smooth surfaces, normals. Without normals, viewers shade triangles flat, as those of voxels should be.

use std::io::Write;
use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use super::{MeshExport, Steps, create, finish, linear, put_vector};
use crate::format::FormatError;
use crate::mesh::MeshKind;
use crate::sculpture::Rgb;

const METRES_PER_MM: f32 = 1e-3;
/// "glTF", "JSON" and "BIN".
const MAGIC: u32 = 0x4654_6C67;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;
const VERSION: u32 = 2;
/// Component types.
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
/// Targets of buffer views, which state the use of a part of the buffer.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The parts of the buffer and their contents.
#[derive(Default)]
struct BufferLayout {
    views: Vec<Value>,
    accessors: Vec<Value>,
    bytes: u64,
}

impl BufferLayout {
    /// Adds a part of `count` elements of `size` bytes; returns its number.
    fn add(&mut self, count: u64, size: u64, target: u32, mut accessor: Value) -> usize {
        let number = self.views.len();
        let length = count * size;
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes, "byteLength": length, "target": target
        }));
        accessor["bufferView"] = json!(number);
        self.accessors.push(accessor);
        self.bytes += length;
        number
    }
}

pub fn write(job: &MeshExport, path: &Path) -> Result<(), FormatError> {
    let mesh = job.mesh;
    let has_normals = job.options.kind == MeshKind::Smooth;
    // Normals take a pass over the triangles, and are vectors of the vertices like positions and colours.
    let (normal_passes, colour_passes) = (u64::from(has_normals), u64::from(mesh.is_coloured()));
    let mut steps = job.steps(1 + normal_passes + colour_passes, 1 + normal_passes);
    let normals = if has_normals { Some(normals(job, &mut steps)?) } else { None };
    let (json, buffer_bytes) = description(job, has_normals);
    let all = 12 + 8 + json.len() as u64 + 8 + buffer_bytes;
    let too_large = |_| FormatError::TooLargeForGlb(all);
    let (all, bytes) = (u32::try_from(all).map_err(too_large)?, buffer_bytes as u32);

    let mut file = create(path)?;
    for word in [MAGIC, VERSION, all, json.len() as u32, JSON_CHUNK] {
        file.write_all(&word.to_le_bytes())?;
    }
    file.write_all(&json)?;
    for word in [bytes, BINARY_CHUNK] {
        file.write_all(&word.to_le_bytes())?;
    }
    for position in mesh.positions() {
        put_vector(&mut file, place(job, position))?;
        steps.step()?;
    }
    for normal in normals.into_iter().flatten() {
        put_vector(&mut file, normal)?;
        steps.step()?;
    }
    if mesh.is_coloured() {
        put_colours(job, &mut file, &mut steps)?;
    }
    for triangle in mesh.triangles() {
        let mut bytes = [0; 12];
        for (to, vertex) in bytes.chunks_exact_mut(4).zip(triangle) {
            to.copy_from_slice(&vertex.to_le_bytes());
        }
        file.write_all(&bytes)?;
        steps.step()?;
    }
    finish(file)
}

/// Returns the position of a vertex in the file.
#[inline(always)]
fn place(job: &MeshExport, position: Vec3) -> Vec3 {
    job.space.place(position) * METRES_PER_MM
}

/// Returns the JSON part of a file, and the length of the buffer that it describes.
fn description(job: &MeshExport, has_normals: bool) -> (Vec<u8>, u64) {
    let mesh = job.mesh;
    let (vertices, indices) = (mesh.vertex_count(), 3 * mesh.triangle_count());
    let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let places = mesh.positions().map(|position| place(job, position));
    let [low, high] = places.fold(start, |[low, high], p| [low.min(p), high.max(p)]);
    let mut layout = BufferLayout::default();
    let positions = json!({
        "componentType": FLOAT, "count": vertices, "type": "VEC3",
        "min": low.to_array(), "max": high.to_array()
    });
    let mut attributes = json!({ "POSITION": layout.add(vertices, 12, VERTICES, positions) });
    if has_normals {
        let accessor = json!({ "componentType": FLOAT, "count": vertices, "type": "VEC3" });
        attributes["NORMAL"] = json!(layout.add(vertices, 12, VERTICES, accessor));
    }
    if mesh.is_coloured() {
        let accessor = json!({
            "componentType": UNSIGNED_SHORT, "normalized": true, "count": vertices, "type": "VEC4"
        });
        attributes["COLOR_0"] = json!(layout.add(vertices, 8, VERTICES, accessor));
    }
    let accessor = json!({ "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR" });
    let indices = layout.add(indices, 4, INDICES, accessor);
    let base = if mesh.is_coloured() { [1.0; 3] } else { mesh.base.0.map(linear) };
    let [r, g, b] = base;
    let json = json!({
        "asset": { "version": "2.0", "generator": "Virtual Sculpture" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "sculpture" }],
        "meshes": [{ "primitives": [
            { "attributes": attributes, "indices": indices, "material": 0 }
        ] }],
        "materials": [{ "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8
        } }],
        "buffers": [{ "byteLength": layout.bytes }],
        "bufferViews": layout.views,
        "accessors": layout.accessors
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    (json, layout.bytes)
}

/// Writes the colours of the vertices, opaque and in linear light.
fn put_colours(
    job: &MeshExport,
    file: &mut impl Write,
    steps: &mut Steps,
) -> Result<(), FormatError> {
    let table: Vec<[u8; 2]> = (0..=u8::MAX)
        .map(|channel| ((linear(channel) * 65535.0 + 0.5) as u16).to_le_bytes())
        .collect();
    for Rgb(colour) in job.mesh.colours() {
        let mut bytes = [0xFF; 8];
        for (to, channel) in bytes.chunks_exact_mut(2).zip(colour) {
            to.copy_from_slice(&table[channel as usize]);
        }
        file.write_all(&bytes)?;
        steps.step()?;
    }
    Ok(())
}

/// Returns the normals of the vertices: area-weighted means of the triangles' normals.
fn normals(job: &MeshExport, steps: &mut Steps) -> Result<Vec<Vec3>, FormatError> {
    let mesh = job.mesh;
    job.need_bytes_a_vertex(size_of::<Vec3>())?;
    let mut normals = vec![Vec3::ZERO; mesh.vertex_count() as usize];
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| job.space.place(mesh.position(vertex)));
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&vertex| normals[vertex as usize] += normal);
        steps.step()?;
    }
    for normal in &mut normals {
        *normal = normal.normalize_or(Vec3::Y);
    }
    Ok(normals)
}
