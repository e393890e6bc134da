//! Erosion: wears down edges and leaves flat faces alone.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "erosion",
    action: "erosion",
    label: "Erosion",
    help: "Erosion: wears down edges and leaves flat faces alone",
    synonyms: "erode weather round",
};
