//! The front of the crate: owns the sources and the bodies that they track (a head, a hand), and predicts the placement
//! of a body at the display time of a frame. Takes time as a value and never blocks.
//!
//! A body follows the first of its channels that is live, so that a second tracker can replace the first; with none it
//! moves to its rest position. All changes are faded.

use crate::calibration::Calibration;
use crate::channel::{Channel, ChannelOptions};
use crate::event::Event;
use crate::fade::{Fade, FadeOptions};
use crate::pose::{HeadPose, Placement};
use crate::source::Source;

/// A tracked body and its fallbacks.
#[derive(Clone, PartialEq, Debug)]
pub struct BodyOptions {
    /// The rest position, in screen axes, while nothing tracks the body.
    pub rest: Placement,
    pub fade: FadeOptions,
    /// In order of preference.
    pub channels: Vec<ChannelOptions>,
}

/// A body of a [`Tracker`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct BodyId(usize);

impl BodyId {
    /// The body that every tracker has.
    pub const HEAD: Self = Self(0);
}

/// Whether a placement is tracked.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Presence {
    Tracked,
    /// A tracker is live; the fade to it is in progress.
    Returning,
    /// No tracker is live; the fade to the rest position is in progress.
    Leaving,
    Absent,
}

/// Predicted placement of a body.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Predicted {
    /// In screen axes.
    pub placement: Placement,
    /// 0 at the rest position, else that of the report, reduced while fading.
    pub confidence: f64,
    pub presence: Presence,
}

#[derive(Debug)]
struct TrackedBody {
    rest: Placement,
    fade_options: FadeOptions,
    channels: Vec<Channel>,
    /// The followed channel; `None`: the rest position.
    guide: Option<usize>,
    fade: Fade,
    /// The latest time for which a placement was requested: fades start no earlier.
    shown_s: f64,
}

/// Sources and bodies.
pub struct Tracker {
    sources: Vec<Box<dyn Source>>,
    bodies: Vec<TrackedBody>,
    scratch: Vec<Event>,
}

impl Tracker {
    pub fn new(head: BodyOptions) -> Self {
        let mut tracker = Self { sources: Vec::new(), bodies: Vec::new(), scratch: Vec::new() };
        tracker.add_body(head);
        tracker
    }

    pub fn add_source(&mut self, source: Box<dyn Source>) {
        self.sources.push(source);
    }

    pub fn add_body(&mut self, options: BodyOptions) -> BodyId {
        self.bodies.push(TrackedBody {
            rest: options.rest,
            fade_options: options.fade,
            channels: options.channels.into_iter().map(Channel::new).collect(),
            guide: None,
            fade: Fade::DONE,
            shown_s: f64::NEG_INFINITY,
        });
        BodyId(self.bodies.len() - 1)
    }

    /// Returns the sources in the order in which they were added.
    pub fn sources(&self) -> impl Iterator<Item = &dyn Source> {
        self.sources.iter().map(|source| &**source)
    }

    /// Polls the sources and chooses the channel that each body follows. Consumes poses and motion; appends buttons,
    /// analogs, dials, texts, losses and finds to `events`.
    pub fn update(&mut self, now_s: f64, events: &mut Vec<Event>) {
        for (index, source) in self.sources.iter_mut().enumerate() {
            source.poll(now_s, &mut self.scratch);
            for event in self.scratch.drain(..) {
                for channel in self.bodies.iter_mut().flat_map(|body| &mut body.channels) {
                    channel.take(&event, index);
                }
                if !matches!(
                    event,
                    Event::Pose(_) | Event::Velocity { .. } | Event::Acceleration { .. }
                ) {
                    events.push(event);
                }
            }
        }
        for body in &mut self.bodies {
            let guide = body.channels.iter().position(|channel| channel.is_live(now_s));
            if guide != body.guide {
                body.turn_to(guide, now_s, &mut self.sources);
            }
        }
    }

    /// Returns the head's last report after calibration and filter, in screen axes.
    pub fn latest(&self) -> Option<&HeadPose> {
        self.latest_of(BodyId::HEAD)
    }

