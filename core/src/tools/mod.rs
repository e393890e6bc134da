//! Tools: the voxels that a solid or a spray covers, as [`crate::sculpture::region::Region`]s, mirror planes,
//! and the pieces of a grid. They compute masks and change nothing of a document.

pub mod ball;
pub mod construct;
mod construct_bricks;
mod construct_ends;
mod construct_planes;
mod construct_quadric;
mod construct_spans;
mod construct_swept;
#[cfg(test)]
mod construct_tests;
pub mod deform;
mod distance;
pub mod drain;
pub mod filter;
pub mod flood;
pub mod footprint;
pub mod form;
pub mod form_curve;
mod form_outline;
pub mod form_region;
pub mod grab;
mod grab_field;
mod grab_flow;
mod grab_motion;
#[cfg(test)]
mod grab_motion_tests;
#[cfg(test)]
mod grab_tests;
mod lanes;
pub mod level;
mod level_counts;
mod level_field;
mod level_hidden;
#[cfg(test)]
mod level_tests;
#[cfg(test)]
mod limit_tests;
pub mod mask;
pub mod mend;
pub mod offset;
#[cfg(test)]
mod offset_tests;
pub mod pieces;
#[cfg(test)]
mod pieces_tests;
mod solid;
mod solid_way;
pub mod spray;
#[cfg(test)]
mod spray_tests;
pub mod stencil;
pub mod symmetry;
#[cfg(test)]
mod symmetry_tests;
pub mod texture;
pub mod thickness;
pub mod tint;
pub mod visible;
#[cfg(test)]
mod visible_tests;
