//! Converts a mesh of coloured triangles to a sculpture: a solid if the mesh encloses a volume, else a shell.
//!
//! Rays along x, y and z through the centres of all voxels are intersected with the triangles (`crossings`), in
//! integers, so that a closed mesh is never entered without being left. Each ray becomes spans of voxels (`spans`),
//! which are handled as rows of bits, layer by layer (`solid`): the grid takes memory for its surface alone. Rays that pass through a hole are ignored; if there are any, the three directions
//! vote. Surface voxels take the colour of the nearest triangle that crosses beside them (`paint`). The result is the
//! same for any number of threads. Knows no files.

mod crossings;
mod frame;
mod mesh;
mod paint;
mod solid;
mod spans;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use thiserror::Error;

use self::crossings::{PlacedMesh, TriangleSlabs};

pub use self::frame::{MeshPlacement, MeshSize, bounds};
pub use self::mesh::{InputMesh, Skin};
use self::spans::inside;
use crate::progress::Progress;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::history::Contents;
use crate::sculpture::{ColourDepth, Grid, GridError, Limits, Material, Rgb};

/// The share of rays through holes from which on a mesh counts as open.
const OPEN_SHARE: f64 = 0.02;

/// The filling of the inside of a mesh.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Fill {
    /// Solid; for an open mesh, only the surface.
    #[default]
    Auto,
    /// Solid, even if there are large holes.
    Solid,
    /// Only the surface, two voxels thick.
    Shell,
}

impl Fill {
    /// All values with their names in the text form.
    pub const NAMED: [(Fill, &'static str); 3] =
        [(Fill::Auto, "auto"), (Fill::Solid, "solid"), (Fill::Shell, "shell")];
}

/// The findings about a mesh.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Findings {
    /// Share of the rays through the mesh that enter it without leaving it, or vice versa: 0 for a closed one.
    pub open_share: f64,
    /// Whether only the surface was used.
    pub is_shell: bool,
}

/// Why a mesh cannot become a sculpture.
#[derive(Debug, Error)]
pub enum VoxeliseError {
    /// The grid is not possible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The work needs more memory than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The mesh has no usable triangle.
    #[error("the mesh has no triangle of finite size; export it again")]
    Nothing,
    /// More triangles than can be indexed.
    #[error("the mesh has more than the 2^26 triangles that can be read; simplify it")]
    TooManyTriangles,
    /// [`Progress::is_cancelled`] returned true.
    #[error("the work was cancelled")]
    Cancelled,
}

/// An error if `needed` bytes are more than allowed.
fn check_memory(needed: u64, budget_bytes: u64) -> Result<(), OverBudget> {
    let (what, budget) = ("the mesh at this size needs", MemoryBudget::GridsAndColours);
    let checked = OverBudget::check(what, needed, budget, budget_bytes);
    checked.map_err(|over| over.advise("choose fewer voxels"))
}

/// A mesh in its grid, to be cut by rays.
struct CutMesh<'a> {
    placed: PlacedMesh,
    /// The triangles by the slabs of each axis.
    slabs: [TriangleSlabs; 3],
    /// The most bytes of the grid.
    grid_bytes: u64,
    progress: &'a dyn Progress,
}

impl CutMesh<'_> {
    fn go_on(&self) -> Result<(), VoxeliseError> {
        if self.progress.is_cancelled() { Err(VoxeliseError::Cancelled) } else { Ok(()) }
    }

    /// Returns the share of rays through holes among all rays with crossings.
    fn open_share(&self) -> Result<f64, VoxeliseError> {
        let (mut open, mut all) = (0, 0);
        for (done, slabs) in self.slabs.iter().enumerate() {
            self.progress.advance(done as f32 / 3.0);
            let counts = (0..slabs.count()).into_par_iter().map(|slab| {
                if self.progress.is_cancelled() {
                    return (0, 0);
                }
                let rays = self.placed.cross(slabs, slab);
                rays.rays().fold((0u64, 0u64), |(open, all), ray| {
                    (open + u64::from(!inside(ray.crossings, |_, _| {})), all + 1)
                })
            });
            let (of_axis, rays) = counts.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
            (open, all) = (open + of_axis, all + rays);
            self.go_on()?;
        }
        Ok(open as f64 / all.max(1) as f64)
    }
}

/// Makes a sculpture of a mesh.
pub fn to_contents(
    mesh: &InputMesh,
    frame: &MeshPlacement,
    fill: Fill,
    depth: ColourDepth,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Contents, Findings), VoxeliseError> {
    let empty = Grid::of_size(frame.dims, frame.voxel_size)?;
    let placed = frame.place(mesh)?;
    let slabs = [0, 1, 2].map(|axis| placed.slabs(axis));
    let cut = CutMesh { placed, slabs, grid_bytes: limits.grid_bytes, progress };
    let budget_bytes = limits.grid_bytes.saturating_add(limits.colour_bytes);
    let lists: u64 = cut.slabs.iter().map(TriangleSlabs::bytes).sum();
    check_memory(lists, budget_bytes)?;
    progress.begin("cutting rays");
    let open_share = cut.open_share()?;
    progress.end();
    progress.begin("filling the grid");
    let mut is_shell = fill == Fill::Shell || fill == Fill::Auto && open_share > OPEN_SHARE;
    let has_holes = open_share > 0.0;
    let mut grid = empty.clone();
    if !is_shell {
        if has_holes {
            check_memory(lists + solid::bytes(&cut, true), budget_bytes)?;
        }
        grid = solid::fill(&cut, empty.clone(), has_holes)?;
        // Sheets that lie back to back enclose nothing.
        is_shell = grid.opaque_count() == 0;
    }
    if is_shell {
        check_memory(lists + solid::bytes(&cut, false), budget_bytes)?;
        grid = solid::shell(&cut, empty)?;
    }
    progress.end();
    cut.go_on()?;
    let base = mesh.only_colour().unwrap_or(Rgb::STONE);
    let mut material = Material::for_grid(&grid, depth, base);
    if depth != ColourDepth::None && mesh.has_colours() && mesh.only_colour().is_none() {
        let painter = paint::Painter { mesh, cut: &cut, is_shell };
        painter.paint(&grid, &mut material, limits.colour_bytes)?;
    }
    Ok((Contents::new(grid, material), Findings { open_share, is_shell }))
}
