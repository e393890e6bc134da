//! Films as GIF: 256 colours per frame, chosen by the crate `gif`, and times in hundredths of a second.
//!
//! Takes pictures one by one and writes each before it asks for the next.

use std::io::{BufWriter, Error};
use std::path::Path;

use gif::{Encoder, EncodingError, Frame, Repeat};

use super::FilmError;
use super::frames::{BUFFER_BYTES, Format, NextPicture, cannot_write, finish};
use crate::format::store::AtomicFile;

/// Viewers show frames shorter than two hundredths of a second for much longer.
pub const MAX_FPS: u16 = 50;
/// One pixel in so many decides about the colours: the crate's compromise between speed and quality.
const SAMPLING: i32 = 10;

/// Writes a GIF that repeats forever.
pub fn write(
    file: AtomicFile,
    path: &Path,
    format: &Format,
    next: &mut NextPicture,
) -> Result<(), FilmError> {
    let failed = |error: EncodingError| match error {
        EncodingError::Io(error) => cannot_write(path, error),
        error => cannot_write(path, Error::other(error)),
    };
    let [width, height] = size(format).map_err(|rule| FilmError::Form(rule.to_string()))?;
    let buffer = BufWriter::with_capacity(BUFFER_BYTES, file);
    let mut encoder = Encoder::new(buffer, width, height, &[]).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    for frame in format.part.clone() {
        let mut picture = Frame::from_rgb_speed(width, height, &next(frame)?, SAMPLING);
        picture.delay = delay_cs(frame, format.fps);
        encoder.write_frame(&picture).map_err(failed)?;
    }
    finish(encoder.into_inner().map_err(failed)?, path)
}

/// Checks whether a film can be a GIF.
pub fn check(format: &Format) -> Result<(), &'static str> {
    if format.fps > MAX_FPS {
        return Err("a GIF has at most 50 frames a second; choose fewer with `--fps`");
    }
    size(format).map(|_| ())
}

fn size(format: &Format) -> Result<[u16; 2], &'static str> {
    let side = |side: u32| u16::try_from(side).map_err(|_| "a GIF has at most 65535 pixels a side");
    Ok([side(format.size.x)?, side(format.size.y)?])
}

/// Returns the duration of a frame, rounded so that errors do not accumulate.
fn delay_cs(frame: u32, fps: u16) -> u16 {
    let begins = |frame: u64| (100 * frame + u64::from(fps) / 2) / u64::from(fps);
    (begins(u64::from(frame) + 1) - begins(frame.into())) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_add_up_at_every_rate() {
        for fps in [1, 7, 24, 25, 30, 50] {
            let total: u32 = (0..u32::from(fps) * 3).map(|f| u32::from(delay_cs(f, fps))).sum();
            assert_eq!(total, 300, "{fps}");
        }
        assert_eq!([0, 1, 2].map(|frame| delay_cs(frame, 30)), [3, 4, 3]);
    }

    #[test]
    fn films_that_do_not_fit_into_a_gif_are_refused() {
        let good = Format { size: glam::UVec2::new(640, 480), fps: 50, frames: 2, part: 0..2 };
        assert!(check(&good).is_ok());
        assert!(check(&Format { fps: 51, ..good.clone() }).unwrap_err().contains("--fps"));
        let wide = Format { size: glam::UVec2::new(65_536, 1), ..good };
        assert!(check(&wide).unwrap_err().contains("65535"));
    }
}
