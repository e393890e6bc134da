//! Voxel models of other programs: MagicaVoxel and Voxlap (`.vox`), Qubicle (`.qb`), Goxel (`.gox`), binvox.
//!
//! Each reader takes the bytes of a whole file and returns a [`Model`]; `assemble` makes a sculpture of it. `vox_write`
//! and `qb_write` go the other way and write to a stream; `quantise` finds a palette. Knows no paths.

pub mod assemble;
mod binvox;
mod gox;
mod gox_layer;
pub mod model;
mod palette;
mod qb;
mod qb_write;
mod quantise;
mod scene;
mod vox;
mod vox_write;
mod voxlap;

pub use self::assemble::{colour_depth, to_contents, turned, voxel_size};
pub use self::model::Model;
use super::spec::Format;

/// The formats, as texts list them.
pub static FORMATS: &[Format] = &[&vox::SPEC, &qb::SPEC, &gox::SPEC, &binvox::SPEC];
