//! Growth: fills concave corners and small holes.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "growth",
    action: "growth",
    label: "Growth",
    help: "Growth: fills concave corners and small holes",
    synonyms: "grow close fill",
};
