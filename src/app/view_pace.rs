//! Ends what the pointer does on the sculpture when the tracking behind the view leaps: the camera
//! before the printed marker, or the head before the screen.
//!
//! A stroke led over the picture would otherwise go on somewhere else. It is ended as a hand's is,
//! by the same speed limit (`input::pace`), and nothing more is done until the button is released.
//! The pointer itself has no such limit: a mouse may cross the picture between two events, and its
//! path over the surface is lifted at edges (`stroke`) and bounded (`path`).

use crate::app::workspace::Workspace;
use crate::input::pace::{ViewPace, Viewpoint};

/// Follows the view, and whether it has ended what is held.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct ViewWatch {
    pace: ViewPace,
    /// What the pointer's button holds was ended.
    lifted: bool,
}

impl ViewWatch {
    /// Whether a drag goes on without doing anything.
    pub fn is_lifted(&self) -> bool {
        self.lifted
    }

    /// The button is released.
    pub fn release(&mut self) {
        self.lifted = false;
    }
}

impl Workspace {
    /// Follows the tracked viewpoint; ends strokes and drags through it where it leaps.
    pub(super) fn follow_view(&mut self, now_s: f64) {
        let viewpoint = match self.ar.is_on() {
            true => self.ar.camera_position_m().map(|at| (Viewpoint::Camera, at)),
            false => self.head.position_m().map(|at| (Viewpoint::Head, at)),
        };
        if !self.view_watch.pace.step(viewpoint, now_s) {
            return;
        }
        let stroke = self.stroke.as_ref().is_some_and(|stroke| stroke.is_led_over_picture());
        let drag = self.marker_drag.take().is_some();
        if stroke {
            self.end_stroke();
        }
        if stroke || drag {
            self.view_watch.lifted = true;
            self.ui
                .toasts
                .note("The view jumped, so the stroke has ended; press again to continue");
        }
    }
}
