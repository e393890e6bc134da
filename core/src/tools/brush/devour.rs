//! Devourer (carve): bites into the surface under it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "devourer",
    action: "devourer",
    label: "Devourer",
    help: "Devourer (carve): bites into the surface under it",
    synonyms: "dig gouge eat remove erase",
};
