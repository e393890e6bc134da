//! Tests the decoding thread with scripted readers: pace, loss, return, panic.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{self, Sender};
use std::time::{Duration, Instant};

use super::error::VideoError;
use super::frame::VideoFrame;
use super::pump::{OpenReader, Play};
use super::reader::{Decoded, Fetched, OwnerWatch, Reader};
use super::slot::PlaybackState;
use super::source::VideoSource;

/// The action of a reader at one call of fetch (and the decode after it).
#[derive(Clone, Debug)]
enum Act {
    Give(u64),
    Broken,
    Idle,
    End,
    Fail,
    Panic,
}

struct Scripted {
    acts: VecDeque<Act>,
    all: Vec<Act>,
    now: Act,
}

fn failure() -> VideoError {
    VideoError::malformed("script", "as told")
}

impl Reader for Scripted {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        self.now = self.acts.pop_front().unwrap_or(Act::Idle);
        match self.now {
            Act::Give(ms) => {
                let position = Duration::from_millis(ms);
                Ok(Fetched::Picture { position, stale: 0, broken: 0 })
            }
            Act::Broken => Ok(Fetched::Picture { position: Duration::ZERO, stale: 0, broken: 0 }),
            Act::Idle => {
                std::thread::sleep(Duration::from_millis(1));
                Ok(Fetched::Idle)
            }
            Act::End => Ok(Fetched::End),
            Act::Fail => Err(failure()),
            Act::Panic => panic!("as told"),
        }
    }

    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
        if matches!(self.now, Act::Broken) {
            return Ok(Decoded::Broken(failure()));
        }
        frame.shape(2, 2, "script")?;
        Ok(Decoded::Whole)
    }

    fn rewind(&mut self) -> Result<Duration, VideoError> {
        self.acts = self.all.clone().into();
        let frames = self.all.iter().filter(|act| matches!(act, Act::Give(_))).count();
        Ok(Duration::from_millis(10) * frames as u32)
    }
}

/// Returns a source whose readers follow the scripts in turn; after the last one, opening fails. Each opening waits for
/// a message over the channel, so that the test can inspect the state before it.
fn source(scripts: &[&[Act]], play: Play) -> (VideoSource, Sender<()>) {
    let mut scripts: VecDeque<Vec<Act>> = scripts.iter().map(|acts| acts.to_vec()).collect();
    let (go, gate) = mpsc::channel();
    let open: OpenReader = Box::new(move |_: &OwnerWatch| {
        gate.recv().map_err(|_| failure())?;
        let all = scripts.pop_front().ok_or_else(failure)?;
        let reader: Box<dyn Reader> =
            Box::new(Scripted { acts: all.clone().into(), all, now: Act::Idle });
        Ok(reader)
    });
    go.send(()).unwrap();
    (VideoSource::start("script".into(), open, play).unwrap(), go)
}

const CAMERA: Play = Play::Camera {
    silence: Duration::from_millis(100),
    first_wait: Duration::from_millis(5),
    longest_wait: Duration::from_millis(20),
};

/// Polls until `done`, for at most a minute.
fn until(source: &mut VideoSource, done: impl Fn(&VideoSource) -> bool) {
    let start = Instant::now();
    while !done(source) {
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", source.state());
        std::thread::sleep(Duration::from_millis(1));
        source.poll();
    }
}

fn error_of(source: &VideoSource) -> String {
    source.state().error().map(ToString::to_string).unwrap_or_default()
}

#[test]
fn a_lost_camera_comes_back_and_its_last_frame_stays() {
    let scripts: [&[Act]; 2] = [&[Act::Give(0), Act::Fail], &[Act::Give(0), Act::Give(1)]];
    let (mut source, go) = source(&scripts, CAMERA);
    until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
    assert!(error_of(&source).contains("as told"));
    assert!(source.frame().is_some_and(|frame| frame.sequence == 1));
    go.send(()).unwrap();
    until(&mut source, |s| s.stats().decoded == 3);
    assert_eq!(source.stats().opened, 2);
    // Nothing more comes, and silence is a loss.
    until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
    assert!(error_of(&source).contains("no picture"));
    assert!(source.frame().is_some_and(|frame| frame.sequence == 3));
    // Opening fails from now on.
    drop(go);
    until(&mut source, |s| error_of(s).contains("as told"));
    assert!(source.frame().is_some_and(|frame| frame.sequence == 3));
}

