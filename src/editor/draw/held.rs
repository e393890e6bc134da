//! Lines and curves that a hand draws in the air, in the room of a headset.
//!
//! Takes places of the grid in voxels; the tube is made when the trigger is let go.

use glam::Vec3;

use super::drawing::Sketch;
use super::view::{chain, circle};
use super::{DrawKind, Editor, tube};
use crate::editor::tool::ToolKind;

/// Least distance from one place to the next, in voxels.
const SPACING_VX: f32 = 0.5;
/// Most places of a way; beyond, it grows no more.
const MOST_PLACES: usize = 8192;

impl Editor {
    /// Begins a drawing by the hand at a place of the grid.
    pub(in crate::editor) fn begin_held_drawing(&mut self, kind: DrawKind, at_vx: Vec3) {
        match kind.spec().by_hand {
            true => self.held_way = vec![at_vx],
            false => {
                self.note("This tool draws over a picture: in a headset, use the line or the curve")
            }
        }
    }

    /// Continues the drawing, if there is one.
    pub(in crate::editor) fn lead_held_drawing(&mut self, to_vx: Vec3) {
        let line = self.tool.kind == ToolKind::Draw(DrawKind::Line);
        let Some(last) = self.held_way.last() else { return };
        if line {
            self.held_way.truncate(1);
            self.held_way.push(to_vx);
        } else if last.distance(to_vx) >= SPACING_VX && self.held_way.len() < MOST_PLACES {
            self.held_way.push(to_vx);
        }
    }

    /// Ends the drawing and makes its tube.
    pub(in crate::editor) fn end_held_drawing(&mut self) {
        let way = std::mem::take(&mut self.held_way);
        let voxel_size = self.document().grid().voxel_size();
        let edges = voxel_size / voxel_size.min_element();
        if let Some(form) = tube::curve(&way, self.tool.draws.radii, edges) {
            let mode = self.tool.mode;
            let commands = vec![self.tool.change(mode).by_drawn_solid(form)];
            self.carry_out_drawn(DrawKind::Curve, mode, commands);
        }
    }

    /// The ball in the hand, and the way that it has gone.
    pub(super) fn held_sketch(&self) -> Sketch {
        let voxel_size = self.document().grid().voxel_size();
        let edges = voxel_size / voxel_size.min_element();
        let [start, end] = self.tool.draws.radii;
        let ball = |at: Vec3, radius: f32| {
            let [x, y, z] = Vec3::AXES.map(|axis| axis * radius / edges);
            [(x, y), (y, z), (z, x)].into_iter().flat_map(move |(a, b)| circle(at, a, b))
        };
        let radius = if self.held_way.is_empty() { start } else { end };
        let mut lines: Vec<[Vec3; 2]> = chain(&self.held_way).collect();
        lines.extend(ball(self.tool.centre_vx, radius));
        lines.extend(self.held_way.first().into_iter().flat_map(|at| ball(*at, start)));
        Sketch { mode: self.tool.mode, lines, faint: Vec::new() }
    }
}
