//! Sampling the surface: the voxel visible through each pixel. Pure CPU code.

pub mod index_map;
mod numbering;
#[doc(hidden)]
pub mod partial;
#[doc(hidden)]
pub mod pixel_rects;
#[doc(hidden)]
pub mod quickstep;
pub mod raycast;
#[doc(hidden)]
pub mod slices;
mod small_bricks;
mod tiles;

pub use index_map::{IndexMap, PixelRect};
pub(crate) use numbering::VoxelNamer;
pub use numbering::{VoxelNumbering, is_linear};
pub use partial::{changed_pixels, pixels_of_grid};
pub use pixel_rects::PixelRects;
pub use small_bricks::SmallBricks;
