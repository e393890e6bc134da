//! Strokes of brushes under an outline in a hand: the brush is used in a cone, at a spacing along its path.

use glam::{Vec2, Vec3};

use super::lead::{Lead, PointerLead, StrokeScene};
use super::path::Path;
use crate::command::Command;
use crate::editor::pressure::touched;
use crate::picking::Picker;
use crate::tools::brush::footprint::{Footprint, MAX_FOOTPRINT};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::BrushStroke;

/// A stroke of a brush in a hand.
pub struct ConeStroke {
    options: BrushOptions,
    /// Path of the cone's middle, in voxels.
    path: Path,
    /// The present cone.
    cone: Footprint,
    is_due: bool,
    uses: u32,
}

impl ConeStroke {
    /// Begins a stroke at the cone. `spacing_vx`: distance along the surface between two uses of the brush.
    pub fn new(options: BrushOptions, cone: Footprint, spacing_vx: f32) -> ConeStroke {
        let path = Path::new(cone.eye_vx + cone.aim, spacing_vx, Vec3::ONE);
        ConeStroke { options, path, cone, is_due: true, uses: 0 }
    }
}

impl Lead for ConeStroke {
    /// The hand moves it, not the pointer.
    fn point_at(&mut self, _: Vec2, _: &mut StrokeScene, _: &Picker) {}

    fn tool_moved(&mut self, _: &mut StrokeScene, _: &Picker) {}

    fn aim(&mut self, cone: Footprint) {
        self.cone = cone;
        let at = cone.eye_vx + cone.aim;
        let mut ahead = self.path;
        ahead.line_to(at, |_| self.is_due = true);
        if self.is_due {
            self.path.jump_to(at, |_| ());
        }
    }

    fn repeats(&self, in_hand: bool) -> bool {
        let stroke = self.options.brush().spec().stroke;
        in_hand && stroke == BrushStroke::Picture { repeats: true }
    }

    fn repeat(&mut self, _: &mut StrokeScene) {
        self.is_due = true;
    }

    fn next(&mut self, scene: &mut StrokeScene, _: Option<&Picker>) -> Option<Command> {
        if !std::mem::take(&mut self.is_due) {
            return None;
        }
        let pen = scene.tool.pens.of_brush(self.options.brush());
        let options = touched(&self.options, pen, scene.grip.now);
        let radius = self.cone.radius * pen.size(scene.grip.now);
        let cone = Footprint { radius: radius.min(MAX_FOOTPRINT), ..self.cone };
        self.uses += 1;
        scene.tool.brush_under(&options, cone, self.uses - 1)
    }

    fn shift(&mut self, by_vx: Vec3) {
        self.path.shift(by_vx);
        self.cone.eye_vx += by_vx;
    }

    fn uses(&self) -> u32 {
        self.uses
    }

    fn pointer(&self) -> PointerLead {
        PointerLead::None
    }

    fn depends_on_picture(&self) -> bool {
        false
    }
}
