//! Draw: raises the surface along its normal; inverted, it lowers it.

use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Inverse, SurfaceNormal};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "draw",
    action: "draw",
    label: "Draw",
    help: "Draw: raises the surface along its normal; inverted, it lowers it",
    synonyms: "raise build layer standard pull normal deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH
            .first(0.5)
            .help("How far the surface is raised: at 100 % by half the radius")
            .param,
        STEADY.param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfEachUse, adds_up: false },
    inverse: Inverse::Sense,
    ..BrushSpec::DEFORM
};
