//! The renderer on the device of the tests, and a block to render.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use virtual_sculpture::command::text::parse_script;
use virtual_sculpture::command::{Command, NewSculpture};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::overlay::ToolPreview;
use virtual_sculpture::render::{Background, FrameDesc, Renderer, SmoothSurface, Video};
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::shade::{Lighting, Pixels};
use virtual_sculpture::view::Eye;

pub const BACKGROUND: Background =
    Background::Gradient { top: Vec3::new(0.23, 0.25, 0.3), bottom: Vec3::new(0.1, 0.1, 0.12) };

/// Device and renderer.
pub struct Painter {
    pub renderer: Renderer,
    pub frames: Frames,
    pub smooth_surface: SmoothSurface,
}

impl Painter {
    pub fn new(device: &Arc<Device>) -> Painter {
        let renderer = Renderer::new(device, FORMAT).unwrap();
        let frames = Frames::new(device).unwrap();
        Painter { renderer, frames, smooth_surface: SmoothSurface::Never }
    }

    /// Renders what the eyes see of a document.
    pub fn paint(&mut self, document: &mut Document, scene: &Scene) -> Vec<Pixels> {
        let desc = FrameDesc {
            eyes: scene.eyes,
            world_from_grid: scene.world_from_grid,
            smooth_surface: self.smooth_surface,
            sample: 0,
            mode: scene.mode,
            lighting: Lighting::default(),
            show_mask: false,
            background: BACKGROUND,
            ground: None,
            smooth_edges: false,
            video: scene.video,
            previews: scene.previews,
            lines: &[],
        };
        let mut recorder = self.frames.begin().unwrap();
        let slot = self.frames.slot();
        self.renderer.paint(&mut recorder, slot, document, &desc).unwrap();
        self.frames.submit(recorder, &[], &[]).unwrap();
        self.renderer.read_back().unwrap()
    }
}

/// The subject of a picture, and how to render it.
pub struct Scene<'a> {
    pub eyes: &'a [Eye],
    pub world_from_grid: Affine3A,
    pub mode: RenderMode,
    pub video: Option<Video<'a>>,
    pub previews: &'a [ToolPreview],
}

/// A sculpture made by commands.
pub fn document(script: &str) -> Document {
    let mut commands = parse_script(script).unwrap().into_iter();
    let new: NewSculpture = match commands.next() {
        Some((_, Command::New(new))) => new,
        other => panic!("the script begins with {other:?}"),
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    for (_, command) in commands {
        document.apply(&command).unwrap();
    }
    document
}
