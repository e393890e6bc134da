//! Smear: takes clay along with the brush.

use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, SurfaceNormal};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "smear",
    action: "smear",
    label: "Smear",
    help: "Smear: takes clay along with the brush",
    synonyms: "nudge smudge drag rub thumb deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.help("How far the clay goes along with the brush").param,
        STEADY.param,
        FALLOFF.param,
    ],
    stroke: BrushStroke::Surface {
        normal: SurfaceNormal::OfPress { on_plane: false },
        adds_up: true,
    },
    ..BrushSpec::DEFORM
};
