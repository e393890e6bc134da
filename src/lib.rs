//! Virtual Sculpture: voxel sculpting in a window, a headset, or head-tracked AR.
//!
//! ARCHITECTURE.md is the map of the rooms below.

#![cfg_attr(not(test), warn(clippy::too_many_lines))]
// These macros panic without a reader: see `terminal`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod app;
pub mod bench;
pub mod cli;
pub mod config;
pub mod controls;
pub mod doctor;
pub mod editor;
pub mod fiducial;
pub mod film;
pub mod folders;
pub mod gpu;
pub mod head_tracking;
pub mod headless;
pub mod input;
pub mod install_hint;
pub mod manual;
pub mod notice;
pub mod options;
pub mod picking;
pub mod picture;
pub mod progress_bar;
pub mod remedy;
pub mod render;
pub mod screen;
mod system_fonts;
pub mod terminal;
mod time_text;
pub mod track;
pub mod ui;
pub mod video;
pub mod viewpoint;

pub use sculpture_core::{
    command, document, format, mesh, persist, print_check, progress, refusal, resample, scenes,
    sculpture, session, shade, surface, tools, trace, view, voxelise,
};
