//! Golden pictures: stereo, a head before the screen, a sculpture on a marker in a video, and the smooth surface.
//!
//! Each is rendered on the device of the tests and compared with a PNG beside this file. If a picture changes for a good
//! reason, `VS_RENEW_GOLDEN=1 cargo test --test program_tests golden::` records them again; look at each before
//! committing it.

mod ar;
mod paint;
mod printed;
mod record;
mod screens;
mod silhouette;
mod smooth;
