//! The present stroke: from the press to the release the tool is used along a path, as one step of the history. A
//! [`Lead`] controls it, one for each kind of tool.

mod cone;
mod held;
mod lead;
mod path;
mod picture;
mod solid;
mod surface;
pub mod sweep;

use glam::{IVec3, Vec2, Vec3};

use super::commands::CommandRunner;
use super::idle::{IdleTool, may_add};
use super::pressure::Grip;
use super::surface_anchor::SurfaceAnchor;
use super::tool::ToolState;
use crate::input::ToolMode;
use crate::picking::Picker;
use crate::tools::brush::BrushId;
use crate::tools::brush::footprint::Footprint;
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::BrushStroke;

use cone::ConeStroke;
use held::HeldStroke;
use lead::Lead;
use picture::PictureStroke;
use solid::SolidStroke;
use surface::SurfaceStroke;
use sweep::SweepSegment;

pub(super) use lead::{PointerLead, StrokeScene};
pub(super) use solid::{PointerGuide, SolidGuide};

/// Time between two uses of a held brush that repeats, in seconds.
const AGAIN_S: f64 = 0.1;

/// A stroke that is not finished.
pub(super) struct Stroke {
    lead: Box<dyn Lead>,
    /// Start of the time without use on the clock of [`Stroking::dwell`], and the number of uses then.
    idle: Option<(f64, u32)>,
}

impl Stroke {
    /// Returns how the pointer controls it.
    pub fn pointer(&self) -> PointerLead {
        self.lead.pointer()
    }

    /// Returns whether the pointer guides a solid over the surface in the present picture.
    pub fn is_led_over(&self, picker: &Picker) -> bool {
        self.lead.is_led_over(picker)
    }

    /// Returns whether its path depends on the surface under the pointer.
    pub fn depends_on_picture(&self) -> bool {
        self.lead.depends_on_picture()
    }
}

/// The present stroke, with the part of the editor that it works on.
pub(super) struct Stroking<'a> {
    pub stroke: &'a mut Option<Stroke>,
    pub commands: &'a mut CommandRunner,
    pub tool: &'a mut ToolState,
    pub anchor: &'a mut SurfaceAnchor,
    pub grip: &'a mut Grip,
}

