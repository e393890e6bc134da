//! The program in a headset: connecting, connecting again, and the frames of the XR session.
//!
//! The headset has a device and a renderer of its own; both it and the window show the sculpture of the same workspace.
//! The workspace and the window go on, whatever happens to the runtime.

mod board_pane;
mod board_panel;
mod board_ui;
mod connect;
mod eye_screenshots;
mod frame_loop;
mod haptics;
mod health;
mod overlay;
mod placement;
pub mod standalone;

#[cfg(test)]
mod hands_tests;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::workspace::Workspace;
use crate::gpu::{DeviceOptions, ValidationLog};
use crate::screen::headset::{HeadsetError, HeadsetOptions, XrEvent};

pub use connect::Connection;
use connect::{ConnectAttempts, SessionStart};
use eye_screenshots::EyeScreenshots;
use frame_loop::XrFrameLoop;

/// Time between two attempts to connect.
const RETRY: Duration = Duration::from_secs(2);
/// Longest time between two attempts with a device that lacks memory.
const MAX_RETRY: Duration = Duration::from_secs(64);
/// Time between two checks that a runtime answers.
const POLL: Duration = Duration::from_millis(100);

/// A session with a headset, or the attempts to begin one.
pub struct Headset {
    state: HeadsetConnection,
    attempts: ConnectAttempts,
    retry: RetryDelay,
    screenshots: Option<EyeScreenshots>,
    started: Instant,
    /// The sculpture has been placed in a room.
    placed: bool,
    /// Messages of the validation layers in sessions that have ended.
    validation_messages: usize,
}

enum HeadsetConnection {
    Disconnected {
        retry_at: Instant,
    },
    Connecting,
    Connected(Box<XrFrameLoop>),
    /// The runtime has ended the program in the headset at the person's request.
    Exited,
}

impl Headset {
    /// Creates the headset. `send` is called on another thread with events for [`Headset::handle`], and returns whether
    /// they are still wanted. `screenshots`: a folder for pictures of the eyes' views.
    pub fn new(
        settings: &HeadsetOptions,
        device: DeviceOptions,
        screenshots: Option<PathBuf>,
        send: impl Fn(Connection, XrEvent) -> bool + Send + Sync + 'static,
    ) -> Headset {
        let started = Instant::now();
        let options = settings.session(device);
        Headset {
            state: HeadsetConnection::Disconnected { retry_at: started },
            attempts: ConnectAttempts::new(settings.clone(), options, Arc::new(send)),
            retry: RetryDelay::default(),
            screenshots: screenshots.map(EyeScreenshots::new),
            started,
            placed: false,
            validation_messages: 0,
        }
    }

    /// Connects when it is time, and checks that the runtime answers. Returns the latest time for the next call; `None`
    /// once the person has exited.
    pub fn poll(&mut self, workspace: &mut Workspace) -> Option<Instant> {
        let now = Instant::now();
        if let HeadsetConnection::Disconnected { retry_at } = self.state
            && now >= retry_at
        {
            self.connect(workspace);
        }
        self.take_result(workspace);
        if let HeadsetConnection::Connected(frames) = &mut self.state
            && frames.becomes_unresponsive(workspace)
        {
            let text = "The headset's runtime does not respond";
            tracing::warn!("{text}");
            workspace.ui.toasts.error(text);
        }
        match &self.state {
            HeadsetConnection::Disconnected { retry_at } => Some(*retry_at),
            HeadsetConnection::Connecting | HeadsetConnection::Connected(_) => Some(now + POLL),
            HeadsetConnection::Exited => None,
        }
    }

    /// Handles an event of a connection; processes the frame that has begun.
    pub fn handle(&mut self, workspace: &mut Workspace, connection: Connection, event: XrEvent) {
        if connection != self.attempts.connection() {
            return;
        }
        let now_s = self.started.elapsed().as_secs_f64();
        let HeadsetConnection::Connected(frames) = &mut self.state else { return };
        match event {
            XrEvent::Frame(frame) => {
                let result = frames.frame(workspace, &frame, &mut self.screenshots, now_s);
                if let Err(error) = result {
                    self.lose(workspace, &error);
                }
            }
            XrEvent::Recentred => frames.recentre(),
            XrEvent::Ended { retry: true } => {
                self.lose(workspace, &HeadsetError::Lost("the runtime is closing"));
            }
            XrEvent::Ended { retry: false } => {
                self.disconnect(workspace);
                let text = "The headset session has ended; start the program with --headset to return to it";
                tracing::info!("{text}");
                workspace.ui.toasts.note(text);
            }
            XrEvent::Failed(error) => self.lose(workspace, &error),
            // `poll` takes the result.
            XrEvent::ConnectFinished => {}
        }
    }

