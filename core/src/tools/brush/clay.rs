//! Clay: builds up a soft mound on the surface.

use super::change::{Change, NewClay, Site};
use super::footprint::Outline;
use super::kernel::rays;
use super::kernel::stamp::Stamp;
use super::keys::{COLOUR, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH};
use super::spec::{BrushSpec, Inverse, Script};
use super::{BrushError, BrushId, BrushUse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "clay",
    action: "clay",
    label: "Clay",
    help: "Clay: builds up a soft mound on the surface",
    synonyms: "build add draw",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH
            .first(4.0)
            .label("Height")
            .help("Height of the mound under the middle of the brush")
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

/// A paraboloid over the footprint, so that strokes blend into what is there.
fn apply(used: &BrushUse, site: &Site) -> Result<Change, BrushError> {
    let reach_vx = used.get(REACH);
    let height = |offset: f32| reach_vx * (1.0 - offset * offset);
    let stamp = rays::under(used, site, |footprint| Stamp {
        add: rays::around(footprint, site, reach_vx, height, Outline::Round),
        ..Stamp::default()
    });
    let new_clay = NewClay::Colour(used.get(COLOUR));
    Ok(Change { add: stamp.add, new_clay, ..Change::default() })
}
