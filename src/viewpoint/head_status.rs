//! The state of head tracking, as the interface reads it, and the steps of its calibration.

use tracking::Presence;

/// The state of head tracking, as the interface reads it.
#[derive(Clone, PartialEq, Debug)]
pub struct HeadStatus {
    /// The view follows the head.
    pub on: bool,
    pub source: String,
    /// Why no poses can come, if none can.
    pub state: Option<String>,
    pub presence: Presence,
    /// Between the eyes, on the screen's axes.
    pub position_m: [f64; 3],
    pub rate_hz: f64,
    pub losses: u32,
    /// Messages that were broken or came too late to be read.
    pub dropped: u64,
    /// Width and height of the screen, and whether they are a guess.
    pub screen_m: [f32; 2],
    pub guessed: bool,
    /// While the tracker is being calibrated.
    pub calibration: Option<CalibrationStatus>,
}

/// How far the calibration has come.
#[derive(Clone, PartialEq, Debug)]
pub struct CalibrationStatus {
    /// Corners touched.
    pub taken: usize,
    /// How well the touches fit, once all were taken.
    pub rms_mm: Option<f64>,
    pub problem: Option<String>,
}

/// A request from the window of the calibration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CalibrationStep {
    /// The corner at hand is being touched.
    Take,
    Again,
    Keep,
    Cancel,
}

impl HeadStatus {
    /// In a word.
    pub fn label(&self) -> &'static str {
        match self.presence {
            Presence::Tracked => "Head tracked",
            Presence::Returning => "Head found",
            Presence::Leaving => "Head lost",
            Presence::Absent => "No head",
        }
    }
}
