//! The print check: finds the faults that keep a sculpture from being printed in 3D, their places, and the commands
//! that repair them.
//!
//! Checks islands, cavities, thin walls, overhangs, and the size on the bed, as slicers (PrusaSlicer) and repair
//! programs (Meshmixer) do. Takes a grid and [`CheckOptions`], returns a [`Checked`]; changes nothing and knows no
//! document. Up is y; the bed lies below the lowest voxel. All cores work, and memory is checked before it is
//! allocated.

mod overhang;
mod places;
#[cfg(test)]
mod tests;

use glam::Vec3;
use thiserror::Error;

use crate::progress::Progress;
use crate::refusal::{InvalidValue, OverBudget};
use crate::sculpture::region::{ListedBricks, VoxelBox};
use crate::sculpture::{Grid, GridError};
use crate::tools::pieces::{Pieces, PiecesOf, pieces};
use crate::tools::repair::{self, Keep, Repair, RepairError, Toward};

/// Diameter of the proposed drain holes, in millimetres: resin and powder hardly run out of smaller ones.
const DRAIN_MM: f32 = 3.0;
/// The most places of a kind that are listed; the largest ones.
pub const MOST_PLACES: usize = 1000;

/// The requirements on a print.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CheckOptions {
    /// Length of a voxel along x in millimetres; `None` for the sculpture's voxel size.
    pub voxel_mm: Option<f32>,
    /// The least thickness of walls.
    pub wall_mm: f32,
    /// The largest angle from the vertical at which surfaces need no support: 0 for none, 90 for all.
    pub overhang_deg: f32,
    /// The width of gaps that are bridged along x or z without support.
    pub bridge_mm: f32,
    /// Width (x), height (y) and depth (z) of the space above the bed.
    pub bed_mm: Vec3,
}

impl Default for CheckOptions {
    fn default() -> Self {
        CheckOptions {
            voxel_mm: None,
            wall_mm: 1.2,
            overhang_deg: 45.0,
            bridge_mm: 5.0,
            bed_mm: Vec3::new(220.0, 250.0, 220.0),
        }
    }
}

/// Why a sculpture cannot be checked.
#[derive(Debug, Error, PartialEq)]
pub enum CheckError {
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// An option breaks a rule.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
    /// The walls are too thick to measure in these voxels.
    #[error(
        "walls of {wall_mm} mm are more than 64 voxels of {voxel_mm} mm thick, which cannot be measured; \
         ask for thinner walls, or for larger voxels"
    )]
    Wall {
        /// The requested thickness.
        wall_mm: f32,
        /// The shortest edge of a voxel.
        voxel_mm: f32,
    },
    /// It takes too much memory.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// It takes too much memory.
    #[error(transparent)]
    Grid(#[from] GridError),
}

impl From<RepairError> for CheckError {
    fn from(error: RepairError) -> CheckError {
        match error {
            RepairError::Cancelled => CheckError::Cancelled,
            RepairError::Invalid(error) => CheckError::Invalid(error),
            RepairError::OverBudget(over) => CheckError::OverBudget(over),
        }
    }
}

/// A kind of problem that a print may have.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum FaultKind {
    /// Pieces that neither stand on the bed nor are connected to another piece.
    Islands,
    /// Empty regions that are not connected to the outside.
    Cavities,
    /// Walls that are thinner than required.
    ThinWalls,
    /// Surfaces that need support.
    Overhangs,
}

impl FaultKind {
    /// All, in the order of the report.
    pub const ALL: [FaultKind; 4] =
        [FaultKind::Islands, FaultKind::Cavities, FaultKind::ThinWalls, FaultKind::Overhangs];

