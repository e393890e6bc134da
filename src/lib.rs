//! Virtual Sculpture: voxel sculpting in a window, a headset, or head-tracked AR.
//!
//! ARCHITECTURE.md is the map of the rooms below.

pub mod app;
pub mod bench;
pub mod cli;
pub mod command;
pub mod command_text;
pub mod config;
pub mod doctor;
pub mod document;
pub mod fiducial;
pub mod format;
pub mod gpu;
pub mod headless;
pub mod input;
pub mod picture;
pub mod progress;
pub mod render;
pub mod scenes;
pub mod screen;
pub mod sculpture;
pub mod session;
pub mod shade;
pub mod surface;
pub mod tools;
pub mod track;
pub mod ui;
pub mod video;
pub mod view;
