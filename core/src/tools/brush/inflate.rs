//! Inflate: swells the surface under it; inverted, it shrinks it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "inflate",
    action: "inflate",
    label: "Inflate",
    help: "Inflate: swells the surface under it; inverted, it shrinks it",
    synonyms: "swell blow expand deform puff shrink deflate",
};
