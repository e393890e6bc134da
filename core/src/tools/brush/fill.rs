//! Fill up: fills pits up to the plane where the stroke began.

use super::change::{BrushChange, Site};
use super::falloff::Falloff;
use super::kernel::offset;
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Inverse, Keeps, Script, SurfaceNormal};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "fill",
    action: "fill-up",
    label: "Fill up",
    help: "Fill up: fills pits up to the plane where the stroke began",
    effect: "Fills pits up to the mean plane of the surface around the press. Inverted, it removes bumps.",
    keeps: Keeps::of("grows", "new clay: the colours around it", "made"),
    synonyms: "level pit dent plane deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.help("How far the surface moves to the plane").param,
        STEADY.param,
        FALLOFF.first(Falloff::Flat).param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: true } },
    inverse: Inverse::Brush(BrushId::Scrape),
    script: Script::in_ball(ContactKind::BallWithNormal, &[STRENGTH.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    Ok(offset::to_plane(used, site, false, true))
}
