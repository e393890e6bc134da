//! Twist: turns the clay like a knob; drag to the right or left.

use super::keys::{FALLOFF, RADIUS, STRENGTH};
use super::spec::{BrushSpec, BrushStroke};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "twist",
    action: "twist",
    label: "Twist",
    help: "Twist: turns the clay like a knob; drag to the right or left",
    synonyms: "rotate turn swirl screw deform",
    options: &[
        RADIUS.first(60.0).param,
        STRENGTH.help("How far the clay turns with the pointer").param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Held { turns: true },
    ..BrushSpec::DEFORM
};
