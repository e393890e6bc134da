//! Commands from the outside: their text form, scripts of them, and what documents make of them.

mod document;
mod model;
mod script;
mod strategies;
mod text;
