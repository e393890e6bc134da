//! Pictures and films of a sculpture with a mask: they show none of it.

use std::path::Path;

use image::RgbImage;

use super::{folder, picture, succeed};
use crate::gpu::fixture::need_device;

/// A block whose upper half is protected, what is empty there as well.
const SCRIPT: &str = "new dims=40,40,40 colour=24 base=#c8beaa fill=solid
subtract ellipsoid at=20,40,24 half=14
mask add cuboid at=20,30,20 half=20,10,20
";

/// `masked.vsc` and the same without its mask, and what is left of each when all is cleared.
fn subjects(path: &Path) {
    std::fs::write(path.join("masked.sculpt"), SCRIPT).unwrap();
    std::fs::write(path.join("bare.sculpt"), "mask clear").unwrap();
    std::fs::write(path.join("clear.sculpt"), "clear grid").unwrap();
    succeed(path, &["run", "masked.sculpt", "--out", "masked.vsc"]);
    succeed(path, &["run", "bare.sculpt", "--in", "masked.vsc", "--out", "bare.vsc"]);
    for (subject, left) in [("masked.vsc", "masked-left.vsc"), ("bare.vsc", "bare-left.vsc")] {
        succeed(path, &["run", "clear.sculpt", "--in", subject, "--out", left]);
    }
}

fn made(path: &Path, subject: &str, verb: &str, out: &str, more: &[&str]) -> RgbImage {
    let out = format!("{subject}-{out}.png");
    let arguments = [verb, &format!("{subject}.vsc"), "--out", &out, "--camera", "1,1,2"];
    succeed(path, &[&arguments[..], more].concat());
    picture(path.join(out))
}

#[test]
fn saved_pictures_and_films_show_no_mask() {
    need_device();
    let folder = folder();
    let path = folder.path();
    subjects(path);
    let small = ["--size", "96x72"];
    // The one file does have a mask.
    let [kept, gone] = ["masked-left", "bare-left"]
        .map(|subject| made(path, subject, "render", "ray", &["--mode", "ray"]));
    assert!(kept != gone);
    let smooth = ["--size", "480x360", "--mode", "ray"];
    let traced = ["--size", "96x72", "--quality", "final", "--samples", "2"];
    let mut pictures: Vec<(String, &str, Vec<&str>)> = vec![
        ("smooth".to_string(), "render", smooth.to_vec()),
        ("final".to_string(), "render", traced.to_vec()),
        ("film".to_string(), "film", [&small[..], &["--frames", "2"]].concat()),
    ];
    for mode in ["ray", "slicing", "march", "march-gpu", "gpu", "gpu-colour"] {
        let arguments = [&small[..], &["--mode", mode]].concat();
        pictures.push((mode.to_string(), "render", arguments));
    }
    for (name, verb, arguments) in pictures {
        let [masked, bare] =
            ["masked", "bare"].map(|subject| made(path, subject, verb, &name, &arguments));
        assert!(masked == bare, "{name}");
    }
}
