//! The integration tests of the model, in one binary. Its harness (`tests/trials` of the program) counts a test that
//! needs something unavailable on the machine as ignored.

// A failed unwrap is a failed test.
#![allow(clippy::unwrap_used)]

// `#[test]` is that of the harness.
#[macro_use]
extern crate trials;

mod bad_files;
mod commands;
mod conversions;
mod example;
mod field;
mod file_access;
mod formats;
mod frozen;
mod fuzz;
mod independent;
mod journal;
mod layered;
#[cfg(target_os = "linux")]
mod memory;
mod meshes_in;
mod saved_history;
mod scans;
mod sprays;
mod study;
mod three_mf;
mod upright;
mod volume_options;
mod voxel_models;

trials::main!();
