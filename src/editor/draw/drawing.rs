//! A drag of a drawing tool: its path so far, the resulting commands, and its preview lines.
//!
//! A value: takes pixels and, where it follows the surface, the grid. Changes nothing.

use glam::{Vec2, Vec3};

use super::block::Base;
use super::lathe::LatheAxis;
use super::options::DrawOptions;
use super::points::CLICK_PX;
use super::text::TextFrame;
use super::view::{DrawView, chain};
use super::{block, glyphs, outline, tube};
use crate::command::Command;
use crate::editor::tool_change::ToolChange;
use crate::input::{DrawKind, ToolMode};
use crate::picking::{Picker, SurfacePoint};
use crate::sculpture::Grid;
use crate::tools::drawn::DrawnSolid;

/// Least distance from one point of a drag to the next, in pixels.
const SPACING_PX: f32 = 2.0;
/// Most points of a drag; beyond, every second point is dropped.
const MOST_POINTS: usize = 4096;
/// Most samples of the surface between two events.
const MOST_LOOKS: f32 = 1024.0;

/// The start of a drag: a position in voxels, and the surface normal there; zero in the air.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DragStart {
    pub point: Vec3,
    pub face: Vec3,
}

/// An unfinished drawing, as lines between grid points (voxels).
#[derive(Clone, PartialEq, Debug)]
pub struct Sketch {
    /// The mode that will apply.
    pub mode: ToolMode,
    /// The drawn lines.
    pub lines: Vec<[Vec3; 2]>,
    /// The lines that follow from the drawn ones, or guide them.
    pub faint: Vec<[Vec3; 2]>,
}

/// A drawing in progress.
#[derive(Clone, Debug)]
pub struct Drawing {
    kind: DrawKind,
    mode: ToolMode,
    /// Takes the other side of a cut.
    inverse: bool,
    /// The view of the drawing.
    view: DrawView,
    ground: DragStart,
    /// Path of the pointer, in pixels: all of it, or the first and the last point.
    pointer_px: Vec<Vec2>,
    /// Points of a line or a curve, in voxels.
    places: Vec<Vec3>,
    /// Distance of the last point from the eye plane, used where there is no surface.
    depth: f32,
}

impl Drawing {
    pub fn new(
        kind: DrawKind,
        mode: ToolMode,
        inverse: bool,
        view: DrawView,
        ground: DragStart,
        at: Vec2,
    ) -> Drawing {
        let depth = view.sight.depth(ground.point);
        let places = vec![ground.point];
        Drawing { kind, mode, inverse, view, ground, pointer_px: vec![at], places, depth }
    }

    /// Follows the surface as it is seen now.
    pub fn with_surface(mut self, picker: &Picker, grid: &Grid) -> Drawing {
        self.view = self.view.with_surface(picker, grid);
        self
    }

    pub fn kind(&self) -> DrawKind {
        self.kind
    }

    pub fn mode(&self) -> ToolMode {
        self.mode
    }

    pub fn view(&self) -> &DrawView {
        &self.view
    }

    /// Moves the base of letters.
    pub fn stand_on(&mut self, ground: DragStart) {
        self.ground = ground;
    }

    /// Moves the pointer to a pixel.
    pub fn lead(&mut self, at: Vec2, grid: &Grid) {
        match self.kind {
            DrawKind::Lasso | DrawKind::Lathe => self.go_on(at),
            DrawKind::Curve => {
                let from = self.last();
                let looks = (at.distance(from) / SPACING_PX).floor().min(MOST_LOOKS);
                for i in 1..=looks as u32 {
                    let look = from.lerp(at, i as f32 / looks);
                    let place = self.place_at(look, grid);
                    self.places.push(place);
                }
                if looks > 0.0 {
                    self.go_on(at);
                }
                halve(&mut self.places);
            }
            DrawKind::Line => {
                self.go_to(at);
                self.depth = self.view.sight.depth(self.ground.point);
                let place = self.place_at(at, grid);
                self.places.truncate(1);
                if at.distance(self.pointer_px[0]) >= SPACING_PX {
                    self.places.push(place);
                }
            }
            DrawKind::Rectangle | DrawKind::Plane | DrawKind::Text => self.go_to(at),
            DrawKind::Box if self.base_to(at).is_some() => self.go_to(at),
            DrawKind::Box => {}
        }
    }

    fn go_on(&mut self, at: Vec2) {
        if self.last().distance(at) >= SPACING_PX {
            self.pointer_px.push(at);
        }
        halve(&mut self.pointer_px);
    }

    fn go_to(&mut self, at: Vec2) {
        self.pointer_px.truncate(1);
        self.pointer_px.push(at);
    }

    /// Returns the last pixel of the path.
    fn last(&self) -> Vec2 {
        self.pointer_px.last().copied().unwrap_or(Vec2::ZERO)
    }

    /// Returns the position of a pixel: on the surface if it follows that, else as far from the eye as the last point.
    fn place_at(&mut self, at: Vec2, grid: &Grid) -> Vec3 {
        let seen = self.view.surface(grid, at).map(|seen| seen.point);
        let place = seen.unwrap_or_else(|| self.view.sight.at_depth(at, self.depth));
        self.depth = self.view.sight.depth(place);
        place
    }

    /// Returns its start, in voxels.
    pub fn start(&self) -> Vec3 {
        self.ground.point
    }

    /// Returns whether the pointer has stayed at the point of the press.
    pub fn is_click(&self) -> bool {
        self.pointer_px.iter().all(|at| at.distance(self.pointer_px[0]) <= CLICK_PX)
    }

    /// Returns the base of a box as dragged so far.
    pub fn base(&self) -> Option<Base> {
        self.base_to(self.last())
    }

