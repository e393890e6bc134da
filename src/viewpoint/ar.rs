//! The sculpture on a printed marker: a thread that searches frames of a camera for the marker, and the camera's eye
//! while the sculpture stands on it.
//!
//! Frames come in as values; the newest wins. The eye belongs to the last searched frame ([`Ar::frame`]), which must be
//! shown behind the sculpture. A lost marker is held for a moment, then the sculpture moves to a place before the
//! camera.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use glam::{Affine3A, DQuat, DVec3, UVec2, Vec3};
use tracking::Placement;
use tracking::fade::{Fade, FadeOptions};

use crate::fiducial::{ArOptions, Grey, MarkerPose, detect, poses};
use crate::video::{Fit, Framing, Intrinsics, MarkerPlacement, VideoFrame};
use crate::view::Eye;

/// The marker is lost after so long without it, in seconds.
const LOST_AFTER_S: f64 = 0.3;
const FADE: FadeOptions = FadeOptions { hold_s: 0.7, leave_s: 1.5, return_s: 0.3 };
/// Distance of the near plane from the camera, in metres.
const NEAREST_M: f32 = 0.01;
/// Time between two looks at the thread's results.
const LOOK_EVERY: Duration = Duration::from_millis(8);
/// A reading of the marker whose error exceeds the other one's by this, in pixels, is rejected.
const AMBIGUOUS_PX: f64 = 0.4;
/// Factor on the size for one notch of the wheel.
const GROWTH_PER_NOTCH: f32 = 1.1;

/// The display of the camera's picture on the screen.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CameraView {
    /// The camera's lens, if it has been measured.
    pub lens: Option<Intrinsics>,
    pub fit: Fit,
    pub mirror: bool,
}

/// A searched frame.
struct Searched {
    frame: Arc<VideoFrame>,
    /// Scaled to the size of the frame.
    lens: Intrinsics,
    /// The readings of the marker, better first; empty if it was not found.
    found: Vec<MarkerPose>,
}

/// The state shared by the finder's thread and [`Ar`].
#[derive(Default)]
struct FinderState {
    next: Option<(Arc<VideoFrame>, Intrinsics)>,
    done: Option<Searched>,
    stop: bool,
}

/// Searches for a marker on a thread of its own.
struct Finder {
    shared: Arc<(Mutex<FinderState>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

fn lock(state: &Mutex<FinderState>) -> MutexGuard<'_, FinderState> {
    // Always consistent, so a panic elsewhere does not matter.
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Finder {
    fn start(id: u32, size_m: f64) -> std::io::Result<Finder> {
        let shared = Arc::new((Mutex::new(FinderState::default()), Condvar::new()));
        let theirs = shared.clone();
        let work = move || {
            let (state, news) = &*theirs;
            loop {
                let idle = |state: &mut FinderState| state.next.is_none() && !state.stop;
                let waited = news.wait_while(lock(state), idle);
                let mut held = waited.unwrap_or_else(PoisonError::into_inner);
                if held.stop {
                    return;
                }
                let Some((frame, lens)) = held.next.take() else { continue };
                drop(held);
                let grey = Grey::from_rgba(frame.width, frame.height, &frame.pixels);
                let seen = detect(&grey, &lens).into_iter().find(|sighting| sighting.id == id);
                let found = seen.map_or(Vec::new(), |s| poses(&s.corners, size_m, lens.fx));
                lock(state).done = Some(Searched { frame, lens, found });
            }
        };
        let thread = std::thread::Builder::new().name("marker".to_owned()).spawn(work)?;
        Ok(Finder { shared, thread: Some(thread) })
    }

    fn give(&self, frame: Arc<VideoFrame>, lens: Intrinsics) {
        let (state, news) = &*self.shared;
        lock(state).next = Some((frame, lens));
        news.notify_one();
    }

    fn take(&self) -> Option<Searched> {
        lock(&self.shared.0).done.take()
    }
}

impl Drop for Finder {
    fn drop(&mut self) {
        let (state, news) = &*self.shared;
        lock(state).stop = true;
        news.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has been reported by its thread.
            let _ = thread.join();
        }
    }
}

/// The state of the printed marker, as the interface reads it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ArStatus {
    /// The sculpture stands on the marker.
    pub on: bool,
    /// Frames come from a camera.
    pub video: bool,
    /// The marker is in the picture.
    pub seen: bool,
    /// Its number.
    pub marker: u32,
    /// Size of a voxel on the table.
    pub voxel_mm: f32,
}

/// The marker and the camera before it.
pub struct Ar {
    settings: ArOptions,
    /// `None` unless the sculpture stands on the marker.
    finder: Option<Finder>,
    /// The number of the last given frame.
    given: Option<u64>,
    look: CameraView,
    shown: Option<(Arc<VideoFrame>, Intrinsics)>,
    /// The last pose of the marker, and its time.
    seen: Option<(Placement, f64)>,
    live: bool,
    fade: Fade,
    now_s: f64,
}

/// Returns the assumed pose of an unseen marker: on a table before the camera.
pub fn rest() -> Placement {
    Placement {
        position_m: DVec3::new(0.0, -0.06, -0.45),
        orientation: DQuat::from_rotation_x(-55f64.to_radians()),
    }
}

impl Ar {
    pub fn new(settings: &ArOptions) -> Ar {
        Ar {
            settings: settings.clone(),
            finder: None,
            given: None,
            look: CameraView { lens: None, fit: Fit::Fill, mirror: false },
            shown: None,
            seen: None,
            live: false,
            fade: Fade::DONE,
            now_s: 0.0,
        }
    }

    pub fn is_on(&self) -> bool {
        self.finder.is_some()
    }

    /// Returns whether it is enabled at the start.
    pub fn wanted(&self) -> bool {
        self.settings.on
    }

