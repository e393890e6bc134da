//! The effect of a pen on each tool: on strength, size, or both, as chosen.
//!
//! Maps a pen's touch to shares of strength and size. Knows no devices and no tool in hand.

use std::collections::BTreeMap;

use crate::input::pen::PenTouch;
use crate::tools::brush::BrushId;

/// Smallest share of the size under pressure, so that a tool in use has a size.
const LEAST_SIZE: f32 = 0.05;
/// Tilt from upright that doubles the size of a brush, in degrees.
const DOUBLES_DEG: f32 = 45.0;
/// Largest factor on the size by tilt.
const MOST_TIMES: f32 = 2.5;

/// The qualities of a brush that a pen controls.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct PenUse {
    /// A lighter press is weaker.
    pub strength: bool,
    /// A lighter press is smaller.
    pub size: bool,
    /// More tilt is larger.
    pub tilt: bool,
}

impl PenUse {
    /// Returns the share of the strength.
    pub fn strength(self, touch: PenTouch) -> f32 {
        if self.strength { touch.pressure } else { 1.0 }
    }

    /// Returns the share of the size, which may exceed 1.
    pub fn size(self, touch: PenTouch) -> f32 {
        let pressed = if self.size { touch.pressure.max(LEAST_SIZE) } else { 1.0 };
        let leant = if self.tilt { 1.0 + touch.lean_deg() / DOUBLES_DEG } else { 1.0 };
        pressed * leant.min(MOST_TIMES)
    }
}

/// The tools on which a pen has an effect.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PenTool {
    /// Any solid.
    Solid,
    Brush(BrushId),
}

impl PenTool {
    /// Returns all such tools.
    pub fn all() -> impl Iterator<Item = PenTool> {
        let brushes = BrushId::ALL.iter().filter(|brush| !brush.spec().is_held());
        std::iter::once(PenTool::Solid).chain(brushes.map(|brush| PenTool::Brush(*brush)))
    }

    pub fn name(self) -> &'static str {
        match self {
            PenTool::Solid => "solid",
            PenTool::Brush(brush) => brush.spec().name,
        }
    }

    /// Returns whether pressure can control a strength.
    pub fn has_strength(self) -> bool {
        match self {
            PenTool::Solid => false,
            PenTool::Brush(brush) => brush.spec().pressure.is_some(),
        }
    }

    /// Returns the default effect of a pen.
    pub fn usual(self) -> PenUse {
        PenUse { strength: self.has_strength(), ..PenUse::default() }
    }
}

/// The effects of a pen on each brush.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PenUses(BTreeMap<&'static str, PenUse>);

impl PenUses {
    pub fn of(&self, tool: PenTool) -> PenUse {
        self.0.get(tool.name()).copied().unwrap_or(tool.usual())
    }

    pub fn of_brush(&self, brush: BrushId) -> PenUse {
        self.of(PenTool::Brush(brush))
    }

    pub fn set(&mut self, tool: PenTool, chosen: PenUse) {
        let strength = chosen.strength && tool.has_strength();
        let chosen = PenUse { strength, ..chosen };
        // Equal to an unchanged one if its effect is the same.
        if chosen == tool.usual() {
            self.0.remove(tool.name());
        } else {
            self.0.insert(tool.name(), chosen);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_brush_has_a_name_of_its_own_and_only_what_has_a_strength_is_led_in_it() {
        let mut uses = PenUses::default();
        let mut names = Vec::new();
        for brush in PenTool::all() {
            assert!(!names.contains(&brush.name()), "{brush:?}");
            names.push(brush.name());
            let all = PenUse { strength: true, size: true, tilt: true };
            uses.set(brush, all);
            assert_eq!(uses.of(brush), PenUse { strength: brush.has_strength(), ..all });
        }
        assert!(!names.contains(&"grab") && !names.contains(&"twist"));
    }
}
