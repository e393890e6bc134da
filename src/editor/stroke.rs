//! The stroke under way: from the press to the release the tool is used along a path, and all of it
//! is one step of the history. Solids follow a path in the grid, brushes under an outline one in the picture.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Editor;
use super::dabs::Dabs;
use super::deform::HeldClay;
use super::path::Path;
use super::pressure::touched;
use super::sweep::{Leg, Sweep};
use super::tool::ToolState;
use crate::command::Command;
use crate::input::ToolMode;
use crate::picking::Picker;
use crate::picking::geometry::{lasting, surface_point};
use crate::sculpture::Grid;
use crate::surface::IndexMap;
use crate::tools::brush::BrushId;
use crate::tools::brush::footprint::{Footprint, MAX_FOOTPRINT};
use crate::tools::brush::keys::{OUTLINE, RADIUS};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::BrushStroke;
use crate::tools::solid::Primitive;

/// After how long a brush that goes on while it is held is used again, in seconds.
const AGAIN_S: f64 = 0.1;
/// Distance of two uses of a stencil, as a share of the radius.
const STENCIL_SPACING: f32 = 2.0;
/// Pixels between two looks at the surface along a drag.
pub(super) const LOOK_EVERY_PX: f32 = 3.0;
/// Most looks at the surface along a drag.
pub(super) const MOST_LOOKS: f32 = 1024.0;
/// A step on the surface longer than this many tool sizes is a leap over an edge.
pub(super) const LEAP: f32 = 2.0;

/// The input that leads the tool.
pub(super) enum Guide {
    /// A drag of the pointer over the surface.
    Surface(SurfaceGuide),
    /// Any input that moves the tool while a key, a button or a hand holds it down. `hovering`: the pointer, if it was
    /// the last to move the tool.
    Tool { hovering: Option<SurfaceGuide> },
}

/// The pointer on the surface as it was seen when it began to lead the stroke, so that what the stroke
/// adds or cuts on its way does not lead it astray.
pub(super) struct SurfaceGuide {
    seen: Option<Arc<IndexMap>>,
    pub at: Vec2,
    /// The depth of the last point, for where the pointer is beside the sculpture.
    depth: f32,
    /// From the surface to the centre of a tool that stands on it.
    lift: Vec3,
}

impl SurfaceGuide {
    /// The pointer at `at` (pixels) has put `tool` on `point` of the surface.
    pub fn new(at: Vec2, point: Vec3, tool: &ToolState, grid: &Grid, picker: &Picker) -> Self {
        SurfaceGuide {
            seen: picker.map().map(|map| lasting(map, grid)),
            at,
            depth: picker.sight().depth(point),
            lift: if tool.stand { tool.centre_vx - point } else { Vec3::ZERO },
        }
    }

    /// Whether the view is still the one in which the surface was seen.
    fn is_of(&self, picker: &Picker) -> bool {
        self.seen.as_ref().map(|seen| seen.rays) == picker.map().map(|map| map.rays)
    }

    /// The point that lies under `look` (pixels), and the tool's centre there.
    pub fn centre_at(&mut self, look: Vec2, grid: &Grid, picker: &Picker) -> Vec3 {
        let sight = picker.sight();
        let found = self.seen.as_ref().and_then(|map| surface_point(map, grid, look));
        let point = found.map_or_else(|| sight.at_depth(look, self.depth), |seen| seen.point);
        self.depth = sight.depth(point);
        point + self.lift
    }
}

/// The work that a stroke does along its path.
pub(super) enum Work {
    Solid {
        mode: ToolMode,
        guide: Guide,
        sweep: Sweep,
    },
    /// A brush under an outline in the picture.
    Picture(BrushOptions),
    /// The same in a hand, in a cone of its own.
    Cone(BrushOptions),
    /// Clay that is taken along.
    Grab(HeldClay),
    /// A brush that moves the surface.
    Dabs(Dabs),
}

