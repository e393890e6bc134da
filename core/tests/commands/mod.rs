//! Commands from the outside: their text form, scripts of them, and what documents make of them.

mod areas;
mod budget;
mod document;
mod files;
mod large;
mod model;
mod orient;
mod orientations;
mod refusals;
mod script;
mod strategies;
mod text;
