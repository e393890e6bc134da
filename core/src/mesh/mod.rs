//! Triangle meshes of a sculpture: closed surfaces around its voxels.
//!
//! Every mesh is watertight and 2-manifold: each edge has two triangles of opposite directions, and the triangles
//! around a vertex form one fan. Voxels that touch only in an edge or a corner are separated (`contact`): the surfaces
//! have vertices of their own there. Meshes at the voxels' faces move these apart by [`GAP_VX`], so that this also
//! holds for files that store only positions; apart from that, their volume is the number of voxels.
//!
//! Slabs of the lattice of voxel corners are meshed independently (`slab`), so a mesh consists of parts and is the same
//! for any number of threads. Takes contents, returns a [`Mesh`] in grid coordinates; knows no files, no units.

mod budget;
mod cache;
mod contact;
mod greedy;
mod kept;
mod layer;
mod place;
mod rows;
mod simplify;
mod slab;
#[cfg(test)]
pub(crate) mod tests;

use glam::Vec3;
use rayon::prelude::*;

use self::budget::StagePieces;
use self::place::{AtCorners, OnSurface, VertexPlacement};
use self::rows::VoxelRows;
use self::slab::Slab;
use crate::progress::Progress;
use crate::refusal::OverBudget;
use crate::sculpture::history::Contents;
use crate::sculpture::{GridError, Limits, Rgb};
use crate::shade::{LevelSet, SmoothField};

pub(crate) use self::budget::Budget;
pub use self::cache::MeshCache;
pub use self::kept::{ContentsVersion, KeptMesh};
pub use self::place::GAP_VX;
pub use self::simplify::simplified;

/// Layers of the lattice in a part: a multiple of the brick edge.
const PART_LAYERS: u32 = 16;

/// The surface that a mesh follows.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum MeshKind {
    /// Each exposed face of a voxel.
    Faces,
    /// The exposed faces, merged to rectangles where they are coplanar.
    Greedy,
    /// The smooth surface that pictures show.
    #[default]
    Smooth,
}

impl MeshKind {
    /// All values with their names in the text form.
    pub const NAMED: [(MeshKind, &'static str); 3] =
        [(MeshKind::Faces, "faces"), (MeshKind::Greedy, "greedy"), (MeshKind::Smooth, "smooth")];
}

/// The colours of the vertices of a mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum VertexColours {
    /// Those of the voxels, if any voxel has a colour of its own.
    #[default]
    Voxels,
    /// None, for files without colours: faces are merged across colours, and less memory is needed.
    None,
}

impl VertexColours {
    /// Returns whether the vertices of a mesh of `contents` have colours.
    fn are_in(self, contents: &Contents) -> bool {
        self == VertexColours::Voxels && contents.material.page_count() > 0
    }
}

/// Why there is no mesh.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// [`Progress::is_cancelled`] returned true.
    #[error("the work was cancelled")]
    Cancelled,
    /// More vertices than a mesh can index.
    #[error(
        "the mesh would have {0} vertices, more than the 2^32 that it can number; export a smaller part of the sculpture"
    )]
    TooLarge(u64),
    /// The mesh, or simplifying it, would take more memory than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The smooth surface does not fit into memory.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// Some vertices of a mesh, and faces.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct MeshPart {
    /// Positions of the vertices in grid coordinates.
    pub positions: Vec<Vec3>,
    /// Their colours; empty if all have the colour of the mesh.
    pub colours: Vec<Rgb>,
    /// Faces of four vertices, counter-clockwise from outside. Indices count from the part's first vertex and may refer
    /// to vertices of later parts.
    pub quads: Vec<[u32; 4]>,
    /// Faces of three vertices.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the first vertex in the mesh.
    pub first_vertex: u32,
}

impl MeshPart {
    /// Removes all vertices and faces; keeps the memory.
    fn clear(&mut self) {
        self.positions.clear();
        self.colours.clear();
        self.quads.clear();
        self.triangles.clear();
    }

