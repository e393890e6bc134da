//! The interface without a window: input by mouse, keys and fields, and its effects.

mod bench;
mod board;
mod changed_on_disk;
mod draw;
mod files;
mod import;
mod in_use;
mod keys;
mod light;
mod masks;
mod memory;
mod panels;
mod pictures;
mod pressure;
mod print_check;
mod recovery;
mod saved_history;
mod stencils;
mod surface;
mod switches;
mod tints;
mod toasts;
mod tools;
mod upright;
mod view;
mod works;
