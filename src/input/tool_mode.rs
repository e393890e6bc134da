//! The effect of a tool on the voxels that it covers.

/// The effect of the tool on the voxels that it covers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum ToolMode {
    Add,
    #[default]
    Subtract,
    Recolour,
    /// Adds them to the mask.
    Protect,
    /// Removes them from the mask. The inverting modifier turns `Protect` into this.
    Release,
}

impl ToolMode {
    /// The available modes.
    pub const ALL: [ToolMode; 4] =
        [ToolMode::Add, ToolMode::Subtract, ToolMode::Recolour, ToolMode::Protect];

    /// Returns the next mode when cycling.
    pub fn next(self) -> ToolMode {
        match self {
            ToolMode::Subtract => ToolMode::Add,
            ToolMode::Add => ToolMode::Recolour,
            ToolMode::Recolour => ToolMode::Protect,
            ToolMode::Protect | ToolMode::Release => ToolMode::Subtract,
        }
    }

    /// Returns the mode while the inverting modifier is held.
    pub fn inverted(self) -> ToolMode {
        match self {
            ToolMode::Add => ToolMode::Subtract,
            ToolMode::Subtract | ToolMode::Recolour => ToolMode::Add,
            ToolMode::Protect => ToolMode::Release,
            ToolMode::Release => ToolMode::Protect,
        }
    }
}
