//! Commands through the public interface: their text form, scripts, and their effect on documents.

mod areas;
mod budget;
mod clay;
mod document;
mod files;
pub mod forms;
mod large;
mod masks;
mod model;
mod orient;
mod orientations;
mod refusals;
mod script;
pub mod strategies;
mod symmetries;
mod text;
mod tints;
