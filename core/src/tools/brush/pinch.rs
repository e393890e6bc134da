//! Pinch: brings the clay together under it; inverted, it spreads it.

use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Inverse, SurfaceNormal};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "pinch",
    action: "pinch",
    label: "Pinch",
    help: "Pinch: brings the clay together under it; inverted, it spreads it",
    synonyms: "gather narrow sharpen tighten deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.first(0.5).help("How far the clay comes together").param,
        STEADY.param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfEachUse, adds_up: true },
    inverse: Inverse::Sense,
    ..BrushSpec::DEFORM
};
