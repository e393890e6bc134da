//! Mask: protects the surface under it, so that nothing changes it.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "mask",
    action: "mask",
    label: "Mask",
    help: "Mask: protects the surface under it, so that nothing changes it",
    synonyms: "protect freeze lock",
};
