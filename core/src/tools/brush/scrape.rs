//! Scrape: removes bumps above the plane where the stroke began.

use super::change::{BrushChange, Site};
use super::falloff::Falloff;
use super::kernel::offset;
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Inverse, Keeps, Script, SurfaceNormal};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "scrape",
    action: "scrape",
    label: "Scrape",
    help: "Scrape: removes bumps above the plane where the stroke began",
    effect: "Removes bumps down to the mean plane of the surface around the press. Inverted, it fills pits.",
    keeps: Keeps::of("shrinks", "cuts show the colour inside", "made"),
    synonyms: "plane shave level deform cut",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.help("How far the surface moves to the plane").param,
        STEADY.param,
        FALLOFF.first(Falloff::Flat).param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: true } },
    inverse: Inverse::Brush(BrushId::Fill),
    script: Script::in_ball(ContactKind::BallWithNormal, &[STRENGTH.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    Ok(offset::to_plane(used, site, true, false))
}
