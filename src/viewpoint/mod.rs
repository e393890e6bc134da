//! The source of the eyes for the next picture, and picking in the last one.
//!
//! [`Viewpoint`] takes the size of the viewport, poses from trackers and frames from cameras; it gives eyes
//! ([`Viewpoint::eyes`]) and a [`Picker`]. To move a sculpture before the eyes, it returns a [`Placement`], which is a
//! command for the document. Knows no window, no interface and no Vulkan.

mod approach;
pub mod ar;
pub mod calibration;
pub mod camera;
pub mod head;
mod head_calibration;
mod head_screen;
mod head_status;
mod tracker_controls;
pub mod turntable;

use std::sync::Arc;
use std::time::Duration;

use glam::{IVec3, UVec2, Vec2, Vec3};

use crate::document::Document;
use crate::input::pace::{TrackingSource as Tracked, ViewPace};
use crate::input::{Action, Side};
use crate::notice::Notice;
use crate::picking::{Picker, Sight};
use crate::render::StereoOptions;
use crate::sculpture::Placement;
use crate::surface::IndexMap;
use crate::video::{Intrinsics, VideoFrame, VideoOptions};
use crate::view::{Eye, StereoLayout};

use ar::Ar;
use camera::VideoInput;
use head::TrackedHead;
use turntable::Turntable;

/// The rectangle of the window that shows the sculpture, in pixels of the window.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ViewportRect {
    pub corner_px: Vec2,
    pub size_px: Vec2,
}

/// Everything that determines the view of the sculpture.
pub struct Viewpoint {
    pub turntable: Turntable,
    pub head: TrackedHead,
    pub ar: Ar,
    pub camera: VideoInput,
    /// Detects jumps of the view's tracking.
    pace: ViewPace,
    viewport: ViewportRect,
    /// The voxels of the last picture, for picking, and the origin of the grid's coordinates then.
    pick_map: Option<(Arc<IndexMap>, IVec3)>,
    /// The eye whose picture the pointer is in: 0, or 1 if the right eye has a picture of its own.
    pub pointing_eye: usize,
}

impl Viewpoint {
    /// Creates it. `fov_deg`: vertical field of view of the turntable's camera.
    pub fn new(document: &Document, fov_deg: f32, head: TrackedHead, ar: Ar) -> Viewpoint {
        let size = UVec2::new(640, 480);
        Viewpoint {
            turntable: Turntable::new(document.grid(), fov_deg, size),
            head,
            ar,
            camera: VideoInput::default(),
            pace: ViewPace::default(),
            viewport: ViewportRect::default(),
            pick_map: None,
            pointing_eye: 0,
        }
    }

    /// Sets the area of the picture in the window.
    pub fn set_viewport(&mut self, viewport: ViewportRect) {
        self.viewport = viewport;
        self.turntable.set_size(viewport.size_px.round().max(Vec2::ONE).as_uvec2());
    }

    pub fn viewport(&self) -> ViewportRect {
        self.viewport
    }

    /// Returns the eyes of the next picture: one, or the left and the right one. They are those of the camera before
    /// the printed marker, of the head before the screen, or of the turntable's camera.
    pub fn eyes(&self, document: &Document, stereo: &StereoOptions) -> Vec<Eye> {
        let is_mono = stereo.layout == StereoLayout::Mono;
        if let Some(eye) = self.camera_eye(document) {
            // The camera behind the picture has one eye.
            return vec![eye; if is_mono { 1 } else { 2 }];
        }
        if is_mono {
            let head = self.tracked_eyes(0.0).map(|[left, _]| left);
            return vec![head.unwrap_or_else(|| self.turntable.eye())];
        }
        if let Some([left, right]) = self.tracked_eyes(stereo.eye_distance_mm * 1e-3) {
            return if stereo.swap_eyes { vec![right, left] } else { vec![left, right] };
        }
        let mono = self.turntable.eye();
        let middle = document.grid().dims().as_vec3() * 0.5;
        let centre = document.world_from_grid().transform_point3(middle);
        let depth = -mono.eye_from_world.transform_point3(centre).z;
        stereo.rig(depth.max(self.turntable.near())).eyes(&mono).to_vec()
    }

    /// Returns the eye whose picture the pointer is in.
    pub fn eye(&self, document: &Document, stereo: &StereoOptions) -> Eye {
        let eyes = self.eyes(document, stereo);
        eyes[self.pointing_eye.min(eyes.len() - 1)]
    }

    /// Returns the left and the right eye of the tracked head, `eye_distance_m` metres apart, while the view follows
    /// it.
    pub fn tracked_eyes(&self, eye_distance_m: f32) -> Option<[Eye; 2]> {
        self.head.eyes(self.viewport, &self.turntable, eye_distance_m)
    }

    /// Returns the eye of the camera, while the sculpture stands on the printed marker.
    fn camera_eye(&self, document: &Document) -> Option<Eye> {
        let dims = document.grid().dims().as_vec3();
        self.ar.eye(&document.world_from_grid(), dims, self.turntable.eye().size)
    }

