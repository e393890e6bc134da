//! Crease: cuts a sharp furrow; inverted, it raises a ridge.

use super::kernel::grab::Falloff;
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Inverse, SurfaceNormal};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "crease",
    action: "crease",
    label: "Crease",
    help: "Crease: cuts a sharp furrow; inverted, it raises a ridge",
    synonyms: "line groove ridge fold wrinkle deform",
    options: &[
        RADIUS.first(30.0).param,
        STRENGTH.help("How deep the furrow is: at 100 % half the radius").param,
        STEADY.param,
        FALLOFF.first(Falloff::Sharp).param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfEachUse, adds_up: false },
    // Its narrow bottom would show each use.
    spacing: 0.08,
    inverse: Inverse::Sense,
    ..BrushSpec::DEFORM
};