    /// Returns its name for the user.
    pub const fn name(self) -> &'static str {
        match self {
            FaultKind::Islands => "floating pieces",
            FaultKind::Cavities => "closed cavities",
            FaultKind::ThinWalls => "thin walls",
            FaultKind::Overhangs => "overhangs",
        }
    }

    /// Returns its name for programs.
    pub const fn key(self) -> &'static str {
        match self {
            FaultKind::Islands => "islands",
            FaultKind::Cavities => "cavities",
            FaultKind::ThinWalls => "thin_walls",
            FaultKind::Overhangs => "overhangs",
        }
    }
}

/// The location of a fault.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FaultLocation {
    /// Number of voxels.
    pub voxels: u64,
    /// The smallest box around them.
    pub bounds: VoxelBox,
}

/// All problems of one kind.
#[derive(Clone, PartialEq, Debug)]
pub struct Finding {
    /// The kind of problem.
    pub kind: FaultKind,
    /// Number of places; [`Finding::places`] lists the largest.
    pub count: usize,
    /// Voxels of all places.
    pub voxels: u64,
    /// The largest first, at most [`MOST_PLACES`].
    pub places: Vec<FaultLocation>,
    /// The voxels of all places.
    pub marked: ListedBricks,
    /// The repairs, the best first. Only support material helps overhangs.
    pub repairs: Vec<Repair>,
}

/// The result of a check.
#[derive(Clone, PartialEq, Debug)]
pub struct Checked {
    /// Edges of a voxel in millimetres.
    pub voxel_mm: Vec3,
    /// Width, height and depth of all voxels together; zero if there are none.
    pub size_mm: Vec3,
    /// Whether that fits above the bed, turned about the vertical by a quarter if need be.
    pub fits: bool,
    /// The area that stands on the bed.
    pub contact_mm2: f32,
    /// The problems; only the kinds that occur.
    pub findings: Vec<Finding>,
}

impl Checked {
    /// Returns whether it can be printed as it is, with support for overhangs.
    pub fn is_printable(&self) -> bool {
        let supported = |finding: &Finding| finding.kind == FaultKind::Overhangs;
        self.size_mm != Vec3::ZERO && self.fits && self.findings.iter().all(supported)
    }

    /// Returns the finding of a kind, if there is one.
    pub fn finding(&self, kind: FaultKind) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.kind == kind)
    }
}

impl CheckOptions {
    /// Checks the options. The error names the first option that is out of range.
    pub fn check(&self) -> Result<(), InvalidValue> {
        let CheckOptions { voxel_mm, wall_mm, overhang_deg, bridge_mm, bed_mm } = *self;
        let is_length = |mm: f32| mm.is_finite() && mm > 0.0;
        let check = InvalidValue::check;
        if let Some(voxel_mm) = voxel_mm {
            check(is_length(voxel_mm), "length of a voxel", "must be above 0 mm", voxel_mm)?;
        }
        check(is_length(wall_mm), "thickness of walls", "must be above 0 mm", wall_mm)?;
        let is_angle = (0.0..=90.0).contains(&overhang_deg);
        let rule = "must be 0 to 90 degrees from the vertical";
        check(is_angle, "angle of overhangs", rule, overhang_deg)?;
        let is_bridge = bridge_mm >= 0.0 && bridge_mm.is_finite();
        check(is_bridge, "length of bridges", "must be 0 mm or more", bridge_mm)?;
        let is_bed = bed_mm.to_array().into_iter().all(is_length);
        let rule = "must be above 0 mm in width, depth and height";
        InvalidValue::check(is_bed, "size of the bed", rule, bed_mm)
    }

    /// Returns the edges of a voxel of `grid` in millimetres.
    pub fn voxel_mm_of(&self, grid: &Grid) -> Vec3 {
        let size = grid.voxel_size();
        self.voxel_mm.map_or(size, |mm| size * (mm / size.x))
    }
}

