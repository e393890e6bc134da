//! Brush: paints the visible surface under it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "paintbrush",
    action: "paintbrush",
    label: "Brush",
    help: "Brush: paints the visible surface under it",
    synonyms: "paint airbrush colour",
};
