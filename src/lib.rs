//! Virtual Sculpture: voxel sculpting in a window, a headset, or head-tracked AR.
//!
//! ARCHITECTURE.md is the map of the rooms below.

pub mod command;
pub mod command_text;
pub mod config;
pub mod document;
pub mod format;
pub mod gpu;
pub mod input;
pub mod progress;
pub mod render;
pub mod scenes;
pub mod screen;
pub mod sculpture;
pub mod shade;
pub mod surface;
pub mod tools;
pub mod ui;
pub mod view;
