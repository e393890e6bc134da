//! Owns what all sources of pictures have in common, seen from the decoding thread, and the sign
//! by which that thread is told to stop.

use std::convert::Infallible;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::time::Duration;

use super::error::VideoError;
use super::frame::Frame;

/// What a fetch brought.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Fetched {
    /// A compressed or raw picture lies in the reader, ready to be decoded.
    Picture {
        /// Place in the film, or time since the camera was opened.
        position: Duration,
        /// Pictures passed over because a newer one had come already.
        stale: u64,
        /// Pictures passed over because they were damaged.
        broken: u64,
    },
    /// Nothing yet; ask again.
    Idle,
    /// The film is over.
    End,
}

/// What became of a fetched picture.
#[derive(Debug)]
pub enum Decoded {
    Whole,
    /// Damaged; the next may be better.
    Broken(VideoError),
}

/// An opened film or camera. Fetching and decoding are apart so that what comes too late is not
/// decoded at all.
pub trait Reader {
    /// Brings the next picture; of a camera the newest. Waits a tenth of a second at most where
    /// nothing comes. An error means that the reader is of no more use.
    fn fetch(&mut self) -> Result<Fetched, VideoError>;

    /// Writes the fetched picture into size and pixels of `frame`. An error means that there is no
    /// use in going on.
    fn decode(&mut self, frame: &mut Frame) -> Result<Decoded, VideoError>;

    /// Back to the first picture of a film. Gives the length of what was played.
    fn rewind(&mut self) -> Result<Duration, VideoError>;
}

/// How long [`Reader::fetch`] may wait where nothing comes.
pub const FETCH_WAIT: Duration = Duration::from_millis(100);

/// Held by the decoding thread: says when the owner of the source is gone.
#[derive(Debug)]
pub struct Stop(Receiver<Infallible>);

/// Held by the owner: dropping it stops the thread.
#[derive(Debug)]
pub struct Running {
    _alive: Sender<Infallible>,
}

impl Stop {
    pub fn new() -> (Running, Stop) {
        let (alive, stop) = mpsc::channel();
        (Running { _alive: alive }, Stop(stop))
    }

    pub fn asked(&self) -> bool {
        matches!(self.0.try_recv(), Err(TryRecvError::Disconnected))
    }

    /// Sleeps; true if the thread must stop, and then at once.
    pub fn wait(&self, time: Duration) -> bool {
        matches!(self.0.recv_timeout(time), Err(RecvTimeoutError::Disconnected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stop_wakes_a_sleeper() {
        let (running, stop) = Stop::new();
        assert!(!stop.asked());
        assert!(!stop.wait(Duration::from_millis(1)));
        let sleeper = std::thread::spawn(move || stop.wait(Duration::from_secs(3600)));
        drop(running);
        assert!(sleeper.join().unwrap());
    }
}