    /// Returns [`Self::latest`] of any body; `None` while it is untracked or unknown.
    pub fn latest_of(&self, body: BodyId) -> Option<&HeadPose> {
        let body = self.bodies.get(body.0)?;
        body.channels[body.guide?].smooth()
    }

    /// Returns the last report of each channel as sent by the tracker, for calibrating.
    pub fn raw_of(&self, body: BodyId) -> impl Iterator<Item = Option<&HeadPose>> {
        self.bodies.get(body.0).into_iter().flat_map(|body| body.channels.iter().map(Channel::raw))
    }

    /// Returns the head's predicted placement at the display time of the frame.
    pub fn predicted(&mut self, display_time_s: f64) -> Predicted {
        self.bodies[0].predicted(display_time_s, &mut self.sources)
    }

    /// Returns [`Self::predicted`] of any body; `None` for an id of another tracker.
    pub fn predicted_of(&mut self, body: BodyId, display_time_s: f64) -> Option<Predicted> {
        let body = self.bodies.get_mut(body.0)?;
        Some(body.predicted(display_time_s, &mut self.sources))
    }

    /// Changes the calibration of a body's channel, with a fade from the shown placement. Returns false if there is no
    /// such channel.
    pub fn set_calibration(
        &mut self,
        body: BodyId,
        channel: usize,
        calibration: Calibration,
        now_s: f64,
    ) -> bool {
        let Some(body) = self.bodies.get_mut(body.0) else { return false };
        if channel >= body.channels.len() {
            return false;
        }
        let start_s = now_s.max(body.shown_s);
        let shown = body.shown_at(start_s, &mut self.sources);
        body.channels[channel].set_calibration(calibration);
        body.fade_from(shown, start_s, &mut self.sources);
        true
    }
}

impl TrackedBody {
    /// Returns the guide's placement for `time_s`.
    fn guide_at(&self, time_s: f64, sources: &mut [Box<dyn Source>]) -> Placement {
        let Some(channel) = self.guide.map(|index| &self.channels[index]) else {
            return self.rest;
        };
        let options = channel.options();
        let located = channel
            .source_index
            .and_then(|index| sources[index].located(options.sensor, time_s))
            .filter(|pose| pose.confidence >= options.min_confidence)
            .map(|pose| options.calibration.apply(pose.placement));
        located.or_else(|| channel.at(time_s)).unwrap_or(self.rest)
    }

    fn shown_at(&self, time_s: f64, sources: &mut [Box<dyn Source>]) -> Placement {
        self.fade.place(self.guide_at(time_s, sources), time_s)
    }

    fn turn_to(&mut self, guide: Option<usize>, now_s: f64, sources: &mut [Box<dyn Source>]) {
        let start_s = now_s.max(self.shown_s);
        let shown = self.shown_at(start_s, sources);
        self.guide = guide;
        self.fade_from(shown, start_s, sources);
    }

    fn fade_from(&mut self, shown: Placement, start_s: f64, sources: &mut [Box<dyn Source>]) {
        let FadeOptions { hold_s, leave_s, return_s } = self.fade_options;
        let guide = self.guide_at(start_s, sources);
        self.fade = if self.guide.is_some() {
            Fade::start(shown, guide, start_s, return_s)
        } else {
            Fade::start(shown, guide, start_s + hold_s, leave_s)
        };
    }

    fn predicted(&mut self, time_s: f64, sources: &mut [Box<dyn Source>]) -> Predicted {
        self.shown_s = self.shown_s.max(time_s);
        let share = self.fade.share(time_s);
        let (confidence, presence) = match self.guide {
            Some(index) => {
                let confidence = self.channels[index].smooth().map_or(0.0, |p| p.confidence);
                let done = if share < 1.0 { Presence::Returning } else { Presence::Tracked };
                (confidence * share, done)
            }
            None if share < 1.0 => (1.0 - share, Presence::Leaving),
            None => (0.0, Presence::Absent),
        };
        Predicted { placement: self.shown_at(time_s, sources), confidence, presence }
    }
}

#[cfg(test)]
#[path = "tracker_tests.rs"]
mod tests;
