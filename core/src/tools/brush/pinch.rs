//! Pinch: brings the clay together under it; inverted, it spreads it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "pinch",
    action: "pinch",
    label: "Pinch",
    help: "Pinch: brings the clay together under it; inverted, it spreads it",
    synonyms: "gather narrow sharpen tighten deform",
};
