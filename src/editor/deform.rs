//! The tools that deform clay: their options, and strokes that take clay along.
//!
//! A stroke of `grab` or `twist` moves the clay as it was when the stroke began. Each command takes the place of the one before,
//! so that however long the drag, the clay is resampled once. Events only say how far to pull; [`Editor::catch_up`] does
//! it, once for each picture.

use glam::{Vec2, Vec3};

use super::Editor;
use super::dabs::normal_around;
use super::stroke::{Stroke, Work};
use crate::command::{Command, SpraySurface};
use crate::picking::Picker;
use crate::tools::brush::deform::DeformKind;
use crate::tools::brush::kernel::grab::{Falloff, Grab, MAX_PULL_VX, MAX_TWIST_DEG, Motion};

/// The options of one tool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DeformOptions {
    /// Of the ball, in the unit of the sizes of brushes; of clay that is held, in units of the smallest edge.
    pub radius: f32,
    /// How far the clay goes along, or the surface to where the brush moves it, 0 to 1.
    pub strength: f32,
    pub falloff: Falloff,
    /// Length of the rope on which the pointer leads the brush, in pixels; 0 without one.
    pub steady_px: f32,
}

/// Longest rope, in pixels.
pub const MAX_STEADY_PX: f32 = 200.0;

impl DeformOptions {
    /// What a tool begins with.
    pub fn of(kind: DeformKind) -> DeformOptions {
        let options = DeformOptions {
            radius: 60.0,
            strength: 1.0,
            falloff: Falloff::default(),
            steady_px: 0.0,
        };
        match kind {
            DeformKind::Grab | DeformKind::Twist => options,
            DeformKind::Smear => DeformOptions { radius: 40.0, ..options },
            DeformKind::Inflate | DeformKind::Draw | DeformKind::Pinch => {
                DeformOptions { radius: 40.0, strength: 0.5, ..options }
            }
            DeformKind::Crease => {
                DeformOptions { radius: 30.0, falloff: Falloff::Sharp, ..options }
            }
            DeformKind::Flatten | DeformKind::Scrape | DeformKind::Fill => {
                DeformOptions { radius: 40.0, falloff: Falloff::Flat, ..options }
            }
        }
    }
}

/// The options of all tools that deform.
#[derive(Clone, PartialEq, Debug)]
pub struct Deforms([DeformOptions; DeformKind::ALL.len()]);

impl Default for Deforms {
    fn default() -> Self {
        Deforms(DeformKind::ALL.map(DeformOptions::of))
    }
}

impl Deforms {
    pub fn of(&self, kind: DeformKind) -> &DeformOptions {
        &self.0[place(kind)]
    }

    pub fn of_mut(&mut self, kind: DeformKind) -> &mut DeformOptions {
        &mut self.0[place(kind)]
    }
}

fn place(kind: DeformKind) -> usize {
    DeformKind::ALL.iter().position(|k| *k == kind).unwrap_or(0)
}

/// How clay turns that is held: like a knob, clockwise when it is led to the right, by the radius for a radian.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Turn {
    /// Out of the clay.
    normal: Vec3,
    /// To the right, as it is seen, of length 1 in units of the smallest edge.
    right: Vec3,
    /// Voxel edges in units of the smallest.
    edges: Vec3,
}

/// Clay that is held, and how far it is pulled.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct HeldClay {
    options: DeformOptions,
    /// How it turns with the pointer; none if it goes along.
    turn: Option<Turn>,
    /// Where the tool took hold, in voxels.
    start: Vec3,
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

    fn command(&self) -> Command {
        let DeformOptions { radius, falloff, strength, .. } = self.options;
        let by = self.by * strength;
        let motion = match self.turn {
            Some(Turn { normal, right, edges }) => {
                let angle = -(by * edges).dot(right) / radius;
                let angle_deg = angle.to_degrees().clamp(-MAX_TWIST_DEG, MAX_TWIST_DEG);
                Motion::Twist { normal, angle_deg }
            }
            None => {
                let furthest = by.abs().max_element();
                let share = if furthest > MAX_PULL_VX { MAX_PULL_VX / furthest } else { 1.0 };
                Motion::Pull { by_vx: by * share }
            }
        };
        let grab = Grab { centre_vx: self.start, radius, motion, falloff };
        Command::Grab { grab, surface: SpraySurface::Stroke }
    }
}

impl Editor {
    /// Begins to use the tool in hand that deforms. `at`: the pointer that leads it (pixels).
    pub(super) fn begin_clay(&mut self, inverse: bool, at: Option<Vec2>, picker: &Picker) {
        match self.tool.deform {
            DeformKind::Grab | DeformKind::Twist => self.begin_grab(at, picker),
            _ => self.begin_dabs(inverse, at, picker),
        }
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
    fn begin_grab(&mut self, at: Option<Vec2>, picker: &Picker) {
        let kind = self.tool.deform;
        if self.stroke.is_some() || !self.execute(&Command::Begin { label: kind.name().into() }) {
            return;
        }
        let start = self.tool.centre_vx;
        let radius = self.tool.ball_radius(kind);
        let options = DeformOptions { radius, ..*self.tool.deforms.of(kind) };
        let turn = (kind == DeformKind::Twist).then(|| {
            let grid = self.session.document().grid();
            let edges = grid.voxel_size() / grid.voxel_size().min_element();
            let normal = normal_around(grid, start, options.radius)
                .or_else(|| at.map(|at| picker.normal(grid, at, true)))
                .and_then(Vec3::try_normalize)
                .unwrap_or(Vec3::Y);
            let beside =
                |at| in_plane_of(start, at + Vec2::X, picker) - in_plane_of(start, at, picker);
            let right = picker.sight().pixel_of(start).map(beside);
            let right = right.and_then(|right| (right * edges).try_normalize()).unwrap_or(Vec3::X);
            Turn { normal, right, edges }
        });
        let held = HeldClay {
            options,
            turn,
            start,
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
                if held.turn.is_none() {
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
        let command = held.command();
        if !self.execute(&command) {
            self.cancel_stroke();
        }
    }
}

/// The point seen at `at` (pixels) in the plane of the view through `point`.
fn in_plane_of(point: Vec3, at: Vec2, picker: &Picker) -> Vec3 {
    let sight = picker.sight();
    sight.at_depth(at, sight.depth(point))
}
