//! Owns the wait for the headset's next frame, on a thread of its own, so that windows go on
//! meanwhile.
//!
//! One frame is waited for at a time and only when it is asked for: a frame that cannot be made
//! in time is left out by the runtime, and none queues up.

use std::sync::mpsc::{Sender, channel};

use openxr as xr;

use super::error::{Doing, HeadsetError, Result};
use super::parting::Helper;

/// A frame that may be made now.
#[derive(Clone, Copy, Debug)]
pub struct FrameTime {
    /// When it will be seen, on the runtime's clock.
    pub(super) display: xr::Time,
    /// Whether anybody would see it.
    pub shown: bool,
}

impl FrameTime {
    /// When it will be seen, in seconds of a steady clock.
    pub fn seconds(&self) -> f64 {
        self.display.as_nanos() as f64 * 1e-9
    }
}

/// What the wait has led to.
pub type FrameNews = Result<FrameTime>;

/// The thread that waits.
pub(super) struct Waiter {
    /// None once the thread is to end.
    asks: Option<Sender<()>>,
    thread: Helper,
    /// A frame has been asked for and not been used.
    asked: bool,
}

impl Waiter {
    /// `tell` is called on the thread with each frame; it says whether anybody still listens.
    pub fn new(
        mut frames: xr::FrameWaiter,
        tell: impl Fn(FrameNews) -> bool + Send + 'static,
    ) -> Result<Waiter> {
        let (asks, heard) = channel();
        let wait = move || {
            while heard.recv().is_ok() {
                let news = frames.wait().doing("wait for the next frame").map(|state| FrameTime {
                    display: state.predicted_display_time,
                    shown: state.should_render,
                });
                if !tell(news) {
                    return;
                }
            }
        };
        let thread = Helper::start("headset frames", wait).map_err(HeadsetError::Thread)?;
        Ok(Waiter { asks: Some(asks), thread, asked: false })
    }

    /// Asks for the next frame, unless one is under way.
    pub fn ask(&mut self) {
        if !std::mem::replace(&mut self.asked, true)
            && let Some(asks) = &self.asks
            && asks.send(()).is_err()
        {
            tracing::debug!("the thread that waits for frames has ended");
        }
    }

    /// The frame that was told of is used now.
    pub fn used(&mut self) {
        self.asked = false;
    }

    /// Whether a frame is on its way.
    pub fn is_waiting(&self) -> bool {
        self.asked
    }
}

impl Drop for Waiter {
    fn drop(&mut self) {
        self.asks = None;
        // It has the session, too, and may keep it for as long as it is held up.
        self.thread.part();
    }
}
