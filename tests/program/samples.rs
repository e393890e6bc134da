//! Antialiased pictures of `render` and `demo`, compared with pictures of four times the size.

use std::path::Path;

use image::RgbImage;

use super::{bytes, fail, folder, picture, succeed};
use crate::gpu::fixture::need_device;

/// A small block with a bowl, a turned notch and a painted corner: curved, straight and coloured edges.
const BLOCK: &str = "new dims=80,80,80 colour=24 fill=solid
subtract ellipsoid at=20,80,50 half=36
subtract cuboid at=66,40,70 half=16,16,24 turn=0,30,20
recolour ellipsoid at=70,76,76 half=30 colour=#c82828
";

/// Writes the picture of `block.vsc` in a mode and returns it.
fn render(folder: &Path, mode: &str, size: &str, samples: &str) -> RgbImage {
    let name = format!("{mode}-{size}-{samples}.png");
    let arguments = ["render", "block.vsc", "--out", &name, "--mode", mode, "--size", size];
    succeed(folder, &[&arguments[..], &["--samples", samples]].concat());
    picture(folder.join(name))
}

/// The mean difference of linear light, in thousandths of white, of a picture from one four times as wide and
/// high, whose pixels are averaged.
fn error(picture: &RgbImage, large: &RgbImage) -> f64 {
    let light = |value: u8| (f64::from(value) / 255.0).powi(2);
    let mut sum = 0.0;
    for (x, y, pixel) in picture.enumerate_pixels() {
        for channel in 0..3 {
            let within = (0..16).map(|i| large.get_pixel(4 * x + i % 4, 4 * y + i / 4).0[channel]);
            let mean = within.map(light).sum::<f64>() / 16.0;
            sum += (light(pixel.0[channel]) - mean).abs();
        }
    }
    1000.0 * sum / (3 * picture.width() * picture.height()) as f64
}

#[test]
fn samples_bring_pictures_of_every_mode_close_to_the_mean_light_of_their_pixels() {
    need_device();
    let folder = folder();
    std::fs::write(folder.path().join("block.sculpt"), BLOCK).unwrap();
    succeed(folder.path(), &["run", "block.sculpt", "--out", "block.vsc"]);
    let usual = ["render", "block.vsc", "--out", "usual.png", "--mode", "ray", "--size", "160x120"];
    succeed(folder.path(), &usual);
    let usual = picture(folder.path().join("usual.png"));
    assert_eq!(render(folder.path(), "ray", "160x120", "1"), usual, "one sample is the default");
    let modes = [
        "ray",
        "quickstep",
        "ray-points",
        "slicing",
        "slicing-points",
        "march",
        "march-gpu",
        "gpu",
        "gpu-colour",
    ];
    for mode in modes {
        let large = render(folder.path(), mode, "640x480", "1");
        let errors = ["1", "5", "16"]
            .map(|samples| error(&render(folder.path(), mode, "160x120", samples), &large));
        let [one, five, sixteen] = errors;
        assert!(five < 0.6 * one && sixteen < 0.35 * one, "{mode}: {errors:?}");
    }
}

#[test]
fn samples_are_the_same_each_time_and_serve_both_eyes() {
    let folder = folder();
    let demo = |out: &str, samples: &str| {
        let arguments = ["demo", "--mode", "ray", "--size", "160x120", "--stereo", "layers"];
        succeed(folder.path(), &[&arguments[..], &["--out", out, "--samples", samples]].concat());
    };
    for (out, samples) in [("a", "7"), ("b", "7"), ("c", "8"), ("d", "1")] {
        demo(out, samples);
    }
    for eye in ["left", "right"] {
        let [a, b, c, d] =
            ["a", "b", "c", "d"].map(|out| folder.path().join(format!("{out}/demo.{eye}.png")));
        assert_eq!(bytes(a.clone()), bytes(b), "{eye}");
        assert_ne!(bytes(a.clone()), bytes(c), "{eye}");
        let changed = picture(a).pixels().zip(picture(d).pixels()).filter(|(a, d)| a != d).count();
        assert!(changed > 1000, "{eye}: {changed}");
    }
}

#[test]
fn an_invalid_number_of_samples_is_refused() {
    let folder = folder();
    for samples in ["0", "65", "1.5", "-1"] {
        let why = fail(folder.path(), &["demo", &format!("--samples={samples}")], 2);
        assert!(why.contains("--samples"), "{why}");
    }
}
