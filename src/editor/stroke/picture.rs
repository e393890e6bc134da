//! Strokes of brushes under an outline: the brush is used at a spacing along a path in the picture.

use std::collections::VecDeque;

use glam::{Vec2, Vec3};

use super::lead::{Lead, PointerLead, StrokeScene};
use super::path::Path;
use crate::command::Command;
use crate::editor::pressure::touched;
use crate::editor::sizes::gauge_at;
use crate::input::pen::PenTouch;
use crate::picking::Picker;
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::keys::{OUTLINE, RADIUS};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::BrushStroke;

/// A stroke of a brush under an outline in the picture.
pub struct PictureStroke {
    options: BrushOptions,
    /// It removes paint instead of applying it.
    unpaints: bool,
    /// In pixels, with z = 0.
    path: Path,
    due: VecDeque<(Vec3, PenTouch)>,
    uses: u32,
}

impl PictureStroke {
    /// Begins a stroke at `at` (pixels).
    pub fn new(
        options: BrushOptions,
        unpaints: bool,
        at: Vec2,
        scene: &mut StrokeScene,
        picker: &Picker,
    ) -> PictureStroke {
        let spec = options.brush().spec();
        let has_image = scene.tool.stencil.is_some() && !unpaints;
        let share = spec.image_spacing.filter(|_| has_image).unwrap_or(spec.spacing);
        let spacing = (share * radius_px(&options, at, scene, picker)).max(1.0);
        let start = at.extend(0.0);
        let path = Path::new(start, spacing, Vec3::ONE);
        let mut stroke = PictureStroke { options, unpaints, path, due: VecDeque::new(), uses: 0 };
        stroke.use_at(&[start], scene);
        stroke
    }

    /// Makes uses of the brush due at points of the picture.
    fn use_at(&mut self, stops: &[Vec3], scene: &mut StrokeScene) {
        self.due.extend(stops.iter().copied().zip(scene.grip.along_path(stops.len())));
    }
}

impl Lead for PictureStroke {
    fn point_at(&mut self, to: Vec2, scene: &mut StrokeScene, _: &Picker) {
        let mut stops = Vec::new();
        let pen = scene.tool.pens.of_brush(self.options.brush());
        self.path.scale(pen.size(scene.grip.now));
        self.path.line_to(to.extend(0.0), |stop| stops.push(stop));
        self.use_at(&stops, scene);
    }

    /// Works at the visible position of the tool.
    fn tool_moved(&mut self, scene: &mut StrokeScene, picker: &Picker) {
        let at = picker.sight().pixel_of(scene.tool.centre_vx);
        if let Some(at) = at.filter(|_| scene.tool.picture_brush().is_some()) {
            self.point_at(at, scene, picker);
        }
    }

    fn repeats(&self, in_hand: bool) -> bool {
        let stroke = self.options.brush().spec().stroke;
        !in_hand && stroke == BrushStroke::Picture { repeats: true }
    }

    fn repeat(&mut self, scene: &mut StrokeScene) {
        self.use_at(&[self.path.end()], scene);
    }

    fn next(&mut self, scene: &mut StrokeScene, picker: Option<&Picker>) -> Option<Command> {
        let Some(picker) = picker else {
            self.due.clear();
            return None;
        };
        // After the grid's box has moved, the uses wait for the next picture.
        let map = picker.map().filter(|_| picker.origin() == scene.document.origin())?;
        while let Some((stop, touch)) = self.due.pop_front() {
            let pen = scene.tool.pens.of_brush(self.options.brush());
            let options = touched(&self.options, pen, touch);
            let at = stop.truncate();
            let pixel = at.max(Vec2::ZERO).as_uvec2().min(map.rays.size - 1);
            let radius = radius_px(&options, at, scene, picker);
            let footprint = Footprint::of_pixel(&map.rays, pixel, radius, options.get(OUTLINE));
            let bare = self.unpaints.then(|| scene.bare_colour());
            let tool = scene.tool.in_use(scene.grip.now, bare);
            let command = tool.brush_under(&options, footprint, self.uses);
            self.uses += 1;
            if command.is_some() {
                return command;
            }
        }
        None
    }

    /// Its path lies in the picture.
    fn shift(&mut self, _: Vec3) {}

    fn uses(&self) -> u32 {
        self.uses
    }

    fn pointer(&self) -> PointerLead {
        PointerLead::Always
    }

    fn depends_on_picture(&self) -> bool {
        true
    }
}

/// Returns the radius of a brush at the visible surface under `at`, in pixels.
fn radius_px(options: &BrushOptions, at: Vec2, scene: &StrokeScene, picker: &Picker) -> f32 {
    let point = scene.anchor.target(scene.grid(), at, picker);
    let gauge = point.map(|point| gauge_at(scene.grid(), point, picker));
    scene.tool.brushes.radius_px(options.get(RADIUS), gauge)
}
