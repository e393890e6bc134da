//! A renderer that has been warmed up creates no pipeline for its first picture, and draws the same.

use glam::{Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::Frames;
use virtual_sculpture::render::overlay::{OverlayLine, ToolPreview};
use virtual_sculpture::render::{
    Background, FrameDesc, RenderMode, Renderer, SmoothSurface, WarmUp,
};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Placement, Rgb};
use virtual_sculpture::shade::{Light, LightFrame, LightSource, Lighting};
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::Camera;

use super::fixture::with_device;
use super::modes::painted;

const RED: Rgb = Rgb::new(255, 0, 0);

fn document(depth: ColourDepth) -> Document {
    let cheese = scenes::cheese(40, 20, 8).unwrap();
    let mut grid = Grid::new(UVec3::splat(40), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|b| *cheese.brick(b));
    let material = Material::for_grid(&grid, depth, Rgb::new(180, 170, 150));
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

/// Lit otherwise than by default: constants of the shaders are those of the light.
fn lighting() -> Lighting {
    let lamp = |source| {
        let colour = Rgb::new(250, 250, 250);
        Some(Light { frame: LightFrame::World, source, colour, intensity: 0.5 })
    };
    Lighting {
        lights: [
            lamp(LightSource::Direction(Vec3::new(0.3, 2.0, 1.0))),
            None,
            lamp(LightSource::Position(Vec3::new(30.0, 50.0, -10.0))),
            None,
        ],
        occlusion: true,
        ..Lighting::default()
    }
}

#[test]
fn the_first_picture_after_warming_up_creates_no_pipeline_in_any_mode() {
    with_device(|device| {
        let depth = ColourDepth::Bits16;
        let mut document = document(depth);
        let dims = document.grid().dims();
        let camera = Camera::framing(40.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y);
        let beside = Camera { eye: camera.eye + Vec3::X, ..camera };
        let eyes = [camera, beside].map(|camera| camera.eye(UVec2::new(90, 70)));
        let tool = ToolPreview {
            primitive: Primitive {
                solid: Solid::Pyramid,
                centre_vx: Vec3::splat(30.0),
                half: Vec3::splat(12.0),
                rotation: Quat::IDENTITY,
            },
            voxel_size: Vec3::ONE,
            colour: RED,
            opacity: [0.5, 0.2],
        };
        let line = OverlayLine {
            from: Vec3::splat(-5.0),
            to: Vec3::splat(45.0),
            colour: RED,
            width_px: 2.0,
            opacity: [0.9, 0.4],
        };
        for mode in RenderMode::ALL {
            let desc = FrameDesc {
                eyes: &eyes,
                world_from_grid: Placement::default().world_from_grid(dims, Vec3::ONE),
                smooth_surface: SmoothSurface::Never,
                sample: 0,
                mode,
                lighting: lighting(),
                show_mask: false,
                background: Background::Gradient { top: Vec3::ONE, bottom: Vec3::X },
                ground: None,
                smooth_edges: true,
                video: None,
                previews: &[tool],
                lines: &[line],
            };
            let mut first_picture = |warm: bool| {
                let mut frames = Frames::new(device).unwrap();
                let mut renderer = Renderer::new(device, FORMAT).unwrap();
                if warm {
                    let of = WarmUp { mode, lighting: lighting(), smooth_edges: true, depth };
                    of.run(&mut renderer).unwrap();
                }
                let before = device.pipelines_created();
                let pictures = painted(&mut frames, &mut renderer, &mut document, &desc);
                let created = device.pipelines_created() - before;
                // The samples of the refined picture, one a frame.
                renderer.set_refinement(2);
                renderer.refine_at_once(true);
                let mut refined = Vec::new();
                for _ in 0..2 {
                    refined = painted(&mut frames, &mut renderer, &mut document, &desc);
                }
                assert!(refined != pictures, "{mode:?}: not refined");
                let in_all = device.pipelines_created() - before;
                ([pictures, refined], [created, in_all])
            };
            let (cold, warm) = (first_picture(false), first_picture(true));
            trials::note!("{mode:?}: {:?} pipelines in the first and the refined picture", cold.1);
            assert_eq!(warm.1, [0, 0], "{mode:?}");
            assert!(cold.0 == warm.0, "{mode:?}: another picture");
            // Pictures of the CPU are only composed, which every mode needs, and their edges smoothed.
            let composed_only = matches!(mode, RenderMode::Ray | RenderMode::Quickstep);
            assert_eq!(cold.1[0] == 1, composed_only, "{mode:?}");
        }
    });
}
