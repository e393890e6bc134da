//! The part of the editor that a tool sees, and changes nothing of: the document, the tool in hand, and where that stands
//! on the surface.

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

    /// Returns the point of the grid under a pixel: on the surface that is seen, or while the grid is empty in the
    /// plane of the view in which the tool was used last.
    pub fn target(&self, at: Vec2, picker: &Picker) -> Option<Vec3> {
        self.anchor.target(self.grid(), at, picker)
    }
}
