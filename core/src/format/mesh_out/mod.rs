//! Writes meshes for other programs: .stl, .ply, .obj with .mtl, .glb and .3mf.
//!
//! Takes contents and [`MeshOptions`]; makes the mesh, simplifies it if wanted, and streams it to the file piece by piece, so that it is in
//! memory once. Lengths are millimetres but in .glb, whose unit is the metre. A file appears when it is complete.

mod glb;
mod obj;
mod ply;
mod stl;
#[cfg(test)]
mod tests;
mod three_mf;

use std::fmt;
use std::io::{BufWriter, Write};
use std::path::Path;

use glam::{Mat3, Vec3};

use super::options::{MeshOptions, MeshUp};
use super::store::AtomicFile;
use super::{FormatError, go_on};
use crate::mesh::{
    Budget, ContentsVersion, Mesh, MeshCache, MeshError, MeshKind, VertexColours, simplified,
};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::{Contents, SurfaceKind};

/// Vertices or triangles between two looks at whether the work is cancelled.
const PORTION: usize = 1 << 16;
/// Bytes that are collected before they are written.
const BUFFER_BYTES: usize = 1 << 20;

/// Summary of a mesh that was written.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshSummary {
    /// Vertices, each once.
    pub vertices: u64,
    /// Triangles.
    pub triangles: u64,
    /// Extent of the mesh along the axes of the file.
    pub size_mm: Vec3,
}

impl fmt::Display for MeshSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Vec3 { x, y, z } = self.size_mm;
        let (triangles, vertices) = (self.triangles, self.vertices);
        write!(f, "{triangles} triangles, {vertices} vertices, {x:.1}x{y:.1}x{z:.1} mm")
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum MeshFormat {
    Stl,
    Ply,
    Obj,
    Glb,
    ThreeMf,
}

impl MeshFormat {
    fn of(path: &Path) -> Option<MeshFormat> {
        match path.extension()?.to_string_lossy().to_ascii_lowercase().as_str() {
            "stl" => Some(MeshFormat::Stl),
            "ply" => Some(MeshFormat::Ply),
            "obj" => Some(MeshFormat::Obj),
            "glb" => Some(MeshFormat::Glb),
            "3mf" => Some(MeshFormat::ThreeMf),
            _ => None,
        }
    }

    /// Triangles in .stl have no colours.
    fn colours(self) -> VertexColours {
        match self {
            MeshFormat::Stl => VertexColours::None,
            _ => VertexColours::Voxels,
        }
    }

    fn usual_up(self) -> MeshUp {
        match self {
            MeshFormat::Obj | MeshFormat::Glb => MeshUp::Y,
            MeshFormat::Stl | MeshFormat::Ply | MeshFormat::ThreeMf => MeshUp::Z,
        }
    }
}

/// Whether a file of that name is a mesh.
pub fn is_mesh(path: &Path) -> bool {
    MeshFormat::of(path).is_some()
}

/// The axis that points up in a mesh of that name unless another is asked for; none if it is no mesh.
pub fn usual_up(path: &Path) -> Option<MeshUp> {
    MeshFormat::of(path).map(MeshFormat::usual_up)
}

/// The surface of a mesh that looks as the sculpture is shown.
pub fn usual_surface(shown: SurfaceKind) -> MeshKind {
    match shown {
        SurfaceKind::Smooth => MeshKind::Smooth,
        SurfaceKind::Cubes => MeshKind::Greedy,
    }
}

