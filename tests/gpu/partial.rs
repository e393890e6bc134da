//! Edits while nothing moves: what a renderer makes anew of a picture gives the picture that a new
//! renderer makes of it all.

use std::sync::Arc;

use glam::{Affine3A, Quat, UVec2, Vec3};
use virtual_sculpture::command::Command;
use virtual_sculpture::config::RenderMode;
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::{Background, Renderer, Shot};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Material, Rgb};
use virtual_sculpture::shade::{Lighting, Pixels};
use virtual_sculpture::view::{Camera, Eye};

use crate::fixture::with_device;

const SIZE: UVec2 = UVec2::new(120, 90);

struct Painter {
    renderer: Renderer,
    frames: Frames,
}

impl Painter {
    fn new(device: &Arc<Device>) -> Painter {
        let renderer = Renderer::new(device, FORMAT).unwrap();
        Painter { renderer, frames: Frames::new(device).unwrap() }
    }

    fn paint(&mut self, eyes: &[Eye], mode: RenderMode, document: &mut Document) -> Vec<Pixels> {
        let lighting = Lighting::default();
        let grey = Vec3::splat(0.2);
        let shot = Shot {
            eyes,
            world_from_grid: Affine3A::from_translation(Vec3::splat(-40.0)),
            mode,
            lighting,
            background: Background::Gradient { top: grey, bottom: grey },
            video: None,
            ghosts: &[],
            lines: &[],
        };
        let mut recorder = self.frames.begin().unwrap();
        self.renderer.paint(&mut recorder, self.frames.slot(), document, &shot).unwrap();
        self.frames.submit(recorder, &[], &[]).unwrap();
        self.renderer.read_back().unwrap()
    }
}

#[test]
fn a_picture_followed_through_edits_is_the_picture_of_the_result() {
    with_device(|device| {
        let eyes = [Vec3::new(0.8, 0.6, 1.0), Vec3::new(0.7, 0.6, 1.1)]
            .map(|from| Camera::framing(69.0, from, Vec3::Y).eye(SIZE));
        let edits = [
            "subtract ellipsoid at=50,60,70 half=12,9,14 turn=20,30,40",
            "add cuboid at=50,60,78 half=6,4,2 colour=#c03020",
            "recolour ellipsoid at=60,60,76 half=14,14,14 colour=#2060c0",
            "undo 1",
            "subtract pyramid at=20,70,60 half=10,10,10 turn=0,45,0",
            "undo all",
            "redo all",
        ];
        for mode in RenderMode::ALL {
            let grid = scenes::cheese(80, 14, 5).unwrap();
            let base = Rgb::new(200, 180, 160);
            let material = Material::new(ColourDepth::Bits24, base, grid.bricks().len());
            let contents = Contents { grid, material };
            let mut document = Document::from_contents(contents, Limits::default());
            let mut follower = Painter::new(device);
            let mut before = follower.paint(&eyes, mode, &mut document);
            for text in edits {
                let command: Command = text.parse().unwrap();
                document.apply(&command).unwrap();
                let followed = follower.paint(&eyes, mode, &mut document);
                // One colour for all shows no paint.
                assert!(mode == RenderMode::Gpu || followed != before, "{mode:?}: {text} is seen");
                let anew = Painter::new(device).paint(&eyes, mode, &mut document);
                assert!(followed == anew, "{mode:?}: {text}");
                before = followed;
            }
            // Nothing is left over of the edits when the eye moves, either.
            let turn = Affine3A::from_quat(Quat::from_rotation_y(0.4));
            let moved = eyes.map(|eye| Eye { eye_from_world: eye.eye_from_world * turn, ..eye });
            let followed = follower.paint(&moved, mode, &mut document);
            assert!(followed == Painter::new(device).paint(&moved, mode, &mut document));
        }
    });
}
