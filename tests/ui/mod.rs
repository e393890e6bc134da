//! The interface without a window: what a person does with mouse, keys and fields, and what comes of it.

mod bench;
mod board;
mod files;
mod keys;
mod light;
mod memory;
mod panels;
mod surface;
mod switches;
mod toasts;
mod tools;
