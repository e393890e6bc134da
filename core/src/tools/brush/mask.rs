//! Mask: protects the surface under it, so that nothing changes it.

use super::BrushId;
use super::keys::{OUTLINE, RADIUS, REACH};
use super::spec::{BrushGroup, BrushSpec, Inverse, Tint};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "mask",
    action: "mask",
    label: "Mask",
    help: "Mask: protects the surface under it, so that nothing changes it",
    synonyms: "protect freeze lock",
    group: BrushGroup::Mask,
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH
            .first(4.0)
            .label("Depth")
            .help("How far from the surface voxels are protected, outwards, too")
            .param,
    ],
    inverse: Inverse::Brush(BrushId::Unmask),
    tint: Tint::Mask,
    ..BrushSpec::SURFACE
};
