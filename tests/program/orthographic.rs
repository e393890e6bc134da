//! Pictures of `render --orthographic`: parallel lines stay parallel, and all of the sculpture is in the picture.

use std::path::Path;

use image::RgbImage;

use super::{folder, picture, succeed};

/// A low bar that lies along the line of sight, seen from above and in front.
const SCRIPT: &str = "new dims=40,20,120 fill=empty
add cuboid at=20,4,60 half=15,3,58 colour=#ffffff
";

fn render(path: &Path, out: &str, more: &[&str]) -> RgbImage {
    let arguments = ["render", "bar.vsc", "--out", out, "--size", "160x160", "--mode", "ray"];
    succeed(path, &[&arguments[..], &["--camera", "0,1,1"], more].concat());
    picture(path.join(out))
}

/// The number of pixels of the bar in each row that has any.
fn widths(picture: &RgbImage) -> Vec<usize> {
    let is_bar = |x: u32, y: u32| picture.get_pixel(x, y)[0] > 100;
    let rows =
        (0..picture.height()).map(|y| (0..picture.width()).filter(|x| is_bar(*x, y)).count());
    rows.filter(|width| *width > 0).collect()
}

#[test]
fn an_orthographic_picture_has_no_vanishing_point_and_shows_everything() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("bar.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "bar.sculpt", "--out", "bar.vsc"]);
    let perspective = widths(&render(path, "perspective.png", &[]));
    let picture = render(path, "parallel.png", &["--orthographic"]);
    let parallel = widths(&picture);
    let spread = |widths: &[usize]| {
        let inner = &widths[4..widths.len() - 4];
        inner.iter().max().unwrap() - inner.iter().min().unwrap()
    };
    assert!(spread(&perspective) > 8, "{perspective:?}");
    assert!(spread(&parallel) <= 1, "{parallel:?}");
    // It fills most of the picture's height, and touches no edge.
    assert!((120..156).contains(&parallel.len()), "{}", parallel.len());
    assert!(picture.get_pixel(80, 0)[0] < 100 && picture.get_pixel(80, 159)[0] < 100);
    let near = widths(&render(path, "near.png", &["--orthographic", "--zoom", "0.5"]));
    assert!((2 * near.len()).abs_diff(parallel.len()) <= 3, "{} {}", near.len(), parallel.len());

    // Final pictures take it, too.
    let traced = ["--orthographic", "--quality", "final", "--samples", "1", "--ground", "none"];
    let arguments = ["render", "bar.vsc", "--out", "final.png", "--size", "160x160", "--sky", "0"];
    let view = ["--camera", "0,1,1", "--sun=0,45", "--no-denoise"];
    succeed(path, &[&arguments[..], &view, &traced].concat());
    let traced = widths(&super::picture(path.join("final.png")));
    assert!(traced.len().abs_diff(parallel.len()) <= 2, "{} {}", traced.len(), parallel.len());
}
