//! Renders a camera's picture of a printed marker on a chequered table, from a known camera pose.

use glam::{DVec2, DVec3, UVec2};
use image::GrayImage;
use virtual_sculpture::fiducial::MarkerPose;
use virtual_sculpture::fiducial::sheet;
use virtual_sculpture::video::{Intrinsics, VideoFrame};

pub const ID: u32 = 3;
pub const SIZE_M: f64 = 0.08;
/// Samples per pixel along each axis.
const PARTS: usize = 3;

/// The picture of a camera with this lens, with the marker at `truth`.
pub fn frame(lens: &Intrinsics, truth: &MarkerPose, sequence: u64) -> VideoFrame {
    let png = sheet::png(ID, SIZE_M * 1e3).unwrap();
    let sheet = image::load_from_memory(&png).unwrap().to_luma8();
    let mut pixels = Vec::new();
    for y in 0..lens.height {
        for x in 0..lens.width {
            let mut sum = 0.0;
            for part in 0..PARTS * PARTS {
                let off = |k: usize| (k as f64 + 0.5) / PARTS as f64 - 0.5;
                let at =
                    DVec2::new(f64::from(x) + off(part % PARTS), f64::from(y) + off(part / PARTS));
                sum += light(lens.ray_from_pixel(at).unwrap(), truth, &sheet);
            }
            let grey = (sum / (PARTS * PARTS) as f64).round() as u8;
            pixels.extend([grey, grey, grey, 255]);
        }
    }
    VideoFrame { width: lens.width, height: lens.height, pixels, sequence, ..VideoFrame::empty() }
}

/// Brightness in a direction.
fn light(ray: DVec2, truth: &MarkerPose, sheet: &GrayImage) -> f64 {
    let inverse = truth.rotation.inverse();
    let eye = inverse * -truth.translation_m;
    let along = inverse * DVec3::new(ray.x, -ray.y, -1.0);
    let far = -eye.z / along.z;
    if far <= 0.0 {
        return 60.0;
    }
    let at = eye + along * far;
    let (width, height) = sheet.dimensions();
    let side_m = sheet::side_mm(SIZE_M * 1e3) * 1e-3;
    let on_sheet = DVec2::new(at.x, -at.y) / side_m + 0.5;
    if on_sheet.cmpge(DVec2::ZERO).all() && on_sheet.cmplt(DVec2::ONE).all() {
        let pixel = (on_sheet * UVec2::new(width, height).as_dvec2()).as_uvec2();
        return if sheet.get_pixel(pixel.x, pixel.y).0[0] > 127 { 215.0 } else { 30.0 };
    }
    let chequer = ((at.x / 0.05).floor() + (at.y / 0.05).floor()).rem_euclid(2.0);
    100.0 + 40.0 * chequer
}
