//! Solids that are drawn: half space, ring, tube, lathe and extrusion.
//!
//! From a [`DrawnSolid`] to the [`crate::sculpture::region::Region`] of its voxels. Knows no grid's contents.

pub mod curve;
mod drawn_solid;
mod outline;
pub mod region;

pub use drawn_solid::{ControlPoint, DrawnSolid, FURTHEST_VX, MAX_POINTS, Pose, is_place};
