//! The tool's anchor on the surface, and the choices of tool, size and rotation for which it was set.
//!
//! Takes surface points and puts the tool there; knows no pointer and no stroke.

use glam::{Vec2, Vec3};

use super::tool::{ToolKind, ToolState};
use crate::picking::{Picker, SurfacePoint};
use crate::sculpture::Grid;
use crate::tools::solid::Solid;

/// The tool's anchor on the surface, with its choices.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct SurfaceAnchor {
    /// `None` once something other than the pointer has moved the tool.
    ground: Option<SurfacePoint>,
    choices: Option<Choices>,
    /// Position of the last use or placement, in voxels: in an empty grid, the pointer moves the tool at that depth.
    /// `None` before.
    worked_at: Option<Vec3>,
}

/// The choices that decide the position of a tool, besides the pointer.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Choices {
    kind: ToolKind,
    solid: Solid,
    half: Vec3,
    /// `None` if the surface decides it.
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

    /// Returns whether the tool is another one than before, or begins to follow.
    fn is_taken_anew(&self, before: &Choices) -> bool {
        (self.kind, self.solid, self.follow) != (before.kind, before.solid, before.follow)
    }
}

impl SurfaceAnchor {
    /// Returns the grid point under a pixel: on the visible surface, or, while the grid is empty, in the view plane
    /// through the last use of the tool.
    pub fn target(&self, grid: &Grid, at: Vec2, picker: &Picker) -> Option<Vec3> {
        let middle = grid.dims().as_vec3() * 0.5;
        picker.target(grid, at, self.worked_at.unwrap_or(middle))
    }

    /// Returns the surface point and face on which the pointer has put the tool; `None` once something else has moved
    /// it.
    pub fn ground(&self) -> Option<SurfacePoint> {
        self.ground
    }

    /// Puts the tool at a surface point, seen at `at`.
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

    /// Puts the tool on a surface point.
    pub fn put_tool(&mut self, tool: &mut ToolState, ground: SurfacePoint, grid: &Grid) {
        self.ground = Some(ground);
        if tool.kind == ToolKind::Solid {
            tool.place_on(ground.point, ground.face, grid.voxel_size());
            self.choices = Some(Choices::of(tool));
        } else if tool.ball_brush().is_some() {
            tool.centre_vx = ground.point;
        }
    }

    /// Records the choices of the tool. Returns `None` for the first or unchanged choices; otherwise whether the tool is
    /// another one, or begins to follow.
    pub fn choose(&mut self, tool: &ToolState) -> Option<bool> {
        let choices = Choices::of(tool);
        let before = self.choices.replace(choices)?;
        (choices != before).then(|| choices.is_taken_anew(&before))
    }

    /// Forgets the anchor after the sculpture was replaced.
    pub fn forget(&mut self, tool: &ToolState) {
        self.leave(tool);
        self.worked_at = None;
    }

    /// Follows a stroke that has moved the tool over the surface to `point`.
    pub fn follow(&mut self, point: Vec3) {
        if let Some(ground) = &mut self.ground {
            ground.point = point;
        }
    }

    /// Moves along with the coordinates of the grid.
    pub fn shift(&mut self, by_vx: Vec3) {
        if let Some(ground) = &mut self.ground {
            ground.point += by_vx;
        }
        self.worked_at = self.worked_at.map(|at| at + by_vx);
    }

    /// Detaches the tool from the surface, so that the pointer no longer places it.
    pub fn leave(&mut self, tool: &ToolState) {
        (self.ground, self.choices) = (None, Some(Choices::of(tool)));
        self.note_worked(tool);
    }

    /// Records that the tool was used or placed at its position.
    pub fn note_worked(&mut self, tool: &ToolState) {
        self.worked_at = Some(tool.centre_vx).filter(|at| at.is_finite());
    }
}
