//! Converts a mesh of coloured triangles to a sculpture: a solid if the mesh encloses a volume, else a shell.
//!
//! Rays along x, y and z through the centres of all voxels are intersected with the triangles (`crossings`), in
//! integers, so that a closed mesh is never entered without being left. Each ray becomes spans of voxels (`spans`),
//! which are handled as rows of bits. Rays that pass through a hole are ignored; if there are any, the three directions
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

use thiserror::Error;

pub use self::frame::{MeshPlacement, MeshSize, bounds};
pub use self::mesh::{InputMesh, Skin};
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

/// Makes a sculpture of a mesh.
pub fn to_contents(
    mesh: &InputMesh,
    frame: &MeshPlacement,
    fill: Fill,
    depth: ColourDepth,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Contents, Findings), VoxeliseError> {
    let go_on = || if progress.is_cancelled() { Err(VoxeliseError::Cancelled) } else { Ok(()) };
    Grid::check(frame.dims, frame.voxel_size, limits.grid_bytes)?;
    let placed = frame.place(mesh)?;
    let budget_bytes = limits.grid_bytes.saturating_add(limits.colour_bytes);
    let needed = placed.crossings_at_most() * 24 + 3 * solid::bytes(frame.dims);
    check_memory(needed, budget_bytes)?;
    progress.begin("cutting rays");
    let mut rays = Vec::new();
    for axis in 0..3 {
        go_on()?;
        progress.advance(axis as f32 / 3.0);
        rays.push(placed.cross(axis));
    }
    progress.end();
    progress.begin("filling the grid");
    let open_share = spans::open_share(&rays);
    let mut is_shell = fill == Fill::Shell || fill == Fill::Auto && open_share > OPEN_SHARE;
    let mut bits = Vec::new();
    if !is_shell {
        bits = solid::fill(&rays, frame.dims, open_share > 0.0);
        // Sheets that lie back to back enclose nothing.
        is_shell = bits.iter().all(|word| *word == 0);
    }
    go_on()?;
    if is_shell {
        bits = solid::shell(&rays, frame.dims);
    }
    progress.advance(0.5);
    let mut grid = Grid::new(frame.dims, frame.voxel_size, limits.grid_bytes)?;
    solid::pour(&bits, &mut grid);
    drop(bits);
    progress.end();
    go_on()?;
    let base = mesh.only_colour().unwrap_or(Rgb::STONE);
    let mut material = Material::for_grid(&grid, depth, base);
    if depth != ColourDepth::None && mesh.has_colours() && mesh.only_colour().is_none() {
        let painter = paint::Painter { mesh, placed: &placed, rays: &rays, is_shell };
        painter.paint(&grid, &mut material, limits.colour_bytes, progress)?;
    }
    Ok((Contents::new(grid, material), Findings { open_share, is_shell }))
}
