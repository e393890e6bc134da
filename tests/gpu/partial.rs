//! Edits while the view stands still: a partly redrawn picture equals the picture of a new renderer.

use std::sync::Arc;

use glam::{Affine3A, Quat, UVec2, Vec3};
use virtual_sculpture::command::Command;
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::overlay::{OverlayLine, ToolPreview};
use virtual_sculpture::render::{Background, FrameDesc, Renderer, SmoothSurface};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Material, Rgb};
use virtual_sculpture::shade::{Lighting, Pixels};
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

const SIZE: UVec2 = UVec2::new(120, 90);

struct Painter {
    renderer: Renderer,
    frames: Frames,
    smooth_surface: SmoothSurface,
}

impl Painter {
    fn new(device: &Arc<Device>) -> Painter {
        let renderer = Renderer::new(device, FORMAT).unwrap();
        Painter {
            renderer,
            frames: Frames::new(device).unwrap(),
            smooth_surface: SmoothSurface::Never,
        }
    }

    fn smooth(device: &Arc<Device>) -> Painter {
        Painter { smooth_surface: SmoothSurface::Always, ..Painter::new(device) }
    }

    fn paint(
        &mut self,
        eyes: &[Eye],
        mode: RenderMode,
        (previews, lines): (&[ToolPreview], &[OverlayLine]),
        document: &mut Document,
    ) -> Vec<Pixels> {
        // Occlusion reaches farther than normals; half of the modes are drawn with it.
        let occlusion =
            RenderMode::ALL.iter().position(|of| *of == mode).is_some_and(|i| i % 2 == 0);
        let lighting = Lighting { occlusion, ..Lighting::default() };
        let grey = Vec3::splat(0.2);
        let desc = FrameDesc {
            eyes,
            world_from_grid: Affine3A::from_translation(Vec3::splat(-40.0)),
            smooth_surface: self.smooth_surface,
            sample: 0,
            mode,
            lighting,
            show_mask: true,
            background: Background::Gradient { top: grey, bottom: grey },
            ground: None,
            smooth_edges: false,
            video: None,
            previews,
            lines,
        };
        let mut recorder = self.frames.begin().unwrap();
        self.renderer.paint(&mut recorder, self.frames.slot(), document, &desc).unwrap();
        self.frames.submit(recorder, &[], &[]).unwrap();
        self.renderer.read_back().unwrap()
    }
}

/// A tool preview around a position.
fn preview(at: Vec3) -> ToolPreview {
    let primitive = Primitive {
        solid: Solid::Ellipsoid,
        centre_vx: at,
        half: Vec3::new(9.0, 6.0, 7.0),
        rotation: Quat::from_rotation_z(0.4),
    };
    let colour = Rgb::new(250, 200, 40);
    ToolPreview { primitive, voxel_size: Vec3::ONE, colour, opacity: [0.5, 0.2] }
}

fn line(from: Vec3, to: Vec3) -> OverlayLine {
    let colour = Rgb::new(20, 240, 250);
    OverlayLine { from, to, colour, width_px: 3.0, opacity: [1.0, 0.3] }
}

/// A block with holes that does not reach its grid's border, so that it can grow.
fn sculpture() -> Document {
    let grid = scenes::cheese(80, 14, 5).unwrap();
    let base = Rgb::new(200, 180, 160);
    let material = Material::for_grid(&grid, ColourDepth::Bits24, base);
    let mut document = Document::from_contents(Contents::new(grid, material), Limits::default());
    document.apply(&"subtract cuboid at=40,40,74 half=40,40,6".parse().unwrap()).unwrap();
    document
}

/// The same with half of it, and what is empty there, protected: above a slope.
fn masked() -> Document {
    let mut contents = sculpture().contents().clone();
    let mut mask = contents.grid.emptied();
    mask.fill_bricks(|b| if b.x + b.y > 9 { Brick::FULL } else { Brick::EMPTY });
    contents.mask = Some(Box::new(mask));
    Document::from_contents(contents, Limits::default())
}

#[test]
fn a_picture_followed_through_edits_is_the_picture_of_the_result() {
    with_device(|device| {
        for mode in RenderMode::ALL {
            follow_edits(&|| Painter::new(device), &sculpture, mode, SIZE);
        }
    });
}

#[test]
fn so_it_is_where_a_mask_is_shown() {
    with_device(|device| {
        for mode in RenderMode::ALL {
            follow_edits(&|| Painter::new(device), &masked, mode, SIZE);
        }
    });
}

/// So large that a voxel covers more than a pixel.
#[test]
fn a_smooth_surface_followed_through_edits_is_that_of_the_result() {
    with_device(|device| {
        for mode in [RenderMode::Ray, RenderMode::MarchGpu] {
            follow_edits(&|| Painter::smooth(device), &sculpture, mode, 3 * SIZE);
            let eyes = [eye(3 * SIZE, Vec3::X)];
            let [smooth, voxels] = [Painter::smooth(device), Painter::new(device)]
                .map(|mut painter| painter.paint(&eyes, mode, (&[], &[]), &mut sculpture()));
            assert!(smooth != voxels, "{mode:?}");
            // From afar there is nothing to be smoothed.
            let eyes = [eye(SIZE / 2, Vec3::X)];
            let [smooth, voxels] = [Painter::smooth(device), Painter::new(device)]
                .map(|mut painter| painter.paint(&eyes, mode, (&[], &[]), &mut sculpture()));
            assert!(smooth == voxels, "{mode:?}");
        }
    });
}

