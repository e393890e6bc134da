//! Erosion: wears down edges and leaves flat faces alone.

use super::change::{Change, Site};
use super::kernel::filter;
use super::kernel::rays::{self, Filtered};
use super::keys::{ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, THRESHOLD};
use super::spec::{BrushSpec, Inverse, Script, Tint};
use super::{BrushError, BrushId, BrushUse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "erosion",
    action: "erosion",
    label: "Erosion",
    help: "Erosion: wears down edges and leaves flat faces alone",
    synonyms: "erode weather round",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.param,
        THRESHOLD
            .help("Voxels with fewer of their 26 neighbours are removed; up to 17 keeps flat faces")
            .param,
        ONCE_PER_STROKE.param,
    ],
    inverse: Inverse::Brush(BrushId::Dilate),
    tint: Tint::Cut,
    idle: "Nothing was removed: all voxels here have as many neighbours as the threshold",
    script: Script::under(&[REACH.param, THRESHOLD.param], apply),
    ..BrushSpec::SURFACE
};

fn apply(used: &BrushUse, site: &Site) -> Result<Change, BrushError> {
    let (reach_vx, threshold) = (used.get(REACH), used.get(THRESHOLD));
    let stamp = rays::under(used, site, |footprint| {
        rays::filtered(footprint, site, reach_vx, 1, |near| Filtered {
            remove: Some(filter::erosion(&near.solid, &near.may, threshold)),
            ..Filtered::default()
        })
    });
    Ok(Change { remove: stamp.remove, ..Change::default() })
}
