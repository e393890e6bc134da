//! Pens as the interface knows them: which there are, how a press counts, and how one touches now.
//!
//! The window fills in what the window system says; the options of pens show it. Knows neither.

use crate::input::pen::{PenCurve, PenTouch};

/// Pens, as the interface shows them.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PenState {
    /// The tablets and pens that the window system has named.
    pub devices: Vec<String>,
    /// How a press counts, and what the settings say of it.
    pub curve: PenCurve,
    pub usual: PenCurve,
    /// How the pen touches now.
    pub touch: Option<PenTouch>,
    /// A pen has been used since the start.
    pub is_used: bool,
}

impl PenState {
    pub fn new(usual: PenCurve) -> PenState {
        PenState { curve: usual, usual, ..PenState::default() }
    }

    /// Returns whether there is a pen whose options are worth showing.
    pub fn is_there(&self) -> bool {
        self.is_used || !self.devices.is_empty()
    }
}
