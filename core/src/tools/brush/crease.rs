//! Crease: cuts a sharp furrow; inverted, it raises a ridge.

use super::BrushUse;
use super::change::{BrushChange, Site};
use super::falloff::Falloff;
use super::kernel::offset::{self, OffsetProfile};
use super::keys::{FALLOFF, HEIGHT, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Inverse, Keeps, Script, SurfaceNormal};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "crease",
    action: "crease",
    label: "Crease",
    help: "Crease: cuts a sharp furrow; inverted, it raises a ridge",
    effect: "Cuts a narrow furrow, half as deep as the radius at full strength. Inverted, it raises a ridge.",
    keeps: Keeps::of("changes with the height", Keeps::AROUND, "not kept"),
    synonyms: "line groove ridge fold wrinkle deform",
    options: &[
        RADIUS.first(30.0).param,
        STRENGTH.help("Depth of the furrow: half the radius at 100 %").param,
        STEADY.param,
        FALLOFF.first(Falloff::Sharp).param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfEachUse },
    // At a wider spacing, its narrow bottom would show each use.
    spacing: 0.08,
    inverse: Inverse::Sense,
    dab: |dab| Some(dab.along_normal().with(HEIGHT, -dab.height())),
    script: Script::in_ball(ContactKind::BallWithNormal, &[HEIGHT.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    Ok(offset::along_normal(used, site, OffsetProfile::Squared))
}
