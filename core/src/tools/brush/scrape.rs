//! Scrape: takes off what stands out of the plane where the stroke began.

use super::spec::BrushSpec;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "scrape",
    action: "scrape",
    label: "Scrape",
    help: "Scrape: takes off what stands out of the plane where the stroke began",
    synonyms: "plane shave level deform cut",
};
