//! A running video source for the program: it never blocks and never fails to answer.

use std::convert::Infallible;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, TryLockError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::address::{Address, FilmKind};
use super::error::VideoError;
use super::frame::VideoFrame;
use super::http::HttpCamera;
use super::mjpeg::Mjpeg;
use super::png_folder::PngFolder;
use super::pump::{self, OpenReader, Play};
use super::reader::{OwnerWatch, Reader, Running};
use super::slot::{FrameSlot, PlaybackState, Stats};
#[cfg(target_os = "linux")]
use super::v4l2::V4l2Camera;
use super::y4m::Y4m;

/// Longest wait for the thread of a dropped source, which may be connecting.
const LAST_WAIT: Duration = Duration::from_millis(250);

/// Frames from a camera, a film or a phone, decoded on a separate thread that ends with this value.
#[derive(Debug)]
pub struct VideoSource {
    slot: Arc<Mutex<FrameSlot>>,
    /// The frame polled last.
    front: VideoFrame,
    state: PlaybackState,
    stats: Stats,
    /// Taken on drop, in this order: stop signal, end signal, thread.
    running: Option<Running>,
    finished: Receiver<Infallible>,
    thread: Option<JoinHandle<()>>,
}

impl VideoSource {
    /// Starts opening the source and returns at once; [`VideoSource::state`] tells the result.
    ///
    /// # Errors
    /// If no thread can be started, or this system has no such cameras.
    pub fn open(address: &Address) -> Result<VideoSource, VideoError> {
        let (subject, open, play): (String, OpenReader, Play) = match address.clone() {
            Address::Film(film) => (
                film.path.display().to_string(),
                Box::new(move |_: &OwnerWatch| -> Result<Box<dyn Reader>, VideoError> {
                    Ok(match film.kind {
                        FilmKind::Y4m => Box::new(Y4m::open(&film)?),
                        FilmKind::Mjpeg => Box::new(Mjpeg::open(&film)?),
                        FilmKind::PngFolder => Box::new(PngFolder::open(&film)?),
                    })
                }),
                Play::Film { repeat: matches!(address, Address::Film(film) if film.repeat) },
            ),
            Address::Http(url) => (
                url.to_string(),
                Box::new(move |stop: &OwnerWatch| -> Result<Box<dyn Reader>, VideoError> {
                    Ok(Box::new(HttpCamera::open(&url, stop)?))
                }),
                Play::CAMERA,
            ),
            #[cfg(target_os = "linux")]
            Address::Camera(camera) => (
                camera.device.display().to_string(),
                Box::new(move |_: &OwnerWatch| -> Result<Box<dyn Reader>, VideoError> {
                    Ok(Box::new(V4l2Camera::open(&camera)?))
                }),
                Play::CAMERA,
            ),
            #[cfg(not(target_os = "linux"))]
            Address::Camera(camera) => {
                let subject = camera.device.display().to_string();
                let problem = "cameras of this computer can only be used on Linux; use a video file or a phone's http:// address";
                return Err(VideoError::unsupported(subject, problem));
            }
        };
        VideoSource::start(subject, open, play)
    }

    /// Starts the thread with any reader.
    pub(super) fn start(
        subject: String,
        open: OpenReader,
        play: Play,
    ) -> Result<VideoSource, VideoError> {
        let slot = Arc::new(Mutex::new(FrameSlot::new()));
        let (running, stop) = OwnerWatch::new();
        let (finish, finished) = mpsc::channel();
        let (for_thread, name) = (Arc::clone(&slot), subject.clone());
        let thread = thread::Builder::new()
            .name("video".into())
            .spawn(move || {
                // Dropped at the end, in every case.
                let _finish = finish;
                pump::run(&subject, open, play, &for_thread, &stop);
            })
            .map_err(|error| VideoError::io(name, error))?;
        Ok(VideoSource {
            slot,
            front: VideoFrame::empty(),
            state: PlaybackState::Opening,
            stats: Stats::default(),
            running: Some(running),
            finished,
            thread: Some(thread),
        })
    }

    /// Returns the new frame, if one has come since the last call, without blocking. Also updates state and statistics.
    pub fn poll(&mut self) -> Option<&VideoFrame> {
        let mut slot = match self.slot.try_lock() {
            Ok(slot) => slot,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            // The thread is swapping a frame in; the next call gets it.
            Err(TryLockError::WouldBlock) => return None,
        };
        self.state = slot.state.clone();
        self.stats = slot.stats;
        let fresh = slot.take(&mut self.front);
        drop(slot);
        fresh.then_some(&self.front)
    }

    /// Returns the last frame of [`VideoSource::poll`], even after the camera is gone.
    pub fn frame(&self) -> Option<&VideoFrame> {
        (self.front.sequence > 0).then_some(&self.front)
    }

    /// Returns the state as of the last [`VideoSource::poll`].
    pub fn state(&self) -> &PlaybackState {
        &self.state
    }

    /// Returns the counters as of the last [`VideoSource::poll`].
    pub fn stats(&self) -> Stats {
        self.stats
    }
}

impl Drop for VideoSource {
    fn drop(&mut self) {
        self.running = None;
        // Wait, so that the camera is free when the next source opens it; a thread in a connect or a name lookup ends
        // by itself.
        let ended = self.finished.recv_timeout(LAST_WAIT) == Err(RecvTimeoutError::Disconnected);
        if let Some(thread) = self.thread.take().filter(|_| ended) {
            // Its panics have been turned into states.
            let _ = thread.join();
        }
    }
}
