//! The state of head tracking, as the interface reads it, and the steps of its calibration.

use tracking::Presence;

/// The state of head tracking, as the interface reads it.
#[derive(Clone, PartialEq, Debug)]
pub struct HeadStatus {
    /// The view follows the head.
    pub on: bool,
    pub source: String,
    /// The reason why no poses can come, if so.
    pub state: Option<String>,
    pub presence: Presence,
    /// Position between the eyes, in the screen's axes.
    pub position_m: [f64; 3],
    pub rate_hz: f64,
    pub losses: u32,
    /// Messages that were broken or not read in time.
    pub dropped: u64,
    /// Width and height of the screen, and whether they are a guess.
    pub screen_m: [f32; 2],
    pub guessed: bool,
    /// `None` unless the tracker is being calibrated.
    pub calibration: Option<CalibrationStatus>,
}

/// The progress of the calibration.
#[derive(Clone, PartialEq, Debug)]
pub struct CalibrationStatus {
    /// Number of touched corners.
    pub taken: usize,
    /// Error of the fit, once all corners were touched.
    pub rms_mm: Option<f64>,
    pub problem: Option<String>,
}

/// A request from the calibration's window.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CalibrationStep {
    /// The present corner is being touched.
    Take,
    Again,
    Keep,
    Cancel,
}

impl HeadStatus {
    /// Returns the state in a word.
    pub fn label(&self) -> &'static str {
        match self.presence {
            Presence::Tracked => "Head tracked",
            Presence::Returning => "Head found",
            Presence::Leaving => "Head lost",
            Presence::Absent => "No head",
        }
    }
}
