//! The interface of all video sources towards the decoding thread, and the signal that stops that
//! thread.

use std::convert::Infallible;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::time::Duration;

use super::error::VideoError;
use super::frame::VideoFrame;

/// The result of a fetch.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Fetched {
    /// The reader has a compressed or raw picture to decode.
    Picture {
        /// Position in the film, or time since the camera was opened.
        position: Duration,
        /// Pictures skipped because a newer one had arrived already.
        stale: u64,
        /// Pictures skipped because they were damaged.
        broken: u64,
    },
    /// Nothing yet; fetch again.
    Idle,
    /// The film has ended.
    End,
}

/// The result of decoding a fetched picture.
#[derive(Debug)]
pub enum Decoded {
    Whole,
    /// Damaged; the next one may be better.
    Broken(VideoError),
}

/// An opened film or camera. Fetching and decoding are separate, so that late pictures need not be decoded.
pub trait Reader {
    /// Fetches the next picture, or of a camera the newest. Waits a tenth of a second at most. After an error the
    /// reader is unusable.
    fn fetch(&mut self) -> Result<Fetched, VideoError>;

    /// Decodes the fetched picture into `frame`, resizing it. After an error the reader is unusable.
    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError>;

    /// Returns to the first picture of a film. Returns the played length.
    fn rewind(&mut self) -> Result<Duration, VideoError>;
}

/// Longest wait of [`Reader::fetch`].
pub const FETCH_WAIT: Duration = Duration::from_millis(100);

/// Held by the decoding thread: detects that the owner of the source is gone.
#[derive(Debug)]
pub struct OwnerWatch(Receiver<Infallible>);

/// Held by the owner: dropping it stops the thread.
#[derive(Debug)]
pub struct Running {
    _alive: Sender<Infallible>,
}

impl OwnerWatch {
    pub fn new() -> (Running, OwnerWatch) {
        let (alive, stop) = mpsc::channel();
        (Running { _alive: alive }, OwnerWatch(stop))
    }

    pub fn asked(&self) -> bool {
        matches!(self.0.try_recv(), Err(TryRecvError::Disconnected))
    }

    /// Sleeps. Returns true without delay if the thread must stop.
    pub fn wait(&self, time: Duration) -> bool {
        matches!(self.0.recv_timeout(time), Err(RecvTimeoutError::Disconnected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stop_wakes_a_sleeper() {
        let (running, stop) = OwnerWatch::new();
        assert!(!stop.asked());
        assert!(!stop.wait(Duration::from_millis(1)));
        let sleeper = std::thread::spawn(move || stop.wait(Duration::from_secs(3600)));
        drop(running);
        assert!(sleeper.join().unwrap());
    }
}
