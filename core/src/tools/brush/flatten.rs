//! Flatten: levels bumps and pits to the plane where the stroke began.

use super::BrushUse;
use super::change::{BrushChange, Site};
use super::falloff::Falloff;
use super::kernel::offset;
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Keeps, Script, SurfaceNormal};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "flatten",
    action: "flatten",
    label: "Flatten",
    help: "Flatten: levels bumps and pits to the plane where the stroke began",
    effect: "Moves the surface in a ball to the mean plane around the press: bumps go, and pits fill.",
    keeps: Keeps::of(
        "bumps go and pits fill, regardless of their volumes",
        Keeps::AROUND,
        "made, to the voxel, at full strength",
    ),
    synonyms: "level plane even deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.help("How far the surface moves to the plane").param,
        STEADY.param,
        FALLOFF.first(Falloff::Flat).param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: true } },
    script: Script::in_ball(ContactKind::BallWithNormal, &[STRENGTH.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    Ok(offset::to_plane(used, site, true, true))
}
