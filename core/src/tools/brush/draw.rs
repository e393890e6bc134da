//! Draw: raises the surface along its normal; inverted, it lowers it.

use super::BrushUse;
use super::change::{BrushChange, Site};
use super::kernel::offset::{self, OffsetProfile};
use super::keys::{FALLOFF, HEIGHT, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Inverse, Keeps, Script, SurfaceNormal};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "draw",
    action: "draw",
    label: "Draw",
    help: "Draw: raises the surface along its normal; inverted, it lowers it",
    effect: "Raises the surface in a ball along its mean normal there, by half the radius at full strength, so that its shape is kept. Inverted, it lowers the surface.",
    keeps: Keeps::of(
        "changes with the height",
        Keeps::AROUND,
        "stay flat in the centre with the falloff flat",
    ),
    synonyms: "raise build layer standard pull normal deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.first(0.5).help("How far the surface is raised: half the radius at 100 %").param,
        STEADY.param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfEachUse },
    inverse: Inverse::Sense,
    dab: |dab| Some(dab.along_normal().with(HEIGHT, dab.height())),
    script: Script::in_ball(ContactKind::BallWithNormal, &[HEIGHT.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    Ok(offset::along_normal(used, site, OffsetProfile::Falloff))
}
