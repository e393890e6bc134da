//! Inflate: swells the surface under it; inverted, it shrinks it.

use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, Inverse};

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "inflate",
    action: "inflate",
    label: "Inflate",
    help: "Inflate: swells the surface under it; inverted, it shrinks it",
    synonyms: "swell blow expand deform puff shrink deflate",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH.first(0.5).help("How far the surface swells: at 100 % by half the radius").param,
        STEADY.param,
        FALLOFF.param,
    ],
    inverse: Inverse::Sense,
    ..BrushSpec::DEFORM
};
