//! Frames of a video, in the form to upload, and the limits of their size.

use std::time::{Duration, Instant};

use super::error::VideoError;

/// Longest side of a frame, in pixels.
pub const MAX_SIDE_PX: u32 = 8192;
/// Most pixels in a frame: 8192 x 4320, 135 MiB as RGBA.
pub const MAX_PIXELS: u64 = 8192 * 4320;
/// Largest compressed picture, in bytes.
pub const MAX_COMPRESSED_BYTES: usize = 32 << 20;

/// A frame.
#[derive(Clone, Debug)]
pub struct VideoFrame {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// sRGB-encoded RGBA, 8 bits each, alpha always 255; rows from the top, no padding:
    /// `width * height * 4` bytes.
    pub pixels: Vec<u8>,
    /// Time of its arrival from the camera, or its time in the film.
    pub arrived: Instant,
    /// Position in the film (restarts when it repeats), or time since the camera was opened.
    pub position: Duration,
    /// Counts the frames of one source from 1; gaps are frames that were not polled.
    pub sequence: u64,
}

impl VideoFrame {
    /// Returns an empty frame: 0 x 0.
    pub fn empty() -> VideoFrame {
        VideoFrame {
            width: 0,
            height: 0,
            pixels: Vec::new(),
            arrived: Instant::now(),
            position: Duration::ZERO,
            sequence: 0,
        }
    }

    /// Resizes the frame. The old pixels keep their positions in memory, which is reused.
    pub(super) fn shape(
        &mut self,
        width: u32,
        height: u32,
        subject: &str,
    ) -> Result<(), VideoError> {
        check_size(u64::from(width), u64::from(height), subject)?;
        self.width = width;
        self.height = height;
        self.pixels.resize(width as usize * height as usize * 4, 255);
        Ok(())
    }
}

/// Refuses sizes beyond the limits.
pub(super) fn check_size(width: u64, height: u64, subject: &str) -> Result<(), VideoError> {
    let side = u64::from(MAX_SIDE_PX);
    if width == 0 || height == 0 {
        return Err(VideoError::malformed(subject, format!("a picture of {width} x {height}")));
    }
    if width > side || height > side || width * height > MAX_PIXELS {
        let problem = format!("a picture of {width} x {height}, more than {MAX_PIXELS} pixels");
        return Err(VideoError::unsupported(subject, problem));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_bounded_and_memory_reused() {
        let mut frame = VideoFrame::empty();
        frame.shape(640, 480, "x").unwrap();
        assert_eq!(frame.pixels.len(), 640 * 480 * 4);
        let at = frame.pixels.as_ptr();
        frame.shape(320, 200, "x").unwrap();
        frame.shape(640, 480, "x").unwrap();
        assert_eq!(frame.pixels.as_ptr(), at);
        for (w, h) in [(0, 1), (1, 0), (8193, 1), (8192, 8192), (u32::MAX, u32::MAX)] {
            assert!(frame.shape(w, h, "x").is_err());
        }
        frame.shape(8192, 4320, "x").unwrap();
    }
}
