//! Brushes: a footprint in the picture or a ball on the surface, and the voxels that change under it.
//!
//! From a grid and one use of a brush to the voxels to remove, to add and to paint. Changes nothing; knows no document.

pub mod deform;
mod distance;
pub mod filter;
pub mod footprint;
pub mod grab;
pub mod level;
pub mod offset;
#[cfg(test)]
mod offset_tests;
pub mod spray;
#[cfg(test)]
mod spray_tests;
pub mod stencil;
pub mod visible;
#[cfg(test)]
mod visible_tests;
