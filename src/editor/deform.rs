//! Strokes of the brushes that deform clay, and in this file those of the brushes that take hold of it.
//!
//! A stroke of `grab` or `twist` moves the clay as it was when the stroke began. Each command takes the place of the one before,
//! so that however long the drag, the clay is resampled once. Events only say how far to pull; [`Editor::catch_up`] does
//! it, once for each picture.

use glam::{Vec2, Vec3};

use super::Editor;
use super::dabs::normal_around;
use super::stroke::{Stroke, Work};
use crate::command::Command;
use crate::picking::Picker;
use crate::tools::brush::BrushId;
use crate::tools::brush::dab::{Dab, DabPlace};
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::BrushStroke;

/// Clay that is held, and how far it is pulled.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct HeldClay {
    options: BrushOptions,
    /// It turns instead of going along.
    turns: bool,
    /// Where the tool took hold, in voxels.
    start: Vec3,
    /// Out of the clay there, of length 1.
    normal: Vec3,
    /// To the right, as it is seen, of length 1 in units of the smallest edge.
    right: Vec3,
    /// Voxel edges in units of the smallest.
    edges: Vec3,
    /// From there to what the pointer pointed at, in voxels; none while a key or a hand holds it away from the pointer.
    aside: Option<Vec3>,
    /// How far the tool has been led, in voxels.
    by: Vec3,
    /// How far it had been when the clay was last pulled.
    done: Vec3,
}

impl HeldClay {
    /// Whether the pointer leads it.
    pub fn is_led(&self) -> bool {
        self.aside.is_some()
    }

    /// Whether nothing has been pulled.
    pub fn is_still(&self) -> bool {
        self.by == Vec3::ZERO
    }

    /// None where it changes nothing.
    fn command(&self) -> Option<Command> {
        let HeldClay { options, start: start_vx, by: by_vx, normal, right, edges, .. } = *self;
        let place = DabPlace::Held { start_vx, by_vx, normal, right, edges };
        (options.brush().spec().dab)(&Dab { options: &options, place }).map(Command::Brush)
    }
}

impl Editor {
    /// Begins to use a brush that deforms. `at`: the pointer that leads it (pixels).
    pub(super) fn begin_clay(
        &mut self,
        brush: BrushId,
        inverse: bool,
        at: Option<Vec2>,
        picker: &Picker,
    ) {
        match brush.spec().stroke {
            BrushStroke::Held { turns } => self.begin_grab(brush, turns, at, picker),
            _ => self.begin_dabs(brush, inverse, at, picker),
        }
    }

    /// The options of a brush where the tool is: the radius in units of the smallest edge.
    pub(super) fn ball_options(&self, brush: BrushId) -> BrushOptions {
        self.tool.brushes.of(brush).with(RADIUS, self.tool.ball_radius(brush))
    }

    /// Leads the clay that is held, or the brush, to a point of the picture.
    pub(super) fn lead_clay(&mut self, to: Vec2, picker: &Picker) {
        self.lead_grab(to, picker);
        self.lead_dabs(to, picker);
    }

    /// Something else has moved the tool: the clay that it holds follows, or the brush.
    pub(super) fn clay_moved(&mut self) {
        self.grab_moved();
        self.dabs_moved();
    }

    /// Takes hold of the clay around the tool. `at`: the pointer that leads it (pixels).
    fn begin_grab(&mut self, brush: BrushId, turns: bool, at: Option<Vec2>, picker: &Picker) {
        if !self.begin_brush(brush) {
            return;
        }
        let start = self.tool.centre_vx;
        let options = self.ball_options(brush);
        let grid = self.session.document().grid();
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let normal = normal_around(grid, start, options.get(RADIUS))
            .or_else(|| at.map(|at| picker.normal(grid, at, true)))
            .and_then(Vec3::try_normalize)
            .unwrap_or(Vec3::Y);
        let beside = |at| in_plane_of(start, at + Vec2::X, picker) - in_plane_of(start, at, picker);
        let right = picker.sight().pixel_of(start).map(beside);
        let right = right.and_then(|right| (right * edges).try_normalize()).unwrap_or(Vec3::X);
        let held = HeldClay {
            options,
            turns,
            start,
            normal,
            right,
            edges,
            aside: at.map(|at| in_plane_of(start, at, picker) - start),
            by: Vec3::ZERO,
            done: Vec3::ZERO,
        };
        self.stroke = Some(Stroke::of_clay(held));
    }

    /// Leads the clay that is held to a point of the picture, in the plane of the view in which it was taken hold of.
    fn lead_grab(&mut self, to: Vec2, picker: &Picker) {
        if let Some(Stroke { work: Work::Grab(held), .. }) = &mut self.stroke
            && let Some(aside) = held.aside
        {
            let by = in_plane_of(held.start, to, picker) - held.start - aside;
            if by.is_finite() {
                held.by = by;
                if !held.turns {
                    self.tool.centre_vx = held.start + by;
                }
                self.leave_ground();
            }
        }
    }

    fn grab_moved(&mut self) {
        let to = self.tool.centre_vx;
        if let Some(Stroke { work: Work::Grab(held), .. }) = &mut self.stroke
            && to.is_finite()
        {
            held.by = to - held.start;
        }
    }

    /// Pulls the clay that is held to where it has been led. To be called once for each picture, since it takes
    /// milliseconds and a device may speak often.
    pub fn catch_up(&mut self) {
        let Some(Stroke { work: Work::Grab(held), .. }) = &mut self.stroke else { return };
        if held.done == held.by {
            return;
        }
        held.done = held.by;
        if held.command().is_some_and(|command| !self.execute(&command)) {
            self.cancel_stroke();
        }
    }
}

/// The point seen at `at` (pixels) in the plane of the view through `point`.
fn in_plane_of(point: Vec3, at: Vec2, picker: &Picker) -> Vec3 {
    let sight = picker.sight();
    sight.at_depth(at, sight.depth(point))
}
