//! Owns the program in a window.

mod aim;
mod deeds;
mod path;
mod stage;
mod stroke;
pub mod workbench;

pub use workbench::Workbench;
