//! What is remembered of the tools that deform clay.

use serde::{Deserialize, Serialize};

use super::memory::{neat, within};
use crate::editor::deform::{DeformOptions, MAX_STEADY_PX};
use crate::editor::sizes::SizeUnit;
use crate::tools::brush::kernel::grab::Falloff;

/// The options of one tool; those that are missing or out of range are as usual.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptDeform {
    radius: Option<f64>,
    strength: Option<f64>,
    falloff: Option<String>,
    steady_px: Option<f64>,
}

impl KeptDeform {
    pub fn of(options: &DeformOptions) -> KeptDeform {
        KeptDeform {
            radius: Some(neat(options.radius)),
            strength: Some(neat(options.strength)),
            falloff: Some(options.falloff.name().to_string()),
            steady_px: Some(neat(options.steady_px)),
        }
    }

    /// Chooses again what was chosen. `unit`: of the radius; without one it is one of an earlier version, in another unit.
    pub fn recall(&self, unit: Option<SizeUnit>, options: &mut DeformOptions) {
        if let Some(unit) = unit {
            options.radius = within(self.radius, unit.radii(), options.radius);
        }
        options.strength = within(self.strength, 0.0..=1.0, options.strength);
        options.steady_px = within(self.steady_px, 0.0..=MAX_STEADY_PX, options.steady_px);
        let named = |falloff: &Falloff| Some(falloff.name()) == self.falloff.as_deref();
        options.falloff = Falloff::ALL.into_iter().find(named).unwrap_or(options.falloff);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::brush::deform::DeformKind;

    #[test]
    fn options_are_found_again_and_nonsense_is_not_believed() {
        let before = DeformOptions {
            radius: 33.3,
            strength: 0.25,
            falloff: Falloff::Sharp,
            steady_px: 40.0,
        };
        let text = toml::to_string(&KeptDeform::of(&before)).unwrap();
        let mut after = DeformOptions::of(DeformKind::Grab);
        toml::from_str::<KeptDeform>(&text).unwrap().recall(Some(SizeUnit::Screen), &mut after);
        assert_eq!(after, before);
        let mut earlier = DeformOptions::of(DeformKind::Grab);
        toml::from_str::<KeptDeform>(&text).unwrap().recall(None, &mut earlier);
        assert_eq!(earlier.radius, DeformOptions::of(DeformKind::Grab).radius, "it was in voxels");
        for text in [
            "",
            "radius = 0.0\nstrength = nan\nfalloff = \"steep\"",
            "radius = inf",
            "steady_px = -1",
        ] {
            let mut after = DeformOptions::of(DeformKind::Grab);
            toml::from_str::<KeptDeform>(text).unwrap().recall(Some(SizeUnit::Screen), &mut after);
            assert_eq!(after, DeformOptions::of(DeformKind::Grab), "{text}");
        }
    }
}
