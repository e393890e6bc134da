//! Erosion: wears down edges and leaves flat faces alone.

use super::change::{BrushChange, Site};
use super::kernel::filter;
use super::kernel::rays;
use super::keys::{ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, THRESHOLD};
use super::spec::{BrushSpec, Inverse, Keeps, OutlineColour, Script};
use super::{BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "erosion",
    action: "erosion",
    label: "Erosion",
    help: "Erosion: wears down edges and leaves flat faces alone",
    effect: "Removes voxels that have few neighbours: edges and corners wear down.",
    keeps: Keeps::of(
        "shrinks",
        "cuts show the colour inside",
        "kept up to the threshold 17, but for their edges",
    ),
    synonyms: "erode weather round",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.param,
        THRESHOLD
            .help("Removes voxels with fewer of their 26 neighbours; up to 17 keeps flat faces")
            .param,
        ONCE_PER_STROKE.param,
    ],
    inverse: Inverse::Brush(BrushId::Dilate),
    tint: OutlineColour::Cut,
    idle: "Nothing was removed: all voxels here have as many neighbours as the threshold",
    script: Script::under(&[REACH.param, THRESHOLD.param], apply),
    ..BrushSpec::SURFACE
};

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let remove = rays::by_threshold(used, site, |near, threshold| {
        filter::erosion(&near.solid, &near.may, threshold)
    });
    Ok(BrushChange { remove, ..BrushChange::default() })
}
