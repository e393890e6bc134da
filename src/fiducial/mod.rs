//! Printed markers: detection in a picture, and the pose relative to the camera.
//!
//! Takes grey pictures and the lens of the camera; returns the marker's number, corners and pose.
//! Must not know where pictures come from nor what is drawn over them. The markers are those of the
//! family tag36h11, which many programs print ([`sheet`] does as well).
//!
//! ```text
//! grey.rs      brightness, blur, local threshold
//! contour.rs   outlines of dark regions
//! quad.rs      outline -> four corners, edges to a fraction of a pixel
//! family.rs    which number a pattern of 6 x 6 cells has
//! detect.rs    all of that in a row
//! pose.rs      corners -> pose, both readings where a flat marker leaves two
//! ```

mod contour;
mod detect;
pub mod family;
mod grey;
mod homography;
mod options;
mod pose;
mod quad;
pub mod sheet;

#[cfg(test)]
mod tests;

pub use detect::{Sighting, detect};
pub use grey::Grey;
pub use options::ArOptions;
pub use pose::{MarkerPose, poses};
