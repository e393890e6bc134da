//! The touch of a pen (a finger, the trigger of a hand) on the tool in use. A mouse presses fully and upright, so it is
//! unaffected. Knows no devices.

use std::borrow::Cow;

use super::pen_use::{PenTool, PenUse};
use super::tool::{ToolKind, ToolState};
use crate::input::pen::PenTouch;
use crate::sculpture::Rgb;
use crate::tools::brush::keys::RADIUS;
use crate::tools::brush::options::BrushOptions;

/// A full press, upright.
pub(super) const FULL: PenTouch = PenTouch { pressure: 1.0, tilt_deg: glam::Vec2::ZERO };

impl ToolState {
    /// Returns the tool as used with this touch: the pen scales a solid. `bare`: replaces the colour, to remove paint.
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

/// Returns the options of a brush used with this touch.
pub(super) fn touched(options: &BrushOptions, by: PenUse, touch: PenTouch) -> BrushOptions {
    let mut options = *options;
    if let Some(key) = options.brush().spec().pressure {
        options.set(key, options.get(key) * by.strength(touch));
    }
    options.with(RADIUS, options.get(RADIUS) * by.size(touch))
}

/// The present touch of a tool, and that of its last use. The pressure between two events is interpolated.
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
    /// Sets the touch of a pen or a finger; `None` for a mouse, which presses fully.
    pub fn touch(&mut self, touch: Option<PenTouch>) {
        let touch = touch.unwrap_or(FULL);
        if touch.pressure.is_finite() && touch.tilt_deg.is_finite() {
            let pressure = touch.pressure.clamp(0.0, 1.0);
            self.now = PenTouch { pressure, ..touch };
        }
    }

    /// Begins a stroke.
    pub fn begin(&mut self) {
        self.used = self.now;
    }

    /// Returns the touch for each of `count` uses on the path to the present position.
    pub fn along_path(&mut self, count: usize) -> impl Iterator<Item = PenTouch> + use<> {
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

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::tools::brush::BrushId;
    use crate::tools::brush::keys::{REACH, STRENGTH};

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
        assert_eq!(grip.along_path(0).count(), 0, "nothing was used");
        let pressures: Vec<f32> = grip.along_path(4).map(|touch| touch.pressure).collect();
        for (found, expected) in pressures.iter().zip([0.4, 0.6, 0.8, 1.0]) {
            assert!((found - expected).abs() < 1e-6, "{pressures:?}");
        }
        grip.now = PenTouch::of_pressure(0.5);
        assert_eq!(grip.along_path(1).next(), Some(PenTouch::of_pressure(0.5)));
    }
}
