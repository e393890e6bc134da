//! Dilation: thickens edges and corners.

use super::BrushId;
use super::keys::{ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, THRESHOLD};
use super::spec::{BrushSpec, Inverse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "dilation",
    action: "dilation",
    label: "Dilation",
    help: "Dilation: thickens edges and corners",
    synonyms: "dilate inflate expand thicken",
    options: &[
        RADIUS.param,
        OUTLINE.param,
        REACH.param,
        THRESHOLD.first(9).param,
        ONCE_PER_STROKE.param,
    ],
    inverse: Inverse::Brush(BrushId::Erode),
    adds: true,
    ..BrushSpec::SURFACE
};
