//! The pointer over the sculpture: the tool goes with it, and stays on its ground when a choice of tool, size or rotation
//! would lift or sink it, without waiting for the pointer.

use glam::{Vec2, Vec3};

use super::Editor;
use super::sizes::gauge_at;
use super::tool::{ToolEdit, ToolKind};
use crate::picking::{Picker, SurfacePoint};

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
        // A brush that a key holds down goes with the pointer.
        let is_led = self.lead_by_pointer(at, picker);
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
        self.tool.brushes.set_gauge(gauge);
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
        self.anchor.forget(&self.tool);
    }

    /// The point of the surface that the pointer has put the tool on; none once something else has
    /// moved it.
    pub(super) fn ground(&self) -> Option<Vec3> {
        self.anchor.ground().map(|ground| ground.point)
    }

    /// Puts the tool at a point of the surface, which is seen at `at`.
    pub(super) fn lead_tool_to(&mut self, at: Vec2, point: Vec3, picker: &Picker) {
        let face = picker.normal(self.document().grid(), at, self.tool.lean);
        self.stand_on(SurfacePoint { point, face });
    }

    fn stand_on(&mut self, ground: SurfacePoint) {
        self.anchor.put(ground);
        if self.tool.kind == ToolKind::Solid {
            let voxel_size = self.document().grid().voxel_size();
            self.tool.place_on(ground.point, ground.face, voxel_size);
            self.anchor.note_choices(&self.tool);
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
        let Some(taken) = self.anchor.choose(&self.tool) else { return };
        let led = self.stroke.is_some() || self.hand.is_leading();
        let led = led || !self.tool.follow || !pointer_use.leads_tool;
        let placed = self.tool.kind == ToolKind::Solid || self.tool.ball_brush().is_some();
        if !placed || led {
            return;
        }
        match (self.pointer.filter(|_| !pointer_use.dragging), self.anchor.ground()) {
            (Some(at), ground) if taken || ground.is_some() => {
                self.hover(at, pointer_use.leads_tool, picker);
            }
            (None, Some(ground)) => self.stand_on(ground),
            _ => {}
        }
    }
}
