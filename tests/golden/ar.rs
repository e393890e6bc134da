//! A sculpture on a printed marker: from the frame of a camera with a distorting lens to the final picture, through
//! detection, pose estimation, eye and renderer. The ground truth is the pose from which the frame is rendered; the code
//! under test does not know it.

use glam::{Affine3A, DQuat, DVec2, DVec3, UVec2, Vec2, Vec3};
use virtual_sculpture::document::Document;
use virtual_sculpture::fiducial::MarkerPose;
use virtual_sculpture::fiducial::{Grey, detect, poses};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::{Video, VideoView};
use virtual_sculpture::shade::Pixels;
use virtual_sculpture::video::{Fit, Framing, Intrinsics, MarkerPlacement, VideoFrame};
use virtual_sculpture::view::Eye;

use super::paint::{Painter, Scene, document};
use super::printed::{self, ID, SIZE_M};
use super::record::assert_recorded;
use super::silhouette::{Mask, hull};
use crate::gpu::fixture::with_device;

const CAMERA: UVec2 = UVec2::new(640, 480);
/// Edge of the block in voxels, and of a voxel in metres: 4 cm on a marker of 8 cm.
const EDGE_VX: f32 = 32.0;
const VOXEL_M: f32 = 0.00125;
const STAND: MarkerPlacement = MarkerPlacement { ground: 0.0, m_per_unit: VOXEL_M };

fn lens() -> Intrinsics {
    let even = Intrinsics::pinhole(CAMERA.x, CAMERA.y, 48f64.to_radians());
    Intrinsics { k1: -0.28, k2: 0.09, p1: 0.0008, p2: -0.0006, cx: 325.0, cy: 232.0, ..even }
}

/// A camera above a table, with its tilt in degrees and the rotation and distance of the marker.
fn truth(tilt_deg: f64, spin_deg: f64, translation_m: [f64; 3]) -> MarkerPose {
    MarkerPose {
        rotation: DQuat::from_rotation_x(-tilt_deg.to_radians())
            * DQuat::from_rotation_z(spin_deg.to_radians()),
        translation_m: translation_m.into(),
        error_px: 0.0,
    }
}

/// A red block, upright in the middle of the marker, one upper corner of it blue.
fn block(more: &str) -> Document {
    document(&format!(
        "new dims=32,32,32 colour=24 base=#c84632 fill=solid\n\
         recolour cuboid at=28,28,28 half=4,4,4 colour=#2846c8\n{more}"
    ))
}

fn on_marker() -> Affine3A {
    Affine3A::from_translation(Vec3::new(-16.0, 0.0, -16.0))
}

/// The program's result for a frame.
fn eye(frame: &VideoFrame, screen: UVec2, mirror: bool) -> (Eye, VideoView) {
    let grey = Grey::from_rgba(frame.width, frame.height, &frame.pixels);
    let seen = detect(&grey, &lens());
    assert_eq!(seen.len(), 1);
    assert_eq!(seen[0].id, ID);
    let pose = poses(&seen[0].corners, SIZE_M, lens().fx)[0];
    let camera_from_marker =
        Affine3A::from_rotation_translation(pose.rotation.as_quat(), pose.translation_m.as_vec3());
    let framing = Framing::new(CAMERA, screen, Fit::Fill, mirror);
    let eye = STAND.eye(camera_from_marker, &lens(), &framing, screen, 0.01 / VOXEL_M);
    let view = VideoView { fit: Fit::Fill, mirror, lens: Some(lens()), beyond: Vec3::ZERO };
    (eye, view)
}

fn paint(
    painter: &mut Painter,
    document: &mut Document,
    frame: &VideoFrame,
    (eye, view): (Eye, VideoView),
    mode: RenderMode,
) -> Pixels {
    let scene = Scene {
        eyes: &[eye],
        world_from_grid: on_marker(),
        mode,
        video: Some(Video { frame, view }),
        previews: &[],
    };
    painter.paint(document, &scene).remove(0)
}

/// The true position, in pixels, of a point in marker axes on a screen that shows the undistorted camera picture.
fn true_pixel(truth: &MarkerPose, marker_m: DVec3, screen: UVec2, mirror: bool) -> Vec2 {
    let p = truth.apply(marker_m);
    let Intrinsics { fx, fy, cx, cy, .. } = lens();
    let pixel = DVec2::new(fx * p.x / -p.z + cx, fy * p.y / p.z + cy) + 0.5;
    // The screen has the shape of the picture.
    let on_screen = pixel / CAMERA.as_dvec2() * screen.as_dvec2();
    let x = if mirror { f64::from(screen.x) - on_screen.x } else { on_screen.x };
    DVec2::new(x, on_screen.y).as_vec2()
}

/// A corner of the block on the marker's axes.
fn corner(index: u32) -> DVec3 {
    let side = |bit: u32| if index >> bit & 1 == 0 { -0.5 } else { 0.5 };
    DVec3::new(side(0), side(1), side(2) + 0.5) * f64::from(EDGE_VX * VOXEL_M)
}

