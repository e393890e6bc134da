//! The data of a sculpture: existence bits, colours, placement, selection, and the edit that changes voxels and records
//! their earlier state for undo.
//!
//! The lowest room: imports no other. Knows no tool, no file, no clock. Programs change a sculpture by commands to a
//! document, two rooms further up, rather than by calling this directly.

pub mod bit_block;
pub(crate) mod bits_growth;
pub mod brick;
pub mod brick_set;
pub mod canvas_frame;
pub mod clip;
pub mod colour;
pub mod colour_record;
mod contents;
pub mod digest;
pub mod edit;
pub mod edit_scope;
mod edit_stats;
pub mod grid;
pub mod grid_region;
pub mod history;
pub mod index_set;
pub mod inherit;
pub mod limits;
pub mod material;
pub mod memory;
pub mod orient;
pub mod orientation;
pub mod paint;
pub mod placement;
pub mod record;
pub mod reframe;
pub mod region;
pub mod selection;
pub mod stroke;
pub(crate) mod to_paint;
pub mod vectors;

pub use brick::Brick;
pub use colour::{ColourDepth, Rgb};
pub use digest::Digest;
pub use grid::{Grid, GridError, NO_VOXEL};
pub use limits::Limits;
pub use material::Material;
pub use placement::Placement;
