//! The lead of a pen over each tool: strength, size, or both, as chosen for it.
//!
//! From how a pen touches to shares of strength and size. Knows no devices and no tool in hand.

use std::collections::BTreeMap;

use crate::input::pen::PenTouch;
use crate::tools::brush::BrushId;

/// Smallest share of the size that pressure leads to: a tool that is used at all has a size.
const LEAST_SIZE: f32 = 0.05;
/// A pen that leans so far makes a brush twice as large, in degrees from upright.
const DOUBLES_DEG: f32 = 45.0;
/// It makes no brush larger than this many times.
const MOST_TIMES: f32 = 2.5;

/// The qualities of a brush that a pen leads.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct PenUse {
    /// The lighter the press, the weaker.
    pub strength: bool,
    /// The lighter the press, the smaller.
    pub size: bool,
    /// The more the pen leans, the larger.
    pub tilt: bool,
}

impl PenUse {
    /// Share of the strength.
    pub fn strength(self, touch: PenTouch) -> f32 {
        if self.strength { touch.pressure } else { 1.0 }
    }

    /// Share of the size, which may be more than all.
    pub fn size(self, touch: PenTouch) -> f32 {
        let pressed = if self.size { touch.pressure.max(LEAST_SIZE) } else { 1.0 };
        let leant = if self.tilt { 1.0 + touch.lean_deg() / DOUBLES_DEG } else { 1.0 };
        pressed * leant.min(MOST_TIMES)
    }
}

/// The tools that a pen can lead something of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PenTool {
    /// Any solid.
    Solid,
    Brush(BrushId),
}

impl PenTool {
    /// Returns all of them.
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

    /// Returns whether there is a strength that pressure can lead.
    pub fn has_strength(self) -> bool {
        match self {
            PenTool::Solid => false,
            PenTool::Brush(brush) => brush.spec().pressure.is_some(),
        }
    }

    /// Returns the lead that a pen has before the person has chosen.
    pub fn usual(self) -> PenUse {
        PenUse { strength: self.has_strength(), ..PenUse::default() }
    }
}

/// The lead of a pen over each brush.
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
        // Equal to one that was never changed, if it leads the same.
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
