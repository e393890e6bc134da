//! Brush: paints the visible surface under it.

use super::keys::{OUTLINE, RADIUS, STRENGTH};
use super::spec::{BrushSpec, Inverse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "paintbrush",
    action: "paintbrush",
    label: "Brush",
    help: "Brush: paints the visible surface under it",
    synonyms: "paint airbrush colour",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        STRENGTH.range(0.01, 1.0).help("How much of the colour each pass mixes in").param,
    ],
    inverse: Inverse::Sense,
    pressure: Some(STRENGTH),
    gives_colour: true,
    ..BrushSpec::SURFACE
};
