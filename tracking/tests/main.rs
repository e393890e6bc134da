//! The integration tests of the tracking crate, in one binary with the harness of the program's tests
//! (`tests/trials`).

// A test that cannot go on has failed.
#![allow(clippy::unwrap_used)]

// `#[test]` is that of the harness.
#[macro_use]
extern crate trials;

mod captured;
mod captures;
mod loopback;
mod mutated;
mod opentrack;
mod replay;
mod server;
mod waiting;

trials::main!();
