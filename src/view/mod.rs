//! Views: where eyes are and which ray belongs to a pixel. Pure geometry.

pub mod camera;
pub mod eye;

pub use camera::Camera;
pub use eye::{Eye, PixelRays};
