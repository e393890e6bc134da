//! Mask: protects the surface under it from all changes.

use super::change::{BrushChange, Site};
use super::footprint::Outline;
use super::kernel::rays;
use super::keys::{MASK_DEPTH, OUTLINE, RADIUS, REACH};
use super::spec::{BrushGroup, BrushSpec, Inverse, Keeps, OutlineColour, Script};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "mask",
    action: "mask",
    label: "Mask",
    help: "Mask: protects the surface under it from all changes",
    effect: "Protects the surface from all tools, commands and pastes. The mask is shown darker and hatched.",
    keeps: Keeps::of("kept", "kept", "kept"),
    synonyms: "protect freeze lock",
    group: BrushGroup::Mask,
    options: &[RADIUS.param, OUTLINE.param, MASK_DEPTH.param],
    inverse: Inverse::Brush(BrushId::Unmask),
    tint: OutlineColour::Mask,
    idle: "Nothing changed: it is masked already",
    script: Script::under(&[REACH.param], apply),
    ..BrushSpec::SURFACE
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let add = rays::around(used, site, |_| 1.0, Outline::Round);
    Ok(BrushChange { add, ..BrushChange::default() })
}
