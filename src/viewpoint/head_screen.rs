//! The screen before the head: its size, and the part that shows the picture.
//!
//! Takes the settings and the window system's facts about screen and window; gives planes in metres. Knows no tracker.

use glam::{DQuat, DVec3, IVec2, UVec2, Vec2};
use tracking::Placement;

use super::ViewportRect;
use crate::head_tracking::ScreenOptions;
use crate::view::off_axis::ScreenPlane;

/// The diagonal of a screen of unknown size: 24 inches, in metres.
const GUESSED_DIAGONAL_M: f32 = 0.61;

/// Position of the program's window on the screen, in pixels of the screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Monitor {
    pub size_px: UVec2,
    /// Upper left corner of the window's contents; `None` if the system does not report it.
    pub window_px: Option<IVec2>,
    /// Size of the window's contents.
    pub window_size_px: UVec2,
}

/// The screen of the window.
pub struct HeadScreen {
    options: ScreenOptions,
    monitor: Option<Monitor>,
}

impl HeadScreen {
    /// Uses the settings until the window system reports a monitor.
    pub fn new(options: &ScreenOptions) -> HeadScreen {
        HeadScreen { options: options.clone(), monitor: None }
    }

    /// Sets the position of the program's window on the screen.
    pub fn set_monitor(&mut self, monitor: Option<Monitor>) {
        self.monitor = monitor;
    }

    /// Returns the assumed pose of an untracked head.
    pub fn rest(&self) -> Placement {
        Placement { position_m: DVec3::from(self.options.rest_m), orientation: DQuat::IDENTITY }
    }

    /// Returns the whole screen, and whether its size is a guess.
    pub fn whole(&self) -> (ScreenPlane, bool) {
        let [width_m, height_m] = self.options.size_m;
        if width_m > 0.0 {
            return (ScreenPlane::new(width_m, height_m), false);
        }
        let pixels = self.monitor.map_or(Vec2::new(16.0, 9.0), |m| m.size_px.as_vec2());
        let size = pixels * (GUESSED_DIAGONAL_M / pixels.length().max(1.0));
        (ScreenPlane::new(size.x, size.y), true)
    }

    /// Returns the part of the screen that shows the picture.
    pub fn plane(&self, viewport: ViewportRect) -> ScreenPlane {
        let (whole, _) = self.whole();
        let Some(monitor) = self.monitor else { return whole };
        // A window of unknown position is assumed in the middle.
        let middle = (monitor.size_px.as_ivec2() - monitor.window_size_px.as_ivec2()) / 2;
        let window = monitor.window_px.unwrap_or(middle).as_vec2();
        let screen = monitor.size_px.max(UVec2::ONE).as_vec2();
        let share = |corner: Vec2| (window + corner) / screen;
        whole.part(share(viewport.corner_px), share(viewport.corner_px + viewport.size_px))
    }
}
