//! Video behind the sculpture: cameras, films and phones to RGBA frames with time stamps, and the
//! 2D geometry of showing them (framing, lens).
//!
//! Takes an [`Address`]; returns a [`VideoSource`] that never blocks its caller: a thread of its
//! own decodes, and the newest frame wins. Must not know Vulkan, windows or sculptures.
//!
//! ```text
//! address.rs --open--> Reader: v4l2 | http | y4m | mjpeg | png_folder
//!                         |  fetch, decode (yuv.rs, jpeg.rs)
//!                      pump.rs  paces films, finds cameras again     (thread)
//!                         |
//!                      slot.rs  one frame, swapped in and out
//!                         |
//!                      VideoSource::poll                             (caller)
//! ```

mod address;
mod colour;
mod error;
mod frame;
mod framing;
mod http;
mod intrinsics;
mod jpeg;
mod marker_eye;
mod mjpeg;
mod options;
mod png_folder;
mod pump;
mod rate;
mod reader;
mod slot;
mod source;
#[cfg(target_os = "linux")]
mod v4l2;
mod y4m;
mod yuv;

#[cfg(test)]
mod intrinsics_tests;
#[cfg(test)]
mod jpeg_tests;
#[cfg(test)]
mod pump_tests;
#[cfg(test)]
mod yuv_tests;

pub use address::{Address, CameraAddress, FilmAddress, FilmKind};
pub use colour::{Colour, ColourChoice, Matrix, Range};
pub use error::VideoError;
pub use frame::{MAX_COMPRESSED_BYTES, MAX_PIXELS, MAX_SIDE_PX, VideoFrame};
pub use framing::{Fit, Framing};
pub use http::Url;
pub use intrinsics::{Intrinsics, IntrinsicsError};
pub use marker_eye::MarkerPlacement;
pub use options::VideoOptions;
pub use rate::Rate;
pub use slot::{PlaybackState, Stats};
pub use source::VideoSource;
#[cfg(target_os = "linux")]
pub use v4l2::{CameraInfo, CameraMode, cameras};
pub use yuv::{LineBuffers, YuvLayout, YuvPicture, to_rgba};
