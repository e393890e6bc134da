//! Films that are folders of PNG pictures of one size, ordered by the numbers in their names.

use std::cmp::Ordering;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::PathBuf;
use std::time::Duration;

use image::codecs::png::PngDecoder;
use image::{ImageDecoder, Limits};

use super::address::FilmAddress;
use super::error::VideoError;
use super::frame::{MAX_COMPRESSED_BYTES, MAX_PIXELS, MAX_SIDE_PX, VideoFrame};
use super::rate::Rate;
use super::reader::{Decoded, Fetched, Reader};

/// Most pictures of a folder: nine hours at 30 per second.
const MAX_PICTURES: usize = 1_000_000;

pub struct PngFolder {
    paths: Vec<PathBuf>,
    rate: Rate,
    /// The size of the first decoded picture, required of all others.
    size: Option<(u32, u32)>,
    bytes: Vec<u8>,
    samples: Vec<u8>,
    index: usize,
}

impl PngFolder {
    pub fn open(address: &FilmAddress) -> Result<PngFolder, VideoError> {
        let subject = address.path.display().to_string();
        let io = |error| VideoError::io(&*subject, error);
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(&address.path).map_err(io)? {
            let path = entry.map_err(io)?.path();
            if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
                paths.push(path);
            }
            if paths.len() > MAX_PICTURES {
                let problem = format!("more than {MAX_PICTURES} pictures");
                return Err(VideoError::unsupported(&*subject, problem));
            }
        }
        if paths.is_empty() {
            return Err(VideoError::malformed(&*subject, "the folder contains no PNG pictures"));
        }
        paths.sort_by(|a, b| {
            let name = |path: &PathBuf| {
                path.file_name().unwrap_or_default().to_string_lossy().into_owned()
            };
            natural_order(&name(a), &name(b)).then_with(|| a.cmp(b))
        });
        Ok(PngFolder {
            paths,
            rate: address.rate.unwrap_or(Rate::DEFAULT),
            size: None,
            bytes: Vec::new(),
            samples: Vec::new(),
            index: 0,
        })
    }

    /// Returns the name of the last picture, for messages.
    fn subject(&self) -> String {
        let path = self.index.checked_sub(1).and_then(|i| self.paths.get(i));
        path.map(|path| path.display().to_string()).unwrap_or_default()
    }
}

impl Reader for PngFolder {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        let Some(path) = self.paths.get(self.index) else {
            return Ok(Fetched::End);
        };
        let io = |error| VideoError::io(path.display().to_string(), error);
        let file = File::open(path).map_err(io)?;
        self.bytes.clear();
        file.take(MAX_COMPRESSED_BYTES as u64 + 1).read_to_end(&mut self.bytes).map_err(io)?;
        let position = self.rate.time_of(self.index as u64);
        self.index += 1;
        if self.bytes.len() > MAX_COMPRESSED_BYTES {
            let problem = format!("more than {MAX_COMPRESSED_BYTES} bytes");
            return Err(VideoError::unsupported(self.subject(), problem));
        }
        Ok(Fetched::Picture { position, stale: 0, broken: 0 })
    }

    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
        let subject = self.subject();
        let malformed = |error: image::ImageError| {
            VideoError::malformed(&*subject, format!("broken PNG: {error}"))
        };
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_SIDE_PX);
        limits.max_image_height = Some(MAX_SIDE_PX);
        limits.max_alloc = Some(MAX_PIXELS * 8);
        let decoder =
            PngDecoder::with_limits(Cursor::new(&self.bytes), limits).map_err(malformed)?;
        let (width, height) = decoder.dimensions();
        let first = *self.size.get_or_insert((width, height));
        if (width, height) != first {
            let problem = format!(
                "{width} x {height} pixels, but the first picture of the folder has {} x {}",
                first.0, first.1
            );
            return Err(VideoError::malformed(subject, problem));
        }
        frame.shape(width, height, &subject)?;
        let colour = decoder.color_type();
        let channels = usize::from(colour.channel_count());
        let sample_bytes = usize::from(colour.bytes_per_pixel()) / channels;
        self.samples.resize(width as usize * height as usize * channels * sample_bytes, 0);
        decoder.read_image(&mut self.samples).map_err(malformed)?;
        expand(&self.samples, channels, sample_bytes, &mut frame.pixels);
        Ok(Decoded::Whole)
    }

    fn rewind(&mut self) -> Result<Duration, VideoError> {
        let length = self.rate.time_of(self.index as u64);
        self.index = 0;
        Ok(length)
    }
}

/// Converts grey, grey + alpha, RGB or RGBA of 8 bits, or of 16 in native byte order, to opaque
/// RGBA of 8.
fn expand(samples: &[u8], channels: usize, sample_bytes: usize, out: &mut [u8]) {
    // Position of the upper 8 bits in a sample.
    let upper = if cfg!(target_endian = "big") { 0 } else { sample_bytes - 1 };
    let pixels = samples.chunks_exact(channels * sample_bytes);
    for (pixel, out) in pixels.zip(out.as_chunks_mut::<4>().0) {
        let sample = |channel: usize| pixel[channel * sample_bytes + upper];
        *out = match channels {
            1 | 2 => [sample(0), sample(0), sample(0), 255],
            _ => [sample(0), sample(1), sample(2), 255],
        };
    }
}

/// Compares texts between numbers as text and numbers by value, so that 2 precedes 10.
fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a, b);
    loop {
        let (text_a, text_b) =
            (prefix(a, |c| !c.is_ascii_digit()), prefix(b, |c| !c.is_ascii_digit()));
        let by_text = text_a.cmp(text_b);
        if by_text != Ordering::Equal || (a.is_empty() && b.is_empty()) {
            return by_text;
        }
        (a, b) = (&a[text_a.len()..], &b[text_b.len()..]);
        let (digits_a, digits_b) =
            (prefix(a, |c| c.is_ascii_digit()), prefix(b, |c| c.is_ascii_digit()));
        let (value_a, value_b) =
            (digits_a.trim_start_matches('0'), digits_b.trim_start_matches('0'));
        // Without leading zeros, the longer number is larger; any length is allowed.
        let by_value = value_a.len().cmp(&value_b.len()).then_with(|| value_a.cmp(value_b));
        if by_value != Ordering::Equal {
            return by_value;
        }
        (a, b) = (&a[digits_a.len()..], &b[digits_b.len()..]);
    }
}

/// Returns the longest prefix of characters that satisfy `is`.
fn prefix(text: &str, is: impl Fn(char) -> bool) -> &str {
    text.find(|c| !is(c)).map_or(text, |end| &text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_ordered_by_value() {
        let mut names = ["f10.png", "f9.png", "f010b.png", "a.png", "f1.png", "f", "f02.png", "g"];
        names.sort_by(|a, b| natural_order(a, b));
        let sorted = ["a.png", "f", "f1.png", "f02.png", "f9.png", "f10.png", "f010b.png", "g"];
        assert_eq!(names, sorted);
        assert_eq!(natural_order("é3", "é03"), Ordering::Equal);
    }
}
