//! Screens: where eyes come from and where images go.

pub mod console;
pub mod headset;
pub mod offscreen;
pub mod pen;
pub mod window;
