//! Tests of lenses: inversion, published formulas, and refusals.

use glam::DVec2;
use proptest::prelude::*;

use super::intrinsics::{Intrinsics, IntrinsicsError};

/// A wide webcam as OpenCV's calibration prints it.
const WEBCAM: &str = "width = 1280\nheight = 720\nfx = 930.1\nfy = 928.4\ncx = 645.2\ncy = 351.9\n\
                      k1 = -0.35\nk2 = 0.14\np1 = 0.001\np2 = -0.0007\nk3 = -0.02";

#[test]
fn the_formula_of_opencv() {
    let lens = Intrinsics::parse(WEBCAM).unwrap();
    // docs.opencv.org, "Camera Calibration and 3D Reconstruction", written out for one ray.
    let (x, y) = (0.4_f64, -0.25_f64);
    let r2 = x * x + y * y;
    let (k1, k2, p1, p2, k3) = (-0.35, 0.14, 0.001, -0.0007, -0.02);
    let radial = 1.0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
    let u = 930.1 * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + 645.2;
    let v = 928.4 * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) + 351.9;
    assert!(lens.pixel_from_ray(DVec2::new(x, y)).distance(DVec2::new(u, v)) < 1e-9);
    // The axis falls on the centre.
    assert_eq!(lens.pixel_from_ray(DVec2::ZERO), DVec2::new(645.2, 351.9));
}

#[test]
fn a_pinhole_is_its_frustum() {
    let lens = Intrinsics::pinhole(640, 480, 1.0);
    lens.check().unwrap();
    let frustum = lens.frustum();
    let half = 0.5_f32.tan();
    assert!((frustum.up - half).abs() < 1e-6 && (frustum.down + half).abs() < 1e-6);
    assert!((frustum.right - half * 640.0 / 480.0).abs() < 1e-6);
    assert!((frustum.left + frustum.right).abs() < 1e-6);
    // The picture's corners are the frustum's.
    let corner = DVec2::new(f64::from(frustum.left), -f64::from(frustum.up));
    assert!(lens.uv_from_ray(corner).length() < 1e-6);
    // Without distortion a picture is looked up where it is.
    let map = lens.undistort_map(64, 48);
    assert!((map[0] - glam::Vec2::new(0.5 / 64.0, 0.5 / 48.0)).length() < 1e-6);
    assert!((map[64 * 48 - 1] - glam::Vec2::new(63.5 / 64.0, 47.5 / 48.0)).length() < 1e-6);
}

#[test]
fn the_undistorted_picture_has_straight_lines() {
    let lens = Intrinsics::parse(WEBCAM).unwrap();
    let map = lens.undistort_map(128, 72);
    // Sampling a picture of the world by the map and by the lens must be the same.
    let ideal = lens.scaled(128, 72);
    for (x, y) in [(0, 0), (127, 0), (64, 36), (3, 71), (100, 20)] {
        let ray =
            DVec2::new((f64::from(x) - ideal.cx) / ideal.fx, (f64::from(y) - ideal.cy) / ideal.fy);
        let seen = map[(y * 128 + x) as usize].as_dvec2();
        assert!(seen.distance(lens.uv_from_ray(ray)) < 1e-6);
    }
    // Barrel distortion: the ideal picture's corners lie further in than the lens's own.
    assert!(map[0].min_element() > 0.0);
}

#[test]
fn another_size_of_the_same_camera() {
    let lens = Intrinsics::parse(WEBCAM).unwrap();
    let small = lens.scaled(640, 360);
    small.check().unwrap();
    for ray in [DVec2::ZERO, DVec2::new(0.3, 0.2), DVec2::new(-0.5, 0.1)] {
        assert!(lens.uv_from_ray(ray).distance(small.uv_from_ray(ray)) < 1e-12);
    }
    let (a, b) = (lens.frustum(), small.frustum());
    assert!((a.left - b.left).abs() < 1e-6 && (a.up - b.up).abs() < 1e-6);
}

#[test]
fn bad_lenses_are_refused() {
    let with = |key: &str, value: &str| {
        let mut lines: Vec<String> =
            WEBCAM.lines().filter(|l| !l.starts_with(key)).map(str::to_owned).collect();
        lines.push(format!("{key} = {value}"));
        Intrinsics::parse(&lines.join("\n"))
    };
    for (key, value) in [
        ("fx", "0"),
        ("fx", "-900"),
        ("fy", "nan"),
        ("fy", "inf"),
        ("fx", "1e9"),
        ("cx", "-5"),
        ("cy", "721"),
        ("width", "0"),
        // The edge would appear at the middle.
        ("k1", "-3"),
        ("k3", "-1e6"),
        ("p1", "5"),
        ("k2", "1e300"),
    ] {
        assert!(matches!(with(key, value), Err(IntrinsicsError::Value(_))), "{key} = {value}");
    }
    for (key, value) in [("width", "-1"), ("fz", "1"), ("fx", "'wide'")] {
        assert!(matches!(with(key, value), Err(IntrinsicsError::Parse(_))), "{key} = {value}");
    }
    assert!(Intrinsics::parse("").is_err());
}

/// Halfway to the corner the distortion hardly grows, but it does not fold.
#[test]
fn a_lens_that_nearly_folds_is_accepted() {
    let lens = Intrinsics {
        k1: -0.246_795_487,
        k2: 0.034_515_794,
        k3: -0.001_490_531,
        ..Intrinsics::pinhole(800, 600, 1.147_862_105)
    };
    lens.check().unwrap();
    for corner in [DVec2::ZERO, DVec2::new(799.0, 599.0)] {
        let ray = lens.ray_from_pixel(corner).unwrap();
        assert!(lens.pixel_from_ray(ray).distance(corner) < 1e-4);
    }
}

proptest! {
    #[test]
    fn ray_and_pixel_are_inverses(
        fov in 0.5..1.6f64, k1 in -0.25..0.25f64, k2 in -0.05..0.05f64, p1 in -0.003..0.003f64,
        p2 in -0.003..0.003f64, k3 in -0.01..0.01f64, x in 0.0..1.0f64, y in 0.0..1.0f64,
    ) {
        let lens = Intrinsics { k1, k2, p1, p2, k3, ..Intrinsics::pinhole(800, 600, fov) };
        // A lens that folds is refused; all others invert everywhere.
        if lens.check().is_ok() {
            let pixel = DVec2::new(x * 799.0, y * 599.0);
            let ray = lens.ray_from_pixel(pixel);
            prop_assert!(ray.is_some());
            let back = lens.pixel_from_ray(ray.unwrap_or(DVec2::NAN));
            prop_assert!(back.distance(pixel) < 1e-4, "{back} {pixel}");
        } else {
            // Somewhere before the corner the radial distortion stops growing, or grows by less
            // than the slope that the tangential one may take from it: a fold.
            let reach = |r: f64| r * (1.0 + k1 * r.powi(2) + k2 * r.powi(4) + k3 * r.powi(6));
            let slope =
                |r: f64| 1.0 + 3.0 * k1 * r.powi(2) + 5.0 * k2 * r.powi(4) + 7.0 * k3 * r.powi(6);
            let tangential = |r: f64| 6.0 * (p1.abs() + p2.abs()) * r;
            let corner = DVec2::new(400.0, 300.0).length() / lens.fx;
            let folds = (0..20_000)
                .map(|i| f64::from(i) * 1e-3)
                .take_while(|&r| reach(r) < corner * 1.05)
                .any(|r| slope(r) <= tangential(r));
            prop_assert!(folds, "refused without need");
        }
    }
}
