//! Owns the stroke in hand: from the press to the release the tool is used along a path, and all
//! of it is one step of the history.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::aim::surface_point;
use super::path::Path;
use super::workbench::Workbench;
use crate::command::Command;
use crate::input::ToolMode;
use crate::surface::IndexMap;

/// Spacing of a path as a share of the tool's smallest half extent.
const SPACING: f32 = 0.35;
/// Pixels between two looks at the surface along a drag.
const LOOK_EVERY_PX: f32 = 3.0;
/// A step on the surface longer than this many tool sizes is a leap over an edge.
const LEAP: f32 = 2.0;

/// What leads the tool.
pub(super) enum Guide {
    /// The pointer on the surface as it was seen when the stroke began, so that what the stroke
    /// adds or cuts on its way does not lead it astray.
    Surface {
        seen: Option<Arc<IndexMap>>,
        at: Vec2,
        /// Of the last point, for where the pointer is beside the sculpture.
        depth: f32,
    },
    /// Whatever moves the tool.
    Tool,
}

/// A stroke that is not finished.
pub struct StrokeInHand {
    mode: ToolMode,
    path: Path,
    pub(super) guide: Guide,
}

impl Workbench {
    /// Opens a stroke where the tool is and uses the tool there.
    pub(super) fn begin_stroke(&mut self, mode: ToolMode, guide: Guide) {
        if self.stroke.is_some() {
            return;
        }
        let command = self.ui.hand.command(mode);
        if !self.execute(&Command::Begin { label: command.label() }) {
            return;
        }
        let edges = self.session.document().grid().voxel_size();
        let edges = edges / edges.min_element();
        let spacing = SPACING * self.ui.hand.half().min_element();
        let path = Path::new(self.ui.hand.centre_vx, spacing.max(0.5), edges);
        self.stroke = Some(StrokeInHand { mode, path, guide });
        if !self.execute(&command) {
            self.cancel_stroke();
        }
    }

    /// Leads the stroke to a point of the picture.
    pub(super) fn lead_stroke(&mut self, to: Vec2) {
        let Some(mut stroke) = self.stroke.take() else { return };
        let mut stops = Vec::new();
        if let Guide::Surface { seen, at, depth } = &mut stroke.guide {
            let sight = self.sight();
            let grid = self.session.document().grid();
            let leap = LEAP * 2.0 * self.ui.hand.half().max_element();
            let looks = (to.distance(*at) / LOOK_EVERY_PX).ceil().max(1.0) as u32;
            for i in 1..=looks {
                let look = at.lerp(to, i as f32 / looks as f32);
                let found = seen.as_ref().and_then(|map| surface_point(map, grid, look));
                let point = found.unwrap_or_else(|| sight.at_depth(look, *depth));
                *depth = sight.depth(point);
                if stroke.path.distance(point) > leap {
                    stroke.path.jump_to(point, |stop| stops.push(stop));
                } else {
                    stroke.path.line_to(point, |stop| stops.push(stop));
                }
            }
            *at = to;
        }
        self.stroke = Some(stroke);
        self.use_tool_at(&stops);
        if let Some(stroke) = &self.stroke {
            let end = stroke.path.end();
            self.ui.hand.move_to(end);
        }
    }

    /// The tool was moved by something else; a stroke that it leads follows.
    pub(super) fn tool_moved(&mut self) {
        let mut stops = Vec::new();
        let to = self.ui.hand.centre_vx;
        if let Some(StrokeInHand { guide: Guide::Tool, path, .. }) = &mut self.stroke {
            path.line_to(to, |stop| stops.push(stop));
        }
        self.use_tool_at(&stops);
        self.ui.hand.centre_vx = to;
    }

    fn use_tool_at(&mut self, stops: &[Vec3]) {
        for &stop in stops {
            let Some(stroke) = &self.stroke else { return };
            let mode = stroke.mode;
            self.ui.hand.move_to(stop);
            if !self.execute(&self.ui.hand.command(mode)) {
                self.cancel_stroke();
            }
        }
    }

    pub(super) fn end_stroke(&mut self) {
        if self.stroke.take().is_some() {
            self.execute(&Command::End);
        }
    }

    pub(super) fn cancel_stroke(&mut self) {
        if self.stroke.take().is_some() {
            self.execute(&Command::Cancel);
        }
    }
}
