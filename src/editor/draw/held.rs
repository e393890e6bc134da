//! Lines and curves that a hand draws in the air, in the room of a headset.
//!
//! Takes grid points in voxels; the tube is made when the trigger is released.

use glam::Vec3;

use super::drawing::Sketch;
use super::drawn::Drawn;
use super::tube;
use super::view::{chain, circle};
use crate::editor::tool::ToolState;
use crate::editor::tool_view::ToolView;
use crate::input::DrawKind;

/// Least distance from one place to the next, in voxels.
const SPACING_VX: f32 = 0.5;
/// Most points of a path; beyond, it stops growing.
const MOST_PLACES: usize = 8192;

/// The path of a drawing hand, in voxels; empty while none draws.
#[derive(Clone, Debug, Default)]
pub(super) struct HeldPath(Vec<Vec3>);

impl HeldPath {
    /// Begins at a grid point.
    pub fn begin(&mut self, at_vx: Vec3) {
        self.0 = vec![at_vx];
    }

    /// Continues to a point, if it has begun. `is_line`: a straight line.
    pub fn lead(&mut self, to_vx: Vec3, is_line: bool) {
        let path = &mut self.0;
        let Some(last) = path.last() else { return };
        if is_line {
            path.truncate(1);
            path.push(to_vx);
        } else if last.distance(to_vx) >= SPACING_VX && path.len() < MOST_PLACES {
            path.push(to_vx);
        }
    }

    /// Ends it and returns its tube.
    pub fn end(&mut self, view: &ToolView) -> Option<Drawn> {
        let path = std::mem::take(&mut self.0);
        let ToolState { mode, draws, .. } = view.tool;
        let solid = tube::curve(&path, draws.radii, view.edges())?;
        Some(Drawn {
            kind: DrawKind::Curve,
            mode: *mode,
            commands: vec![view.tool.change(*mode).by_drawn_solid(solid)],
            floating: Vec::new(),
        })
    }

    /// Cancels it. Returns false if there is nothing.
    pub fn cancel(&mut self) -> bool {
        !std::mem::take(&mut self.0).is_empty()
    }

    /// Returns the ball in the hand, and its path.
    pub fn sketch(&self, view: &ToolView) -> Sketch {
        let path = &self.0;
        let edges = view.edges();
        let [start, end] = view.tool.draws.radii;
        let ball = |at: Vec3, radius: f32| {
            let [x, y, z] = Vec3::AXES.map(|axis| axis * radius / edges);
            [(x, y), (y, z), (z, x)].into_iter().flat_map(move |(a, b)| circle(at, a, b))
        };
        let radius = if path.is_empty() { start } else { end };
        let mut lines: Vec<[Vec3; 2]> = chain(path).collect();
        lines.extend(ball(view.tool.centre_vx, radius));
        lines.extend(path.first().into_iter().flat_map(|at| ball(*at, start)));
        Sketch { mode: view.tool.mode, lines, faint: Vec::new() }
    }
}
