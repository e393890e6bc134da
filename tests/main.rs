//! The integration tests of the program, in one binary: its harness (`tests/trials`) counts a test that needs
//! something which the machine lacks as ignored.

// A test that cannot go on has failed.
#![allow(clippy::unwrap_used)]

// `#[test]` is that of the harness.
#[macro_use]
extern crate trials;

mod allocations;
mod evaluation;
#[cfg(target_os = "linux")]
mod faults;
mod golden;
mod gpu;
mod hands;
#[cfg(target_os = "linux")]
mod headset;
mod program;
#[cfg(unix)]
mod retry;
mod rooms;
#[cfg(unix)]
mod signals;
mod track;
mod ui;
mod video;
#[cfg(target_os = "linux")]
mod window;
mod words;

trials::main!();
