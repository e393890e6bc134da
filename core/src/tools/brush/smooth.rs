//! Smooth: evens out bumps and pits.

use super::keys::{OUTLINE, RADIUS, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Tint};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "smooth",
    action: "smooth",
    label: "Smooth",
    help: "Smooth: evens out bumps and pits",
    synonyms: "soften relax blur polish",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        STRENGTH.range(0.01, 1.0).first(0.5).help("How much of what is smaller than the brush each use takes away; it goes on while the button is held").param,
    ],
    stroke: BrushStroke::Picture { repeats: true },
    pressure: Some(STRENGTH),
    tint: Tint::Neutral,
    ..BrushSpec::SURFACE
};
