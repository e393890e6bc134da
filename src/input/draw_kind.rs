//! The tools that draw a solid over the picture, by what a drag of the pointer draws.
//!
//! Holds their names only: `editor::draw` makes solids of the drags.

/// The shape that a drag of the pointer draws.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum DrawKind {
    /// An outline by hand: what lies behind it, or a slab.
    Lasso,
    /// The same with an upright rectangle.
    Rectangle,
    /// A line across the picture: everything on one side of it.
    Plane,
    /// The base of a box on a face.
    Box,
    /// A straight tube.
    Line,
    /// A tube along a curve by hand.
    Curve,
    /// A profile that is turned about the vertical through its beginning.
    Lathe,
    /// Nothing: a press puts letters on the surface.
    Text,
}

impl DrawKind {
    pub const ALL: [DrawKind; 8] = [
        DrawKind::Lasso,
        DrawKind::Rectangle,
        DrawKind::Plane,
        DrawKind::Box,
        DrawKind::Line,
        DrawKind::Curve,
        DrawKind::Lathe,
        DrawKind::Text,
    ];

    /// Its name in key tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            DrawKind::Lasso => "lasso",
            DrawKind::Rectangle => "rectangle",
            DrawKind::Plane => "plane-cut",
            DrawKind::Box => "box",
            DrawKind::Line => "line",
            DrawKind::Curve => "curve",
            DrawKind::Lathe => "lathe",
            DrawKind::Text => "text",
        }
    }
}
