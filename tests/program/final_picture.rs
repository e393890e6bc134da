//! Final pictures of `render`: what they show, the files, and what is refused.

use std::path::Path;

use image::RgbImage;

use super::{bytes, fail, folder, picture, succeed};
use crate::gpu::fixture::need_device;

/// A block on its edge of the ground, with a tower behind it.
const SCRIPT: &str = "new dims=40,40,40 colour=24 base=#c8beaa fill=empty
add cuboid at=20,6,20 half=18,6,12 colour=#c04020
add cuboid at=20,20,10 half=4,18,3 colour=#d0d0d0
";

const SMALL: [&str; 4] = ["--size", "96x72", "--samples", "4"];

fn subject(path: &Path) {
    std::fs::write(path.join("s.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
}

fn render(path: &Path, out: &str, more: &[&str]) -> String {
    let arguments = ["render", "a.vsc", "--quality", "final", "--out", out];
    succeed(path, &[&arguments[..], &SMALL, more].concat())
}

fn brightness(picture: &RgbImage) -> f64 {
    picture.iter().map(|value| f64::from(*value)).sum::<f64>() / picture.len() as f64
}

#[test]
fn a_final_picture_shows_light_and_shadow_and_is_the_same_each_time() {
    let folder = folder();
    let path = folder.path();
    subject(path);
    let said = render(path, "a.png", &[]);
    assert!(said.contains("wrote a.png (96x72)"), "{said}");
    render(path, "b.png", &[]);
    let file = |name: &str| bytes(path.join(name));
    assert_eq!(file("a.png"), file("b.png"));

    // The block is red, the ground is not, and its shadow falls away from the sun.
    let day = picture(path.join("a.png"));
    let is_red = |p: &image::Rgb<u8>| u32::from(p[0]) > 2 * u32::from(p[2]);
    let red = day.pixels().filter(|p| is_red(p)).count();
    assert!((300..4000).contains(&red), "{red}");
    render(path, "left.png", &["--sun=-90,30", "--sun-size", "0.5"]);
    render(path, "right.png", &["--sun=90,30", "--sun-size", "0.5"]);
    let [left, right] = ["left.png", "right.png"].map(|name| picture(path.join(name)));
    let half = |picture: &RgbImage, right: bool| {
        let those =
            picture.enumerate_pixels().filter(|(x, _, p)| (*x >= 48) == right && !is_red(p));
        those.map(|(_, _, p)| f64::from(p[1])).sum::<f64>()
    };
    assert!(half(&left, false) > 1.02 * half(&right, false), "shadows to the left");
    assert!(half(&right, true) > 1.02 * half(&left, true), "shadows to the right");

    render(path, "dark.png", &["--exposure=-2"]);
    assert!(brightness(&picture(path.join("dark.png"))) < 0.7 * brightness(&day));
    for (out, more) in [
        ("lens.png", &["--aperture", "10", "--focus", "0.5,0.7"][..]),
        ("raw.png", &["--no-denoise"]),
        ("lamp.png", &["--sun-strength", "0", "--sky", "0.2", "--area-light=70,30,1.5,1"]),
        ("floating.jpg", &["--ground", "none", "--bounces", "0"]),
    ] {
        render(path, out, more);
        assert_ne!(file(out), file("a.png"), "{out}");
    }
}

#[test]
fn a_final_picture_shows_the_smooth_surface_unless_voxels_are_asked_for() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(
        path.join("ball.sculpt"),
        "new dims=24,24,24 colour=0 base=#c03020 fill=empty\nadd ellipsoid at=12,12,12 half=10\n",
    )
    .unwrap();
    succeed(path, &["run", "ball.sculpt", "--out", "ball.vsc"]);
    let arguments = ["render", "ball.vsc", "--quality", "final", "--ground", "none"];
    let render = |out: &str, more: &[&str]| {
        let size = ["--out", out, "--size", "120x120", "--samples", "8"];
        succeed(path, &[&arguments[..], &size, more].concat());
        picture(path.join(out))
    };
    // Pixels on the wrong side of the circle with as many pixels about the same middle.
    let beside_circle = |picture: &RgbImage| {
        let is_ball = |p: &image::Rgb<u8>| 2 * u32::from(p[0]) > 3 * u32::from(p[2]);
        let ball: Vec<[f64; 2]> = picture
            .enumerate_pixels()
            .filter(|(_, _, p)| is_ball(p))
            .map(|(x, y, _)| [f64::from(x), f64::from(y)])
            .collect();
        let count = ball.len() as f64;
        let middle = [0, 1].map(|axis| ball.iter().map(|at| at[axis]).sum::<f64>() / count);
        let squared = count / std::f64::consts::PI;
        let inside =
            |at: &&[f64; 2]| (at[0] - middle[0]).powi(2) + (at[1] - middle[1]).powi(2) < squared;
        assert!(count > 2500.0, "{count}");
        ball.len() - ball.iter().filter(inside).count()
    };
    let [smooth, voxels] =
        [render("smooth.png", &[]), render("voxels.png", &["--voxels"])].map(|p| beside_circle(&p));
    assert!(2 * smooth < voxels, "{smooth} {voxels}");
}

#[test]
fn linear_light_goes_to_an_exr_file() {
    let folder = folder();
    subject(folder.path());
    render(folder.path(), "a.exr", &[]);
    let file = bytes(folder.path().join("a.exr"));
    assert_eq!(file[..4], 20_000_630u32.to_le_bytes());
    // Ten channels of two bytes and one of four.
    let pixels = 96 * 72 * 24;
    assert!((pixels + 72 * 16..pixels + 72 * 16 + 1000).contains(&file.len()), "{}", file.len());
}

#[test]
fn arguments_that_make_no_final_picture_are_refused_and_nothing_is_written() {
    let folder = folder();
    let path = folder.path();
    subject(path);
    for (arguments, why) in [
        (&["--out", "a.exr"][..], "add `--quality final`"),
        (&["--out", "a.png", "--sun", "1,2"], "--sun applies to final pictures only"),
        (&["--out", "a.png", "--samples", "65"], "only `render --quality final` takes more"),
        (&["--out", "a.png", "--quality", "final", "--samples", "0"], "--samples"),
        (&["--out", "a.png", "--quality", "final", "--mode", "ray"], "--mode does not apply"),
        (&["--out", "a.png", "--quality", "final", "--focus", "2,2"], "0 to 1 each"),
        (&["--out", "a.txt", "--quality", "final"], ".exr"),
        (&["--out", "a.png", "--quality", "final", "--trace-on", "gpu"], "add `--voxels`"),
    ] {
        let error = fail(path, &[&["render", "a.vsc"], arguments].concat(), 2);
        assert!(error.contains(why), "{arguments:?}: {error}");
    }
    let large = ["--out", "a.png", "--quality", "final", "--size", "16384x16384"];
    let error = fail(path, &[&["render", "a.vsc"][..], &large].concat(), 1);
    assert!(error.contains("too large") && error.contains("67108864"), "{error}");
    let nowhere = ["--out", "no/a.png", "--quality", "final", "--size", "8x8"];
    assert!(fail(path, &[&["render", "a.vsc"][..], &nowhere].concat(), 1).contains("no/a.png"));
    assert_eq!(std::fs::read_dir(path).unwrap().count(), 2);
}

#[test]
fn a_device_traces_the_same_picture() {
    need_device();
    let folder = folder();
    let path = folder.path();
    subject(path);
    render(path, "cpu.png", &["--trace-on", "cpu", "--voxels"]);
    render(path, "gpu.png", &["--trace-on", "gpu", "--voxels"]);
    let [cpu, gpu] = ["cpu.png", "gpu.png"].map(|name| picture(path.join(name)));
    let (a, b) = (brightness(&cpu), brightness(&gpu));
    assert!((a - b).abs() < 0.5, "{a} {b}");
    let far = cpu.iter().zip(gpu.iter()).filter(|(a, b)| a.abs_diff(**b) > 24).count();
    assert!(far * 50 < cpu.len(), "{far} values differ");
    std::fs::write(path.join("none.toml"), "[gpu]\ndevice = \"none such\"\n").unwrap();
    let arguments = [
        "render",
        "a.vsc",
        "--quality",
        "final",
        "--trace-on",
        "gpu",
        "--voxels",
        "--out",
        "x.png",
    ];
    let error = fail(path, &[&arguments[..], &["--config", "none.toml"]].concat(), 4);
    assert!(error.contains("none such") && error.contains("--trace-on cpu"), "{error}");
    assert!(!path.join("x.png").exists());
}
