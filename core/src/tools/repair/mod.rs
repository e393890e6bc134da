//! Repairs for printing: islands, cavities, thin walls and drain holes.
//!
//! From a grid to the voxels to remove and to add. Changes nothing; knows no document.

pub mod ball;
pub mod drain;
mod plan;
pub mod thickness;

pub use drain::Toward;
pub use plan::{Keep, Repair, RepairError, RepairPlan, check_memory, standing, thickness};
