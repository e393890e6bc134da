//! Owns the video picture behind the sculpture: opens what the person names, takes the newest
//! frame without ever waiting for it, and says what becomes of the camera.
//!
//! A frame stays when its camera is gone, until the video is switched off. Knows no Vulkan.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::ar::Look;
use super::workspace::Workspace;
use crate::ui::video::{VideoState, VideoStatus};
use crate::video::{Address, Frame, Intrinsics, State, VideoError, VideoOptions, VideoSource};

/// Between two looks for a new frame.
const LOOK_EVERY: Duration = Duration::from_millis(8);

/// What is opened, if anything is.
#[derive(Default)]
pub struct Camera {
    source: Option<VideoSource>,
    /// What was asked for when it was opened: another wish opens it anew.
    opened: VideoOptions,
    lens: Option<Intrinsics>,
    frame: Option<Arc<Frame>>,
    state: VideoState,
}

impl Camera {
    pub(super) fn status(&self) -> VideoStatus {
        let size = self.frame.as_ref().map(|frame| [frame.width, frame.height]);
        let stats = self.source.as_ref().map(|source| source.stats()).unwrap_or_default();
        VideoStatus { state: self.state.clone(), size, stats }
    }

    /// How soon to look for another frame.
    pub(super) fn repaint_after(&self) -> Option<Duration> {
        let moving =
            matches!(self.source.as_ref()?.state(), State::Opening | State::Live | State::Lost(_));
        moving.then_some(LOOK_EVERY)
    }

    fn open(&mut self, settings: &VideoOptions) -> Result<(), String> {
        // The old camera is free before the new one is opened: it may be the same.
        *self = Camera { opened: settings.clone(), ..Camera::default() };
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

    /// Takes what has come; gives what is to be said about it.
    fn poll(&mut self) -> Option<News> {
        let source = self.source.as_mut()?;
        if let Some(frame) = source.poll() {
            self.frame = Some(Arc::new(frame.clone()));
        }
        let state = match source.state() {
            State::Opening => VideoState::Opening,
            State::Live => VideoState::Live,
            State::Ended => VideoState::Ended,
            State::Lost(error) => VideoState::Lost(error.to_string()),
            State::Failed(error) => VideoState::Failed(error.to_string()),
        };
        if state == self.state {
            return None;
        }
        let before = std::mem::replace(&mut self.state, state);
        match (&before, &self.state) {
            (VideoState::Lost(_), VideoState::Live) => Some(News::Back),
            // A camera that is looked for says the same in other words now and then.
            (VideoState::Lost(_), VideoState::Lost(_)) => None,
            (_, VideoState::Lost(error)) => Some(News::Lost(error.clone())),
            (_, VideoState::Failed(error)) => Some(News::Failed(error.clone())),
            _ => None,
        }
    }
}

enum News {
    Lost(String),
    Back,
    Failed(String),
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

impl Workspace {
    /// Opens and closes the camera as is wished, and takes its newest frame.
    pub(super) fn follow_camera(&mut self) {
        // The marker is looked for in the video.
        let wished = self.ui.view.video.on || self.ar_is_on();
        if !wished {
            if self.camera.source.is_some() || self.camera.frame.is_some() {
                self.camera = Camera::default();
            }
            return;
        }
        let settings = VideoOptions { on: true, ..self.ui.view.video.clone() };
        let same = |a: &VideoOptions, b: &VideoOptions| {
            (&a.source, &a.lens, a.on) == (&b.source, &b.lens, b.on)
        };
        if !same(&self.camera.opened, &settings)
            && let Err(error) = self.camera.open(&settings)
        {
            self.camera.state = VideoState::Failed(error.clone());
            self.ui.toasts.error(format!("No video: {error}"));
        }
        match self.camera.poll() {
            Some(News::Lost(error)) => {
                let text =
                    "The camera has been disconnected; its last picture stays until it is back";
                self.ui.toasts.error(format!("{text}: {error}"));
            }
            Some(News::Back) => self.ui.toasts.note("The camera is back"),
            Some(News::Failed(error)) => {
                self.ui.toasts.error(format!("The video has stopped: {error}"))
            }
            None => {}
        }
        if let Some(frame) = self.camera.frame.clone() {
            let look = Look { lens: self.camera.lens, fit: settings.fit, mirror: settings.mirror };
            self.see(&frame, look);
        }
    }

    /// The frame to be shown behind the sculpture, and its lens: the one that the eye belongs to,
    /// or the newest.
    pub fn video(&self) -> Option<(&Arc<Frame>, Option<Intrinsics>)> {
        let wished = self.ui.view.video.on || self.ar_is_on();
        let frame = self.ar_frame().or(self.camera.frame.as_ref()).filter(|_| wished)?;
        Some((frame, self.camera.lens))
    }
}

#[cfg(test)]
#[path = "camera_tests.rs"]
mod tests;
