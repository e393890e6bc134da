//! Devourer (carve): bites into the surface under it.

use super::BrushId;
use super::keys::{BITE, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH};
use super::spec::{BrushSpec, Inverse, Tint};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "devourer",
    action: "devourer",
    label: "Devourer",
    help: "Devourer (carve): bites into the surface under it",
    synonyms: "dig gouge eat remove erase",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.label("Depth").help("How deep it cuts into the surface under the brush").param,
        BITE.param,
        ONCE_PER_STROKE.first(true).param,
    ],
    inverse: Inverse::Brush(BrushId::Clay),
    pressure: Some(REACH),
    tint: Tint::Cut,
    ..BrushSpec::SURFACE
};
