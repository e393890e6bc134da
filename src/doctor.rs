//! Owns `doctor`: what this machine offers to the program, and what to install where something
//! lacks. It only looks; it changes nothing and fails nowhere.

use crate::config::{Config, personal_file};

/// Prints a line for each thing the program can use.
pub fn report(config: &Config) {
    println!("virtual-sculpture {}", env!("CARGO_PKG_VERSION"));
    match personal_file() {
        Some(path) if path.exists() => println!("settings: {}", path.display()),
        Some(path) => println!("settings: defaults ({} does not exist)", path.display()),
        None => println!("settings: defaults (no HOME)"),
    }
}