    fn heap_bytes(&self) -> u64 {
        let bytes = self.positions.capacity() * size_of::<Vec3>()
            + self.colours.capacity() * size_of::<Rgb>()
            + self.quads.capacity() * size_of::<[u32; 4]>()
            + self.triangles.capacity() * size_of::<[u32; 3]>();
        bytes as u64
    }
}

/// A closed surface.
#[derive(Clone, PartialEq, Debug)]
pub struct Mesh {
    /// The parts in the order of their vertices.
    pub parts: Vec<MeshPart>,
    /// The colour of vertices without one of their own.
    pub base: Rgb,
}

impl Mesh {
    /// Meshes `contents`. The smooth surface is computed first, within `limits`.
    pub fn of(
        contents: &Contents,
        kind: MeshKind,
        colours: VertexColours,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<Mesh, MeshError> {
        match kind {
            MeshKind::Faces => Mesh::placed(contents, &AtCorners, colours, limits, progress),
            MeshKind::Greedy => greedy::mesh(contents, colours, limits, progress),
            MeshKind::Smooth => {
                // Smoothing takes longer than counting.
                Budget::new(limits)
                    .check_for(bytes_of_faces(contents, colours.are_in(contents)))?;
                let mut smoothing = SmoothField::new(&contents.grid, limits)?;
                if !smoothing.update(&contents.grid, None, progress) {
                    return Err(MeshError::Cancelled);
                }
                Mesh::smooth(contents, smoothing.levels(), colours, limits, progress)
            }
        }
    }

    /// Returns the mesh of a given smooth surface.
    pub fn smooth(
        contents: &Contents,
        levels: &LevelSet,
        colours: VertexColours,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<Mesh, MeshError> {
        let place = OnSurface::new(&contents.grid, levels);
        Mesh::placed(contents, &place, colours, limits, progress)
    }

    fn placed(
        contents: &Contents,
        place: &impl VertexPlacement,
        colours: VertexColours,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<Mesh, MeshError> {
        progress.begin("making the mesh");
        let coloured = colours.are_in(contents);
        let slab = Slab { contents, place, coloured };
        let end = contents.grid.dims().z + 1;
        let starts: Vec<u32> = (0..end).step_by(PART_LAYERS as usize).collect();
        let (budget, pieces) =
            (Budget::new(limits), StagePieces::new(progress, [0.0, 1.0], starts.len()));
        let part = |&start: &u32| {
            if progress.is_cancelled() {
                return None;
            }
            let part = slab.part(start..(start + PART_LAYERS).min(end), &budget);
            pieces.one();
            part
        };
        let parts: Option<Vec<MeshPart>> = starts.par_iter().map(part).collect();
        progress.end();
        if progress.is_cancelled() {
            return Err(MeshError::Cancelled);
        }
        let Some(parts) = parts else {
            budget.check_for(bytes_of_faces(contents, coloured))?;
            budget.check()?;
            return Err(MeshError::Cancelled);
        };
        Mesh::joined(parts, contents.material.base())
    }

    /// Returns a mesh of parts whose faces count from their own vertices.
    fn joined(mut parts: Vec<MeshPart>, base: Rgb) -> Result<Mesh, MeshError> {
        let count: u64 = parts.iter().map(|part| part.positions.len() as u64).sum();
        if count > u64::from(u32::MAX) {
            return Err(MeshError::TooLarge(count));
        }
        let mut first = 0;
        for part in &mut parts {
            part.first_vertex = first;
            first += part.positions.len() as u32;
        }
        Ok(Mesh { parts, base })
    }

    /// Returns the number of vertices.
    pub(crate) fn vertex_count(&self) -> u64 {
        self.parts.iter().map(|part| part.positions.len() as u64).sum()
    }

    /// Returns the number of triangles; a quad counts as two.
    pub(crate) fn triangle_count(&self) -> u64 {
        self.parts.iter().map(|part| (2 * part.quads.len() + part.triangles.len()) as u64).sum()
    }

    /// Returns whether vertices have colours of their own.
    pub fn is_coloured(&self) -> bool {
        self.parts.iter().any(|part| !part.colours.is_empty())
    }

    /// Returns the position of a vertex.
    pub fn position(&self, vertex: u32) -> Vec3 {
        let part = self.part_of(vertex);
        part.positions[(vertex - part.first_vertex) as usize]
    }

    fn part_of(&self, vertex: u32) -> &MeshPart {
        let after = self.parts.partition_point(|part| part.first_vertex <= vertex);
        &self.parts[after - 1]
    }

    /// Returns the positions of all vertices.
    pub fn positions(&self) -> impl Iterator<Item = Vec3> {
        self.parts.iter().flat_map(|part| part.positions.iter().copied())
    }

    /// Returns the colours of all vertices.
    pub fn colours(&self) -> impl Iterator<Item = Rgb> {
        self.parts.iter().flat_map(|part| {
            let own = part.colours.iter().copied();
            let missing = part.positions.len() - part.colours.len();
            own.chain(std::iter::repeat_n(self.base, missing))
        })
    }

    /// Returns the triangles by the indices of their vertices, counter-clockwise from outside.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        (0..self.parts.len()).flat_map(|part| self.triangles_of(part))
    }

    /// Returns the triangles of a part. Quads are split along their shorter diagonal.
    pub(crate) fn triangles_of(&self, part: usize) -> impl Iterator<Item = [u32; 3]> {
        let (number, part) = (part, &self.parts[part]);
        let first = part.first_vertex;
        let position = move |vertex: u32| match part.positions.get(vertex as usize) {
            Some(position) => *position,
            None => self.position_beyond(number, vertex),
        };
        let quads = part.quads.iter().flat_map(move |&[a, b, c, d]| {
            let ac = position(a).distance_squared(position(c));
            let bd = position(b).distance_squared(position(d));
            if ac <= bd { [[a, b, c], [a, c, d]] } else { [[b, c, d], [b, d, a]] }
        });
        let triangles = quads.chain(part.triangles.iter().copied());
        triangles.map(move |triangle| triangle.map(|vertex| first + vertex))
    }

    /// Returns the position of a vertex of a later part, by its index in `part`.
    #[cold]
    fn position_beyond(&self, part: usize, vertex: u32) -> Vec3 {
        self.position(self.parts[part].first_vertex + vertex)
    }

    /// Returns the enclosed volume, in voxels.
    pub fn volume_vx(&self) -> f64 {
        let sums = (0..self.parts.len()).into_par_iter().map(|part| {
            let corners = |[a, b, c]: [u32; 3]| [a, b, c].map(|v| self.position(v).as_dvec3());
            let volume = |[a, b, c]: [glam::DVec3; 3]| a.dot(b.cross(c)) / 6.0;
            self.triangles_of(part).map(|triangle| volume(corners(triangle))).sum::<f64>()
        });
        sums.collect::<Vec<_>>().into_iter().sum()
    }

    /// Returns the bytes in memory.
    pub fn heap_bytes(&self) -> u64 {
        self.parts.iter().map(MeshPart::heap_bytes).sum()
    }
}

/// Adds a face of any number of vertices, as a fan of triangles from the first if there are more than four.
fn push_polygon(part: &mut MeshPart, vertices: &[u32]) {
    if let &[a, b, c, d] = vertices {
        part.quads.push([a, b, c, d]);
        return;
    }
    part.triangles.extend(vertices[1..].windows(2).map(|pair| [vertices[0], pair[0], pair[1]]));
}

/// Returns the bytes of a mesh with a face for each exposed face of a voxel, and about as many vertices.
fn bytes_of_faces(contents: &Contents, coloured: bool) -> u64 {
    let end = contents.grid.dims().z + 1;
    let starts: Vec<u32> = (0..end).step_by(PART_LAYERS as usize).collect();
    let faces = starts.par_iter().map(|&start| {
        let layers = start..(start + PART_LAYERS).min(end);
        let rows =
            VoxelRows::of(&contents.grid, i64::from(layers.start) - 1..i64::from(layers.end));
        rows.faces(layers) as u64
    });
    faces.sum::<u64>() * slab::bytes_of_face(coloured)
}
