//! Compares pictures with the recorded ones beside this file, or records them.

use std::path::Path;

use virtual_sculpture::shade::Pixels;

/// Tolerance for rounding, of 255 levels.
const TOLERANCE: u8 = 2;
/// Share of pixels that may exceed it: edges that fall on the other side of a pixel's centre.
const STRAYS: f64 = 1e-3;

/// Asserts that a picture equals the recorded one, or records it.
pub fn assert_recorded(name: &str, picture: &Pixels) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    let (width, height) = picture.size.into();
    let bytes = picture.rgba.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let is = image::RgbImage::from_raw(width, height, bytes).unwrap();
    if std::env::var_os("VS_RENEW_GOLDEN").is_some_and(|v| v == "1") {
        is.save(&path).unwrap();
        return;
    }
    let should = image::open(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; VS_RENEW_GOLDEN=1 makes it", path.display()))
        .to_rgb8();
    assert_eq!(is.dimensions(), should.dimensions(), "{name}");
    let differs = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > TOLERANCE)
    };
    let strays = is.pixels().zip(should.pixels()).filter(differs).count();
    if strays as f64 > STRAYS * f64::from(width * height) {
        let new = std::env::temp_dir().join(format!("new-{name}"));
        is.save(&new).unwrap();
        panic!(
            "{strays} pixels of {name} have changed: compare {} with {}; if that is as it should \
             be, VS_RENEW_GOLDEN=1 cargo test --test program_tests golden::",
            new.display(),
            path.display()
        );
    }
}
