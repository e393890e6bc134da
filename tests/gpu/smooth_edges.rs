//! Smooth edges of pictures that are not refined: nearer to the truth at outlines, and the same to the byte elsewhere.

use std::sync::Arc;

use glam::{Affine3A, UVec2, UVec3, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::overlay::OverlayLine;
use virtual_sculpture::render::{Background, FrameDesc, RenderMode, Renderer, SmoothSurface};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::{Lighting, Pixels};
use virtual_sculpture::surface::{IndexMap, raycast};
use virtual_sculpture::view::{Camera, Eye, StereoRig};

use super::fixture::with_device;
use super::modes::painted;

const SIZE: UVec2 = UVec2::new(160, 120);

fn document(grid: Grid) -> Document {
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(220, 200, 120));
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

/// A ball and a bar, with stripes.
fn painted_ball() -> Document {
    let mut document = document(Grid::new(UVec3::splat(96), Vec3::ONE, 1 << 24).unwrap());
    let mut apply = |text: &str| document.apply(&text.parse().unwrap()).unwrap();
    apply("add ellipsoid at=48,48,48 half=38,38,38 colour=#e0c878");
    for x in (12..84).step_by(8) {
        apply(&format!("recolour cuboid at={x},48,48 half=2,48,48 colour=#103060"));
    }
    document
}

fn eye() -> Eye {
    Camera::framing(60.0, Vec3::new(0.7, 0.5, 1.0), Vec3::Y).eye(SIZE)
}

fn desc(mode: RenderMode, eyes: &[Eye], smooth_edges: bool) -> FrameDesc<'_> {
    FrameDesc {
        eyes,
        world_from_grid: Affine3A::from_translation(Vec3::splat(-48.0)),
        smooth_surface: SmoothSurface::Never,
        sample: 0,
        mode,
        lighting: Lighting::default(),
        show_mask: false,
        background: Background::Gradient { top: Vec3::new(0.1, 0.2, 0.4), bottom: Vec3::ZERO },
        ground: None,
        smooth_edges,
        video: None,
        previews: &[],
        lines: &[],
    }
}

fn pictures(device: &Arc<Device>, document: &mut Document, desc: &FrameDesc) -> Vec<Pixels> {
    let mut frames = Frames::new(device).unwrap();
    let mut renderer = Renderer::new(device, FORMAT).unwrap();
    painted(&mut frames, &mut renderer, document, desc)
}

/// The mean of 16 samples, in linear light, as values of 0 to 255.
fn supersampled(
    frames: &mut Frames,
    renderer: &mut Renderer,
    document: &mut Document,
    desc: &FrameDesc,
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0f64; 3]; SIZE.element_product() as usize];
    for index in 0..16 {
        let eyes: Vec<Eye> = desc.eyes.iter().map(|eye| eye.sample(index)).collect();
        let desc = FrameDesc { eyes: &eyes, ..*desc };
        let picture = painted(frames, renderer, document, &desc).remove(0);
        for (sum, rgba) in sums.iter_mut().zip(&picture.rgba) {
            for (sum, value) in sum.iter_mut().zip(rgba) {
                *sum += f64::from(*value).powi(2) / 16.0;
            }
        }
    }
    sums.into_iter().map(|sum| sum.map(f64::sqrt)).collect()
}

fn rms(picture: &Pixels, expected: &[[f64; 3]]) -> f64 {
    let squares = picture.rgba.iter().zip(expected).flat_map(|(found, expected)| {
        found.iter().zip(expected).map(|(f, e)| (f64::from(*f) - e).powi(2))
    });
    (squares.sum::<f64>() / (3.0 * expected.len() as f64)).sqrt()
}

#[test]
fn pictures_come_nearer_to_supersampled_ones_with_every_shading() {
    with_device(|device| {
        let eyes = [eye()];
        // Of one colour, so that outlines alone differ, and with others before others.
        let mut ball = document(Grid::new(UVec3::splat(96), Vec3::ONE, 1 << 24).unwrap());
        ball.apply(&"add ellipsoid at=48,48,48 half=38,38,38 colour=#e0c878".parse().unwrap())
            .unwrap();
        let mut cheese = document(scenes::cheese(96, 24, 5).unwrap());
        // One of each shading.
        for mode in [
            RenderMode::Slicing,
            RenderMode::MarchGpu,
            RenderMode::GpuColour,
            RenderMode::RayPoints,
        ] {
            for (name, document, most) in [("ball", &mut ball, 0.5), ("cheese", &mut cheese, 0.85)]
            {
                let mut frames = Frames::new(device).unwrap();
                let mut renderer = Renderer::new(device, FORMAT).unwrap();
                let [sharp, smooth] = [false, true].map(|smooth| desc(mode, &eyes, smooth));
                let truth = supersampled(&mut frames, &mut renderer, document, &sharp);
                let mut error = |desc: &FrameDesc| {
                    let picture = painted(&mut frames, &mut renderer, document, desc).remove(0);
                    rms(&picture, &truth)
                };
                let (sharp, smooth) = (error(&sharp), error(&smooth));
                trials::note!(
                    "{mode:?}, {name}: error {sharp:.2} of 255, with smooth edges {smooth:.2}"
                );
                assert!(smooth < most * sharp, "{mode:?}, {name}: {sharp} to {smooth}");
            }
        }
    });
}