#[test]
fn a_camera_is_sought_at_growing_intervals() {
    let (note, tries) = mpsc::channel();
    let open: OpenReader = Box::new(move |_: &OwnerWatch| {
        let _ = note.send(Instant::now());
        Err(failure())
    });
    let _source = VideoSource::start("script".into(), open, CAMERA).unwrap();
    let times: Vec<Instant> = tries.iter().take(6).collect();
    for (pair, least) in times.windows(2).zip([5, 10, 20, 20, 20]) {
        assert!(pair[1] - pair[0] >= Duration::from_millis(least));
    }
}

#[test]
fn a_panic_and_broken_pictures_are_losses_not_ends() {
    let scripts: [&[Act]; 3] = [&[Act::Panic], &[Act::Broken, Act::Broken], &[Act::Give(0)]];
    let (mut source, go) = source(&scripts, CAMERA);
    until(&mut source, |s| error_of(s).contains("has failed"));
    go.send(()).unwrap();
    until(&mut source, |s| error_of(s).contains("as told"));
    go.send(()).unwrap();
    until(&mut source, |s| matches!(s.state(), PlaybackState::Live));
    assert_eq!(source.stats().broken, 2);
}

#[test]
fn a_film_keeps_its_pace_and_repeats() {
    let film = [Act::Give(0), Act::Give(10), Act::Give(20), Act::End];
    let start = Instant::now();
    let (mut source, _) = source(&[&film], Play::Film { repeat: true });
    // Frames 1 to 3 of the first pass, 4 to 6 of the second; the 6th is due after 50 ms.
    until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence >= 6));
    assert!(start.elapsed() >= Duration::from_millis(50));
    let stats = source.stats();
    assert!(matches!(source.state(), PlaybackState::Live) && stats.opened == 1, "{stats:?}");
}

#[test]
fn a_film_ends_or_fails_and_keeps_its_last_frame() {
    let (mut ended, _) = source(&[&[Act::Give(0), Act::End]], Play::Film { repeat: false });
    until(&mut ended, |s| matches!(s.state(), PlaybackState::Ended));
    assert!(ended.frame().is_some());
    let (mut failed, _) = source(&[&[Act::Give(0), Act::Fail]], Play::Film { repeat: true });
    until(&mut failed, |s| matches!(s.state(), PlaybackState::Failed(_)));
    assert!(failed.frame().is_some() && failed.stats().opened == 1);
    for acts in [&[Act::End][..], &[Act::Broken, Act::End], &[Act::Panic]] {
        let (mut none, _) = source(&[acts], Play::Film { repeat: true });
        until(&mut none, |s| matches!(s.state(), PlaybackState::Failed(_)));
        assert!(none.frame().is_none());
    }
}

#[test]
fn a_slow_machine_drops_frames_and_not_time() {
    // 200 frames that were all due already: far fewer are decoded, and the last is reached.
    let film: Vec<Act> = (0..200).map(|_| Act::Give(0)).chain([Act::Give(150), Act::End]).collect();
    let (mut source, _) = source(&[&film], Play::Film { repeat: false });
    until(&mut source, |s| matches!(s.state(), PlaybackState::Ended));
    let stats = source.stats();
    assert!(stats.stale > 100 && stats.decoded + stats.stale == 201, "{stats:?}");
    assert_eq!(source.frame().map(|frame| frame.position), Some(Duration::from_millis(150)));
}

#[test]
fn dropping_a_source_stops_its_thread() {
    struct Noted {
        script: Scripted,
        _note: Arc<()>,
    }
    impl Reader for Noted {
        fn fetch(&mut self) -> Result<Fetched, VideoError> {
            self.script.fetch()
        }
        fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
            self.script.decode(frame)
        }
        fn rewind(&mut self) -> Result<Duration, VideoError> {
            self.script.rewind()
        }
    }
    let alive = Arc::new(());
    for play in [CAMERA, Play::Film { repeat: true }] {
        let note = Arc::clone(&alive);
        let open: OpenReader = Box::new(move |_: &OwnerWatch| {
            // A film whose next frame is due in an hour.
            let all = vec![Act::Give(0), Act::Give(3_600_000)];
            let script = Scripted { acts: all.clone().into(), all, now: Act::Idle };
            Ok(Box::new(Noted { script, _note: Arc::clone(&note) }) as Box<dyn Reader>)
        });
        let mut source = VideoSource::start("script".into(), open, play).unwrap();
        until(&mut source, |s| s.frame().is_some());
        drop(source);
        assert_eq!(Arc::strong_count(&alive), 1);
    }
}