/// Writes a sculpture as a mesh, atomically.
pub fn save_mesh(
    path: &Path,
    contents: &Contents,
    options: &MeshOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<MeshSummary, FormatError> {
    let make = |colours| Mesh::of(contents, options.kind, colours, limits, progress);
    save_made(path, contents, options, limits, progress, make)
}

/// [`save_mesh`], with what `cache` has of the mesh of the version before, and leaving this one there.
pub fn save_mesh_again(
    path: &Path,
    contents: &Contents,
    options: &MeshOptions,
    limits: &Limits,
    (cache, version): (&MeshCache, &ContentsVersion),
    progress: &dyn Progress,
) -> Result<MeshSummary, FormatError> {
    let cache = cache.at(version);
    let make = |colours| cache.mesh_of(contents, options.kind, colours, limits, progress);
    save_made(path, contents, options, limits, progress, make)
}

fn save_made(
    path: &Path,
    contents: &Contents,
    options: &MeshOptions,
    limits: &Limits,
    progress: &dyn Progress,
    make: impl Fn(VertexColours) -> Result<Mesh, MeshError>,
) -> Result<MeshSummary, FormatError> {
    let format = MeshFormat::of(path).ok_or(FormatError::NotAMeshFile)?;
    if format == MeshFormat::Glb && options.up == Some(MeshUp::Z) {
        return Err(FormatError::UpOfGlb);
    }
    if options.points_only && format != MeshFormat::Ply {
        return Err(FormatError::PointsInPlyOnly);
    }
    let space = Space::of(contents, format, options)?;
    if contents.grid.opaque_count() == 0 {
        return Err(FormatError::NoSurface);
    }
    let mut mesh = make(format.colours())?;
    if let Some(triangles) = options.triangles {
        mesh = simplified(mesh, triangles, limits, progress)?;
    }
    let job = Job { mesh: &mesh, space, options, budget: Budget::new(limits), progress };
    progress.begin("writing");
    let written = match format {
        MeshFormat::Stl => stl::write(&job, path),
        MeshFormat::Ply => ply::write(&job, path),
        MeshFormat::Obj => obj::write(&job, path),
        MeshFormat::Glb => glb::write(&job, path),
        MeshFormat::ThreeMf => three_mf::write(&job, path),
    };
    progress.end();
    written?;
    let [low, high] = job.bounds();
    Ok(MeshSummary {
        vertices: mesh.vertex_count(),
        triangles: if options.points_only { 0 } else { mesh.triangle_count() },
        size_mm: high - low,
    })
}

/// From grid coordinates to the coordinates of a file, in millimetres.
#[derive(Clone, Copy, Debug)]
struct Space {
    turn_and_scale: Mat3,
    offset: Vec3,
}

impl Space {
    fn of(
        contents: &Contents,
        format: MeshFormat,
        options: &MeshOptions,
    ) -> Result<Space, FormatError> {
        let mut voxel_mm = contents.grid.voxel_size();
        if let Some(length) = options.voxel_mm {
            if !length.is_finite() || length <= 0.0 {
                return Err(FormatError::VoxelMillimetres(length));
            }
            voxel_mm *= length / voxel_mm.x;
        }
        let scale = Mat3::from_diagonal(voxel_mm);
        Ok(match options.up.unwrap_or(format.usual_up()) {
            MeshUp::Y => Space { turn_and_scale: scale, offset: Vec3::ZERO },
            // A quarter turn about x; the grid stays where coordinates are positive.
            MeshUp::Z => Space {
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
struct Job<'a> {
    mesh: &'a Mesh,
    space: Space,
    options: &'a MeshOptions,
    budget: Budget,
    progress: &'a dyn Progress,
}

impl Job<'_> {
    /// An error if there is no room for so many bytes for each vertex beside the mesh.
    fn need_bytes_a_vertex(&self, bytes: usize) -> Result<(), FormatError> {
        let needed = self.mesh.heap_bytes() + self.mesh.vertex_count() * bytes as u64;
        Ok(self.budget.check_for(needed)?)
    }

    /// Positions of the vertices, in millimetres.
    fn positions(&self) -> impl Iterator<Item = Vec3> {
        self.mesh.positions().map(|position| self.space.place(position))
    }

    /// The lowest and highest coordinates.
    fn bounds(&self) -> [Vec3; 2] {
        let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        self.positions().fold(start, |[low, high], p| [low.min(p), high.max(p)])
    }

    /// The work of going through vertices and triangles so many times.
    fn steps(&self, vertex_passes: u64, triangle_passes: u64) -> Steps<'_> {
        let all =
            vertex_passes * self.mesh.vertex_count() + triangle_passes * self.mesh.triangle_count();
        Steps { progress: self.progress, done: 0, all: all.max(1), until_report: PORTION }
    }
}

/// Counts what is written, to report progress and to stop when cancelled.
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

/// Begins a file.
fn create(path: &Path) -> Result<BufWriter<AtomicFile>, FormatError> {
    Ok(BufWriter::with_capacity(BUFFER_BYTES, AtomicFile::create(path)?))
}

/// Ends a file: it gets its name.
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

/// The count as 32 bits; an error if it does not fit.
fn count_of(count: u64, most: u64) -> Result<u32, FormatError> {
    match u32::try_from(count) {
        Ok(number) if count <= most => Ok(number),
        _ => Err(FormatError::TooLargeForMesh(count)),
    }
}

/// A channel of sRGB in linear light, 0 to 1.
fn linear(channel: u8) -> f32 {
    let value = f32::from(channel) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