fn mask(picture: &Pixels, is: impl Fn(i32, i32, i32) -> bool) -> Mask {
    let set = picture.rgba.iter().map(|[r, g, b, _]| is((*r).into(), (*g).into(), (*b).into()));
    Mask { size: picture.size, set: set.collect() }
}

/// The video is grey, the block is not.
fn block_of(picture: &Pixels) -> Mask {
    mask(picture, |r, g, b| r.max(b) > g + 12)
}

fn blue_of(picture: &Pixels) -> Mask {
    mask(picture, |r, _, b| b > r + 12)
}

#[test]
fn block_and_video_lie_where_they_truly_are() {
    with_device(|device| {
        // A renderer makes the pictures of one document.
        let mut painter = Painter::new(device);
        let mut document = block("");
        let mut painter_of_nothing = Painter::new(device);
        let mut nothing = block("clear grid\n");
        let places = [
            truth(50.0, 25.0, [0.01, -0.02, -0.33]),
            truth(35.0, -60.0, [-0.07, 0.03, -0.42]),
            truth(65.0, 130.0, [0.08, -0.05, -0.4]),
        ];
        for (sequence, truth) in (1..).zip(places) {
            let frame = printed::frame(&lens(), &truth, sequence);
            for mirror in [false, true] {
                let seen = eye(&frame, CAMERA, mirror);
                let picture = paint(&mut painter, &mut document, &frame, seen, RenderMode::Ray);
                let block = block_of(&picture);
                let outline =
                    hull((0..8).map(|i| true_pixel(&truth, corner(i), CAMERA, mirror)).collect());
                assert_eq!(outline.len(), 6, "three faces are seen");
                for (found, true_corner) in block.corners(&outline).iter().zip(&outline) {
                    let off_px = found.distance(*true_corner);
                    assert!(off_px < 2.0, "{off_px} px at {true_corner}: {truth:?}");
                }
                if mirror {
                    continue;
                }
                // The video without the block: undistorted, with the marker in place.
                let painter = &mut painter_of_nothing;
                let video = paint(painter, &mut nothing, &frame, seen, RenderMode::Ray);
                let rgba: Vec<u8> = video.rgba.iter().flatten().copied().collect();
                let straight = Intrinsics { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0, ..lens() };
                let found = detect(&Grey::from_rgba(CAMERA.x, CAMERA.y, &rgba), &straight);
                let corners = [(-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5)];
                for (ray, (x, y)) in found[0].corners.iter().zip(corners) {
                    let at = straight.pixel_from_ray(*ray).as_vec2() + 0.5;
                    let place = DVec3::new(x, y, 0.0) * SIZE_M;
                    let off_px = at.distance(true_pixel(&truth, place, CAMERA, false));
                    assert!(off_px < 1.0, "{off_px} px: {truth:?}");
                }
            }
        }
    });
}

/// The block with a tunnel from the front to the back, through which the paper is seen.
fn tunnelled() -> Document {
    block("subtract cuboid at=16,10,16 half=8,10,16\n")
}

#[test]
fn a_sculpture_on_a_marker_plain_and_mirrored() {
    with_device(|device| {
        let mut painter = Painter::new(device);
        let screen = UVec2::new(240, 180);
        let truth = truth(35.0, 20.0, [0.005, -0.015, -0.22]);
        let frame = printed::frame(&lens(), &truth, 1);
        let mut document = tunnelled();
        let mut take = |mirror, mode| {
            let seen = eye(&frame, screen, mirror);
            paint(&mut painter, &mut document, &frame, seen, mode)
        };
        assert_recorded("ar.png", &take(false, RenderMode::Ray));
        assert_recorded("ar-mirrored.png", &take(true, RenderMode::Ray));
        for mode in RenderMode::ALL {
            let [plain, mirrored] = [false, true].map(|mirror| take(mirror, mode));
            // The same on the other side, light and all.
            let flipped = |i: usize| {
                let (x, y) = (i as u32 % screen.x, i as u32 / screen.x);
                plain.rgba[(y * screen.x + screen.x - 1 - x) as usize]
            };
            let differs = |(i, is): &(usize, &[u8; 4])| {
                is.iter().zip(flipped(*i)).any(|(a, b)| a.abs_diff(b) > 24)
            };
            let strays = mirrored.rgba.iter().enumerate().filter(differs).count();
            assert!(strays < 200, "{mode:?}: {strays} pixels are not those of the mirror");
            if !matches!(mode, RenderMode::Gpu) {
                // The marked corner: a step to the right on the marker is one to the left here.
                for (picture, mirror) in [(&plain, false), (&mirrored, true)] {
                    let blue = blue_of(picture);
                    let middle = DVec3::new(12.0, -12.0, 28.0) * f64::from(VOXEL_M);
                    let expected = true_pixel(&truth, middle, screen, mirror);
                    assert!(blue.count() > 50, "{mode:?}");
                    let off_px = blue.middle().distance(expected);
                    assert!(off_px < 4.0, "{mode:?} {mirror}: {} {expected}", blue.middle());
                }
            }
        }
    });
}
