//! Smooth: evens out bumps and pits.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "smooth",
    action: "smooth",
    label: "Smooth",
    help: "Smooth: evens out bumps and pits",
    synonyms: "soften relax blur polish",
};
