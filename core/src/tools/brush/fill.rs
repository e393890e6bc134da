//! Fill up: fills pits up to the plane where the stroke began.

use super::BrushId;
use super::kernel::grab::Falloff;
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, Inverse, SurfaceNormal};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "fill",
    action: "fill-up",
    label: "Fill up",
    help: "Fill up: fills pits up to the plane where the stroke began",
    synonyms: "level pit dent plane deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.help("How far the surface goes to the plane").param,
        STEADY.param,
        FALLOFF.first(Falloff::Flat).param,
    ],
    stroke: BrushStroke::Surface {
        normal: SurfaceNormal::OfPress { on_plane: true },
        adds_up: false,
    },
    inverse: Inverse::Brush(BrushId::Scrape),
    ..BrushSpec::DEFORM
};
