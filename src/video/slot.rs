//! The slot for the newest decoded frame. Frames are swapped, never copied, so three buffers are
//! enough: the thread's, the slot's, and the reader's.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::error::VideoError;
use super::frame::VideoFrame;

/// The state of a source.
#[derive(Clone, Debug)]
pub enum PlaybackState {
    /// Being opened for the first time.
    Opening,
    /// Frames are coming.
    Live,
    /// The camera is gone or silent and is tried again; the last frame stays.
    Lost(Arc<VideoError>),
    /// The film has ended and does not repeat; the last frame stays.
    Ended,
    /// The film cannot be shown, or not any further; the last frame stays.
    Failed(Arc<VideoError>),
}

impl PlaybackState {
    /// Returns the reason for [`PlaybackState::Lost`] and [`PlaybackState::Failed`].
    pub fn error(&self) -> Option<&VideoError> {
        match self {
            PlaybackState::Lost(error) | PlaybackState::Failed(error) => Some(error),
            PlaybackState::Opening | PlaybackState::Live | PlaybackState::Ended => None,
        }
    }
}

/// Frame counters of a source.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Stats {
    /// Decoded in full.
    pub decoded: u64,
    /// Decoded, but replaced by a newer one before it was polled.
    pub unseen: u64,
    /// Skipped without decoding, because decoding was late.
    pub stale: u64,
    /// Skipped as damaged.
    pub broken: u64,
    /// Number of successful openings.
    pub opened: u64,
}

/// Shared by the decoding thread and the reader.
#[derive(Debug)]
pub struct FrameSlot {
    frame: VideoFrame,
    fresh: bool,
    pub state: PlaybackState,
    pub stats: Stats,
}

impl FrameSlot {
    pub fn new() -> FrameSlot {
        FrameSlot {
            frame: VideoFrame::empty(),
            fresh: false,
            state: PlaybackState::Opening,
            stats: Stats::default(),
        }
    }

    /// Swaps a frame in and an old one, for its allocation, out.
    pub fn put(&mut self, frame: &mut VideoFrame) {
        std::mem::swap(&mut self.frame, frame);
        self.stats.decoded += 1;
        self.stats.unseen += u64::from(self.fresh);
        self.fresh = true;
        self.state = PlaybackState::Live;
    }

    /// Swaps the newest frame out, leaving the reader's old one for its allocation. Returns false if none has come
    /// since the last call.
    pub fn take(&mut self, frame: &mut VideoFrame) -> bool {
        if self.fresh {
            std::mem::swap(&mut self.frame, frame);
            self.fresh = false;
            return true;
        }
        false
    }
}

/// Returns the slot, even if a thread panicked while holding it: every change to it is complete.
pub fn lock(slot: &Mutex<FrameSlot>) -> MutexGuard<'_, FrameSlot> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newest_frame_wins_and_three_buffers_serve() {
        let (mut slot, mut back, mut front) =
            (FrameSlot::new(), VideoFrame::empty(), VideoFrame::empty());
        assert!(!slot.take(&mut front));
        let mut buffers = std::collections::HashSet::new();
        for sequence in 1..=99 {
            back.shape(8, 8, "x").unwrap();
            back.sequence = sequence;
            buffers.insert(back.pixels.as_ptr());
            slot.put(&mut back);
            if sequence % 3 == 0 {
                assert!(slot.take(&mut front));
                assert_eq!(front.sequence, sequence);
                assert!(!slot.take(&mut front));
                assert_eq!(front.sequence, sequence);
            }
        }
        assert_eq!(buffers.len(), 3);
        assert_eq!(slot.stats, Stats { decoded: 99, unseen: 66, ..Stats::default() });
    }
}
