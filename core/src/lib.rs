#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod command;
pub mod document;
pub mod format;
pub mod journal;
pub mod mesh;
pub mod print_check;
pub mod progress;
pub mod saved_history;
pub mod scenes;
pub mod sculpture;
pub mod session;
pub mod shade;
pub mod spill;
pub mod surface;
pub mod tools;
pub mod trace;
pub mod view;
pub mod voxelise;
