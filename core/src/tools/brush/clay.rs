//! Clay: builds up a soft mound on the surface.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "clay",
    action: "clay",
    label: "Clay",
    help: "Clay: builds up a soft mound on the surface",
    synonyms: "build add draw",
};
