//! The areas that commands work on, the operations on the selection, and their names.

/// The voxels that a command for an area works on. The limit to the selection applies to all areas.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Area {
    /// All voxels of the grid.
    #[default]
    Grid,
    /// The boxes on the stack.
    Selection,
    /// The marker's box.
    Marker,
}

impl Area {
    /// All areas, in the order in which interfaces offer them.
    pub const ALL: [Area; 3] = [Area::Grid, Area::Selection, Area::Marker];

    /// Returns its name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            Area::Grid => "grid",
            Area::Selection => "selection",
            Area::Marker => "marker",
        }
    }
}

/// An operation on the stack of selected boxes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SelectOp {
    /// Add the marker's box.
    Add,
    /// Subtract the marker's box.
    Subtract,
    /// Remove the uppermost box.
    Drop,
    /// Remove all boxes.
    Clear,
}

impl SelectOp {
    /// All operations, in the order in which interfaces offer them.
    pub const ALL: [SelectOp; 4] =
        [SelectOp::Add, SelectOp::Subtract, SelectOp::Drop, SelectOp::Clear];

    /// Returns its name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            SelectOp::Add => "add",
            SelectOp::Subtract => "subtract",
            SelectOp::Drop => "drop",
            SelectOp::Clear => "clear",
        }
    }
}
