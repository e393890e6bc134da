//! Commands through the public interface: their text form, scripts, and their effect on documents.

mod areas;
mod brushes;
mod budget;
mod canvas;
mod clay;
mod document;
pub mod drawn_solids;
mod every_tool;
mod file_options;
mod files;
mod large;
pub mod masks;
mod model;
mod orient;
mod orientations;
mod places;
mod refusals;
mod script;
mod soak;
pub mod strategies;
mod surface;
mod symmetries;
mod text;
mod tints;
mod uses;
