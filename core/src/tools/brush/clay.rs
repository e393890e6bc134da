//! Clay: builds up a soft mound on the surface.

use super::change::{BrushChange, NewClay, Site};
use super::footprint::Outline;
use super::kernel::rays;
use super::keys::{COLOUR, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH};
use super::spec::{BrushSpec, Inverse, Keeps, Script};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "clay",
    action: "clay",
    label: "Clay",
    help: "Clay: builds up a soft mound on the surface",
    effect: "Builds up a mound, highest under its centre.",
    keeps: Keeps::of("grows", "new clay: the colour in hand", "not kept"),
    synonyms: "build add draw",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH
            .first(4.0)
            .label("Height")
            .help("Height of the mound under the centre of the brush")
            .param,
        ONCE_PER_STROKE.first(true).param,
    ],
    inverse: Inverse::Brush(BrushId::Devour),
    pressure: Some(REACH),
    gives_colour: true,
    adds: true,
    idle: "Nothing was added: the grid ends here",
    script: Script::under(&[REACH.param, COLOUR.param], apply),
    ..BrushSpec::SURFACE
};

/// Adds a paraboloid over the footprint, so that strokes blend into the surface.
fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let add = rays::around(used, site, |offset| 1.0 - offset * offset, Outline::Round);
    let new_clay = NewClay::Colour(used.get(COLOUR));
    Ok(BrushChange { add, new_clay, ..BrushChange::default() })
}
