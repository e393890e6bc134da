//! Views: the positions of eyes and the rays of their pixels. Pure geometry.

pub mod camera;
pub mod eye;
#[doc(hidden)]
pub mod off_axis;
pub mod room;
#[doc(hidden)]
pub mod samples;
pub mod stereo;
#[doc(hidden)]
pub mod stereo_layout;

pub use camera::{Camera, FRAME_MARGIN};
pub use eye::{Eye, PixelRays};
pub use room::{Room, RoomPose, RoomView, Similarity};
pub use samples::{MAX_SAMPLES, sample_offset_px};
pub use stereo::StereoRig;
pub use stereo_layout::StereoLayout;
