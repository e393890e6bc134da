//! Crease: cuts a sharp furrow; inverted, it raises a ridge.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "crease",
    action: "crease",
    label: "Crease",
    help: "Crease: cuts a sharp furrow; inverted, it raises a ridge",
    synonyms: "line groove ridge fold wrinkle deform",
};
