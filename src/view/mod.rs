//! Views: where eyes are and which ray belongs to a pixel. Pure geometry.

pub mod camera;
pub mod eye;
pub mod stereo;
pub mod stereo_layout;
pub mod off_axis;
pub mod stereo;

pub use camera::Camera;
pub use eye::{Eye, PixelRays};
pub use stereo::StereoRig;
pub use stereo_layout::StereoLayout;
