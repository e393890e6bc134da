//! Flatten: levels bumps and pits to the plane where the stroke began.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "flatten",
    action: "flatten",
    label: "Flatten",
    help: "Flatten: levels bumps and pits to the plane where the stroke began",
    synonyms: "level plane even deform",
};