impl Stroking<'_> {
    /// Opens a stroke of a brush at a point of the picture and uses it there. `unpaints`: it paints the bare colour.
    pub fn begin_picture_brush(
        &mut self,
        options: BrushOptions,
        unpaints: bool,
        at: Vec2,
        picker: &Picker,
    ) {
        self.begin_brush(options.brush(), Some(picker), |scene| {
            Box::new(PictureStroke::new(options, unpaints, at, scene, picker))
        });
    }

    /// Opens a stroke of a brush in a hand, and uses it. `cone`: its area; `spacing_vx`: distance along the surface
    /// between two uses.
    pub fn begin_cone(&mut self, options: BrushOptions, cone: Footprint, spacing_vx: f32) {
        self.begin_brush(options.brush(), None, |_| {
            Box::new(ConeStroke::new(options, cone, spacing_vx))
        });
    }

    /// Opens a stroke of a deforming brush at the tool. `at`: the pointer (pixels).
    pub fn begin_clay(&mut self, brush: BrushId, inverse: bool, at: Option<Vec2>, picker: &Picker) {
        self.begin_brush(brush, Some(picker), |scene| {
            let options = scene.tool.brushes.ball_options(brush);
            match brush.spec().stroke {
                BrushStroke::Held { turns } => {
                    Box::new(HeldStroke::new(options, turns, at, scene, picker))
                }
                _ => Box::new(SurfaceStroke::new(options, inverse, at, scene, picker)),
            }
        });
    }

    /// Opens a stroke of the solid in hand at the tool and uses it there. `unpaints`: it paints the bare colour;
    /// `guide`: the input that moves it.
    pub fn begin_solid(
        &mut self,
        mode: ToolMode,
        unpaints: bool,
        guide: impl FnOnce(&StrokeScene) -> SolidGuide,
    ) {
        let label = self.tool.command(mode, &SweepSegment::place(&self.tool.primitive())).label();
        let paints = mode == ToolMode::Recolour && self.tool.picture.is_none() && !unpaints;
        let gives_colour = mode == ToolMode::Add || paints;
        self.begin_stroke(label, gives_colour, None, |scene| {
            Box::new(SolidStroke::new(mode, unpaints, guide(scene), scene))
        });
    }

    fn begin_brush(
        &mut self,
        brush: BrushId,
        picker: Option<&Picker>,
        lead: impl FnOnce(&mut StrokeScene) -> Box<dyn Lead>,
    ) {
        let spec = brush.spec();
        self.begin_stroke(spec.name.into(), spec.gives_colour, picker, lead);
    }

    /// Opens a stroke, unless there is one, and executes the due commands.
    fn begin_stroke(
        &mut self,
        label: String,
        gives_colour: bool,
        picker: Option<&Picker>,
        lead: impl FnOnce(&mut StrokeScene) -> Box<dyn Lead>,
    ) {
        if self.stroke.is_some() || !self.commands.begin_stroke(label, may_add(self.tool)) {
            return;
        }
        if gives_colour {
            self.tool.used_colour();
        }
        self.grip.begin();
        let lead = lead(&mut self.scene());
        *self.stroke = Some(Stroke { lead, idle: None });
        self.carry_out_due(picker);
    }

    fn scene(&mut self) -> StrokeScene<'_> {
        let document = self.commands.document();
        StrokeScene { document, tool: self.tool, anchor: self.anchor, grip: self.grip }
    }

    fn with_lead<T>(
        &mut self,
        act: impl FnOnce(&mut dyn Lead, &mut StrokeScene) -> T,
    ) -> Option<T> {
        let Stroking { stroke, commands, tool, anchor, grip } = self;
        let lead = &mut *stroke.as_mut()?.lead;
        Some(act(lead, &mut StrokeScene { document: commands.document(), tool, anchor, grip }))
    }

    fn carry_out_due(&mut self, picker: Option<&Picker>) {
        while let Some(command) = self.with_lead(|lead, scene| lead.next(scene, picker)).flatten() {
            if !self.commands.execute(&command) {
                self.cancel();
            }
            self.follow_shift();
        }
    }

    /// Moves the tool and its stroke along with the coordinates of the grid, if its box has moved.
    pub fn follow_shift(&mut self) {
        let by_vx = self.commands.take_shift();
        if by_vx == IVec3::ZERO {
            return;
        }
        let by_vx = by_vx.as_vec3();
        self.tool.centre_vx += by_vx;
        self.anchor.shift(by_vx);
        if let Some(stroke) = self.stroke {
            stroke.lead.shift(by_vx);
        }
    }

    /// Moves the stroke to a point of the picture.
    pub fn lead_to(&mut self, to: Vec2, picker: &Picker) {
        self.with_lead(|lead, scene| lead.point_at(to, scene, picker));
        self.carry_out_due(Some(picker));
    }

    /// Moves the stroke to a point of the picture if it follows the pointer without a button. Returns false if it does
    /// not.
    pub fn lead_by_pointer(&mut self, to: Vec2, picker: &Picker) -> bool {
        let leads = self.stroke.as_ref().is_some_and(|s| s.pointer() == PointerLead::Always);
        if leads {
            self.lead_to(to, picker);
        }
        leads
    }

    /// Moves the stroke of a brush in a hand.
    pub fn aim(&mut self, cone: Footprint) {
        self.with_lead(|lead, _| lead.aim(cone));
        self.carry_out_due(None);
    }

    /// Follows the pointer, which has put the tool on `point`, seen at `at`: a solid that is held down continues there.
    pub fn tool_put(&mut self, at: Vec2, point: Vec3, picker: &Picker) {
        self.with_lead(|lead, scene| lead.tool_put(at, point, scene, picker));
        self.carry_out_due(Some(picker));
    }

    /// Follows a tool moved by something else.
    pub fn tool_moved(&mut self, picker: &Picker) {
        self.with_lead(|lead, scene| lead.tool_moved(scene, picker));
        self.carry_out_due(Some(picker));
    }

    /// Does the work that is too slow for every event of a frequent device. Called once per picture.
    pub fn catch_up(&mut self) {
        self.with_lead(|lead, _| lead.catch_up());
        self.carry_out_due(None);
    }

    /// Uses a held brush again where it is, if it repeats and has not been used for a while. Returns the seconds until
    /// the next call. `now_s`: on any clock; `by_hand`: in a headset.
    pub fn dwell(&mut self, now_s: f64, by_hand: bool, picker: &Picker) -> Option<f64> {
        let Stroke { lead, idle, .. } = self.stroke.as_mut()?;
        if !lead.repeats(by_hand) {
            return None;
        }
        let uses = lead.uses();
        // It has been used since, or this is the first call.
        if idle.is_none_or(|(_, before)| before != uses) {
            *idle = Some((now_s, uses));
        }
        let since_s = idle.map_or(now_s, |(since_s, _)| since_s);
        let left_s = since_s + AGAIN_S - now_s;
        if left_s > 0.0 {
            return Some(left_s);
        }
        self.with_lead(|lead, scene| lead.repeat(scene));
        self.carry_out_due(Some(picker));
        if let Some(stroke) = self.stroke {
            stroke.idle = Some((now_s, stroke.lead.uses()));
        }
        Some(AGAIN_S)
    }

    /// Ends the stroke, and explains a lack of effect. `in_hand`: a hand in a headset holds the tool.
    pub fn end(&mut self, in_hand: bool) {
        self.with_lead(|lead, scene| lead.finish(scene));
        self.carry_out_due(None);
        self.grip.touch(None);
        let Some(stroke) = self.stroke.take() else { return };
        self.anchor.note_worked(self.tool);
        let Some(tally) = self.commands.end_stroke().filter(|_| !stroke.lead.is_still()) else {
            return;
        };
        match tally.changed {
            0 => self.commands.explain_idle(&tally.tried, IdleTool::of(self.tool, in_hand)),
            _ => self.commands.note_cut_off(tally.beyond),
        }
    }

    /// Reverts the stroke.
    pub fn cancel(&mut self) {
        if self.stroke.take().is_some() {
            self.commands.cancel_stroke();
            self.follow_shift();
        }
    }
}