/// Inside a surface without folds, and where there is none, nothing is mixed, whatever the colours.
#[test]
fn pixels_away_from_outlines_stay_the_same_to_the_byte() {
    with_device(|device| {
        let mut document = painted_ball();
        let eyes = [eye()];
        let at = desc(RenderMode::Ray, &eyes, false).world_from_grid;
        let mut map = IndexMap::new(eyes[0].pixel_rays(&at));
        raycast::sample(document.grid(), &map.rays.clone(), &mut map);
        let seen = |x: i32, y: i32| {
            let inside =
                x.clamp(0, SIZE.x as i32 - 1) + y.clamp(0, SIZE.y as i32 - 1) * SIZE.x as i32;
            map.voxels[inside as usize] != u32::MAX
        };
        for mode in [RenderMode::Ray, RenderMode::MarchGpu, RenderMode::GpuColour] {
            let [sharp, smooth] = [false, true]
                .map(|on| pictures(device, &mut document, &desc(mode, &eyes, on)).remove(0));
            let (mut kept, mut mixed) = (0, 0);
            for (i, (sharp, smooth)) in sharp.rgba.iter().zip(&smooth.rgba).enumerate() {
                let (x, y) = ((i as u32 % SIZE.x) as i32, (i as u32 / SIZE.x) as i32);
                let around = (-1..2).flat_map(|dy| (-1..2).map(move |dx| (x + dx, y + dy)));
                if around.map(|(x, y)| seen(x, y)).all(|there| there == seen(x, y)) {
                    assert_eq!(sharp, smooth, "{mode:?} at {x}, {y}");
                    kept += 1;
                } else {
                    mixed += usize::from(sharp != smooth);
                }
            }
            assert!(kept > 10_000 && mixed > 100, "{mode:?}: {kept} {mixed}");
        }
        let mut empty = self::document(Grid::new(UVec3::splat(96), Vec3::ONE, 1 << 24).unwrap());
        let of = |on| (RenderMode::Ray, on);
        let [sharp, smooth] = [of(false), of(true)]
            .map(|(mode, on)| pictures(device, &mut empty, &desc(mode, &eyes, on)));
        assert!(sharp == smooth, "without edges");
    });
}

#[test]
fn lines_stay_sharp_and_each_eye_is_its_own_picture() {
    with_device(|device| {
        let mut document = painted_ball();
        let middle = eye();
        let rig = StereoRig { eye_distance: 12.0, convergence: 140.0, swap: false };
        let eyes = rig.eyes(&middle);
        let both = pictures(device, &mut document, &desc(RenderMode::MarchGpu, &eyes, true));
        for (eye, picture) in eyes.iter().zip(&both) {
            let alone = [*eye];
            let alone = desc(RenderMode::MarchGpu, &alone, true);
            assert!(pictures(device, &mut document, &alone).remove(0) == *picture);
        }
        // A line over the background, where no edge is near.
        let line = OverlayLine {
            from: Vec3::new(40.0, 99.0, 48.0),
            to: Vec3::new(56.0, 104.0, 48.0),
            colour: Rgb::new(255, 255, 255),
            width_px: 2.0,
            opacity: [1.0, 1.0],
        };
        let eyes = [middle];
        let mut empty = self::document(Grid::new(UVec3::splat(96), Vec3::ONE, 1 << 24).unwrap());
        let [sharp, smooth] = [false, true].map(|on| {
            let desc = FrameDesc { lines: &[line], ..desc(RenderMode::Ray, &eyes, on) };
            pictures(device, &mut empty, &desc)
        });
        assert!(sharp == smooth, "lines are drawn afterwards");
        assert!(sharp[0].rgba.contains(&[255; 4]));
    });
}

#[test]
fn partial_redraws_equal_whole_ones() {
    with_device(|device| {
        let eyes = [eye()];
        for mode in [RenderMode::Ray, RenderMode::MarchGpu, RenderMode::GpuColour] {
            let mut document = document(scenes::cheese(96, 24, 5).unwrap());
            let desc = desc(mode, &eyes, true);
            let mut frames = Frames::new(device).unwrap();
            let mut renderer = Renderer::new(device, FORMAT).unwrap();
            painted(&mut frames, &mut renderer, &mut document, &desc);
            for edit in [
                "subtract ellipsoid at=90,88,90 half=9,9,9",
                "add ellipsoid at=48,95,48 half=6,9,6 colour=#30c060",
                "subtract cuboid at=20,60,92 half=7,3,9",
            ] {
                document.apply(&edit.parse().unwrap()).unwrap();
                let found = painted(&mut frames, &mut renderer, &mut document, &desc);
                assert!(found == pictures(device, &mut document, &desc), "{mode:?}: {edit}");
            }
        }
    });
}
