//! Plans the repairs that make a sculpture fit for a 3D printer: removes islands, fills or drains cavities, and
//! thickens thin walls.
//!
//! From a [`Repair`] and a grid to the voxels to remove and to add; changes nothing. Knows no document. Up is y, and
//! the print bed lies below the lowest voxel. Lengths are in voxel edges along x.

use glam::Vec3;
use thiserror::Error;

use super::drain::{self, Toward};
use super::thickness::Thickness;
use crate::progress::Progress;
use crate::refusal::{InvalidValue, MemoryBudget, OverBudget};
use crate::sculpture::Grid;
use crate::sculpture::region::ListedBricks;
use crate::tools::pieces::{Pieces, PiecesError, PiecesOf, pieces};

/// The rule of lengths.
const LENGTH_RULE: &str = "must be above 0 and at most 64 voxels on every axis";

/// The pieces that do not count as islands.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Keep {
    /// The largest, and those that stand on the bed.
    #[default]
    Standing,
    /// The largest piece alone.
    Largest,
}

/// A change that makes a sculpture fit for printing.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Repair {
    /// Removes the pieces that are not connected to a kept one.
    RemoveIslands {
        /// The pieces to keep.
        keep: Keep,
        /// Removes only islands of fewer voxels; `None` for all.
        smaller_vx: Option<u32>,
    },
    /// Fills empty places that do not reach the outside.
    FillCavities {
        /// Fills only cavities of fewer voxels; `None` for all.
        smaller_vx: Option<u32>,
    },
    /// Adds voxels around walls that are thinner.
    Thicken {
        /// The minimum thickness of walls.
        to_vx: f32,
    },
    /// Drills a hole from each cavity to the outside.
    Drain {
        /// The diameter of the hole.
        diameter_vx: f32,
        /// The direction of the hole.
        toward: Toward,
    },
}

impl Keep {
    /// All values, in the order in which interfaces offer them.
    pub const ALL: [Keep; 2] = [Keep::Standing, Keep::Largest];

    /// Returns the name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            Keep::Standing => "standing",
            Keep::Largest => "largest",
        }
    }
}

/// The reason why a repair failed.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum RepairError {
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// A length breaks a rule.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
    /// Finding the pieces or measuring the walls takes too much memory.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

impl From<PiecesError> for RepairError {
    fn from(error: PiecesError) -> RepairError {
        match error {
            PiecesError::Cancelled => RepairError::Cancelled,
            PiecesError::OverBudget(over) => RepairError::OverBudget(over),
        }
    }
}

/// The voxels that a repair changes.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct RepairPlan {
    /// The voxels to remove.
    pub remove: ListedBricks,
    /// The voxels to add.
    pub add: ListedBricks,
}

impl Repair {
    /// Returns the verb of its command.
    pub fn verb(&self) -> &'static str {
        match self {
            Repair::RemoveIslands { .. } => "remove-islands",
            Repair::FillCavities { .. } => "fill-cavities",
            Repair::Thicken { .. } => "thicken",
            Repair::Drain { .. } => "drain",
        }
    }

    /// Checks the numbers of the repair.
    pub fn check(&self, voxel: Vec3) -> Result<(), InvalidValue> {
        match *self {
            Repair::Thicken { to_vx } => thickness(to_vx, voxel).map(drop),
            Repair::Drain { diameter_vx, .. } => {
                let is_diameter = diameter_vx > 0.0 && diameter_vx <= 64.0;
                InvalidValue::check(is_diameter, "diameter of a hole", LENGTH_RULE, diameter_vx)
            }
            Repair::RemoveIslands { .. } | Repair::FillCavities { .. } => Ok(()),
        }
    }

    /// Returns the voxels of `grid` that the repair changes, found within `budget_bytes` beyond the grid itself.
    pub fn plan(
        &self,
        grid: &Grid,
        budget_bytes: u64,
        progress: &dyn Progress,
    ) -> Result<RepairPlan, RepairError> {
        self.check(grid.voxel_size())?;
        let (mut remove, mut add) = (ListedBricks::default(), ListedBricks::default());
        match *self {
            Repair::RemoveIslands { keep, smaller_vx } => {
                let found = pieces(grid, PiecesOf::Solid, budget_bytes, progress)?;
                let stays = stays(&found, keep);
                let list = found.list();
                let is_small = |piece: u32| {
                    smaller_vx.is_none_or(|n| list[piece as usize].voxels < u64::from(n))
                };
                remove = found.voxels_of(&|piece| !stays[piece as usize] && is_small(piece));
            }
            Repair::FillCavities { smaller_vx } => {
                let found = pieces(grid, PiecesOf::Empty, budget_bytes, progress)?;
                let list = found.list();
                let is_small = |piece: u32| {
                    smaller_vx.is_none_or(|n| list[piece as usize].voxels < u64::from(n))
                };
                add = found.voxels_of(&|piece| !found.reaches_border(piece) && is_small(piece));
            }
            Repair::Thicken { to_vx } => {
                let thickness = thickness(to_vx, grid.voxel_size())?;
                check_memory(thickness.bytes_to_thicken(grid), budget_bytes)?;
                let added = thickness.thicken(grid, progress).ok_or(RepairError::Cancelled)?;
                add = ListedBricks::new(added.bricks(grid.brick_dims()));
            }
            Repair::Drain { diameter_vx, toward } => {
                let found = pieces(grid, PiecesOf::Empty, budget_bytes, progress)?;
                let holes = drain::holes(grid, &found, diameter_vx, toward, progress);
                remove = holes.ok_or(RepairError::Cancelled)?;
            }
        }
        Ok(RepairPlan { remove, add })
    }
}

/// Returns an error if walls cannot be measured within `budget_bytes`; measuring takes `needed` bytes.
pub fn check_memory(needed: u64, budget_bytes: u64) -> Result<(), OverBudget> {
    OverBudget::check("measuring the walls needs", needed, MemoryBudget::Grids, budget_bytes)
}

/// Returns the thickness for walls of `to_vx` voxel edges along x.
pub fn thickness(to_vx: f32, voxel: Vec3) -> Result<Thickness, InvalidValue> {
    let thickness = Thickness::new(to_vx * voxel.x, voxel);
    thickness.ok_or_else(|| InvalidValue::new("thickness of a wall", LENGTH_RULE, to_vx))
}

/// Returns for each piece of a solid whether it stands on the bed, on which the lowest voxel lies.
pub fn standing(solid: &Pieces) -> Vec<bool> {
    let floor = |place: usize| solid.list()[place].bounds().0.y;
    let lowest = (0..solid.list().len()).map(floor).min();
    (0..solid.list().len()).map(|place| Some(floor(place)) == lowest).collect()
}

fn stays(solid: &Pieces, keep: Keep) -> Vec<bool> {
    let mut stays = match keep {
        Keep::Standing => standing(solid),
        Keep::Largest => vec![false; solid.list().len()],
    };
    if let Some(largest) = solid.largest() {
        stays[largest as usize] = true;
    }
    stays
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
