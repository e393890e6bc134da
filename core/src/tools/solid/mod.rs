//! Solids in a box: ellipsoid, cuboid and so on, at any pose, and the volumes that they sweep in straight motion.
//!
//! From a [`Primitive`] to the [`crate::sculpture::region::Region`] of its voxels. Knows no grid's contents.

pub mod body;
mod bricks;
mod coverage;
mod ends;
mod kind;
mod parts;
mod placed;
mod planes;
mod quadric;
mod shape;
mod simd_real;
pub(super) mod spans;
pub mod spec;
mod sweep;
mod swept;
#[cfg(test)]
pub mod tests;

pub use kind::Solid;
pub use placed::{PlacedSolid, Primitive, SolidRow, check_sweep_end};
pub use shape::SolidShape;
