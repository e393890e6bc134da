//! Smear: takes clay along with the brush.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "smear",
    action: "smear",
    label: "Smear",
    help: "Smear: takes clay along with the brush",
    synonyms: "nudge smudge drag rub thumb deform",
};
