//! Devourer (carve): bites into the surface under it.

use super::change::{BrushChange, Site};
use super::kernel::rays;
use super::keys::{BITE, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH};
use super::spec::{BrushSpec, Inverse, Keeps, OutlineColour, Script};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "devourer",
    action: "devourer",
    label: "Devourer",
    help: "Devourer (carve): bites into the surface under it",
    effect: "Cuts a ball or a cube out of the clay around every point under it.",
    keeps: Keeps::of("shrinks", "cuts show the colour inside", "not kept"),
    synonyms: "dig gouge eat remove erase",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.label("Depth").help("Depth of the cut into the surface under the brush").param,
        BITE.param,
        ONCE_PER_STROKE.first(true).param,
    ],
    inverse: Inverse::Brush(BrushId::Clay),
    pressure: Some(REACH),
    tint: OutlineColour::Cut,
    idle: "Nothing was cut",
    script: Script::under(&[REACH.param, BITE.param], apply),
    ..BrushSpec::SURFACE
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let remove = rays::around(used, site, |_| 1.0, used.get(BITE));
    Ok(BrushChange { remove, ..BrushChange::default() })
}
