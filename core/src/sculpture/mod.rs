//! The model of a sculpture: bits, colours, placement, earlier states, and the edit that changes it. Its door is [`crate::document::Document::apply`].
//!
//! Knows no Vulkan, no window, no clock and no files.

pub mod bit_block;
pub mod brick;
pub mod brick_set;
pub mod clip;
pub mod colour;
pub mod edit;
pub mod grid;
pub mod history;
pub mod inherit;
pub mod limits;
pub mod material;
pub mod orientation;
pub mod paint;
pub mod placement;
pub mod record;
pub mod region;
mod row_edit;
pub mod selection;
pub mod stroke;
pub mod vectors;

pub use brick::Brick;
pub use colour::{ColourDepth, Rgb};
pub use grid::{Grid, GridError, NO_VOXEL};
pub use limits::Limits;
pub use material::Material;
pub use placement::Placement;
