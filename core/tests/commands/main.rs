//! Commands from the outside: their text form, scripts of them, and what documents make of them.

// A test that cannot go on has failed.
#![allow(clippy::unwrap_used)]

mod areas;
mod budget;
mod document;
mod files;
mod model;
mod orientations;
mod refusals;
mod script;
mod strategies;
mod text;
