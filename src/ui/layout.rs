//! The appearance of the interface, and the positions of its panels and windows.
//!
//! Panels change them; knows no panel.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::widgets::spot::Spot;
use super::window_options::{SCALE_RANGE, Theme};
use crate::input::Panel;

/// The size of text and buttons, on top of the display's own scale.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scale {
    now: f32,
    configured: f32,
}

impl Scale {
    pub fn new(configured: f32) -> Scale {
        Scale { now: configured, configured }
    }

    pub fn factor(self) -> f32 {
        self.now
    }

    /// Changes the size by tenths, within the valid range.
    pub fn change_by(&mut self, tenths: f32) {
        let to = (self.now * 10.0 + tenths).round() / 10.0;
        self.now = to.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
    }

    /// Sets a factor, within the valid range.
    pub fn set(&mut self, factor: f32) {
        self.now = factor.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
    }

    pub fn reset(&mut self) {
        self.now = self.configured;
    }
}

/// Position and size of a panel's window, in pixels of the screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct PanelPlace {
    /// Not known on every system.
    #[serde(default)]
    pub corner_px: Option<[i32; 2]>,
    pub size_px: [u32; 2],
}

/// The last sizes of the windows, with the positions of those of panels.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Windows {
    /// Width and height of the main window in points, unless it fills the screen; `None` before it was open.
    pub main: Option<[u32; 2]>,
    pub maximised: bool,
    pub panels: BTreeMap<Panel, PanelPlace>,
}

/// The appearance of the interface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Appearance {
    pub theme: Theme,
    pub scale: Scale,
}

/// The positions of panels and windows.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PanelLayout {
    /// The panels in windows of their own.
    pub detached: BTreeSet<Panel>,
    pub windows: Windows,
    /// The main window shows nothing but the picture. Not remembered.
    pub hidden: bool,
    /// The sections of the options and of the toolbox that a person has opened or closed, by title.
    pub sections: BTreeMap<String, bool>,
    /// The option to show. Not remembered.
    pub led_to: Option<Spot>,
}

impl PanelLayout {
    /// Detaches a panel, or docks it again.
    pub fn toggle_detached(&mut self, panel: Panel) {
        if !self.detached.remove(&panel) {
            self.detached.insert(panel);
        }
    }

    /// Opens the section with an option, and lets the option blink once it is visible.
    pub fn lead_to(&mut self, spot: Spot) {
        self.hidden = false;
        if let Some(section) = spot.section() {
            self.sections.insert(section.to_string(), true);
        }
        self.led_to = Some(spot);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_by_tenths_within_its_range_and_back() {
        let mut scale = Scale::new(1.25);
        scale.change_by(1.0);
        assert_eq!(scale.factor(), 1.4);
        scale.change_by(-1.0);
        assert_eq!(scale.factor(), 1.3);
        (0..50).for_each(|_| scale.change_by(1.0));
        assert_eq!(scale.factor(), 4.0);
        (0..50).for_each(|_| scale.change_by(-1.0));
        assert_eq!(scale.factor(), 0.5);
        scale.reset();
        assert_eq!(scale.factor(), 1.25);
    }
}