/// Checks `grid`, with at most about `budget_bytes` of additional memory.
pub fn check(
    grid: &Grid,
    options: &CheckOptions,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Checked, CheckError> {
    options.check()?;
    let voxel_mm = options.voxel_mm_of(grid);
    let wall_vx = options.wall_mm / voxel_mm.x;
    let too_thick = CheckError::Wall { wall_mm: options.wall_mm, voxel_mm: voxel_mm.min_element() };
    let thickness = repair::thickness(wall_vx, grid.voxel_size()).map_err(|_| too_thick)?;
    let Some((low, high)) = grid.opaque_bounds() else {
        let (size_mm, findings) = (Vec3::ZERO, Vec::new());
        return Ok(Checked { voxel_mm, size_mm, fits: true, contact_mm2: 0.0, findings });
    };
    let size_mm = (high - low).as_vec3() * voxel_mm;
    let mut findings = Vec::new();
    findings.extend(islands(grid, budget_bytes, progress)?);
    findings.extend(cavities(grid, voxel_mm.x, budget_bytes, progress)?);

    repair::check_memory(thickness.bytes_to_measure(grid), budget_bytes)?;
    let thin = thickness.thin(grid, progress).ok_or(CheckError::Cancelled)?;
    let thicken = vec![Repair::Thicken { to_vx: wall_vx }];
    findings.extend(places::gathered(
        grid,
        FaultKind::ThinWalls,
        thin,
        thicken,
        budget_bytes,
        progress,
    )?);

    let over = overhang::overhangs(grid, options, low.y, progress).ok_or(CheckError::Cancelled)?;
    findings.extend(places::gathered(
        grid,
        FaultKind::Overhangs,
        over,
        vec![],
        budget_bytes,
        progress,
    )?);
    let contact = places::count_in_layer(grid, low.y) as f32;
    Ok(Checked {
        voxel_mm,
        size_mm,
        fits: fits(size_mm, options.bed_mm),
        contact_mm2: contact * voxel_mm.x * voxel_mm.z,
        findings,
    })
}

/// Returns whether a print fits above the bed, turned about the vertical by a quarter if need be.
fn fits(size: Vec3, bed: Vec3) -> bool {
    size.cmple(bed).all() || Vec3::new(size.z, size.y, size.x).cmple(bed).all()
}

fn islands(
    grid: &Grid,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Option<Finding>, RepairError> {
    let found = pieces(grid, PiecesOf::Solid, budget_bytes, progress)?;
    let standing = repair::standing(&found);
    let largest_stands = found.largest().is_none_or(|piece| standing[piece as usize]);
    // If the largest piece floats, the pieces that stand on the bed are removed.
    let keep = if largest_stands { Keep::Standing } else { Keep::Largest };
    let repairs = vec![Repair::RemoveIslands { keep, smaller_vx: None }];
    Ok(of_pieces(&found, FaultKind::Islands, repairs, &|piece| !standing[piece as usize]))
}

fn cavities(
    grid: &Grid,
    voxel_mm: f32,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Option<Finding>, RepairError> {
    let found = pieces(grid, PiecesOf::Empty, budget_bytes, progress)?;
    let diameter_vx = (DRAIN_MM / voxel_mm).clamp(1.0, 64.0);
    let repairs = vec![
        Repair::FillCavities { smaller_vx: None },
        Repair::Drain { diameter_vx, toward: Toward::Down },
    ];
    Ok(of_pieces(&found, FaultKind::Cavities, repairs, &|piece| !found.reaches_border(piece)))
}

/// Returns the finding of faulty pieces.
fn of_pieces(
    found: &Pieces,
    kind: FaultKind,
    repairs: Vec<Repair>,
    is_wrong: &(dyn Fn(u32) -> bool + Sync),
) -> Option<Finding> {
    let wrong = (0u32..).zip(found.list()).filter(|(number, _)| is_wrong(*number));
    let all = wrong.map(|(_, piece)| {
        let (min, max) = piece.bounds();
        let bounds = VoxelBox { min: min.as_ivec3(), max: max.as_ivec3() };
        FaultLocation { voxels: piece.voxels, bounds }
    });
    places::finding(kind, all.collect(), repairs, || found.voxels_of(is_wrong))
}
