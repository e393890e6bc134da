//! The read-only part of the editor that a tool sees: the document, the tool in hand, and its anchor on the surface.

use glam::{Vec2, Vec3};

use super::surface_anchor::SurfaceAnchor;
use super::tool::ToolState;
use crate::document::Document;
use crate::picking::Picker;
use crate::sculpture::Grid;

/// The part of the editor that a tool sees.
#[derive(Clone, Copy)]
pub(super) struct ToolView<'a> {
    pub document: &'a Document,
    pub tool: &'a ToolState,
    pub anchor: &'a SurfaceAnchor,
}

impl<'a> ToolView<'a> {
    pub fn grid(&self) -> &'a Grid {
        self.document.grid()
    }

    /// Voxel edges in units of the smallest.
    pub fn edges(&self) -> Vec3 {
        let size = self.grid().voxel_size();
        size / size.min_element()
    }

    /// Returns the grid point under a pixel: on the visible surface, or, while the grid is empty, in the view plane
    /// through the last use of the tool.
    pub fn target(&self, at: Vec2, picker: &Picker) -> Option<Vec3> {
        self.anchor.target(self.grid(), at, picker)
    }
}