/// A stroke that is not finished.
pub(super) struct Stroke {
    pub work: Work,
    /// In voxels; in pixels with z = 0 for brushes in the picture; of no use to clay that is held, nor to solids, which sweep.
    pub path: Path,
    /// Voxels that it has changed so far.
    pub changed: u64,
    /// The first commands, as long as they have changed nothing.
    pub tried: Vec<Command>,
    /// It has added, and would have gone on beyond the walls of the grid.
    pub beyond: bool,
    /// How often a brush was used.
    uses: u32,
    /// Since when it has not been used, on the clock of [`Editor::dwell`].
    idle_since_s: Option<f64>,
    /// The cone of a brush in a hand, as it is now.
    held: Option<Footprint>,
    /// It takes paint away instead of putting it on.
    pub unpaints: bool,
}

impl Stroke {
    /// A stroke that takes clay along.
    pub fn of_clay(held: HeldClay) -> Stroke {
        Stroke::new(Work::Grab(held), Path::new(Vec3::ZERO, 1.0, Vec3::ONE))
    }

    /// A stroke that has done nothing yet.
    pub fn new(work: Work, path: Path) -> Stroke {
        let (uses, idle_since_s, held) = (0, None, None);
        Stroke {
            work,
            path,
            changed: 0,
            tried: Vec::new(),
            beyond: false,
            unpaints: false,
            uses,
            idle_since_s,
            held,
        }
    }

    /// Whether a tool that deforms clay is at work.
    pub fn is_clay(&self) -> bool {
        matches!(self.work, Work::Grab(_) | Work::Dabs(_))
    }

    /// Whether the pointer on the surface leads a solid.
    pub fn follows_surface(&self) -> bool {
        matches!(self.work, Work::Solid { guide: Guide::Surface(_), .. })
    }

    /// The pointer that leads a solid over the surface, in a drag or hovering.
    fn surface_guide(&self) -> Option<&SurfaceGuide> {
        match &self.work {
            Work::Solid { guide: Guide::Surface(guide), .. } => Some(guide),
            Work::Solid { guide: Guide::Tool { hovering }, .. } => hovering.as_ref(),
            Work::Picture(_) | Work::Cone(_) | Work::Grab(_) | Work::Dabs(_) => None,
        }
    }

    pub fn is_picture_brush(&self) -> bool {
        matches!(self.work, Work::Picture(_))
    }

    /// Whether where it goes depends on what the picture shows under the pointer.
    pub fn is_led_over_picture(&self) -> bool {
        let clay = match &self.work {
            Work::Grab(held) => held.is_led(),
            Work::Dabs(dabs) => dabs.is_led(),
            _ => false,
        };
        self.surface_guide().is_some() || self.is_picture_brush() || clay
    }
}

impl ToolState {
    /// The solid in hand with its centre at a place, or in the middle of the voxel there.
    fn primitive_at(&self, centre_vx: Vec3) -> Primitive {
        Primitive { centre_vx: self.snapped(centre_vx), ..self.primitive() }
    }

    /// Leads `sweep` over the surface to `centre_vx`: straight, or where the surface leaps with the tool
    /// lifted.
    fn go_over_surface(&self, sweep: &mut Sweep, centre_vx: Vec3, mut leg: impl FnMut(Leg)) {
        if sweep.distance(centre_vx) > LEAP * 2.0 * self.half().max_element() {
            sweep.finish(&self.primitive(), &mut leg);
            sweep.jump(&self.primitive_at(centre_vx), leg);
        } else {
            sweep.lead(&self.primitive_at(centre_vx), leg);
        }
    }
}

