//! Grab: pulls the surface along with the pointer.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "grab",
    action: "grab",
    label: "Grab",
    help: "Grab: pulls the surface along with the pointer",
    synonyms: "move pull push drag tweak deform hand",
};
