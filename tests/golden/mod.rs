//! Pictures as they were when somebody last looked at them: stereo, a head before the screen, and a
//! sculpture on a marker in a video.
//!
//! Each is drawn by the renderer on the device of the tests and compared with a PNG beside this file.
//! Where a picture has changed for a good reason, `VS_RENEW_GOLDEN=1 cargo test --test program_tests golden::` writes
//! them anew; look at each before committing it.

mod ar;
mod paint;
mod printed;
mod record;
mod screens;
mod silhouette;
