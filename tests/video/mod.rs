//! Video sources: real files and sockets, intact and damaged.

mod damaged;
mod films;
mod phone;

use std::time::{Duration, Instant};

use jpeg_encoder::{ColorType, Encoder};
use virtual_sculpture::video::{Address, PlaybackState, VideoFrame, VideoSource};

pub fn open(address: &str) -> VideoSource {
    VideoSource::open(&address.parse().unwrap()).unwrap()
}

/// Polls until `done`, for a minute at most.
pub fn until(source: &mut VideoSource, done: impl Fn(&VideoSource) -> bool) {
    let start = Instant::now();
    while !done(source) {
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", source.state());
        std::thread::sleep(Duration::from_millis(1));
        source.poll();
    }
}

/// The colour of the centre; asserts that all others are within `slack` of it.
pub fn single_colour(frame: &VideoFrame, slack: u8) -> [u8; 3] {
    let pixels = frame.pixels.as_chunks::<4>().0;
    assert_eq!(pixels.len(), (frame.width * frame.height) as usize);
    let [r, g, b, _] = pixels[pixels.len() / 2];
    for [r2, g2, b2, a] in pixels {
        assert!(*a == 255 && r2.abs_diff(r).max(g2.abs_diff(g)).max(b2.abs_diff(b)) <= slack);
    }
    [r, g, b]
}

pub fn near(a: [u8; 3], b: [u8; 3], slack: u8) -> bool {
    (0..3).all(|i| a[i].abs_diff(b[i]) <= slack)
}

/// Colours that a picture's number stands for, far apart.
pub fn colour(number: u8) -> [u8; 3] {
    [number % 4 * 60 + 30, number / 4 % 4 * 60 + 30, number / 16 % 4 * 60 + 30]
}

pub fn jpeg(width: u16, height: u16, rgb: [u8; 3]) -> Vec<u8> {
    let pixels = rgb.repeat(usize::from(width) * usize::from(height));
    let mut bytes = Vec::new();
    Encoder::new(&mut bytes, 95).encode(&pixels, width, height, ColorType::Rgb).unwrap();
    bytes
}

#[test]
fn addresses_that_cannot_be() {
    for text in ["", "v4l2:", "https://cam/", "http://", "clip.mp4", "x.y4m?speed=3"] {
        let error = text.parse::<Address>().unwrap_err().to_string();
        assert!(error.contains("video address"), "{error}");
    }
    let mut source = open("v4l2:/dev/no-such-camera");
    if cfg!(target_os = "linux") {
        until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
        assert!(source.state().error().unwrap().to_string().contains("/dev/no-such-camera"));
    }
}
