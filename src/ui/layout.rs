//! The choices about how the interface looks and where its panels and windows are.
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

    /// Larger by tenths, as far as the settings allow.
    pub fn change_by(&mut self, tenths: f32) {
        let to = (self.now * 10.0 + tenths).round() / 10.0;
        self.now = to.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
    }

    /// To a factor, as far as the settings allow.
    pub fn set(&mut self, factor: f32) {
        self.now = factor.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
    }

    pub fn reset(&mut self) {
        self.now = self.configured;
    }
}

/// Where the window of a panel is, in pixels of the screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct PanelPlace {
    /// Not known everywhere.
    #[serde(default)]
    pub corner_px: Option<[i32; 2]>,
    pub size_px: [u32; 2],
}

/// How large the windows were last, and where those of panels.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Windows {
    /// Width and height of the main window in points, while it does not fill the screen; none
    /// before it was open.
    pub main: Option<[u32; 2]>,
    pub maximised: bool,
    pub panels: BTreeMap<Panel, PanelPlace>,
}

/// How the interface looks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Appearance {
    pub theme: Theme,
    pub scale: Scale,
}

/// Where panels and windows are.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PanelLayout {
    /// The panels that are windows of their own.
    pub detached: BTreeSet<Panel>,
    pub windows: Windows,
    /// Nothing but the picture is shown in the main window. Not remembered.
    pub hidden: bool,
    /// The sections of the options and of the toolbox that were opened or closed, by their titles.
    pub sections: BTreeMap<String, bool>,
    /// The option that is to be shown. Not remembered.
    pub led_to: Option<Spot>,
}

impl PanelLayout {
    /// Detaches a panel, or docks it again.
    pub fn toggle_detached(&mut self, panel: Panel) {
        if !self.detached.remove(&panel) {
            self.detached.insert(panel);
        }
    }

    /// Opens the section with an option, and lets the option blink once it is shown.
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
