//! Unmask: takes protection from the surface under it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "unmask",
    action: "unmask",
    label: "Unmask",
    help: "Unmask: takes protection from the surface under it",
    synonyms: "unprotect release erase thaw",
};
