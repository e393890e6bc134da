//! Options of the view in the window, independent of the render mode.

use serde::Deserialize;

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViewOptions {
    /// Uses parallel projection.
    pub orthographic: bool,
    /// Shows the axes of the grid in a corner of the picture.
    pub gizmo: bool,
    /// Shows lines below the sculpture, a round number of voxels apart.
    pub floor: bool,
    /// Shows a ground below the sculpture, with its shadow.
    pub ground: bool,
}

impl Default for ViewOptions {
    fn default() -> Self {
        ViewOptions { orthographic: false, gizmo: true, floor: false, ground: false }
    }
}
