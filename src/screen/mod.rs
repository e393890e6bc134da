//! Screens: where eyes come from and where images go.

pub mod headset;
pub mod window;
pub mod offscreen;
