//! Unmask: takes protection from the surface under it.

use super::BrushId;
use super::keys::{OUTLINE, RADIUS, REACH};
use super::spec::{BrushGroup, BrushSpec, Inverse, Tint};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "unmask",
    action: "unmask",
    label: "Unmask",
    help: "Unmask: takes protection from the surface under it",
    synonyms: "unprotect release erase thaw",
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
    inverse: Inverse::Brush(BrushId::Mask),
    options_of: Some(BrushId::Mask),
    tint: Tint::Mask,
    ..BrushSpec::SURFACE
};
