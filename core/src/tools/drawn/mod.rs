//! Solids that are drawn: half space, ring, tube, lathe and extrusion.
//!
//! From a [`Form`] to the [`crate::sculpture::region::Region`] of its voxels. Knows no grid's contents.

pub mod curve;
mod form;
mod outline;
pub mod region;

pub use form::{Bead, FURTHEST_VX, Form, MAX_POINTS, Pose, is_place};
