//! Where the tool stands on the surface: it goes with the pointer, and stays on its ground when a
//! choice of tool, size or rotation would lift or sink it, without waiting for the pointer.

use glam::{Vec2, Vec3};

use super::Editor;
use super::sizes::gauge_at;
use super::stroke::PointerLead;
use super::tool::{ToolEdit, ToolKind, ToolState};
use crate::picking::{Picker, SurfacePoint};
use crate::sculpture::Grid;
use crate::tools::solid::Solid;

/// Where the tool was put on the surface, and with which choices.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct SurfaceAnchor {
    /// None once something else than the pointer has moved the tool.
    ground: Option<SurfacePoint>,
    choices: Option<Choices>,
    /// Where the tool was used or put last, in voxels: in an empty grid the pointer leads it at that depth. None before.
    worked_at: Option<Vec3>,
}

/// The choices that the place of a tool depends on, besides the pointer.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Choices {
    kind: ToolKind,
    solid: Solid,
    half: Vec3,
    /// None if the surface gives it.
    turn_deg: Option<Vec3>,
    follow: bool,
    snap: bool,
    stand: bool,
}

impl Choices {
    fn of(tool: &ToolState) -> Choices {
        let &ToolState { kind, solid, follow, snap, stand, .. } = tool;
        let turn_deg = (!tool.lean).then(|| tool.turn_deg());
        Choices { kind, solid, half: tool.half(), turn_deg, follow, snap, stand }
    }

    /// Whether the tool is another than before, or begins to follow.
    fn is_taken_anew(&self, before: &Choices) -> bool {
        (self.kind, self.solid, self.follow) != (before.kind, before.solid, before.follow)
    }
}

impl SurfaceAnchor {
    /// The point of the grid under a pixel: on the surface that is seen, or while the grid is empty in the plane of the
    /// view in which the tool was used last.
    pub fn target(&self, grid: &Grid, at: Vec2, picker: &Picker) -> Option<Vec3> {
        let middle = grid.dims().as_vec3() * 0.5;
        picker.target(grid, at, self.worked_at.unwrap_or(middle))
    }

    /// A stroke has led the tool over the surface to `point`.
    pub fn follow(&mut self, point: Vec3) {
        if let Some(ground) = &mut self.ground {
            ground.point = point;
        }
    }

    /// The tool is where it is meant to be, wherever the pointer is.
    pub fn leave(&mut self, tool: &ToolState) {
        (self.ground, self.choices) = (None, Some(Choices::of(tool)));
        self.note_worked(tool);
    }

    /// The tool has been used, or put somewhere, where it is.
    pub fn note_worked(&mut self, tool: &ToolState) {
        self.worked_at = Some(tool.centre_vx).filter(|at| at.is_finite());
    }
}

/// How the pointer of a window is used at the moment.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PointerUse {
    /// The tool goes where the pointer is; in some tables of keys drags alone move it.
    pub leads_tool: bool,
    /// It holds something on the picture.
    pub dragging: bool,
}

impl Editor {
    /// The pointer moves with nothing held.
    pub fn hover(&mut self, at: Vec2, leads_tool: bool, picker: &Picker) {
        self.gauge(picker);
        let is_led = self.stroke.as_ref().is_some_and(|s| s.pointer() == PointerLead::Always);
        if is_led {
            // A brush that a key holds down goes with the pointer.
            self.lead_stroke(at, picker);
        }
        // So does what is drawn with a key held, or by several presses.
        self.lead_drawing(at, picker);
        self.lead_unfinished(at, picker);
        if is_led && self.tool.picture_brush().is_none() {
            return;
        }
        // The tool in a hand at work is not the pointer's.
        if !self.tool.follow || !leads_tool || self.hand.is_working() {
            return;
        }
        let solid = self.tool.kind == ToolKind::Solid;
        if solid && self.stroke.as_ref().is_some_and(|stroke| stroke.is_led_over(picker)) {
            self.lead_stroke(at, picker);
        } else if let Some(point) = self.target(at, picker) {
            self.lead_tool_to(at, point, picker);
            if solid {
                self.hover_stroke(at, point, picker);
            }
        }
    }

    /// The point of the grid under a pixel: on the surface that is seen, or while the grid is empty in the plane of the
    /// view in which the tool was used last.
    pub fn target(&self, at: Vec2, picker: &Picker) -> Option<Vec3> {
        self.anchor.target(self.document().grid(), at, picker)
    }

    /// Notes how large a pixel is where the tool works: under the pointer, or else where the tool is.
    pub(super) fn gauge(&mut self, picker: &Picker) {
        if self.hand.is_leading() {
            return;
        }
        let point = self.pointer.and_then(|at| self.target(at, picker));
        let point = point.unwrap_or(self.tool.centre_vx);
        let gauge = gauge_at(self.document().grid(), point, picker);
        self.tool.set_gauge(gauge);
    }

    /// The tool has been used, or put somewhere, where it is.
    pub(super) fn note_worked(&mut self) {
        self.anchor.note_worked(&self.tool);
    }

    /// Makes a change of the tool that a panel asks for.
    pub fn edit_tool(&mut self, edit: ToolEdit) {
        let placed = matches!(edit, ToolEdit::Place(_));
        self.tool.edit(edit);
        if placed {
            self.leave_ground();
        }
    }

    /// Another sculpture is there.
    pub(super) fn forget_anchor(&mut self) {
        self.leave_ground();
        self.anchor.worked_at = None;
    }

    /// The point of the surface that the pointer has put the tool on; none once something else has
    /// moved it.
    pub(super) fn ground(&self) -> Option<Vec3> {
        self.anchor.ground.map(|ground| ground.point)
    }

    /// Puts the tool at a point of the surface, which is seen at `at`.
    pub(super) fn lead_tool_to(&mut self, at: Vec2, point: Vec3, picker: &Picker) {
        let face = picker.normal(self.document().grid(), at, self.tool.lean);
        self.stand_on(SurfacePoint { point, face });
    }

    fn stand_on(&mut self, ground: SurfacePoint) {
        self.anchor.ground = Some(ground);
        if self.tool.kind == ToolKind::Solid {
            let voxel_size = self.document().grid().voxel_size();
            self.tool.place_on(ground.point, ground.face, voxel_size);
            self.anchor.choices = Some(Choices::of(&self.tool));
        } else if self.tool.ball_brush().is_some() {
            self.tool.centre_vx = ground.point;
        }
    }

    /// The tool is where it is meant to be, wherever the pointer is.
    pub fn leave_ground(&mut self) {
        self.anchor.leave(&self.tool);
    }

    /// Lets the tool follow at once what was chosen about it.
    pub fn keep_anchor(&mut self, pointer_use: PointerUse, picker: &Picker) {
        self.gauge(picker);
        let choices = Choices::of(&self.tool);
        let Some(before) = self.anchor.choices.replace(choices) else { return };
        let led = self.stroke.is_some() || self.hand.is_leading();
        let led = led || !choices.follow || !pointer_use.leads_tool;
        let placed = choices.kind == ToolKind::Solid || self.tool.ball_brush().is_some();
        if choices == before || !placed || led {
            return;
        }
        let taken = choices.is_taken_anew(&before);
        match (self.pointer.filter(|_| !pointer_use.dragging), self.anchor.ground) {
            (Some(at), ground) if taken || ground.is_some() => {
                self.hover(at, pointer_use.leads_tool, picker);
            }
            (None, Some(ground)) => self.stand_on(ground),
            _ => {}
        }
    }
}
