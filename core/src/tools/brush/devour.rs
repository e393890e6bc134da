//! Devourer (carve): bites into the surface under it.

use super::change::{Change, Site};
use super::kernel::rays;
use super::kernel::stamp::Stamp;
use super::keys::{BITE, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH};
use super::spec::{BrushSpec, Inverse, Script, Tint};
use super::{BrushError, BrushId, BrushUse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "devourer",
    action: "devourer",
    label: "Devourer",
    help: "Devourer (carve): bites into the surface under it",
    synonyms: "dig gouge eat remove erase",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.label("Depth").help("How deep it cuts into the surface under the brush").param,
        BITE.param,
        ONCE_PER_STROKE.first(true).param,
    ],
    inverse: Inverse::Brush(BrushId::Clay),
    pressure: Some(REACH),
    tint: Tint::Cut,
    idle: "Nothing was cut",
    script: Script::under(&[REACH.param, BITE.param], apply),
    ..BrushSpec::SURFACE
};

fn apply(used: &BrushUse, site: &Site) -> Result<Change, BrushError> {
    let (reach_vx, bite) = (used.get(REACH), used.get(BITE));
    let stamp = rays::under(used, site, |footprint| Stamp {
        remove: rays::around(footprint, site, reach_vx, |_| reach_vx, bite),
        ..Stamp::default()
    });
    Ok(Change { remove: stamp.remove, ..Change::default() })
}