impl Editor {
    /// Opens a stroke of a brush at a point of the picture and uses it there.
    pub(super) fn begin_picture_brush(
        &mut self,
        options: BrushOptions,
        unpaints: bool,
        at: Vec2,
        picker: &Picker,
    ) {
        if !self.begin_brush(options.brush()) {
            return;
        }
        self.grip.begin();
        let share = match options.brush() {
            // Beside each other, since one over another would blur the image.
            BrushId::Paint if self.tool.stencil.is_some() && !unpaints => STENCIL_SPACING,
            brush => brush.spec().spacing,
        };
        let spacing = (share * self.brush_px(&options, at, picker)).max(1.0);
        let path = Path::new(at.extend(0.0), spacing, Vec3::ONE);
        self.stroke = Some(Stroke { unpaints, ..Stroke::new(Work::Picture(options), path) });
        self.use_in_picture(&[at.extend(0.0)], picker);
    }

    /// Opens the undo step of a stroke of a brush. False if another stroke is under way, or it cannot begin.
    pub(super) fn begin_brush(&mut self, brush: BrushId) -> bool {
        let label = brush.spec().name.into();
        let begun = self.stroke.is_none() && self.execute(&Command::Begin { label });
        if begun && brush.spec().gives_colour {
            self.tool.used_colour();
        }
        begun
    }

    /// Leads the stroke of a brush to a point of the picture.
    pub(super) fn lead_picture_brush(&mut self, to: Vec2, picker: &Picker) {
        let mut stops = Vec::new();
        if let Some(Stroke { work: Work::Picture(options), path, .. }) = &mut self.stroke {
            path.scale(self.tool.pens.of_brush(options.brush()).size(self.grip.now));
            path.line_to(to.extend(0.0), |stop| stops.push(stop));
        }
        self.use_in_picture(&stops, picker);
    }

    /// Uses the brush at points of the picture as it was last shown.
    fn use_in_picture(&mut self, stops: &[Vec3], picker: &Picker) {
        for (stop, touch) in stops.iter().zip(self.grip.on_way(stops.len())) {
            let Some(Stroke { work: Work::Picture(options), uses, .. }) = &self.stroke else {
                return;
            };
            let options = touched(options, self.tool.pens.of_brush(options.brush()), touch);
            let Some(map) = picker.map() else { return };
            let at = stop.truncate();
            let pixel = at.max(Vec2::ZERO).as_uvec2().min(map.rays.size - 1);
            let radius = self.brush_px(&options, at, picker);
            let footprint = Footprint::of_pixel(&map.rays, pixel, radius, options.get(OUTLINE));
            let command = self.tool_in_use().brush_under(&options, footprint, *uses);
            self.use_brush(command);
        }
    }

    fn use_brush(&mut self, command: Option<Command>) {
        if let Some(stroke) = &mut self.stroke {
            stroke.uses += 1;
            stroke.idle_since_s = None;
        }
        if command.is_some_and(|command| !self.execute(&command)) {
            self.cancel_stroke();
        }
    }

    /// The radius of a brush where the picture shows the surface at `at`, in pixels.
    fn brush_px(&self, options: &BrushOptions, at: Vec2, picker: &Picker) -> f32 {
        let gauge = self.target(at, picker).map(|point| self.gauge_at(point, picker));
        self.tool.radius_px(options.get(RADIUS), gauge)
    }

    /// Uses a brush that goes on for as long as it is held once more where it is, if it has not been used for a while.
    /// Returns after how long to ask again, in seconds. `now_s`: on any clock; `by_hand`: in a headset.
    pub fn dwell(&mut self, now_s: f64, by_hand: bool, picker: &Picker) -> Option<f64> {
        let stroke = self.stroke.as_mut()?;
        let brush = match stroke.work {
            Work::Picture(options) if !by_hand => options.brush(),
            Work::Cone(options) if by_hand => options.brush(),
            _ => return None,
        };
        if brush.spec().stroke != (BrushStroke::Picture { repeats: true }) {
            return None;
        }
        let since_s = *stroke.idle_since_s.get_or_insert(now_s);
        let left_s = since_s + AGAIN_S - now_s;
        if left_s > 0.0 {
            return Some(left_s);
        }
        let end = stroke.path.end();
        match (&stroke.work, stroke.held) {
            (Work::Cone(_), Some(footprint)) => self.use_cone(footprint),
            _ => self.use_in_picture(&[end], picker),
        }
        if let Some(stroke) = &mut self.stroke {
            stroke.idle_since_s = Some(now_s);
        }
        Some(AGAIN_S)
    }

