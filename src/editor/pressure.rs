//! The lead of a pen's pressure and tilt: over the strength of a brush, its size, or both, each as chosen.
//!
//! From how a pen (a finger, the trigger of a hand) touches to shares of strength and size. A mouse presses fully and
//! upright, so nothing changes for it. Knows no devices.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::Editor;
use super::tool::{ToolKind, ToolState};
use crate::input::pen::PenTouch;
use crate::sculpture::Rgb;
use crate::tools::brush::BrushId;
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;

/// Smallest share of the size that pressure leads to: a tool that is used at all has a size.
const LEAST_SIZE: f32 = 0.05;
/// A pen that leans so far makes a brush twice as large, in degrees from upright.
const DOUBLES_DEG: f32 = 45.0;
/// It makes no brush larger than this many times.
const MOST_TIMES: f32 = 2.5;

/// A full press, upright.
pub(super) const FULL: PenTouch = PenTouch { pressure: 1.0, tilt_deg: glam::Vec2::ZERO };

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
    /// All of them.
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

    /// Whether there is a strength that pressure can lead.
    pub fn has_strength(self) -> bool {
        match self {
            PenTool::Solid => false,
            PenTool::Brush(brush) => brush.spec().pressure.is_some(),
        }
    }

    /// The lead that a pen has before the person has chosen.
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

impl ToolState {
    /// The tool in hand, if a pen can lead something of it.
    pub fn pen_tool(&self) -> Option<PenTool> {
        match self.kind {
            ToolKind::Solid => Some(PenTool::Solid),
            ToolKind::Brush(brush) => (!brush.spec().is_held()).then_some(PenTool::Brush(brush)),
            ToolKind::Draw(_) | ToolKind::Marker => None,
        }
    }

    /// The tool as it is used when it is touched so: a solid is as large as the pen says. `bare`: the colour that it gives in
    /// place of its own, since it takes paint away.
    pub(super) fn in_use(&self, touch: PenTouch, bare: Option<Rgb>) -> Cow<'_, ToolState> {
        let size = match self.kind {
            ToolKind::Solid => self.pens.of(PenTool::Solid).size(touch),
            _ => 1.0,
        };
        if bare.is_none() && size == 1.0 {
            return Cow::Borrowed(self);
        }
        let mut tool = self.clone();
        tool.scale_by(size);
        if let Some(bare) = bare {
            tool.colour = bare;
            (tool.picture, tool.stencil) = (None, None);
        }
        Cow::Owned(tool)
    }
}

/// The options with which a brush is used that is touched so.
pub(super) fn touched(options: &BrushOptions, by: PenUse, touch: PenTouch) -> BrushOptions {
    let mut options = *options;
    if let Some(key) = options.brush().spec().pressure {
        options.set(key, options.get(key) * by.strength(touch));
    }
    options.with(RADIUS, options.get(RADIUS) * by.size(touch))
}

/// How a tool is touched now, and was at its last use: between two events a hand presses evenly more or less.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Grip {
    pub now: PenTouch,
    used: PenTouch,
}

impl Default for Grip {
    fn default() -> Grip {
        Grip { now: FULL, used: FULL }
    }
}

impl Grip {
    /// A stroke begins.
    pub fn begin(&mut self) {
        self.used = self.now;
    }

    /// How it is touched at each of `count` uses on the way to where it is now.
    pub fn on_way(&mut self, count: usize) -> impl Iterator<Item = PenTouch> + use<> {
        let (from, to) = (self.used, self.now);
        if count > 0 {
            self.used = to;
        }
        (1..=count).map(move |i| {
            let share = i as f32 / count as f32;
            PenTouch {
                pressure: from.pressure + (to.pressure - from.pressure) * share,
                tilt_deg: from.tilt_deg.lerp(to.tilt_deg, share),
            }
        })
    }
}

impl Editor {
    /// Takes how a pen or a finger touches; none for a mouse, which presses fully.
    pub fn set_touch(&mut self, touch: Option<PenTouch>) {
        let touch = touch.unwrap_or(FULL);
        if touch.pressure.is_finite() && touch.tilt_deg.is_finite() {
            let pressure = touch.pressure.clamp(0.0, 1.0);
            self.grip.now = PenTouch { pressure, ..touch };
        }
    }

    /// Takes how hard the trigger of a hand is pressed, 0 to 1.
    pub fn set_pressure(&mut self, pressure: f32) {
        self.set_touch(Some(PenTouch::of_pressure(pressure)));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::tools::brush::keys::{REACH, STRENGTH};

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

    #[test]
    fn pressure_leads_what_was_chosen_and_a_mouse_changes_nothing() {
        let light = PenTouch { pressure: 0.25, tilt_deg: Vec2::new(45.0, 0.0) };
        let chosen = |strength, size, tilt| PenUse { strength, size, tilt };
        let clay = BrushOptions::first(BrushId::Clay);
        let of = |by, touch| touched(&clay, by, touch);
        let usual = PenTool::Brush(BrushId::Clay).usual();
        assert_eq!(of(usual, light), clay.with(REACH, 1.0));
        assert_eq!(of(chosen(false, true, false), light), clay.with(RADIUS, 5.0));
        let wide = of(chosen(false, false, true), light);
        assert!((wide.get(RADIUS) - 40.0).abs() < 1e-3);
        assert_eq!(of(chosen(true, true, true), FULL), clay);
        let paint = BrushOptions::first(BrushId::Paint);
        assert_eq!(touched(&paint, usual, light), paint.with(STRENGTH, 0.25));
        let crease = BrushOptions::first(BrushId::Crease);
        assert_eq!(
            touched(&crease, chosen(true, true, false), light),
            crease.with(STRENGTH, 0.25).with(RADIUS, 0.25 * crease.get(RADIUS))
        );
        let growth = BrushOptions::first(BrushId::Grow);
        assert_eq!(touched(&growth, usual, light), growth, "it has no strength");
        let none = PenTouch::of_pressure(0.0);
        assert!(of(chosen(false, true, false), none).get(RADIUS) >= 1.0);
    }

    #[test]
    fn a_hand_presses_evenly_between_two_events() {
        let mut grip = Grip { now: PenTouch::of_pressure(0.2), used: FULL };
        grip.begin();
        grip.now = PenTouch::of_pressure(1.0);
        assert_eq!(grip.on_way(0).count(), 0, "nothing was used");
        let pressures: Vec<f32> = grip.on_way(4).map(|touch| touch.pressure).collect();
        for (found, expected) in pressures.iter().zip([0.4, 0.6, 0.8, 1.0]) {
            assert!((found - expected).abs() < 1e-6, "{pressures:?}");
        }
        grip.now = PenTouch::of_pressure(0.5);
        assert_eq!(grip.on_way(1).next(), Some(PenTouch::of_pressure(0.5)));
    }
}
