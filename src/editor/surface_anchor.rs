//! Where the tool stands on the surface, and with which choices of tool, size and rotation it was put there.
//!
//! Takes points of the surface and puts the tool there; knows no pointer and no stroke.

use glam::{Vec2, Vec3};

use super::tool::{ToolKind, ToolState};
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

    /// Returns whether the tool is another than before, or begins to follow.
    fn is_taken_anew(&self, before: &Choices) -> bool {
        (self.kind, self.solid, self.follow) != (before.kind, before.solid, before.follow)
    }
}

impl SurfaceAnchor {
    /// Returns the point of the grid under a pixel: on the surface that is seen, or while the grid is empty in the
    /// plane of the view in which the tool was used last.
    pub fn target(&self, grid: &Grid, at: Vec2, picker: &Picker) -> Option<Vec3> {
        let middle = grid.dims().as_vec3() * 0.5;
        picker.target(grid, at, self.worked_at.unwrap_or(middle))
    }

    /// Returns the point and the face of the surface that the pointer has put the tool on; none once something else has
    /// moved it.
    pub fn ground(&self) -> Option<SurfacePoint> {
        self.ground
    }

    /// Puts the tool at a point of the surface, which is seen at `at`.
    pub fn lead_tool_to(
        &mut self,
        tool: &mut ToolState,
        at: Vec2,
        point: Vec3,
        grid: &Grid,
        picker: &Picker,
    ) {
        let face = picker.normal(grid, at, tool.lean);
        self.put_tool(tool, SurfacePoint { point, face }, grid);
    }

    /// Puts the tool on a point of the surface.
    pub fn put_tool(&mut self, tool: &mut ToolState, ground: SurfacePoint, grid: &Grid) {
        self.ground = Some(ground);
        if tool.kind == ToolKind::Solid {
            tool.place_on(ground.point, ground.face, grid.voxel_size());
            self.choices = Some(Choices::of(tool));
        } else if tool.ball_brush().is_some() {
            tool.centre_vx = ground.point;
        }
    }

    /// Takes the choices of the tool. None if they are those of before, or the first; else whether the tool is another, or
    /// begins to follow.
    pub fn choose(&mut self, tool: &ToolState) -> Option<bool> {
        let choices = Choices::of(tool);
        let before = self.choices.replace(choices)?;
        (choices != before).then(|| choices.is_taken_anew(&before))
    }

    /// Another sculpture is there.
    pub fn forget(&mut self, tool: &ToolState) {
        self.leave(tool);
        self.worked_at = None;
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
