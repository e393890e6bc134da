//! The video background: framing, mirroring and lens against their twins on the CPU.

use std::time::{Duration, Instant};

use glam::{DVec2, UVec2, Vec2, Vec3};
use virtual_sculpture::gpu::Frames;
use virtual_sculpture::render::{Backdrop, VideoView};
use virtual_sculpture::screen::offscreen::{FORMAT, Offscreen};
use virtual_sculpture::video::{Fit, Framing, Intrinsics, VideoFrame};

use super::fixture::with_device;

const PICTURE: UVec2 = UVec2::new(64, 48);
const SCREEN: UVec2 = UVec2::new(90, 50);
const BEYOND: Vec3 = Vec3::new(0.2, 0.4, 0.6);

/// A gradient, so that a pixel's colour gives its position to a fraction of a pixel: red increases to the right, green
/// downwards.
fn shade_at(at: Vec2) -> Vec2 {
    (at + 0.5) * Vec2::new(3.0, 4.0) + 20.0
}

fn frame() -> VideoFrame {
    let mut pixels = Vec::new();
    for y in 0..PICTURE.y {
        for x in 0..PICTURE.x {
            let shade = shade_at(Vec2::new(x as f32, y as f32));
            pixels.extend([shade.x.round() as u8, shade.y.round() as u8, 99, 255]);
        }
    }
    VideoFrame {
        width: PICTURE.x,
        height: PICTURE.y,
        pixels,
        arrived: Instant::now(),
        position: Duration::ZERO,
        sequence: 1,
    }
}

#[test]
fn the_picture_lies_where_framing_and_lens_say() {
    let lens = Intrinsics {
        cx: 33.0,
        cy: 22.0,
        k1: -0.2,
        k2: 0.05,
        p1: 0.004,
        p2: -0.003,
        k3: 0.01,
        ..Intrinsics::pinhole(PICTURE.x, PICTURE.y, 1.0)
    };
    lens.check().unwrap();
    with_device(|device| {
        let mut backdrop = Backdrop::new(device, FORMAT).unwrap();
        let mut screen = Offscreen::new(device, SCREEN, 1).unwrap();
        let mut frames = Frames::new(device).unwrap();
        let frame = frame();
        let views = [Fit::Fit, Fit::Fill, Fit::Stretch]
            .into_iter()
            .flat_map(|fit| [(fit, false, None), (fit, true, None), (fit, true, Some(lens))]);
        for (fit, mirror, lens) in views {
            let view = VideoView { fit, mirror, lens, beyond: BEYOND };
            let mut recorder = frames.begin().unwrap();
            backdrop.begin(frames.slot());
            backdrop.bring(&mut recorder, &frame).unwrap();
            screen.begin(&mut recorder, 0);
            backdrop.draw(&mut recorder, SCREEN, &view);
            screen.end(&mut recorder);
            frames.submit(recorder, &[], &[]).unwrap();
            let drawn = screen.read_back(0).unwrap();

            let framing = Framing::new(PICTURE, SCREEN, fit, mirror);
            let size = PICTURE.as_vec2();
            let mut inside = 0;
            for (y, x) in (0..SCREEN.y).flat_map(|y| (0..SCREEN.x).map(move |x| (y, x))) {
                let on_screen = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / SCREEN.as_vec2();
                let mut at = framing.picture_from_screen(on_screen) * size - 0.5;
                if let Some(lens) = lens {
                    let centre = DVec2::new(lens.cx, lens.cy);
                    let ray = (at.as_dvec2() - centre) / DVec2::new(lens.fx, lens.fy);
                    at = lens.pixel_from_ray(ray).as_vec2();
                }
                let [r, g, b, _] = drawn.rgba[(x + y * SCREEN.x) as usize];
                let from_edge = (at + 0.5).min(size - 0.5 - at).min_element();
                if from_edge < -0.01 {
                    assert_eq!([r, g, b], [51, 102, 153], "{view:?} {x} {y}");
                } else if from_edge > 0.51 {
                    inside += 1;
                    let off = (Vec2::new(f32::from(r), f32::from(g)) - shade_at(at)).abs();
                    // A third of a pixel, including quantisation to 8 bits.
                    assert!(off.max_element() <= 1.5, "{view:?} {x} {y}: {off}");
                }
            }
            assert!(inside > 2000, "{view:?}: {inside}");
        }
    });
}
