//! The widths of the import dialog and its parts, in points. Knows none of them.

/// Largest width of the dialog, in points, and the space beside it in a small window.
pub const MOST_WIDTH: f32 = 960.0;
pub const BESIDE: f32 = 48.0;
/// Width of the column of options.
pub const OPTIONS_WIDTH: f32 = 252.0;
pub const NARROW: f32 = 400.0;
