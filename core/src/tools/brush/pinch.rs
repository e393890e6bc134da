//! Pinch: gathers the clay under it; inverted, it spreads the clay.

use super::change::{BrushChange, Site};
use super::dab::Dab;
use super::kernel::grab::{self, Motion};
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Inverse, Keeps, Script, SurfaceNormal};
use super::{BrushSurface, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "pinch",
    action: "pinch",
    label: "Pinch",
    help: "Pinch: gathers the clay under it; inverted, it spreads the clay",
    effect: "Gathers the clay in a ball towards the normal of the surface and lets it rise along the normal, so that ridges become narrower and higher. Inverted, it spreads the clay. Uses add up.",
    keeps: Keeps::of("kept within 1 %", "goes along", "not kept"),
    synonyms: "gather narrow sharpen tighten deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.first(0.5).help("How far the clay is gathered").param,
        STEADY.param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfEachUse },
    inverse: Inverse::Sense,
    dab,
    script: Script::of_clay(
        ContactKind::BallWithNormal,
        &[STRENGTH.range(-1.0, 1.0).required().param, FALLOFF.param],
        apply,
    ),
    ..BrushSpec::DEFORM
};

/// How far one use gathers the clay at full strength; some ten of them overlap.
const SHARE: f32 = 0.1;

fn dab(dab: &Dab) -> Option<BrushUse> {
    let strength = dab.sense() * dab.options.get(STRENGTH) * SHARE;
    let used = dab.along_normal().with(STRENGTH, strength).on(BrushSurface::Now);
    (strength != 0.0).then_some(used)
}

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let strength = used.get(STRENGTH);
    grab::change(used, site, |normal| Motion::Pinch { normal, strength })
}
