//! Erosion: wears down edges and leaves flat faces alone.

use super::BrushId;
use super::keys::{ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, THRESHOLD};
use super::spec::{BrushSpec, Inverse, Tint};

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
    ..BrushSpec::SURFACE
};
