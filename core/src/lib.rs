//! The model of a voxel sculpture and everything pure around it: grids of existence bits, colours,
//! commands and history, tools, file formats, samplers and shading on the CPU, and views.
//!
//! Knows no Vulkan, no window, no interface and no clock. Every change of a sculpture is a
//! [`command::Command`] through [`document::Document::apply`] or [`session::Session::execute`].

pub mod command;
pub mod command_text;
pub mod document;
pub mod format;
pub mod progress;
pub mod scenes;
pub mod sculpture;
pub mod session;
pub mod shade;
pub mod surface;
pub mod tools;
pub mod view;
