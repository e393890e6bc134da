//! Fill up: fills pits up to the plane where the stroke began.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "fill",
    action: "fill-up",
    label: "Fill up",
    help: "Fill up: fills pits up to the plane where the stroke began",
    synonyms: "level pit dent plane deform",
};