    /// Returns the base of a box that extends to a pixel.
    fn base_to(&self, at: Vec2) -> Option<Base> {
        let from = SurfacePoint { point: self.ground.point, face: self.ground.face };
        Base::new(&self.view, &from, at)
    }

    /// Returns the corners of a box on its base. Its height is the chosen one, or the least possible if the pointer
    /// sets it later.
    fn corners(&self, options: &DrawOptions) -> Option<[Vec3; 2]> {
        let height = if options.height_by_pointer { 0.0 } else { options.height };
        let base = self.base()?;
        Some(block::corners(&self.view, &base, height, self.mode == ToolMode::Add))
    }

    /// Returns the outline over the picture, in pixels.
    fn outline(&self) -> Vec<Vec2> {
        match self.kind {
            DrawKind::Rectangle => outline::rectangle(self.pointer_px[0], self.last()).to_vec(),
            _ => self.pointer_px.clone(),
        }
    }

    /// Returns the commands that make the solid, or advice on what to draw instead.
    pub fn commands(
        &self,
        options: &DrawOptions,
        change: impl Into<ToolChange>,
        grid: &Grid,
    ) -> Result<Vec<Command>, String> {
        let change = change.into();
        let one = |solid: DrawnSolid| vec![change.by_drawn_solid(solid)];
        let (view, point) = (&self.view, self.ground.point);
        let made = match self.kind {
            DrawKind::Lasso | DrawKind::Rectangle => {
                let depth = (self.mode == ToolMode::Add).then_some(options.thickness);
                let outline = self.outline();
                outline::is_meant(&outline)
                    .then(|| outline::prism(view, &outline, point, depth))
                    .flatten()
                    .map(one)
            }
            DrawKind::Plane => {
                outline::half_space(view, self.pointer_px[0], self.last(), self.inverse).map(one)
            }
            DrawKind::Box => self
                .corners(options)
                .map(|corners| vec![change.by_solid(block::cuboid(view.edges, corners), None)]),
            DrawKind::Line => {
                let end = self.places.last().copied().unwrap_or(point);
                Some(one(tube::line(point, end, options.radii)))
            }
            DrawKind::Curve => tube::curve(&self.places, options.radii, view.edges).map(one),
            DrawKind::Lathe => LatheAxis::new(view, point, options.upright)
                .and_then(|axis| axis.turned(view, &self.pointer_px))
                .map(one),
            DrawKind::Text => {
                let letters = glyphs::letters(&options.text, options.font, options.text_height)?;
                let stand = TextFrame::new(view, point, self.ground.face);
                let solids = stand.map(|stand| stand.solids(grid, &letters, options.text_depth));
                solids
                    .filter(|solids| !solids.is_empty())
                    .map(|solids| solids.into_iter().flat_map(one).collect())
            }
        };
        made.ok_or_else(|| self.kind.spec().advice.to_string())
    }

    /// Returns the letters of a text that would float because there is no surface under them.
    pub fn floating(&self, options: &DrawOptions, grid: &Grid) -> Vec<char> {
        let stand = || TextFrame::new(&self.view, self.ground.point, self.ground.face);
        let letters = || glyphs::letters(&options.text, options.font, options.text_height).ok();
        let is_text = self.kind == DrawKind::Text;
        let line = is_text.then(|| stand().zip(letters())).flatten();
        line.map_or_else(Vec::new, |(stand, letters)| stand.floating(grid, &letters))
    }

    /// Returns its preview lines.
    pub fn sketch(&self, options: &DrawOptions, grid: &Grid) -> Sketch {
        let view = &self.view;
        let depth = view.sight.depth(self.ground.point);
        let place = |at: Vec2| view.sight.at_depth(at, depth);
        let (lines, faint) = match self.kind {
            DrawKind::Lasso | DrawKind::Rectangle => {
                let places: Vec<Vec3> = self.outline().into_iter().map(place).collect();
                let closing = [self.last(), self.pointer_px[0]].map(place);
                match self.kind {
                    DrawKind::Lasso => (chain(&places).collect(), vec![closing]),
                    _ => (chain(&places).chain([[places[3], places[0]]]).collect(), Vec::new()),
                }
            }
            DrawKind::Plane => {
                let (from, to) = (self.pointer_px[0], self.last());
                let far = (to - from).normalize_or_zero() * view.sight.rays.size.as_vec2().length();
                let mut lines = vec![[from, to].map(place)];
                let hatching = outline::hatching(from, to, self.inverse);
                if from != to {
                    lines.extend(hatching.into_iter().map(|pair| pair.map(place)));
                }
                (lines, vec![[from - far, from].map(place), [to, to + far].map(place)])
            }
            DrawKind::Box => {
                (self.corners(options).map(block::edges_of).unwrap_or_default(), Vec::new())
            }
            DrawKind::Line | DrawKind::Curve => {
                (tube::sketch(view, &self.places, options.radii), Vec::new())
            }
            DrawKind::Lathe => LatheAxis::new(view, self.ground.point, options.upright)
                .map(|axis| axis.sketch(view, &self.pointer_px))
                .unwrap_or_default(),
            DrawKind::Text => {
                let letters = glyphs::letters(&options.text, options.font, options.text_height);
                let stand = TextFrame::new(view, self.ground.point, self.ground.face);
                let lines = stand.zip(letters.ok()).map(|(stand, text)| stand.sketch(grid, &text));
                (lines.unwrap_or_default(), Vec::new())
            }
        };
        Sketch { mode: self.mode, lines, faint }
    }
}

/// Drops every second point, but not the first, if there are too many.
fn halve<T>(points: &mut Vec<T>) {
    if points.len() > MOST_POINTS {
        let mut keep = false;
        points.retain(|_| {
            keep = !keep;
            keep
        });
    }
}
