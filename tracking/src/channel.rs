//! The processing chain of one sensor: it calibrates reports to screen axes, filters and predicts them, and detects a
//! loss. Takes events, gives placements; knows no other sensor.

use crate::calibration::Calibration;
use crate::event::Event;
use crate::filter::{OneEuroOptions, PlacementFilter};
use crate::pose::{HeadPose, Placement, Velocity};
use crate::predict::{PredictionOptions, predict};

/// The sensor, and the processing of its reports.
#[derive(Clone, PartialEq, Debug)]
pub struct ChannelOptions {
    /// As in [`HeadPose::source`].
    pub source: String,
    pub sensor: u32,
    pub calibration: Calibration,
    /// `None`: positions and orientations are not filtered.
    pub smoothing: Option<Smoothing>,
    pub prediction: PredictionOptions,
    /// Time without a report after which the sensor counts as lost, seconds.
    pub lost_after_s: f64,
    /// Reports below this confidence are ignored.
    pub min_confidence: f64,
}

/// Filter settings of a channel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Smoothing {
    pub position: OneEuroOptions,
    pub orientation: OneEuroOptions,
}

impl Default for Smoothing {
    fn default() -> Self {
        Self { position: OneEuroOptions::POSITION, orientation: OneEuroOptions::ORIENTATION }
    }
}

impl ChannelOptions {
    pub fn new(source: &str, sensor: u32) -> Self {
        Self {
            source: source.to_owned(),
            sensor,
            calibration: Calibration::default(),
            smoothing: Some(Smoothing::default()),
            prediction: PredictionOptions::default(),
            lost_after_s: 0.3,
            min_confidence: 0.1,
        }
    }
}

/// Time for which a velocity reported apart from a pose is used, in seconds.
const VELOCITY_LIVES_S: f64 = 0.25;

/// The state of one sensor.
#[derive(Debug)]
pub(crate) struct Channel {
    options: ChannelOptions,
    filter: PlacementFilter,
    /// The last report as received, in tracker axes.
    raw: Option<HeadPose>,
    /// The last report after calibration and filter, in screen axes.
    smooth: Option<HeadPose>,
    /// Velocity of the filtered placement.
    velocity: Velocity,
    /// The velocity last reported by the tracker, in its axes, and its time.
    measured: Option<(Velocity, f64)>,
    /// The source has reported the loss of the device, and no report has come since.
    gone: bool,
    /// The tracker's source of the last report.
    pub(crate) source_index: Option<usize>,
}

impl Channel {
    pub(crate) fn new(options: ChannelOptions) -> Self {
        let smoothing = options.smoothing.unwrap_or_default();
        Self {
            filter: PlacementFilter::new(smoothing.position, smoothing.orientation),
            options,
            raw: None,
            smooth: None,
            velocity: Velocity::default(),
            measured: None,
            gone: false,
            source_index: None,
        }
    }

    pub(crate) fn options(&self) -> &ChannelOptions {
        &self.options
    }

    pub(crate) fn raw(&self) -> Option<&HeadPose> {
        self.raw.as_ref()
    }

    pub(crate) fn smooth(&self) -> Option<&HeadPose> {
        self.smooth.as_ref()
    }

    /// Sets the calibration, applies it to the last report again, and restarts the filter.
    pub(crate) fn set_calibration(&mut self, calibration: Calibration) {
        self.options.calibration = calibration;
        self.filter.reset();
        self.smooth = None;
        if let Some(raw) = self.raw.clone() {
            self.take_pose(&raw);
        }
    }

    /// Handles events of this sensor; ignores the others.
    pub(crate) fn take(&mut self, event: &Event, source_index: usize) {
        match event {
            Event::Pose(pose) if self.is_mine(&pose.source, pose.sensor) => {
                self.source_index = Some(source_index);
                self.gone = false;
                self.take_pose(pose);
            }
            Event::Velocity { source, sensor, velocity, time_s }
                if self.is_mine(source, *sensor) =>
            {
                self.measured = Some((*velocity, *time_s));
                if let Some(raw) = &self.raw
                    && *time_s >= raw.time_s
                {
                    let calibration = &self.options.calibration;
                    self.velocity = calibration.apply_velocity(raw.placement, *velocity);
                }
            }
            Event::Lost { source, .. } if **source == *self.options.source => {
                self.gone = true;
                self.measured = None;
            }
            _ => {}
        }
    }

    fn is_mine(&self, source: &str, sensor: u32) -> bool {
        sensor == self.options.sensor && source == self.options.source
    }

    /// Processes a pose. Drops one older than the last, which arrived out of order.
    fn take_pose(&mut self, pose: &HeadPose) {
        if self.smooth.as_ref().is_some_and(|last| pose.time_s < last.time_s)
            || pose.confidence < self.options.min_confidence
        {
            return;
        }
        let measured = pose.velocity.or_else(|| {
            let (velocity, time_s) = self.measured?;
            ((pose.time_s - time_s).abs() < VELOCITY_LIVES_S).then_some(velocity)
        });
        let calibration = &self.options.calibration;
        let placement = calibration.apply(pose.placement);
        let measured = measured.map(|v| calibration.apply_velocity(pose.placement, v));
        let (smooth, velocity) = self.filter.step(placement, measured, pose.time_s);
        let shown = if self.options.smoothing.is_some() { smooth } else { placement };
        self.velocity = velocity;
        self.smooth = Some(HeadPose { placement: shown, velocity: Some(velocity), ..pose.clone() });
        self.raw = Some(pose.clone());
    }

    /// Returns whether the sensor reports.
    pub(crate) fn is_live(&self, now_s: f64) -> bool {
        !self.gone
            && self
                .smooth
                .as_ref()
                .is_some_and(|pose| now_s - pose.time_s <= self.options.lost_after_s)
    }

    /// Returns the placement predicted for `time_s`; `None` before the first report.
    pub(crate) fn at(&self, time_s: f64) -> Option<Placement> {
        let pose = self.smooth.as_ref()?;
        let ahead_s = time_s - pose.time_s;
        Some(predict(pose.placement, self.velocity, ahead_s, &self.options.prediction))
    }
}
