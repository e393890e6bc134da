//! Repairs for printing: islands, cavities, thin walls and drain holes.
//!
//! From a grid to the voxels to remove and to add. Changes nothing; knows no document.

pub mod ball;
pub mod drain;
mod mend;
pub mod thickness;

pub use drain::Toward;
pub use mend::{Keep, Mend, MendError, MendPlan, check_memory, standing, thickness, voxels_of};
