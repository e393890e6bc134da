//! Strokes of the deforming brushes: the brush is used at a spacing along a path over the surface. Most move the
//! surface as it was when the stroke began, so that overlapping uses do not add up; pinch and smear build on earlier
//! uses.
//!
//! Flatten, scrape and fill use one plane for the whole stroke, that of the surface around the press. Draw and crease
//! go along the normal of the surface around each use, as it was when the stroke began.

use std::collections::VecDeque;

use glam::{Vec2, Vec3};

use super::lead::{Lead, PointerLead, StrokeScene};
use super::path::Path;
use crate::command::Command;
use crate::editor::pen_use::PenUse;
use crate::editor::pressure::touched;
use crate::editor::surface_guide::{LEAP, SurfaceGuide, normal_around};
use crate::input::pen::PenTouch;
use crate::picking::Picker;
use crate::tools::brush::BrushId;
use crate::tools::brush::dab::{Dab, DabPlace};
use crate::tools::brush::kernel::grab::{MAX_RADIUS, MIN_RADIUS};
use crate::tools::brush::keys::{RADIUS, STEADY};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::{BrushStroke, Inverse, SurfaceNormal};

/// A stroke of a brush over the surface.
pub struct SurfaceStroke {
    options: BrushOptions,
    /// The effect of a pen on it.
    pen: PenUse,
    /// The modifier that inverts the tool was held at the press.
    inverse: bool,
    /// The pointer on the surface; `None` while something else moves the tool.
    guide: Option<SurfaceGuide>,
    /// In voxels.
    path: Path,
    /// Start of the stroke, in voxels, and the direction out of the surface there.
    start: Vec3,
    normal: Vec3,
    /// Position of the last use, in voxels.
    last: Vec3,
    /// Voxel edges in units of the smallest.
    edges: Vec3,
    due: VecDeque<(Vec3, PenTouch)>,
    uses: u32,
}

impl SurfaceStroke {
    /// Begins a stroke at the tool. `options`: with the radius in units of the smallest edge; `at`: the pointer
    /// (pixels).
    pub fn new(
        options: BrushOptions,
        inverse: bool,
        at: Option<Vec2>,
        scene: &mut StrokeScene,
        picker: &Picker,
    ) -> SurfaceStroke {
        let brush = options.brush();
        let start = scene.tool.centre_vx;
        let edges = scene.edges();
        let spacing = (brush.spec().spacing * options.get(RADIUS)).max(1.0);
        let mut stroke = SurfaceStroke {
            options,
            pen: scene.tool.pens.of_brush(brush),
            inverse,
            guide: at.map(|at| SurfaceGuide::new(at, start, scene.grid(), picker)),
            path: Path::new(start, spacing, edges),
            start,
            normal: scene.normal_at(start, options.get(RADIUS), at, picker),
            last: start,
            edges,
            due: VecDeque::new(),
            uses: 0,
        };
        stroke.use_at(&[start], scene);
        stroke
    }

    /// Makes uses of the brush due at points, in voxels.
    fn use_at(&mut self, stops: &[Vec3], scene: &mut StrokeScene) {
        self.due.extend(stops.iter().copied().zip(scene.grip.along_path(stops.len())));
    }

    /// Returns the normal of its use.
    fn normal_used(&self) -> SurfaceNormal {
        match self.options.brush().spec().stroke {
            BrushStroke::Surface { normal, .. } => normal,
            _ => SurfaceNormal::OfPress { on_plane: false },
        }
    }

    /// Returns the brush, or its counterpart with the modifier, and its sense.
    fn brush_and_sense(&self) -> (BrushId, f32) {
        let brush = self.options.brush();
        match brush.spec().inverse {
            Inverse::Brush(other) if self.inverse => (other, 1.0),
            Inverse::Sense if self.inverse => (brush, -1.0),
            _ => (brush, 1.0),
        }
    }

    /// Returns the use of the brush at a point, in voxels; `None` where it does nothing.
    fn command(&self, at: Vec3, touch: PenTouch) -> Option<Command> {
        let (brush, sense) = self.brush_and_sense();
        let options = touched(&self.options, self.pen, touch);
        let options = options.with(RADIUS, options.get(RADIUS).clamp(MIN_RADIUS, MAX_RADIUS));
        let options = options.of(brush);
        let normal = self.normal;
        let above = ((at - self.start) * self.edges).dot(normal);
        let at_vx = match self.normal_used() {
            SurfaceNormal::OfPress { on_plane: true } => at - normal * above / self.edges,
            _ => at,
        };
        let (from_vx, edges) = (self.last, self.edges);
        let place = DabPlace::Surface { at_vx, from_vx, normal, edges, sense };
        (brush.spec().dab)(&Dab { options: &options, place }).map(Command::Brush)
    }
}

impl Lead for SurfaceStroke {
    fn point_at(&mut self, to: Vec2, scene: &mut StrokeScene, picker: &Picker) {
        let SurfaceStroke { guide: Some(guide), path, options, .. } = self else { return };
        if !to.is_finite() {
            return;
        }
        path.scale(self.pen.size(scene.grip.now));
        let mut stops = Vec::new();
        let leap = LEAP * 2.0 * options.get(RADIUS);
        guide.go_to(to, options.get(STEADY), scene.document.grid(), picker, |point| {
            match path.distance(point) > leap {
                true => path.jump_to(point, |stop| stops.push(stop)),
                false => path.line_to(point, |stop| stops.push(stop)),
            }
        });
        scene.tool.centre_vx = path.end();
        self.use_at(&stops, scene);
        scene.anchor.leave(scene.tool);
    }

    fn tool_moved(&mut self, scene: &mut StrokeScene, _: &Picker) {
        let mut stops = Vec::new();
        self.path.scale(self.pen.size(scene.grip.now));
        self.path.line_to(scene.tool.centre_vx, |stop| stops.push(stop));
        self.use_at(&stops, scene);
    }

    fn next(&mut self, scene: &mut StrokeScene, _: Option<&Picker>) -> Option<Command> {
        while let Some((stop, touch)) = self.due.pop_front() {
            if self.normal_used() == SurfaceNormal::OfEachUse {
                let surface = scene.document.stroke_surface();
                let normal = normal_around(surface, stop, self.options.get(RADIUS));
                self.normal = normal.and_then(Vec3::try_normalize).unwrap_or(self.normal);
            }
            let command = self.command(stop, touch);
            self.last = stop;
            self.uses += 1;
            if command.is_some() {
                return command;
            }
        }
        None
    }

    fn shift(&mut self, by_vx: Vec3) {
        self.path.shift(by_vx);
        for point in [&mut self.start, &mut self.last] {
            *point += by_vx;
        }
        self.due.iter_mut().for_each(|(stop, _)| *stop += by_vx);
        if let Some(guide) = &mut self.guide {
            guide.shift(by_vx);
        }
    }

    fn uses(&self) -> u32 {
        self.uses
    }

    fn pointer(&self) -> PointerLead {
        PointerLead::Always
    }

    fn depends_on_picture(&self) -> bool {
        self.guide.is_some()
    }
}
