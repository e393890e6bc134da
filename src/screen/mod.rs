//! Screens: the sources of eyes and the destinations of images.

pub mod console;
pub mod headset;
pub mod offscreen;
pub mod pen;
pub mod window;