    /// Puts the sculpture on the marker from now on.
    pub fn start(&mut self) -> std::io::Result<()> {
        let ArOptions { marker, marker_mm, .. } = self.settings;
        self.finder = Some(Finder::start(marker, marker_mm * 1e-3)?);
        Ok(())
    }

    pub fn stop(&mut self) {
        (self.finder, self.given, self.shown, self.seen) = (None, None, None, None);
        (self.live, self.fade) = (false, Fade::DONE);
    }

    fn guide(&self) -> Placement {
        match self.seen {
            Some((placement, _)) if self.live => placement,
            _ => rest(),
        }
    }

    /// Returns the assumed pose of the marker, relative to the camera.
    pub fn placement(&self) -> Placement {
        self.fade.place(self.guide(), self.now_s)
    }

    /// Returns the position of the camera relative to the marker, in metres, while the marker is tracked.
    pub fn camera_position_m(&self) -> Option<Vec3> {
        let tracked = self.is_on() && self.live && self.shown.is_some();
        let Placement { position_m, orientation } = self.placement();
        tracked.then(|| (orientation.inverse() * -position_m).as_vec3())
    }

    /// Takes the results of the search, and decides whether the marker is there.
    pub fn update(&mut self, now_s: f64) {
        let before = self.placement();
        let was_live = self.live;
        self.now_s = now_s;
        if let Some(Searched { frame, lens, found }) = self.finder.as_ref().and_then(Finder::take) {
            if let Some(pose) = self.likely(&found) {
                let orientation = pose.rotation;
                self.seen =
                    Some((Placement { position_m: pose.translation_m, orientation }, now_s));
            }
            self.shown = Some((frame, lens));
        }
        self.live = self.seen.is_some_and(|(_, seen_s)| now_s - seen_s <= LOST_AFTER_S);
        if self.live != was_live {
            let (start_s, length_s) = match self.live {
                true => (now_s, FADE.return_s),
                false => (now_s + FADE.hold_s, FADE.leave_s),
            };
            self.fade = Fade::start(before, self.guide(), start_s, length_s);
        }
    }

    /// Returns the reading nearer to the last one, out of two equally good ones.
    fn likely(&self, found: &[MarkerPose]) -> Option<MarkerPose> {
        let sound =
            |pose: &&MarkerPose| pose.translation_m.is_finite() && pose.rotation.is_finite();
        let best = *found.iter().find(sound)?;
        let Some((last, _)) = self.seen.filter(|_| self.live) else { return Some(best) };
        let angle = |pose: &MarkerPose| pose.rotation.angle_between(last.orientation);
        found
            .iter()
            .filter(sound)
            .filter(|pose| pose.error_px <= best.error_px + AMBIGUOUS_PX)
            .min_by(|a, b| angle(a).total_cmp(&angle(b)))
            .copied()
    }

    pub fn repaint_after(&self) -> Option<Duration> {
        self.is_on().then_some(LOOK_EVERY)
    }

    /// Enlarges or shrinks the sculpture on the table.
    pub fn zoom(&mut self, notches: f32) {
        let factor = GROWTH_PER_NOTCH.powf(notches.clamp(-20.0, 20.0));
        self.settings.voxel_mm = (self.settings.voxel_mm * factor).clamp(0.001, 1000.0);
    }

    pub fn status(&self) -> ArStatus {
        ArStatus {
            on: self.is_on(),
            video: self.shown.is_some(),
            seen: self.live,
            marker: self.settings.marker,
            voxel_mm: self.settings.voxel_mm,
        }
    }

    /// Returns the camera's eye on a grid, in a picture of `size` pixels; `None` without frames.
    pub fn eye(&self, world_from_grid: &Affine3A, dims: Vec3, size: UVec2) -> Option<Eye> {
        let (frame, lens) = self.shown.as_ref().filter(|_| self.is_on())?;
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let ground = (0..8)
            .map(|i| world_from_grid.transform_point3(corner(i) * dims).y)
            .fold(f32::MAX, f32::min);
        let units_per_voxel = world_from_grid.matrix3.x_axis.length().max(f32::MIN_POSITIVE);
        let stand =
            MarkerPlacement { ground, m_per_unit: self.settings.voxel_mm * 1e-3 / units_per_voxel };
        let Placement { position_m, orientation } = self.placement();
        let camera_from_marker =
            Affine3A::from_rotation_translation(orientation.as_quat(), position_m.as_vec3());
        let picture = UVec2::new(frame.width, frame.height);
        let framing = Framing::new(picture, size, self.look.fit, self.look.mirror);
        let near = NEAREST_M / stand.m_per_unit;
        Some(stand.eye(camera_from_marker, lens, &framing, size, near))
    }

    /// Takes the newest frame of the camera and its placement on the screen.
    pub fn see(&mut self, frame: &Arc<VideoFrame>, look: CameraView) {
        self.look = look;
        let Some(finder) = &self.finder else { return };
        if self.given == Some(frame.sequence) || frame.width == 0 || frame.height == 0 {
            return;
        }
        self.given = Some(frame.sequence);
        let fov_y_rad = self.settings.camera_fov_deg.to_radians();
        let lens =
            look.lens.unwrap_or_else(|| Intrinsics::pinhole(frame.width, frame.height, fov_y_rad));
        finder.give(frame.clone(), lens.scaled(frame.width, frame.height));
    }

    /// Returns the frame of the eye, while the sculpture stands on the marker. It must be shown behind it, without the
    /// lens's distortion.
    pub fn frame(&self) -> Option<&Arc<VideoFrame>> {
        self.shown.as_ref().filter(|_| self.is_on()).map(|(frame, _)| frame)
    }
}
