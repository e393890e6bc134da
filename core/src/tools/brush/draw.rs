//! Draw: raises the surface along its normal; inverted, it lowers it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "draw",
    action: "draw",
    label: "Draw",
    help: "Draw: raises the surface along its normal; inverted, it lowers it",
    synonyms: "raise build layer standard pull normal deform",
};
