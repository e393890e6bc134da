//! Tools: the voxels that a solid or a spray covers, as [`crate::sculpture::region::Region`]s, mirror planes, and the
//! pieces of a grid. They compute masks and do not change a document.

pub mod brush;
#[cfg(test)]
mod coverage_tests;
pub mod drawn;
pub mod flood;
#[cfg(test)]
mod limit_tests;
pub mod mask;
mod parallelepiped;
pub mod pieces;
#[cfg(test)]
mod pieces_tests;
pub mod repair;
pub mod solid;
pub mod symmetry;
#[cfg(test)]
mod symmetry_tests;
pub mod texture;
mod tiles;
pub mod tint;