    /// Returns whether pictures are visible in the headset.
    pub fn is_showing(&self) -> bool {
        matches!(&self.state, HeadsetConnection::Connected(frames) if frames.is_showing())
    }

    /// Returns whether the person has exited the program in the headset.
    pub fn has_exited(&self) -> bool {
        matches!(self.state, HeadsetConnection::Exited)
    }

    /// Returns the number of messages of the validation layers so far.
    pub fn validation_messages(&self) -> usize {
        let count = |log: Arc<ValidationLog>| log.messages().len();
        match &self.state {
            HeadsetConnection::Connected(frames) => {
                self.validation_messages + count(frames.validation_log())
            }
            _ => self.validation_messages,
        }
    }

    /// Begins an attempt to connect.
    fn connect(&mut self, workspace: &mut Workspace) {
        let start = SessionStart {
            blend: workspace.ui.headset.blend,
            placed: self.placed,
            head: workspace.viewpoint.head.session_head().cloned(),
            view: workspace.ui.view.clone(),
            depth: workspace.session().document().material().depth(),
        };
        match self.attempts.begin(start) {
            Ok(()) => self.state = HeadsetConnection::Connecting,
            Err(error) => self.lose(workspace, &error),
        }
    }

    /// Takes the result of the attempt to connect.
    fn take_result(&mut self, workspace: &mut Workspace) {
        if !matches!(self.state, HeadsetConnection::Connecting) {
            return;
        }
        match self.attempts.take_result() {
            Some(Ok(frames)) => {
                let text = format!("Headset connected: {}", frames.name());
                tracing::info!("{text}");
                workspace.ui.toasts.note(text);
                self.retry.note_success();
                workspace.display.blends = frames.blends();
                workspace.ui.view.suit_device(frames.is_software());
                self.state = HeadsetConnection::Connected(frames);
            }
            Some(Err(error)) => self.lose(workspace, &error),
            None => {}
        }
    }

    /// Ends the session, if there is one, reports why there is none, and tries again later.
    fn lose(&mut self, workspace: &mut Workspace, error: &HeadsetError) {
        self.disconnect(workspace);
        if self.retry.note_failure(error) {
            let (reason, delay) = (&self.retry.reported, self.retry.delay);
            tracing::warn!("no headset: {reason}; trying again every {delay:?}");
            workspace.ui.toasts.error(format!("No headset: {reason}. Still looking for one."));
        }
        self.state =
            HeadsetConnection::Disconnected { retry_at: Instant::now() + self.retry.delay };
    }

    /// Ends the actions of the hands, and the session.
    fn disconnect(&mut self, workspace: &mut Workspace) {
        if let HeadsetConnection::Connected(mut frames) =
            std::mem::replace(&mut self.state, HeadsetConnection::Exited)
        {
            frames.release_hands(workspace);
            workspace.display.blends.clear();
            self.placed |= frames.is_placed();
            let log = frames.validation_log();
            drop(frames);
            self.validation_messages += log.messages().len();
        }
    }
}

/// The time of the next attempt, and the reason that has been reported.
struct RetryDelay {
    delay: Duration,
    /// The reason reported last. Each reason is reported once.
    reported: String,
}

impl Default for RetryDelay {
    fn default() -> Self {
        RetryDelay { delay: RETRY, reported: String::new() }
    }
}

impl RetryDelay {
    fn note_success(&mut self) {
        self.reported.clear();
    }

    /// Sets the delay. Returns true if the error should be reported. The delay grows for a device that lacks memory,
    /// since memory does not return at once.
    fn note_failure(&mut self, error: &HeadsetError) -> bool {
        self.delay = match error {
            HeadsetError::Gpu(_) => (self.delay * 2).min(MAX_RETRY),
            _ => RETRY,
        };
        let reason = error.to_string();
        let is_new = self.reported != reason;
        self.reported = reason;
        is_new
    }
}
