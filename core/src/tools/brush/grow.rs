//! Growth: fills concave corners and small holes.

use super::BrushId;
use super::keys::{ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, THRESHOLD};
use super::spec::{BrushSpec, Inverse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "growth",
    action: "growth",
    label: "Growth",
    help: "Growth: fills concave corners and small holes",
    synonyms: "grow close fill",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.param,
        THRESHOLD.first(12).param,
        ONCE_PER_STROKE.param,
    ],
    inverse: Inverse::Brush(BrushId::Erode),
    adds: true,
    ..BrushSpec::SURFACE
};
