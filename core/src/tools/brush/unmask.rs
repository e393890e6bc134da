//! Unmask: removes the protection from the surface under it.

use super::change::{BrushChange, Site};
use super::footprint::Outline;
use super::kernel::rays;
use super::keys::{MASK_DEPTH, OUTLINE, RADIUS, REACH};
use super::spec::{BrushGroup, BrushSpec, Inverse, Keeps, OutlineColour, Script};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "unmask",
    action: "unmask",
    label: "Unmask",
    help: "Unmask: removes the protection from the surface under it",
    effect: "Removes the protection.",
    keeps: Keeps::of("kept", "kept", "kept"),
    synonyms: "unprotect release erase thaw",
    group: BrushGroup::Mask,
    options: &[RADIUS.param, OUTLINE.param, MASK_DEPTH.param],
    inverse: Inverse::Brush(BrushId::Mask),
    options_of: Some(BrushId::Mask),
    tint: OutlineColour::Mask,
    idle: "Nothing changed: there is no mask here",
    script: Script::under(&[REACH.param], apply),
    ..BrushSpec::SURFACE
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let remove = rays::around(used, site, |_| 1.0, Outline::Round);
    Ok(BrushChange { remove, ..BrushChange::default() })
}
