//! Pens as the interface knows them: the devices, the pressure curve, and the present touch.
//!
//! The window fills in the reports of the window system; the options of pens show them. Knows neither.

use crate::input::pen::{PenCurve, PenTouch};

/// Pens, as the interface shows them.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PenState {
    /// The tablets and pens named by the window system.
    pub devices: Vec<String>,
    /// The pressure curve, and its value in the settings.
    pub curve: PenCurve,
    pub usual: PenCurve,
    /// The present touch of the pen.
    pub touch: Option<PenTouch>,
    /// A pen has been used since the start.
    pub is_used: bool,
}

impl PenState {
    pub fn new(usual: PenCurve) -> PenState {
        PenState { curve: usual, usual, ..PenState::default() }
    }

    /// Returns whether there is a pen, so that its options are worth showing.
    pub fn is_there(&self) -> bool {
        self.is_used || !self.devices.is_empty()
    }
}
