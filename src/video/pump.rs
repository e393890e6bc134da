//! The decoding thread: films at their rate, camera frames as they arrive, and reconnection to lost cameras. Knows
//! readers only by their trait; puts frames and states into the slot.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::error::{VideoError, guarded};
use super::frame::VideoFrame;
use super::reader::{Decoded, Fetched, OwnerWatch, Reader};
use super::slot::{FrameSlot, PlaybackState, lock};

/// Opens a reader; called again after each loss of a camera.
pub type OpenReader = Box<dyn FnMut(&OwnerWatch) -> Result<Box<dyn Reader>, VideoError> + Send>;

/// The playback of a source.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Play {
    /// Frames are shown at their times.
    Film { repeat: bool },
    /// Frames are shown as they arrive. A camera that is gone or silent is tried again after `first_wait`, then after
    /// twice that, and so on up to `longest_wait`.
    Camera { silence: Duration, first_wait: Duration, longest_wait: Duration },
}

impl Play {
    pub const CAMERA: Play = Play::Camera {
        // Longer than cameras take for their first frame.
        silence: Duration::from_secs(5),
        first_wait: Duration::from_millis(250),
        longest_wait: Duration::from_secs(4),
    };
}

/// A film that is later than this continues from its present position without catching up (the computer slept, the disk
/// stalled).
const TOO_FAR_BEHIND: Duration = Duration::from_secs(1);
/// Longest time between shown frames of a film on a machine that is too slow.
const LONGEST_SKIP: Duration = Duration::from_millis(250);

/// The reason for the end of a session without an error.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SessionEnd {
    Stopped,
    Over,
}

/// Runs until the film ends or `stop` is signalled.
pub fn run(
    subject: &str,
    mut open: OpenReader,
    play: Play,
    slot: &Arc<Mutex<FrameSlot>>,
    stop: &OwnerWatch,
) {
    let mut pump = Pump { slot, stop, back: VideoFrame::empty(), sequence: 0 };
    let mut wait = Duration::ZERO;
    loop {
        let seen = pump.sequence;
        let error = match guarded(subject, || pump.session(subject, &mut open, play)) {
            Ok(SessionEnd::Stopped) => return,
            Ok(SessionEnd::Over) => return lock(slot).state = PlaybackState::Ended,
            Err(error) => Arc::new(error),
        };
        let Play::Camera { first_wait, longest_wait, .. } = play else {
            lock(slot).state = PlaybackState::Failed(error);
            return;
        };
        lock(slot).state = PlaybackState::Lost(error);
        let was_well = pump.sequence > seen;
        wait = if was_well { first_wait } else { (wait * 2).clamp(first_wait, longest_wait) };
        if stop.wait(wait) {
            return;
        }
    }
}

struct Pump<'a> {
    slot: &'a Mutex<FrameSlot>,
    stop: &'a OwnerWatch,
    /// The frame being written.
    back: VideoFrame,
    sequence: u64,
}

impl Pump<'_> {
    /// Runs from opening to the end or an error.
    fn session(
        &mut self,
        subject: &str,
        open: &mut OpenReader,
        play: Play,
    ) -> Result<SessionEnd, VideoError> {
        let mut reader = open(self.stop)?;
        lock(self.slot).stats.opened += 1;
        match play {
            Play::Film { repeat } => self.show_film(subject, &mut *reader, repeat),
            Play::Camera { silence, .. } => self.follow(subject, &mut *reader, silence),
        }
    }

    fn follow(
        &mut self,
        subject: &str,
        reader: &mut dyn Reader,
        silence: Duration,
    ) -> Result<SessionEnd, VideoError> {
        let mut last_good = Instant::now();
        let mut trouble = None;
        while !self.stop.asked() {
            match reader.fetch()? {
                Fetched::Picture { position, stale, broken } => {
                    let arrived = Instant::now();
                    self.count(stale, broken);
                    match reader.decode(&mut self.back)? {
                        Decoded::Whole => {
                            self.publish(arrived, position);
                            last_good = Instant::now();
                            trouble = None;
                        }
                        Decoded::Broken(error) => {
                            self.count(0, 1);
                            trouble = Some(error);
                        }
                    }
                }
                Fetched::Idle => {}
                Fetched::End => return Ok(SessionEnd::Over),
            }
            if last_good.elapsed() > silence {
                let seconds = silence.as_secs();
                return Err(
                    trouble.unwrap_or(VideoError::Silent { subject: subject.into(), seconds })
                );
            }
        }
        Ok(SessionEnd::Stopped)
    }

    fn show_film(
        &mut self,
        subject: &str,
        reader: &mut dyn Reader,
        repeat: bool,
    ) -> Result<SessionEnd, VideoError> {
        let mut start = Instant::now();
        let mut last_shown = start;
        let mut shown = 0_u64;
        let mut trouble = None;
        while !self.stop.asked() {
            let position = match reader.fetch()? {
                Fetched::Picture { position, stale, broken } => {
                    self.count(stale, broken);
                    position
                }
                Fetched::Idle => continue,
                Fetched::End if shown == 0 => {
                    return Err(trouble.unwrap_or_else(|| {
                        VideoError::malformed(subject, "the video contains no pictures")
                    }));
                }
                Fetched::End if !repeat => return Ok(SessionEnd::Over),
                Fetched::End => {
                    start += reader.rewind()?;
                    shown = 0;
                    continue;
                }
            };
            let mut due = start + position;
            let now = Instant::now();
            let behind = now.saturating_duration_since(due);
            if behind > TOO_FAR_BEHIND {
                start += behind;
                due = now;
            } else if !behind.is_zero() && now - last_shown < LONGEST_SKIP && shown > 0 {
                self.count(1, 0);
                continue;
            }
            match reader.decode(&mut self.back)? {
                Decoded::Whole => {}
                Decoded::Broken(error) => {
                    self.count(0, 1);
                    trouble = Some(error);
                    continue;
                }
            }
            if self.stop.wait(due.saturating_duration_since(Instant::now())) {
                break;
            }
            self.publish(due, position);
            last_shown = Instant::now();
            shown += 1;
        }
        Ok(SessionEnd::Stopped)
    }

    fn publish(&mut self, arrived: Instant, position: Duration) {
        self.sequence += 1;
        self.back.arrived = arrived;
        self.back.position = position;
        self.back.sequence = self.sequence;
        lock(self.slot).put(&mut self.back);
    }

    fn count(&self, stale: u64, broken: u64) {
        if stale + broken > 0 {
            let stats = &mut lock(self.slot).stats;
            stats.stale += stale;
            stats.broken += broken;
        }
    }
}
