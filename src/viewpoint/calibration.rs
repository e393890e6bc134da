//! The calibration of a tracker by touching the four corners of the screen, and the file that
//! keeps it.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;
use tracking::calibration::{Calibration, CalibrationFit, Touch, fit_touches, screen_corners_m};
use tracking::{HeadPose, Placement};

/// A touch is the mean over this time, in seconds.
const OVER_S: f64 = 0.3;
/// Largest distance of the tip from this mean meanwhile, in metres.
const STEADY_M: f64 = 0.006;
/// Reports that a touch needs at least.
const LEAST_REPORTS: usize = 3;

/// The reason why a calibration cannot be read or written.
#[derive(Debug, Error)]
pub enum CalibrationFileError {
    #[error("the calibration {0} cannot be read: {1}")]
    Read(PathBuf, std::io::Error),
    #[error("the calibration {0} cannot be used: {1}; delete the file and calibrate again")]
    Parse(PathBuf, Box<toml::de::Error>),
    #[error("the calibration {0} has impossible values; delete the file and calibrate again")]
    Value(PathBuf),
    #[error("the calibration {0} cannot be saved: {1}")]
    Write(PathBuf, std::io::Error),
}

/// The contents of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibrationFile {
    /// Rotation from tracker axes to screen axes.
    rotation_xyzw: [f64; 4],
    /// The tracker's origin in screen axes.
    translation_m: [f64; 3],
    scale: f64,
}

/// Reads a calibration, and completes it with the position of the eyes.
pub fn read(path: &Path, eyes: Placement) -> Result<Calibration, CalibrationFileError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| CalibrationFileError::Read(path.into(), error))?;
    let kept: CalibrationFile = toml::from_str(&text)
        .map_err(|error| CalibrationFileError::Parse(path.into(), Box::new(error)))?;
    let rotation = DQuat::from_array(kept.rotation_xyzw);
    let placement = Placement::checked(kept.translation_m.into(), rotation);
    match placement.filter(|_| (0.01..=100.0).contains(&kept.scale)) {
        Some(Placement { position_m, orientation }) => Ok(Calibration {
            rotation: orientation,
            translation_m: position_m,
            scale: kept.scale,
            sensor_from_eyes: eyes,
        }),
        None => Err(CalibrationFileError::Value(path.into())),
    }
}

/// Writes a calibration under a temporary name, then renames it.
pub fn write(path: &Path, calibration: &Calibration) -> Result<(), CalibrationFileError> {
    let kept = CalibrationFile {
        rotation_xyzw: calibration.rotation.to_array(),
        translation_m: calibration.translation_m.to_array(),
        scale: calibration.scale,
    };
    let body = toml::to_string(&kept).map_err(|error| std::io::Error::other(error.to_string()));
    let write = |body: String| {
        let folder = path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        let head =
            "# Calibration of the head tracker by four touches; delete this file to undo it.\n";
        std::io::Write::write_all(&mut file, (head.to_owned() + &body).as_bytes())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error).map(|_| ())
    };
    body.and_then(write).map_err(|error| CalibrationFileError::Write(path.into(), error))
}

/// A calibration in progress.
pub struct Calibrating {
    corners_m: [DVec3; 4],
    /// The touching tip in the sensor's axes.
    tip_m: DVec3,
    /// Recent times and positions of the tip, in the tracker's axes.
    recent: VecDeque<(f64, DVec3)>,
    touches: Vec<Touch>,
    /// `None` until all corners were touched.
    pub fit: Option<CalibrationFit>,
    pub problem: Option<String>,
}

impl Calibrating {
    pub fn new(width_m: f32, height_m: f32, tip_m: DVec3) -> Calibrating {
        Calibrating {
            corners_m: screen_corners_m(f64::from(width_m), f64::from(height_m)),
            tip_m,
            recent: VecDeque::new(),
            touches: Vec::new(),
            fit: None,
            problem: None,
        }
    }

    /// Returns the number of corners touched so far.
    pub fn taken(&self) -> usize {
        self.touches.len()
    }

    /// Takes the sensor's pose as reported by the tracker.
    pub fn hear(&mut self, raw: Option<&HeadPose>, now_s: f64) {
        if let Some(pose) = raw
            && self.recent.back().is_none_or(|(time_s, _)| pose.time_s > *time_s)
        {
            let tip = Touch::with_tip(pose.placement, self.tip_m, DVec3::ZERO);
            self.recent.push_back((pose.time_s, tip.tracker_m));
        }
        while self.recent.front().is_some_and(|(time_s, _)| now_s - time_s > OVER_S) {
            self.recent.pop_front();
        }
    }

    /// Records a touch of the present corner.
    pub fn take(&mut self) {
        let Some(&screen_m) = self.corners_m.get(self.touches.len()) else { return };
        self.problem = None;
        if self.recent.len() < LEAST_REPORTS {
            self.problem = Some("The tracker does not see the object: no poses arrive.".into());
            return;
        }
        let count = self.recent.len() as f64;
        let tracker_m = self.recent.iter().map(|(_, tip)| *tip).sum::<DVec3>() / count;
        if self.recent.iter().any(|(_, tip)| tip.distance(tracker_m) > STEADY_M) {
            self.problem = Some("Hold it still on the corner, then record it again.".into());
            return;
        }
        self.touches.push(Touch { tracker_m, screen_m });
        if self.touches.len() == self.corners_m.len() {
            match fit_touches(&self.touches, false) {
                Ok(fit) => self.fit = Some(fit),
                Err(error) => {
                    self.touches.clear();
                    self.problem = Some(format!("Calibration failed: {error}. Start again."));
                }
            }
        }
    }

    /// Starts again with the first corner.
    pub fn again(&mut self) {
        self.touches.clear();
        (self.fit, self.problem) = (None, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_keeps_the_calibration_and_faults_name_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/calibration.toml");
        let given = Calibration {
            rotation: DQuat::from_rotation_y(0.3),
            translation_m: DVec3::new(0.1, -0.2, 1.5),
            ..Calibration::default()
        };
        write(&path, &given).unwrap();
        let back = read(&path, Placement::IDENTITY).unwrap();
        assert!(back.rotation.angle_between(given.rotation) < 1e-9);
        assert_eq!(back.translation_m, given.translation_m);
        for bad in [
            "",
            "scale = 0.0",
            "rotation_xyzw = [0.0,0.0,0.0,0.0]\ntranslation_m = [0.0,0.0,0.0]\nscale = 1.0",
        ] {
            std::fs::write(&path, bad).unwrap();
            let error = read(&path, Placement::IDENTITY).unwrap_err().to_string();
            assert!(error.contains("calibration.toml"), "{error}");
        }
    }
}
