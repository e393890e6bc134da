//! The stroke under way: from the press to the release the tool is used along a path, and all of it
//! is one step of the history. Solids follow a path in the grid, sprays one in the picture.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Editor;
use super::dabs::Dabs;
use super::deform::HeldClay;
use super::path::Path;
use super::pressure::PenTool;
use super::sprays::SprayOptions;
use super::sweep::{Leg, Sweep};
use super::tool::ToolState;
use crate::command::Command;
use crate::input::ToolMode;
use crate::picking::Picker;
use crate::picking::geometry::{lasting, surface_point};
use crate::sculpture::Grid;
use crate::surface::IndexMap;
use crate::tools::brush::footprint::{Footprint, MAX_FOOTPRINT};
use crate::tools::brush::spray::SprayKind;
use crate::tools::solid::Primitive;

/// After how long a spray that goes on while it is held is used again, in seconds.
const AGAIN_S: f64 = 0.1;
/// Spacing of a spray's path as a share of its radius.
const SPACING: f32 = 0.35;
/// Pixels between two looks at the surface along a drag.
pub(super) const LOOK_EVERY_PX: f32 = 3.0;
/// Most looks at the surface along a drag.
pub(super) const MOST_LOOKS: f32 = 1024.0;
/// A step on the surface longer than this many tool sizes is a leap over an edge.
pub(super) const LEAP: f32 = 2.0;

/// What leads the tool.
pub(super) enum Guide {
    /// A drag of the pointer over the surface.
    Surface(SurfaceGuide),
    /// Whatever moves the tool, while a key, a button or a hand holds it down; `hovering`: the
    /// pointer, if it has moved the tool last.
    Tool { hovering: Option<SurfaceGuide> },
}

