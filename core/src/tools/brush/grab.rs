//! Grab: pulls the surface along with the pointer.

use super::keys::{FALLOFF, RADIUS, STRENGTH};
use super::spec::{BrushSpec, BrushStroke};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "grab",
    action: "grab",
    label: "Grab",
    help: "Grab: pulls the surface along with the pointer",
    synonyms: "move pull push drag tweak deform hand",
    options: &[
        RADIUS.first(60.0).param,
        STRENGTH.help("How far the surface goes along with the pointer").param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Held { turns: false },
    ..BrushSpec::DEFORM
};
