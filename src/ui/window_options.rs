//! Options of the main window: its size, theme and scale, and the guide.

use serde::{Deserialize, Serialize};

use crate::options::{InvalidOption, require, require_in};

/// Valid scales of text and buttons.
pub const SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.5..=4.0;

#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    #[default]
    Dark,
    Light,
}

impl Theme {
    pub fn other(self) -> Theme {
        match self {
            Theme::Dark => Theme::Light,
            Theme::Light => Theme::Dark,
        }
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WindowOptions {
    /// Width and height in points.
    pub size: [u32; 2],
    pub theme: Theme,
    /// Show the guide at the first start.
    pub guide: bool,
    pub scale: f32,
}

impl Default for WindowOptions {
    fn default() -> Self {
        WindowOptions { size: [1280, 800], theme: Theme::Dark, guide: true, scale: 1.0 }
    }
}

impl WindowOptions {
    pub fn check(&self) -> Result<(), InvalidOption> {
        require(
            self.size.iter().all(|side| (320..=16384).contains(side)),
            "size",
            format_args!("{:?}", self.size),
            "must be 320 to 16384 points each",
        )?;
        require_in(SCALE_RANGE, "scale", self.scale, "must be 0.5 to 4")
    }
}