    /// Returns whether the view's tracking has jumped, was lost or found since the last call: that of the camera before
    /// the printed marker, or of the head before the screen.
    pub fn has_leapt(&mut self, now_s: f64) -> bool {
        let tracked = match self.ar.is_on() {
            true => self.ar.camera_position_m().map(|at| (Tracked::Camera, at)),
            false => self.head.position_m().map(|at| (Tracked::Head, at)),
        };
        self.pace.step(tracked, now_s)
    }

    /// Returns the picker for the picture as it was last shown.
    pub fn picker(&self, document: &Document, stereo: &StereoOptions) -> Picker {
        let sight = Sight::new(&self.eye(document, stereo), &document.world_from_grid());
        Picker::new(sight, self.pick_map(document).cloned(), document.origin())
    }

    /// Sets the index map of the last picture, which showed this document.
    pub fn set_pick_map(&mut self, map: Arc<IndexMap>, document: &Document) {
        self.pick_map = Some((map, document.origin()));
    }

    /// Returns the index map of the last picture, if the coordinates of the grid are still those that it has.
    pub fn pick_map(&self, document: &Document) -> Option<&Arc<IndexMap>> {
        let (map, origin) = self.pick_map.as_ref()?;
        (*origin == document.origin()).then_some(map)
    }

    /// Drops the index map, so that the renderer can reuse its memory.
    pub fn forget_pick_map(&mut self) {
        self.pick_map = None;
    }

    /// Returns the placement that shows all of the sculpture from a side.
    pub fn look_from(&mut self, side: Side, up: Vec3, document: &Document) -> Placement {
        let mut placement = self.turntable.looking_from(side, up, document.placement());
        let (grid, frame) = (document.grid(), &document.contents().frame);
        if frame.centre_vx() != grid.dims().as_vec3() * 0.5 {
            let world_from_grid = placement.world_from_framed(frame, grid.voxel_size());
            placement.translation -= world_from_grid.transform_point3(grid.dims().as_vec3() * 0.5);
        }
        self.turntable.show_all(grid, &placement);
        placement
    }

    /// Returns the placement after a drag of `by` pixels; `None` if the action does not move the sculpture.
    pub fn dragged(
        &self,
        action: Action,
        placement: &Placement,
        by: Vec2,
        up: Vec3,
    ) -> Option<Placement> {
        match action {
            Action::TurnSculpture => Some(self.turntable.turned(placement, by, up)),
            Action::PanSculpture => Some(self.turntable.shifted(placement, by)),
            _ => None,
        }
    }

    /// Zooms by notches of the wheel about the pixel `at`: never into the sculpture, and out of it if the camera is
    /// inside. Returns the placement that keeps the point there; `None` on a printed marker, where the sculpture itself
    /// grows.
    pub fn zoomed(&mut self, document: &Document, notches: f32, at: Vec2) -> Option<Placement> {
        if self.ar.is_on() {
            self.ar.zoom(notches);
            return None;
        }
        let (grid, placement) = (document.grid(), document.placement());
        let (eye, world_from_grid) = (self.turntable.eye(), document.world_from_grid());
        let gap = self.turntable.gap();
        if let Some(back) = approach::exit_distance(grid, &eye, &world_from_grid, gap) {
            let middle = self.turntable.middle();
            return Some(self.turntable.advanced(placement, -back, middle));
        }
        let surface = approach::surface_depth(grid, &eye, &world_from_grid, at);
        Some(self.turntable.zoomed(placement, notches, at, surface))
    }

    /// Returns the placement that brings the sculpture nearer by as much as a drag of `pixels` would move it, but not
    /// onto the camera.
    pub fn brought_nearer(
        &mut self,
        document: &Document,
        placement: &Placement,
        pixels: f32,
    ) -> Placement {
        let (eye, middle) = (self.turntable.eye(), self.turntable.middle());
        let world_from_grid = document.world_from_grid();
        let surface = approach::surface_depth(document.grid(), &eye, &world_from_grid, middle);
        self.turntable.brought_nearer(placement, pixels, surface)
    }

    /// Returns whether the camera is inside the sculpture, where nothing is visible.
    pub fn is_inside(&self, document: &Document) -> bool {
        let eye = self.turntable.eye();
        !self.ar.is_on() && approach::is_inside(document.grid(), &eye, &document.world_from_grid())
    }

    /// Opens and closes the camera as requested, and hands its newest frame to the marker tracker.
    pub fn follow_camera(&mut self, settings: &VideoOptions) -> Option<Notice> {
        // The marker is searched for in the video.
        let wished = settings.on || self.ar.is_on();
        let (look, notice) = self.camera.follow(settings, wished);
        if let Some((frame, look)) = look {
            self.ar.see(&frame, look);
        }
        notice
    }

    /// Returns the frame to show behind the sculpture, with its lens: the eye's frame, or else the newest.
    pub fn video(&self, settings: &VideoOptions) -> Option<(&Arc<VideoFrame>, Option<Intrinsics>)> {
        let wished = settings.on || self.ar.is_on();
        let frame = self.ar.frame().or(self.camera.frame()).filter(|_| wished)?;
        Some((frame, self.camera.lens()))
    }

    /// Returns the soonest time after which trackers or cameras need another picture.
    pub fn repaint_after(&self) -> Option<Duration> {
        let news =
            [self.head.repaint_after(), self.ar.repaint_after(), self.camera.repaint_after()];
        news.into_iter().flatten().min()
    }
}
