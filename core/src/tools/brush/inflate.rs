//! Inflate: swells the surface under it; inverted, it shrinks it.

use super::change::{BrushChange, Site};
use super::kernel::offset::{self, OffsetTarget};
use super::keys::{FALLOFF, HEIGHT, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, ContactKind, Inverse, Keeps, Script};
use super::{BrushDirection, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "inflate",
    action: "inflate",
    label: "Inflate",
    help: "Inflate: swells the surface under it; inverted, it shrinks it",
    effect: "Swells the surface in a ball along its normals, by half the radius at full strength. Inverted, it shrinks the surface.",
    keeps: Keeps::of(
        "changes with the height",
        Keeps::AROUND,
        "stay flat in the centre with the falloff flat",
    ),
    synonyms: "swell blow expand deform puff shrink deflate",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.first(0.5).help("How far the surface swells: half the radius at 100 %").param,
        STEADY.param,
        FALLOFF.param,
    ],
    inverse: Inverse::Sense,
    dab: |dab| Some(dab.used(BrushDirection::None).with(HEIGHT, dab.height())),
    script: Script::in_ball(ContactKind::Ball, &[HEIGHT.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    Ok(offset::change(used, site, |_| OffsetTarget::Along(used.get(HEIGHT))))
}
