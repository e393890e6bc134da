//! Twist: turns the clay like a knob; drag to the right or left.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "twist",
    action: "twist",
    label: "Twist",
    help: "Twist: turns the clay like a knob; drag to the right or left",
    synonyms: "rotate turn swirl screw deform",
};
