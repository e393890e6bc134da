//! Remembers the options of the print check: the printer and its abilities, not the findings.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::print_check::CheckOptions;
use crate::ui::memory::values::{neat, within};

/// Valid lengths, in millimetres.
const LENGTH_MM: std::ops::RangeInclusive<f32> = 0.001..=100_000.0;

/// All choices except the length of a voxel, which belongs to a sculpture. Missing or invalid ones get their defaults.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptCheck {
    wall_mm: Option<f64>,
    overhang_deg: Option<f64>,
    bridge_mm: Option<f64>,
    /// Width, height and depth.
    bed_mm: Option<[f64; 3]>,
}

impl KeptCheck {
    pub fn of(options: &CheckOptions) -> KeptCheck {
        let CheckOptions { voxel_mm: _, wall_mm, overhang_deg, bridge_mm, bed_mm } = *options;
        KeptCheck {
            wall_mm: Some(neat(wall_mm)),
            overhang_deg: Some(neat(overhang_deg)),
            bridge_mm: Some(neat(bridge_mm)),
            bed_mm: Some(bed_mm.to_array().map(neat)),
        }
    }

    /// Restores the choices.
    pub fn recall(self, options: &mut CheckOptions) {
        let side = |i: usize, usual| within(self.bed_mm.map(|bed| bed[i]), LENGTH_MM, usual);
        let Vec3 { x, y, z } = options.bed_mm;
        options.bed_mm = Vec3::new(side(0, x), side(1, y), side(2, z));
        options.wall_mm = within(self.wall_mm, LENGTH_MM, options.wall_mm);
        options.overhang_deg = within(self.overhang_deg, 0.0..=90.0, options.overhang_deg);
        options.bridge_mm = within(self.bridge_mm, 0.0..=1000.0, options.bridge_mm);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printer_is_found_again_and_nonsense_is_not_believed() {
        let before = CheckOptions {
            voxel_mm: Some(0.5),
            wall_mm: 0.8,
            overhang_deg: 60.0,
            bridge_mm: 0.0,
            bed_mm: Vec3::new(300.0, 400.0, 310.0),
        };
        let text = toml::to_string(&KeptCheck::of(&before)).unwrap();
        let mut after = CheckOptions::default();
        toml::from_str::<KeptCheck>(&text).unwrap().recall(&mut after);
        assert_eq!(after, CheckOptions { voxel_mm: None, ..before });
        for text in
            ["", "wall_mm = -1.0\noverhang_deg = 91.0\nbridge_mm = nan\nbed_mm = [0.0, inf, -3.0]"]
        {
            let mut after = CheckOptions::default();
            toml::from_str::<KeptCheck>(text).unwrap().recall(&mut after);
            assert_eq!(after, CheckOptions::default(), "{text}");
        }
    }
}
