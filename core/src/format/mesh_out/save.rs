//! Saves a sculpture as a mesh: checks the request against the capabilities of the format, makes the mesh, and has the
//! format's writer stream it to the file.
//!
//! Takes contents, [`MeshOptions`] and a path; gives a summary of the written mesh. Knows formats only by their
//! descriptions.

use std::fmt;
use std::path::Path;

use glam::Vec3;

use super::{FileTransform, MeshExport, MeshWriter};
use crate::format::options::MeshOptions;
use crate::format::{FormatError, list};
use crate::mesh::{
    Budget, ContentsVersion, Mesh, MeshCache, MeshError, MeshKind, VertexColours, simplified,
};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::{Contents, SurfaceKind};

/// Summary of a written mesh.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshSummary {
    /// Number of distinct vertices.
    pub vertices: u64,
    /// Number of triangles.
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

/// Returns the surface of a mesh that looks like the displayed sculpture.
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

/// Saves as [`save_mesh`] does, reusing the mesh of the previous version from `cache`, and leaving this one there.
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
    let (format, MeshWriter { write, traits }) =
        list::mesh_export(path).ok_or_else(list::not_a_mesh)?;
    if traits.is_up_fixed && options.up.is_some_and(|up| up != traits.up) {
        return Err(FormatError::FixedUp { extension: format.extension(), up: traits.up });
    }
    if options.points_only && !traits.holds_points {
        return Err(list::no_points());
    }
    let space = FileTransform::of(contents, traits, options)?;
    if contents.grid.opaque_count() == 0 {
        return Err(FormatError::NoSurface);
    }
    let mut mesh =
        make(if traits.has_colours { VertexColours::Voxels } else { VertexColours::None })?;
    if let Some(triangles) = options.triangles {
        mesh = simplified(mesh, triangles, limits, progress)?;
    }
    let job = MeshExport { mesh: &mesh, space, options, budget: Budget::new(limits), progress };
    progress.begin("writing");
    let written = write(&job, path);
    progress.end();
    written?;
    let [low, high] = job.bounds();
    Ok(MeshSummary {
        vertices: mesh.vertex_count(),
        triangles: if options.points_only { 0 } else { mesh.triangle_count() },
        size_mm: high - low,
    })
}