/// The pointer on the surface as it was seen when it began to lead the stroke, so that what the stroke
/// adds or cuts on its way does not lead it astray.
pub(super) struct SurfaceGuide {
    seen: Option<Arc<IndexMap>>,
    pub at: Vec2,
    /// Of the last point, for where the pointer is beside the sculpture.
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

/// What a stroke does along its path.
pub(super) enum Work {
    Solid {
        mode: ToolMode,
        guide: Guide,
        sweep: Sweep,
    },
    Spray {
        kind: SprayKind,
        options: SprayOptions,
    },
    /// A spray that is held in a hand, with rays of its own.
    HeldSpray {
        kind: SprayKind,
        options: SprayOptions,
    },
    /// Clay that is taken along.
    Grab(HeldClay),
    /// A brush that moves the surface.
    Dabs(Dabs),
}

/// A stroke that is not finished.
pub(super) struct Stroke {
    pub work: Work,
    /// In voxels; in pixels with z = 0 for sprays; of no use to clay that is held, nor to solids, which sweep.
    pub path: Path,
    /// Voxels that it has changed so far.
    pub changed: u64,
    /// The first commands, as long as they have changed nothing.
    pub tried: Vec<Command>,
    /// It has added, and would have gone on beyond the walls of the grid.
    pub beyond: bool,
    /// How often a spray was used.
    uses: u32,
    /// Since when it has not been used, on the clock of [`Editor::dwell`].
    idle_since_s: Option<f64>,
    /// The rays of a spray that is held in a hand, as they are now.
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
            Work::Spray { .. } | Work::HeldSpray { .. } | Work::Grab(_) | Work::Dabs(_) => None,
        }
    }

    pub fn is_spray(&self) -> bool {
        matches!(self.work, Work::Spray { .. })
    }

    /// Whether where it goes depends on what the picture shows under the pointer.
    pub fn is_led_over_picture(&self) -> bool {
        let clay = match &self.work {
            Work::Grab(held) => held.is_led(),
            Work::Dabs(dabs) => dabs.is_led(),
            _ => false,
        };
        self.surface_guide().is_some() || self.is_spray() || clay
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
    /// Opens a stroke of a spray at a point of the picture and uses it there.
    pub(super) fn begin_spray(
        &mut self,
        kind: SprayKind,
        options: SprayOptions,
        unpaints: bool,
        at: Vec2,
        picker: &Picker,
    ) {
        if self.stroke.is_some() || !self.execute(&Command::Begin { label: kind.name().into() }) {
            return;
        }
        if kind.gives_colour() {
            self.tool.used_colour();
        }
        self.grip.begin();
        let share = match kind {
            // Beside each other, since one over another would blur the image.
            SprayKind::Paintbrush if self.tool.stencil.is_some() && !unpaints => 2.0,
            _ => SPACING,
        };
        let spacing = (share * self.spray_px(&options, at, picker)).max(1.0);
        let path = Path::new(at.extend(0.0), spacing, Vec3::ONE);
        let work = Work::Spray { kind, options };
        self.stroke = Some(Stroke { unpaints, ..Stroke::new(work, path) });
        self.spray_at(&[at.extend(0.0)], picker);
    }

    /// Leads the stroke of a spray to a point of the picture.
    pub(super) fn lead_spray(&mut self, to: Vec2, picker: &Picker) {
        let mut stops = Vec::new();
        if let Some(Stroke { work: Work::Spray { kind, .. }, path, .. }) = &mut self.stroke {
            path.scale(self.tool.pens.of(PenTool::Spray(*kind)).size(self.grip.now));
            path.line_to(to.extend(0.0), |stop| stops.push(stop));
        }
        self.spray_at(&stops, picker);
    }

    /// Uses the spray at points of the picture as it was last shown.
    fn spray_at(&mut self, stops: &[Vec3], picker: &Picker) {
        for (stop, touch) in stops.iter().zip(self.grip.on_way(stops.len())) {
            let Some(Stroke { work: Work::Spray { kind, options }, uses, .. }) = &self.stroke
            else {
                return;
            };
            let options = options.touched(*kind, self.tool.pens.of(PenTool::Spray(*kind)), touch);
            let Some(map) = picker.map() else { return };
            let at = stop.truncate();
            let pixel = at.max(Vec2::ZERO).as_uvec2().min(map.rays.size - 1);
            let (radius, outline) = (self.spray_px(&options, at, picker), options.outline);
            let footprint = Footprint::of_pixel(&map.rays, pixel, radius, outline);
            let command = self.tool_in_use().spray_command(*kind, &options, footprint, *uses);
            self.note_use();
            if !self.execute(&command) {
                self.cancel_stroke();
            }
        }
    }

    /// The radius of a spray where the picture shows the surface at `at`, in pixels.
    fn spray_px(&self, options: &SprayOptions, at: Vec2, picker: &Picker) -> f32 {
        let gauge = self.target(at, picker).map(|point| self.gauge_at(point, picker));
        self.tool.radius_px(options.radius, gauge)
    }

    fn note_use(&mut self) {
        if let Some(stroke) = &mut self.stroke {
            stroke.uses += 1;
            stroke.idle_since_s = None;
        }
    }

    /// Uses a spray that goes on for as long as it is held once more where it is, if it has not been used for a while.
    /// Returns after how long to ask again, in seconds. `now_s`: on any clock; `by_hand`: in a headset.
    pub fn dwell(&mut self, now_s: f64, by_hand: bool, picker: &Picker) -> Option<f64> {
        let stroke = self.stroke.as_mut()?;
        match stroke.work {
            Work::Spray { kind: SprayKind::Smooth, .. } if !by_hand => {}
            Work::HeldSpray { kind: SprayKind::Smooth, .. } if by_hand => {}
            _ => return None,
        }
        let since_s = *stroke.idle_since_s.get_or_insert(now_s);
        let left_s = since_s + AGAIN_S - now_s;
        if left_s > 0.0 {
            return Some(left_s);
        }
        let end = stroke.path.end();
        match (&stroke.work, stroke.held) {
            (Work::HeldSpray { .. }, Some(footprint)) => self.use_held_spray(footprint),
            _ => self.spray_at(&[end], picker),
        }
        if let Some(stroke) = &mut self.stroke {
            stroke.idle_since_s = Some(now_s);
        }
        Some(AGAIN_S)
    }

    /// Opens a stroke of a spray that is held in a hand, and uses it. `footprint`: its rays;
    /// `spacing_vx`: how far they go along the surface before it is used again.
    pub(super) fn begin_held_spray(
        &mut self,
        kind: SprayKind,
        options: SprayOptions,
        footprint: Footprint,
        spacing_vx: f32,
    ) {
        if self.stroke.is_some() || !self.execute(&Command::Begin { label: kind.name().into() }) {
            return;
        }
        if kind.gives_colour() {
            self.tool.used_colour();
        }
        let path = Path::new(footprint.eye_vx + footprint.aim, spacing_vx, Vec3::ONE);
        self.stroke = Some(Stroke::new(Work::HeldSpray { kind, options }, path));
        self.use_held_spray(footprint);
    }

    /// Leads the stroke of a spray that is held in a hand.
    pub(super) fn lead_held_spray(&mut self, footprint: Footprint) {
        let at = footprint.eye_vx + footprint.aim;
        if let Some(Stroke { work: Work::HeldSpray { .. }, path, held, .. }) = &mut self.stroke {
            *held = Some(footprint);
            let mut due = false;
            let mut way = *path;
            way.line_to(at, |_| due = true);
            if due {
                path.jump_to(at, |_| ());
                self.use_held_spray(footprint);
            }
        }
    }

    fn use_held_spray(&mut self, footprint: Footprint) {
        if let Some(Stroke { work: Work::HeldSpray { kind, options }, uses, .. }) = &self.stroke {
            let by = self.tool.pens.of(PenTool::Spray(*kind));
            let options = options.touched(*kind, by, self.grip.now);
            let radius = footprint.radius * by.size(self.grip.now);
            let footprint = Footprint { radius: radius.min(MAX_FOOTPRINT), ..footprint };
            let command = self.tool.spray_command(*kind, &options, footprint, *uses);
            self.note_use();
            if !self.execute(&command) {
                self.cancel_stroke();
            }
        }
    }

    /// Opens a stroke where the tool is and uses the tool there. `unpaints`: what it paints is the bare colour.
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
        if self.tool.spray().is_some() {
            // The spray works where the tool would be seen.
            self.pointer = picker.sight().pixel_of(to);
            if let Some(at) = self.pointer {
                self.lead_spray(at, picker);
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
