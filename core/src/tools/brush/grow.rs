//! Growth: fills concave corners and small holes.

use super::change::{BrushChange, NewClay, Site};
use super::kernel::filter;
use super::kernel::rays;
use super::keys::{COLOUR, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, THRESHOLD};
use super::spec::{BrushSpec, Inverse, Keeps, Script};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "growth",
    action: "growth",
    label: "Growth",
    help: "Growth: fills concave corners and small holes",
    effect: "Adds voxels where there are many neighbours, until the surface is closed: concave corners and small holes fill up.",
    keeps: Keeps::of("grows", "new clay: the colours around it", "kept from the threshold 10 on"),
    synonyms: "grow close fill",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.param,
        THRESHOLD.first(12).param,
        ONCE_PER_STROKE.param,
    ],
    inverse: Inverse::Brush(BrushId::Erode),
    adds: true,
    idle: "Nothing was added: no place here has as many neighbours as the threshold, or the grid ends here",
    script: Script::under(
        &[REACH.param, THRESHOLD.first(12).param, COLOUR.optional().param],
        apply,
    ),
    ..BrushSpec::SURFACE
};

/// Greatest number of rounds in which voxels are added.
const ROUNDS: u32 = 64;

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let add = rays::by_threshold(used, site, |near, threshold| {
        filter::growth(&near.solid, &near.may, threshold, ROUNDS)
    });
    let new_clay = used.find(COLOUR).map_or(NewClay::Inherited, NewClay::Colour);
    Ok(BrushChange { add, new_clay, ..BrushChange::default() })
}
