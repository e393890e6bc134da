//! Writes meshes for other programs: .stl, .ply, .obj with .mtl, .glb and .3mf.
//!
//! Takes contents and [`MeshOptions`]; makes the mesh, simplifies it if requested (`save.rs`), and streams it to the
//! file piece by piece, so that it is in memory once. Lengths are millimetres except in .glb, whose unit is the metre.
//! A file appears when it is complete.

pub mod glb;
pub mod obj;
pub mod ply;
pub mod save;
pub mod stl;
#[cfg(test)]
mod tests;
pub mod three_mf;

use std::io::{BufWriter, Write};
use std::path::Path;

use glam::{Mat3, Vec3};

use super::options::{MeshOptions, MeshUp};
use super::store::AtomicFile;
use super::{FormatError, go_on};
use crate::mesh::{Budget, Mesh};
use crate::progress::Progress;
use crate::refusal::InvalidValue;
use crate::sculpture::history::Contents;

/// Number of vertices or triangles between two checks for cancellation.
const PORTION: usize = 1 << 16;
/// Number of bytes that are buffered before they are written.
const BUFFER_BYTES: usize = 1 << 20;

/// The writing of meshes of a format.
pub struct MeshWriter {
    /// Writes a file, which appears when it is complete.
    pub write: fn(&MeshExport, &Path) -> Result<(), FormatError>,
    /// The capabilities of its files.
    pub traits: MeshTraits,
}

/// The capabilities of meshes of a format.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MeshTraits {
    /// The default up axis.
    pub up: MeshUp,
    /// Whether no other axis can point up.
    pub is_up_fixed: bool,
    /// Whether vertices have colours.
    pub has_colours: bool,
    /// Whether there may be vertices without triangles.
    pub holds_points: bool,
}

impl MeshTraits {
    /// Creates the traits of triangles with colours and a choice of the up axis.
    pub(super) const fn new(up: MeshUp) -> MeshTraits {
        MeshTraits { up, is_up_fixed: false, has_colours: true, holds_points: false }
    }
}

/// The map from grid coordinates to the coordinates of a file, in millimetres.
#[derive(Clone, Copy, Debug)]
struct FileTransform {
    turn_and_scale: Mat3,
    offset: Vec3,
}

impl FileTransform {
    fn of(
        contents: &Contents,
        traits: &MeshTraits,
        options: &MeshOptions,
    ) -> Result<FileTransform, FormatError> {
        let mut voxel_mm = contents.grid.voxel_size();
        if let Some(length) = options.voxel_mm {
            let is_length = length.is_finite() && length > 0.0;
            let rule = "must be positive, in millimetres";
            InvalidValue::check(is_length, "length of a voxel", rule, length)?;
            voxel_mm *= length / voxel_mm.x;
        }
        let scale = Mat3::from_diagonal(voxel_mm);
        Ok(match options.up.unwrap_or(traits.up) {
            MeshUp::Y => FileTransform { turn_and_scale: scale, offset: Vec3::ZERO },
            // A quarter turn about x; the grid stays at positive coordinates.
            MeshUp::Z => FileTransform {
                turn_and_scale: Mat3::from_cols(Vec3::X, Vec3::Z, -Vec3::Y) * scale,
                offset: Vec3::Y * (voxel_mm.z * contents.grid.dims().z as f32),
            },
        })
    }

    #[inline(always)]
    fn place(&self, position: Vec3) -> Vec3 {
        self.turn_and_scale * position + self.offset
    }
}

/// A mesh to be written.
pub struct MeshExport<'a> {
    mesh: &'a Mesh,
    space: FileTransform,
    options: &'a MeshOptions,
    budget: Budget,
    progress: &'a dyn Progress,
}

impl MeshExport<'_> {
    /// Returns an error if there is no memory for so many bytes per vertex beside the mesh.
    fn need_bytes_a_vertex(&self, bytes: usize) -> Result<(), FormatError> {
        let needed = self.mesh.heap_bytes() + self.mesh.vertex_count() * bytes as u64;
        Ok(self.budget.check_for(needed)?)
    }

    /// Returns the positions of the vertices, in millimetres.
    fn positions(&self) -> impl Iterator<Item = Vec3> {
        self.mesh.positions().map(|position| self.space.place(position))
    }

    /// Returns the lowest and highest coordinates.
    fn bounds(&self) -> [Vec3; 2] {
        let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        self.positions().fold(start, |[low, high], p| [low.min(p), high.max(p)])
    }

    /// Returns the work of passing so many times over the vertices and triangles.
    fn steps(&self, vertex_passes: u64, triangle_passes: u64) -> Steps<'_> {
        let all =
            vertex_passes * self.mesh.vertex_count() + triangle_passes * self.mesh.triangle_count();
        Steps { progress: self.progress, done: 0, all: all.max(1), until_report: PORTION }
    }
}

/// Counts written elements, to report progress and to stop when cancelled.
struct Steps<'a> {
    progress: &'a dyn Progress,
    done: u64,
    all: u64,
    until_report: usize,
}

impl Steps<'_> {
    #[inline(always)]
    fn step(&mut self) -> Result<(), FormatError> {
        self.until_report -= 1;
        if self.until_report == 0 { self.report() } else { Ok(()) }
    }

    #[cold]
    fn report(&mut self) -> Result<(), FormatError> {
        self.until_report = PORTION;
        self.done += PORTION as u64;
        self.progress.advance((self.done as f32 / self.all as f32).min(1.0));
        go_on(self.progress)
    }
}

/// Creates a file.
fn create(path: &Path) -> Result<BufWriter<AtomicFile>, FormatError> {
    Ok(BufWriter::with_capacity(BUFFER_BYTES, AtomicFile::create(path)?))
}

/// Completes a file and gives it its name.
fn finish(file: BufWriter<AtomicFile>) -> Result<(), FormatError> {
    let file = file.into_inner().map_err(|error| error.into_error())?;
    Ok(file.finish()?)
}

/// Writes the three coordinates as little-endian floats.
#[inline(always)]
fn put_vector(file: &mut impl Write, v: Vec3) -> Result<(), FormatError> {
    let mut bytes = [0; 12];
    for (to, coordinate) in bytes.chunks_exact_mut(4).zip(v.to_array()) {
        to.copy_from_slice(&coordinate.to_le_bytes());
    }
    Ok(file.write_all(&bytes)?)
}

/// Returns the count as 32 bits; an error if it does not fit.
fn count_of(count: u64, most: u64) -> Result<u32, FormatError> {
    match u32::try_from(count) {
        Ok(number) if count <= most => Ok(number),
        _ => Err(FormatError::TooLargeForMesh(count)),
    }
}

/// Converts an sRGB channel to linear, 0 to 1.
fn linear(channel: u8) -> f32 {
    let value = f32::from(channel) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