    /// Opens a stroke of a brush in a hand, and uses it. `footprint`: its cone; `spacing_vx`: how far that goes along the
    /// surface before it is used again.
    pub(super) fn begin_cone(
        &mut self,
        options: BrushOptions,
        footprint: Footprint,
        spacing_vx: f32,
    ) {
        if !self.begin_brush(options.brush()) {
            return;
        }
        let path = Path::new(footprint.eye_vx + footprint.aim, spacing_vx, Vec3::ONE);
        self.stroke = Some(Stroke::new(Work::Cone(options), path));
        self.use_cone(footprint);
    }

    /// Leads the stroke of a brush in a hand.
    pub(super) fn lead_cone(&mut self, footprint: Footprint) {
        let at = footprint.eye_vx + footprint.aim;
        if let Some(Stroke { work: Work::Cone(_), path, held, .. }) = &mut self.stroke {
            *held = Some(footprint);
            let mut due = false;
            let mut way = *path;
            way.line_to(at, |_| due = true);
            if due {
                path.jump_to(at, |_| ());
                self.use_cone(footprint);
            }
        }
    }

    fn use_cone(&mut self, footprint: Footprint) {
        if let Some(Stroke { work: Work::Cone(options), uses, .. }) = &self.stroke {
            let by = self.tool.pens.of_brush(options.brush());
            let options = touched(options, by, self.grip.now);
            let radius = footprint.radius * by.size(self.grip.now);
            let footprint = Footprint { radius: radius.min(MAX_FOOTPRINT), ..footprint };
            let command = self.tool.brush_under(&options, footprint, *uses);
            self.use_brush(command);
        }
    }

    /// Opens a stroke where the tool is and uses the tool there. `unpaints`: the stroke paints the bare colour.
    pub(super) fn begin_stroke(&mut self, mode: ToolMode, unpaints: bool, guide: Guide) {
        if self.stroke.is_some() {
            return;
        }
        self.grip.begin();
        let command = self.tool.command(mode, &Leg::place(&self.tool.primitive()));
        if !self.execute(&Command::Begin { label: command.label() }) {
            return;
        }
        let edges = self.session.document().grid().voxel_size();
        let edges = edges / edges.min_element();
        let sweep = Sweep::new(&self.tool.primitive(), edges);
        let path = Path::new(Vec3::ZERO, 1.0, Vec3::ONE);
        let work = Work::Solid { mode, guide, sweep };
        self.stroke = Some(Stroke { unpaints, ..Stroke::new(work, path) });
        let paints = mode == ToolMode::Recolour && self.tool.picture.is_none() && !unpaints;
        if mode == ToolMode::Add || paints {
            self.tool.used_colour();
        }
        let command = self.tool_in_use().command(mode, &Leg::place(&self.tool.primitive()));
        if !self.execute(&command) {
            self.cancel_stroke();
        }
    }

