//! The video behind the sculpture: opens the person's source, takes the newest frame without waiting, and reports the
//! state of the camera.
//!
//! The last frame stays after its camera is gone, until the video is switched off. Knows no Vulkan.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::ar::CameraView;
use crate::notice::Notice;
use crate::video::{
    Address, Intrinsics, PlaybackState, Stats, VideoError, VideoFrame, VideoOptions, VideoSource,
};

/// Time between two looks for a new frame.
const LOOK_EVERY: Duration = Duration::from_millis(8);

/// The state of the video.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub enum VideoState {
    #[default]
    Off,
    Opening,
    Live,
    /// The camera is gone, and the program tries to reopen it.
    Lost(String),
    /// The film is over.
    Ended,
    Failed(String),
}

/// The state of the video, as the interface reads it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct VideoStatus {
    pub state: VideoState,
    /// Pixels of the last frame.
    pub size: Option<[u32; 2]>,
    pub stats: Stats,
}

/// The open video, if there is one.
#[derive(Default)]
pub struct VideoInput {
    source: Option<VideoSource>,
    /// The options at its opening: different options reopen it.
    opened: VideoOptions,
    lens: Option<Intrinsics>,
    frame: Option<Arc<VideoFrame>>,
    state: VideoState,
}

impl VideoInput {
    pub fn status(&self) -> VideoStatus {
        let size = self.frame.as_ref().map(|frame| [frame.width, frame.height]);
        let stats = self.source.as_ref().map(|source| source.stats()).unwrap_or_default();
        VideoStatus { state: self.state.clone(), size, stats }
    }

    /// Returns the time until the next look for a frame.
    pub fn repaint_after(&self) -> Option<Duration> {
        let moving = matches!(
            self.source.as_ref()?.state(),
            PlaybackState::Opening | PlaybackState::Live | PlaybackState::Lost(_)
        );
        moving.then_some(LOOK_EVERY)
    }

    fn open(&mut self, settings: &VideoOptions) -> Result<(), String> {
        // The old camera is free before the new one is opened: it may be the same.
        *self = VideoInput { opened: settings.clone(), ..VideoInput::default() };
        if !settings.lens.as_os_str().is_empty() {
            self.lens = Some(read_lens(&settings.lens)?);
        }
        let address = match settings.source.trim() {
            "" => first_camera()?,
            text => text.parse().map_err(|error: VideoError| error.to_string())?,
        };
        self.source = Some(VideoSource::open(&address).map_err(|error| error.to_string())?);
        self.state = VideoState::Opening;
        Ok(())
    }

    /// Takes the new state and frame. Returns a notice for the person.
    fn poll(&mut self) -> Option<Notice> {
        let source = self.source.as_mut()?;
        if let Some(frame) = source.poll() {
            self.frame = Some(Arc::new(frame.clone()));
        }
        let state = match source.state() {
            PlaybackState::Opening => VideoState::Opening,
            PlaybackState::Live => VideoState::Live,
            PlaybackState::Ended => VideoState::Ended,
            PlaybackState::Lost(error) => VideoState::Lost(error.to_string()),
            PlaybackState::Failed(error) => VideoState::Failed(error.to_string()),
        };
        if state == self.state {
            return None;
        }
        let before = std::mem::replace(&mut self.state, state);
        match (&before, &self.state) {
            (VideoState::Lost(_), VideoState::Live) => Some(Notice::note("The camera is back")),
            // A camera being reopened reports the same in varying words.
            (VideoState::Lost(_), VideoState::Lost(_)) => None,
            (_, VideoState::Lost(error)) => {
                let text =
                    "The camera has been disconnected; its last picture stays until it is back";
                Some(Notice::error(format!("{text}: {error}")))
            }
            (_, VideoState::Failed(error)) => {
                Some(Notice::error(format!("The video has stopped: {error}")))
            }
            _ => None,
        }
    }

    /// Opens and closes the camera as requested. Returns its newest frame with its placement on the screen, and a
    /// notice for the person.
    pub fn follow(
        &mut self,
        settings: &VideoOptions,
        wished: bool,
    ) -> (Option<(Arc<VideoFrame>, CameraView)>, Option<Notice>) {
        if !wished {
            if self.source.is_some() || self.frame.is_some() {
                *self = VideoInput::default();
            }
            return (None, None);
        }
        let settings = VideoOptions { on: true, ..settings.clone() };
        let same = |a: &VideoOptions, b: &VideoOptions| {
            (&a.source, &a.lens, a.on) == (&b.source, &b.lens, b.on)
        };
        let mut notice = None;
        if !same(&self.opened, &settings)
            && let Err(error) = self.open(&settings)
        {
            notice = Some(Notice::error(format!("No video: {error}")));
            self.state = VideoState::Failed(error);
        }
        let notice = self.poll().or(notice);
        let look = CameraView { lens: self.lens, fit: settings.fit, mirror: settings.mirror };
        (self.frame.clone().map(|frame| (frame, look)), notice)
    }

    /// Returns the newest frame.
    pub fn frame(&self) -> Option<&Arc<VideoFrame>> {
        self.frame.as_ref()
    }

    pub fn lens(&self) -> Option<Intrinsics> {
        self.lens
    }

    pub fn state(&self) -> &VideoState {
        &self.state
    }

    /// Returns whether a camera or film is open.
    pub fn is_open(&self) -> bool {
        self.source.is_some()
    }
}

fn read_lens(path: &Path) -> Result<Intrinsics, String> {
    let name = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|error| format!("the lens file {name} cannot be read: {error}"))?;
    Intrinsics::parse(&text)
        .map_err(|error| format!("the lens file {name} cannot be used: {error}"))
}

#[cfg(target_os = "linux")]
fn first_camera() -> Result<Address, String> {
    let cameras = crate::video::cameras().map_err(|error| error.to_string())?;
    let first = cameras.first().ok_or(
        "this computer has no camera; enter a video file, a folder of PNGs or a phone's http:// address",
    )?;
    format!("v4l2:{}", first.device.display())
        .parse()
        .map_err(|error: VideoError| error.to_string())
}

#[cfg(not(target_os = "linux"))]
fn first_camera() -> Result<Address, String> {
    Err("enter a video file, a folder of PNGs or a phone's http:// address".to_string())
}
