//! Options of the view in the window that belong to no render mode.

use serde::Deserialize;

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViewOptions {
    /// Parallel lines stay parallel.
    pub orthographic: bool,
    /// The axes of the grid in a corner of the picture.
    pub gizmo: bool,
    /// Lines below the sculpture, a round number of voxels apart.
    pub floor: bool,
    /// A ground below the sculpture, with its shadow.
    pub ground: bool,
}

impl Default for ViewOptions {
    fn default() -> Self {
        ViewOptions { orthographic: false, gizmo: true, floor: false, ground: false }
    }
}