    /// Leads the stroke to a point of the picture.
    pub(super) fn lead_stroke(&mut self, to: Vec2, picker: &Picker) {
        let Some(mut stroke) = self.stroke.take_if(|_| to.is_finite()) else { return };
        let mut legs = Vec::new();
        let mut end = None;
        if let Work::Solid {
            guide: Guide::Surface(guide) | Guide::Tool { hovering: Some(guide) },
            sweep,
            ..
        } = &mut stroke.work
        {
            let grid = self.session.document().grid();
            let from = guide.at;
            let looks = (to.distance(from) / LOOK_EVERY_PX).ceil().clamp(1.0, MOST_LOOKS) as u32;
            for i in 1..=looks {
                let look = from.lerp(to, i as f32 / looks as f32);
                let centre = guide.centre_at(look, grid, picker);
                self.tool.go_over_surface(sweep, centre, |leg| legs.push(leg));
                end = Some(centre);
            }
            guide.at = to;
        }
        self.stroke = Some(stroke);
        self.sweep_tool(&legs);
        if let (Some(stroke), Some(end)) = (&self.stroke, end) {
            self.tool.move_to(end);
            if let Some(SurfaceGuide { lift, .. }) = stroke.surface_guide() {
                self.led_over(end - *lift);
            }
        }
    }

    /// Whether the pointer, as the picture is now, leads a solid that is held down.
    pub(super) fn is_hover_led(&self, picker: &Picker) -> bool {
        let guide = self.stroke.as_ref().and_then(Stroke::surface_guide);
        guide.is_some_and(|guide| guide.is_of(picker))
    }

    /// The pointer has put the tool on `point`, which is seen at `at`: a solid that is held down
    /// follows it from here on.
    pub(super) fn hover_stroke(&mut self, at: Vec2, point: Vec3, picker: &Picker) {
        let mut legs = Vec::new();
        let to = self.tool.centre_vx;
        let grid = self.session.document().grid();
        if let Some(Stroke {
            work: Work::Solid { guide: Guide::Tool { hovering }, sweep, .. },
            ..
        }) = &mut self.stroke
        {
            *hovering = Some(SurfaceGuide::new(at, point, &self.tool, grid, picker));
            self.tool.go_over_surface(sweep, to, |leg| legs.push(leg));
        }
        self.sweep_tool(&legs);
    }

    /// The tool was moved by something else; a stroke that it leads follows.
    pub(super) fn tool_moved(&mut self, picker: &Picker) {
        let mut legs = Vec::new();
        let to = self.tool.centre_vx;
        self.clay_moved();
        if self.tool.picture_brush().is_some() {
            // The brush works where the tool would be seen.
            self.pointer = picker.sight().pixel_of(to);
            if let Some(at) = self.pointer {
                self.lead_picture_brush(at, picker);
            }
            return;
        }
        if let Some(Stroke {
            work: Work::Solid { guide: Guide::Tool { hovering }, sweep, .. },
            ..
        }) = &mut self.stroke
        {
            *hovering = None;
            sweep.lead(&self.tool.primitive_at(to), |leg| legs.push(leg));
        }
        self.sweep_tool(&legs);
    }

    fn sweep_tool(&mut self, legs: &[Leg]) {
        for leg in legs {
            let Some(Stroke { work: Work::Solid { mode, .. }, .. }) = &self.stroke else {
                return;
            };
            if !self.execute(&self.tool_in_use().command(*mode, leg)) {
                self.cancel_stroke();
            }
        }
    }

    /// Lets a solid arrive where it has been led.
    fn finish_sweep(&mut self) {
        let mut legs = Vec::new();
        let tool = self.tool.primitive();
        if let Some(Stroke { work: Work::Solid { sweep, .. }, .. }) = &mut self.stroke {
            sweep.finish(&tool, |leg| legs.push(leg));
        }
        self.sweep_tool(&legs);
    }

    pub(super) fn end_stroke(&mut self) {
        self.catch_up();
        self.finish_sweep();
        self.set_touch(None);
        let Some(stroke) = self.stroke.take() else { return };
        self.note_worked();
        if !self.execute(&Command::End) {
            return;
        }
        match stroke.work {
            Work::Grab(held) if held.is_still() => {}
            _ if stroke.changed == 0 => self.explain_idle(&stroke.tried),
            _ => self.note_cut_off(stroke.beyond),
        }
    }

    pub fn cancel_stroke(&mut self) {
        if self.stroke.take().is_some() {
            self.execute(&Command::Cancel);
        }
    }
}
