//! The ground below the sculpture in every kind of render mode, against its twin on the CPU.

use std::sync::Arc;

use glam::{Affine3A, UVec2, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::{Background, FrameDesc, RenderMode, Renderer, SmoothSurface};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::ground::GroundShader;
use virtual_sculpture::shade::{Ground, Lighting, Pixels, ShadePose};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;
use super::modes::painted;

const SIZE: UVec2 = UVec2::new(160, 120);

fn document(grid: Grid) -> Document {
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::new(210, 120, 60));
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

fn cheese() -> Document {
    document(scenes::cheese(64, 14, 5).unwrap())
}

fn eye() -> Eye {
    Camera::framing(60.0, Vec3::new(0.8, 0.7, 1.0), Vec3::Y).eye(SIZE)
}

fn ground() -> Ground {
    let colour = Rgb::new(190, 200, 210);
    Ground { up: Vec3::Y, colour, shadow_only: false, sun_deg: 5.0, sample: 0 }
}

fn desc(mode: RenderMode, eyes: &[Eye], ground: Option<Ground>) -> FrameDesc<'_> {
    FrameDesc {
        eyes,
        world_from_grid: Affine3A::from_translation(Vec3::splat(-32.0)),
        smooth_surface: SmoothSurface::Never,
        sample: 0,
        mode,
        lighting: Lighting::default(),
        show_mask: false,
        background: Background::Gradient { top: Vec3::new(0.1, 0.2, 0.4), bottom: Vec3::ZERO },
        ground,
        smooth_edges: false,
        video: None,
        previews: &[],
        lines: &[],
    }
}

fn picture(device: &Arc<Device>, document: &mut Document, desc: &FrameDesc) -> Pixels {
    let mut frames = Frames::new(device).unwrap();
    let mut renderer = Renderer::new(device, FORMAT).unwrap();
    painted(&mut frames, &mut renderer, document, desc).remove(0)
}

/// `picture` with the ground of the twin where it shows the `background`.
fn with_ground(
    picture: &Pixels,
    background: &Pixels,
    document: &Document,
    desc: &FrameDesc,
) -> Pixels {
    let (grid, ground) = (document.grid(), desc.ground.unwrap());
    let mut shader = GroundShader::new(grid, ground.up).unwrap();
    let eye = &desc.eyes[0];
    let world_from_grid = desc.world_from_grid;
    let pose = ShadePose { eye_from_world: eye.eye_from_world, world_from_grid };
    let rays = eye.pixel_rays(&world_from_grid);
    let mut pixels = Pixels::new(SIZE);
    shader.put_behind(&ground, &desc.lighting, &pose, &rays, &mut pixels);
    let mut out = picture.clone();
    for ((out, behind), front) in out.rgba.iter_mut().zip(&background.rgba).zip(&pixels.rgba) {
        if out == behind {
            let opacity = f32::from(front[3]) / 255.0;
            for channel in 0..3 {
                let [front, behind] = [front[channel], behind[channel]].map(f32::from);
                out[channel] = (behind + (front - behind) * opacity).round() as u8;
            }
        }
    }
    out
}

fn assert_near(what: &str, found: &Pixels, expected: &Pixels) {
    for (i, (found, expected)) in found.rgba.iter().zip(&expected.rgba).enumerate() {
        let off = found.iter().zip(expected).map(|(f, e)| f.abs_diff(*e)).max();
        let at = UVec2::new(i as u32 % SIZE.x, i as u32 / SIZE.x);
        assert!(off <= Some(2), "{what} at {at}: {found:?}, not {expected:?}");
    }
}

#[test]
fn the_ground_is_that_of_the_cpu_in_every_mode() {
    with_device(|device| {
        let eyes = [eye()];
        let empty = Grid::new(glam::UVec3::splat(64), Vec3::ONE, 1 << 20).unwrap();
        let (mut cheese, mut empty) = (cheese(), document(empty));
        let background = picture(device, &mut empty, &desc(RenderMode::Ray, &eyes, Some(ground())));
        let plain = picture(device, &mut empty, &desc(RenderMode::Ray, &eyes, None));
        assert!(background == plain, "below nothing there is no ground");
        let shadow_only = Ground { shadow_only: true, ..ground() };
        for mode in RenderMode::ALL {
            for ground in [ground(), shadow_only] {
                let [without, with] = [None, Some(ground)].map(|ground| desc(mode, &eyes, ground));
                let plain = picture(device, &mut cheese, &without);
                let found = picture(device, &mut cheese, &with);
                let expected = with_ground(&plain, &background, &cheese, &with);
                let what = format!("{mode:?}, shadow alone: {}", ground.shadow_only);
                assert_near(&what, &found, &expected);
                let changed = plain.rgba.iter().zip(&found.rgba).filter(|(a, b)| a != b).count();
                let least = if ground.shadow_only { 300 } else { 2000 };
                assert!(changed > least, "{what}: {changed} pixels");
                let brighter = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).any(|c| b[c] > a[c]);
                let brighter = plain.rgba.iter().zip(&found.rgba).filter(|pair| brighter(*pair));
                assert_eq!(brighter.count() == 0, ground.shadow_only, "{what}");
            }
        }
    });
}

/// Two pictures of a renderer equal those of new ones, while the sculpture's shadow follows an edit in the air.
#[test]
fn the_shadow_follows_edits_and_the_ground_the_lowest_voxel() {
    with_device(|device| {
        let eyes = [eye()];
        for mode in [RenderMode::Ray, RenderMode::MarchGpu] {
            let mut document = cheese();
            let desc = desc(mode, &eyes, Some(ground()));
            let mut frames = Frames::new(device).unwrap();
            let mut renderer = Renderer::new(device, FORMAT).unwrap();
            let mut last = painted(&mut frames, &mut renderer, &mut document, &desc).remove(0);
            for edit in [
                "subtract cuboid at=32,50,32 half=32,16,32",
                "add cuboid at=2,60,2 half=2,2,2 colour=#ffffff",
                "subtract cuboid at=32,4,32 half=40,6,40",
            ] {
                document.apply(&edit.parse().unwrap()).unwrap();
                let found = painted(&mut frames, &mut renderer, &mut document, &desc).remove(0);
                assert!(found == picture(device, &mut document, &desc), "{mode:?}: {edit}");
                let differ = last.rgba.iter().zip(&found.rgba).filter(|(a, b)| a != b).count();
                assert!(differ > 200, "{mode:?}: {edit}: {differ} pixels");
                last = found;
            }
        }
    });
}
