//! Clay: builds up a soft mound on the surface.

use super::BrushId;
use super::keys::{ONCE_PER_STROKE, OUTLINE, RADIUS, REACH};
use super::spec::{BrushSpec, Inverse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "clay",
    action: "clay",
    label: "Clay",
    help: "Clay: builds up a soft mound on the surface",
    synonyms: "build add draw",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH
            .first(4.0)
            .label("Height")
            .help("Height of the mound under the middle of the brush")
            .param,
        ONCE_PER_STROKE.first(true).param,
    ],
    inverse: Inverse::Brush(BrushId::Devour),
    pressure: Some(REACH),
    gives_colour: true,
    adds: true,
    ..BrushSpec::SURFACE
};
