//! Dilation: thickens edges and corners.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "dilation",
    action: "dilation",
    label: "Dilation",
    help: "Dilation: thickens edges and corners",
    synonyms: "dilate inflate expand thicken",
};