/// Whether the CPU or the device finds and lights the smooth surface, in whichever mode.
#[test]
fn smooth_pictures_of_all_modes_are_alike() {
    with_device(|device| {
        let eyes = [eye(3 * SIZE, Vec3::new(0.8, 0.6, 1.0))];
        let paint = |mode| {
            let mut painter = Painter::smooth(device);
            let mut document = sculpture();
            let first = painter.paint(&eyes, mode, (&[], &[]), &mut document);
            // A mode before it leaves nothing behind.
            painter.paint(&eyes, RenderMode::March, (&[], &[]), &mut document);
            assert!(painter.paint(&eyes, mode, (&[], &[]), &mut document) == first, "{mode:?}");
            first
        };
        // Pairs with the same light, see `Painter::paint`.
        for pair in
            [[RenderMode::MarchGpu, RenderMode::GpuColour], [RenderMode::Gpu, RenderMode::Ray]]
        {
            let [a, b] = pair.map(paint);
            let differs =
                |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 4);
            let strays = a[0].rgba.iter().zip(&b[0].rgba).filter(differs).count();
            assert!(100 * strays <= a[0].rgba.len(), "{pair:?}: {strays} pixels");
        }
    });
}

fn eye(size: UVec2, from: Vec3) -> Eye {
    Camera::framing(69.0, from, Vec3::Y).eye(size)
}

/// Compares pictures of a painter that follows edits with those of new ones.
fn follow_edits(
    new_painter: &dyn Fn() -> Painter,
    new_document: &dyn Fn() -> Document,
    mode: RenderMode,
    size: UVec2,
) {
    let eyes = [Vec3::new(0.8, 0.6, 1.0), Vec3::new(0.7, 0.6, 1.1)].map(|from| eye(size, from));
    let edits = [
        "subtract ellipsoid at=50,60,62 half=12,9,14 turn=20,30,40",
        "add cuboid at=50,60,71 half=6,4,6 colour=#c03020",
        "recolour ellipsoid at=60,60,68 half=14,14,14 colour=#2060c0",
        "undo 1",
        "symmetry x=even",
        "subtract pyramid at=20,70,60 half=10,10,10 turn=0,45,0",
        "mask add ellipsoid at=24,44,66 half=12,9,14 turn=20,30,40",
        "mask grow by=3",
        "mask subtract cuboid at=50,60,68 half=9,6,8 to=60,40,68",
        "mask invert",
        "undo all",
        "redo all",
        "mask clear",
    ];
    // The frame stays; the second line and the tool move, unless the mask alone changes: that is to be seen by itself.
    let frame = line(Vec3::ZERO, Vec3::splat(80.0));
    let mut document = new_document();
    let mut follower = new_painter();
    let mut before = follower.paint(&eyes, mode, (&[], &[frame]), &mut document);
    let mut moves = 0;
    for text in edits {
        moves += usize::from(!text.starts_with("mask"));
        let command: Command = text.parse().unwrap();
        document.apply(&command).unwrap();
        let place = Vec3::new(5.0 + 8.0 * moves as f32, 40.0, 70.0);
        let previews = &[preview(place)][..usize::from(moves % 3 != 1)];
        let lines = [frame, line(place, place + Vec3::Y * 20.0)];
        let tools = (previews, lines.as_slice());
        let followed = follower.paint(&eyes, mode, tools, &mut document);
        assert!(followed != before, "{mode:?}: {text} is seen");
        let anew = new_painter().paint(&eyes, mode, tools, &mut document);
        assert!(followed == anew, "{mode:?}: {text}");
        before = followed;
    }
    // Nothing stale remains when the eye moves, either, to what no picture has shown since it was edited.
    let tools: (&[ToolPreview], &[OverlayLine]) = (&[], &[frame]);
    for (angle, edit) in [(0.4, None), (2.4, None), (4.0, Some("undo 1")), (4.1, None)] {
        let turn = Affine3A::from_quat(Quat::from_rotation_y(angle));
        let moved = eyes.map(|eye| Eye { eye_from_world: eye.eye_from_world * turn, ..eye });
        if let Some(text) = edit {
            document.apply(&text.parse().unwrap()).unwrap();
        }
        let followed = follower.paint(&moved, mode, tools, &mut document);
        let anew = new_painter().paint(&moved, mode, tools, &mut document);
        assert!(followed == anew, "{mode:?}: turned by {angle}");
    }
}

#[test]
fn a_tool_that_moves_over_a_resting_sculpture_leaves_nothing_behind() {
    with_device(|device| {
        let eyes = [Camera::framing(69.0, Vec3::new(0.8, 0.6, 1.0), Vec3::Y).eye(SIZE)];
        let mut document = sculpture();
        for mode in RenderMode::ALL {
            let mut follower = Painter::new(device);
            let bare = follower.paint(&eyes, mode, (&[], &[]), &mut document);
            for i in 0..6 {
                let place = Vec3::new(15.0 * i as f32, 75.0 - 10.0 * i as f32, 66.0);
                let tools = (&[preview(place)][..], &[line(place, Vec3::splat(40.0))][..]);
                let followed = follower.paint(&eyes, mode, tools, &mut document);
                let anew = Painter::new(device).paint(&eyes, mode, tools, &mut document);
                assert!(followed == anew && followed != bare, "{mode:?}: {place}");
            }
            assert!(follower.paint(&eyes, mode, (&[], &[]), &mut document) == bare, "{mode:?}");
        }
    });
}
