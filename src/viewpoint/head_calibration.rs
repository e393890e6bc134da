//! The calibration in use of the head's tracker, its file, and a new one in progress.
//!
//! Takes poses and steps; gives calibrations and notices. Knows no tracker.

use std::path::PathBuf;

use tracking::HeadPose;
use tracking::calibration::Calibration;

use super::calibration::{self, Calibrating};
use super::head_status::{CalibrationStatus, CalibrationStep};
use crate::head_tracking::TrackingOptions;
use crate::notice::Notice;
use crate::view::off_axis::ScreenPlane;

/// The calibration in use, and one in progress.
pub struct HeadCalibration {
    now: Calibration,
    file: Option<PathBuf>,
    under_way: Option<Calibrating>,
}

impl HeadCalibration {
    /// Uses the calibration of the settings.
    pub fn new(settings: &TrackingOptions) -> HeadCalibration {
        HeadCalibration { now: settings.calibration(), file: None, under_way: None }
    }

    /// Returns the calibration in use.
    pub fn now(&self) -> Calibration {
        self.now
    }

    pub fn is_under_way(&self) -> bool {
        self.under_way.is_some()
    }

    /// Keeps calibrations in a file, and loads the one there or the one that the settings name.
    pub fn keep_in(&mut self, path: PathBuf, settings: &TrackingOptions) -> Option<Notice> {
        let named = &settings.calibration;
        let path = if named.is_empty() { path } else { PathBuf::from(named) };
        let mut notice = None;
        if path.exists() || !named.is_empty() {
            match calibration::read(&path, settings.eyes()) {
                Ok(calibration) => self.use_now(calibration, settings),
                Err(error) => notice = Some(Notice::error(error.to_string())),
            }
        }
        self.file = Some(path);
        notice
    }

    /// Starts one by four touches of the corners of `screen`.
    pub fn begin(&mut self, screen: &ScreenPlane, settings: &TrackingOptions) {
        let tip_m = settings.tip_m.into();
        self.under_way = Some(Calibrating::new(screen.width_m, screen.height_m, tip_m));
    }

    /// Cancels the one in progress, if there is one.
    pub fn cancel(&mut self) {
        self.under_way = None;
    }

    /// Takes the tracker's own pose at `now_s`; `None` if there is no new one.
    pub fn hear(&mut self, raw: Option<&HeadPose>, now_s: f64) {
        if let Some(under_way) = &mut self.under_way {
            under_way.hear(raw, now_s);
        }
    }

    /// Records a touch of the awaited corner, if there is one.
    pub fn touch(&mut self) {
        if let Some(under_way) = &mut self.under_way {
            under_way.take();
        }
    }

    /// Executes a step. Afterwards, the calibration in use may be another one.
    pub fn step(&mut self, step: CalibrationStep, settings: &TrackingOptions) -> Option<Notice> {
        let under_way = self.under_way.as_mut()?;
        match step {
            CalibrationStep::Take => under_way.take(),
            CalibrationStep::Again => under_way.again(),
            CalibrationStep::Cancel => self.under_way = None,
            CalibrationStep::Keep => {
                let fit = under_way.fit.take()?;
                self.use_now(fit.calibration, settings);
                let file = self.file.as_ref();
                return Some(match file.map(|path| calibration::write(path, &self.now)) {
                    Some(Err(error)) => Notice::error(error.to_string()),
                    Some(Ok(())) | None => Notice::note("Head tracker calibrated"),
                });
            }
        }
        None
    }

    pub fn status(&self) -> Option<CalibrationStatus> {
        self.under_way.as_ref().map(|under_way| CalibrationStatus {
            taken: under_way.taken(),
            rms_mm: under_way.fit.as_ref().map(|fit| fit.rms_m * 1e3),
            problem: under_way.problem.clone(),
        })
    }

    /// Uses a calibration from now on, with the eye position of the settings.
    fn use_now(&mut self, calibration: Calibration, settings: &TrackingOptions) {
        self.now = Calibration { sensor_from_eyes: settings.eyes(), ..calibration };
        self.under_way = None;
    }
}
