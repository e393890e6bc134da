//! Owns the work on a sculpture without the screen: what the interface and the devices ask for
//! becomes commands for the session, the view moves, the tool is led over the surface.
//!
//! Takes an egui pass and, from the renderer, the voxels that were seen; gives the eye to render
//! next. Knows no window and no Vulkan, so that all of it can be tested without either.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{CursorIcon, Id, Rect, Sense, Ui};
use glam::{Affine3A, UVec2, Vec2, Vec3};

use super::ar::Ar;
use super::camera::Camera;
use super::footing::Footing;
use super::head::Head;
use super::job::{self, Job};
use super::keys::KeyFile;
use super::marker::MarkerDrag;
use super::memory::MemoryFile;
use super::overlay::OverlayScene;
use super::pad::Pads;
use super::stroke::StrokeInHand;
use super::turntable::Turntable;
use super::view_pace::ViewWatch;
use crate::config::Config;
use crate::input::events::{Viewport, device_events};
use crate::input::pad::shift_tap::ShiftTap;
use crate::input::trigger::Trigger;
use crate::input::{Action, ActionEvent, Bindings, DeviceEvent, Mapper, Panel, Side};
use crate::sculpture::region::VoxelBox;
use crate::session::Session;

use crate::surface::IndexMap;
use crate::ui::{self, FrameTimes, UiContext, UiRequest, UiState};
use crate::view::{Eye, Pose, StereoLayout};

/// Everything but the screen.
pub struct Workspace {
    pub(super) session: Session,
    pub ui: UiState,
    /// The tables of keys as the person has changed them.
    pub(super) presets: Vec<Bindings>,
    /// The same as the program brings them along.
    pub(super) pristine: Vec<Bindings>,
    /// Where changes to the tables are kept, if anywhere.
    pub(super) key_file: Option<KeyFile>,
    /// Where it is remembered how the program was left, if anywhere.
    pub(super) memory: Option<MemoryFile>,
    /// What is held in the main window.
    mapper: Mapper,
    /// What is held in the windows of panels.
    panel_mappers: BTreeMap<Panel, Mapper>,
    shift_tap: ShiftTap,
    pub(super) pads: Pads,
    /// Voxels that were changed since a hand in the room last felt it.
    pub(super) bitten_by_hand: u64,
    /// Where a hand in the room has led the tool last.
    pub(super) hand_pose: Option<Pose>,
    pub(super) turntable: Turntable,
    pub(super) head: Head,
    pub(super) ar: Ar,
    pub(super) camera: Camera,
    pub(super) stroke: Option<StrokeInHand>,
    pub(super) view_watch: ViewWatch,
    /// Where the tool stands on the surface.
    pub(super) footing: Footing,
    /// What a drag does to the marker.
    pub(super) marker_drag: Option<MarkerDrag>,
    /// The box that was selected only because tools were to be limited to the marker.
    pub(super) lent_to_limit: Option<VoxelBox>,
    /// What drags have moved the marker by, less whole voxels.
    pub(super) marker_rest: Vec3,
    /// Where the pointer is, in pixels of the picture; none while it is elsewhere.
    pub(super) pointer: Option<Vec2>,
    /// A drag of `Sculpt` that began beside the sculpture and turns it.
    pub(super) turns_instead: bool,
    /// The voxels in the last picture, to find what the pointer points at.
    pub(super) seen: Option<Arc<IndexMap>>,
    picture: Rect,
    pixels_per_point: f32,
    /// Long work under way.
    pub(super) job: Option<Job>,
    /// It may do what cannot be undone.
    pub(super) irreversible_job: bool,
    /// A stroke that is over, but cannot be undone: the person is asked whether to keep it.
    pub(super) stroke_in_question: bool,
    leaving: bool,
    pub times: FrameTimes,
    pub device: String,
    /// Whether the window can have a layer an eye.
    pub quad_buffered: bool,
    /// The eye whose picture the pointer is in: 0, or 1 where the right eye has a place of its own.
    pub pointing_eye: usize,
}

impl Workspace {
    pub fn new(session: Session, config: &Config, presets: Vec<Bindings>) -> Workspace {
        let grid = session.document().grid();
        let turntable = Turntable::new(grid, config.render.fov_deg, UVec2::new(640, 480));
        let mut workspace = Workspace {
            ui: UiState::new(&config.ui_options(), grid.dims()),
            session,
            pristine: presets.clone(),
            presets,
            key_file: None,
            memory: None,
            mapper: Mapper::default(),
            panel_mappers: BTreeMap::new(),
            shift_tap: ShiftTap::default(),
            pads: Pads::new(&config.gamepad),
            bitten_by_hand: 0,
            hand_pose: None,
            turntable,
            head: Head::new(config),
            ar: Ar::new(&config.ar),
            camera: Camera::default(),
            stroke: None,
            view_watch: ViewWatch::default(),
            footing: Footing::default(),
            marker_drag: None,
            lent_to_limit: None,
            marker_rest: Vec3::ZERO,
            pointer: None,
            turns_instead: false,
            seen: None,
            picture: Rect::ZERO,
            pixels_per_point: 1.0,
            job: None,
            irreversible_job: false,
            stroke_in_question: false,
            leaving: false,
            times: FrameTimes::default(),
            device: String::new(),
            quad_buffered: false,
            pointing_eye: 0,
        };
        workspace.look_from(Side::Corner);
        if workspace.head.wanted() {
            workspace.start_head();
        }
        if workspace.ar.wanted() {
            workspace.start_ar();
        }
        workspace
    }

    pub fn session(&self) -> &Session {
        &self.session
    }

    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// The area of the picture in points.
    pub fn picture(&self) -> Rect {
        self.picture
    }

    /// The same in pixels of the window.
    pub(super) fn picture_px(&self) -> Rect {
        self.picture * self.pixels_per_point
    }

    /// The eyes of the next picture: one, or the left and the right one. They are those of the
    /// camera before the printed marker, of the head before the screen, or before the middle of
    /// the screen.
    pub fn eyes(&self) -> Vec<Eye> {
        let stereo = &self.ui.view.stereo;
        let is_mono = stereo.layout == StereoLayout::Mono;
        if let Some(eye) = self.camera_eye() {
            // The camera behind the picture has one eye.
            return vec![eye; if is_mono { 1 } else { 2 }];
        }
        if is_mono {
            return vec![self.head_eye().unwrap_or_else(|| self.turntable.eye())];
        }
        if let Some([left, right]) = self.tracked_eyes(stereo.eye_distance_mm * 1e-3) {
            return if stereo.swap_eyes { vec![right, left] } else { vec![left, right] };
        }
        let mono = self.turntable.eye();
        let centre = mono.eye_from_world.transform_point3(self.placed_centre());
        stereo.rig((-centre.z).max(self.turntable.camera().near)).eyes(&mono).to_vec()
    }

    /// The eye whose picture the pointer is in.
    pub fn eye(&self) -> Eye {
        let eyes = self.eyes();
        eyes[self.pointing_eye.min(eyes.len() - 1)]
    }

    /// The middle of the grid, in world coordinates.
    fn placed_centre(&self) -> Vec3 {
        let middle = self.session.document().grid().dims().as_vec3() * 0.5;
        self.world_from_grid().transform_point3(middle)
    }

    pub fn world_from_grid(&self) -> Affine3A {
        self.session.document().world_from_grid()
    }

    /// Hears from the renderer which voxels the last picture shows.
    pub fn saw(&mut self, map: Arc<IndexMap>) {
        self.seen = Some(map);
    }

    /// Gives back the voxels of the last picture, so that their memory can be used again.
    pub fn forget_seen(&mut self) {
        self.seen = None;
    }

    /// Whether the person has left the program.
    pub fn is_leaving(&self) -> bool {
        self.leaving
    }

    /// Whether voxels are being changed by a hand that is still down.
    pub fn stroke_in_hand(&self) -> bool {
        self.stroke.is_some()
    }

    /// Whether the pointer holds something on the picture.
    pub(super) fn is_dragging(&self) -> bool {
        self.mapper.captures_pointer()
    }

    /// The window was asked to close.
    pub fn ask_to_leave(&mut self) {
        self.act(Action::Quit);
    }

    /// One pass of the interface: listens to the devices, shows the panels, does what was asked.
    pub fn show(&mut self, root: &mut Ui) {
        self.follow_job();
        self.follow_camera();
        self.listen(root);
        let mut requests = Vec::new();
        let picture =
            self.with_context(false, |ui, context| ui::show(root, ui, context, &mut requests).rect);
        self.draw_pad_pointer(root.ctx());
        let response = root.interact(picture, picture_id(), Sense::hover());
        self.set_picture(picture, root.pixels_per_point());
        if response.contains_pointer() && !self.ui.is_modal() {
            root.set_cursor_icon(self.cursor(root));
        }
        if !requests.is_empty() {
            root.request_repaint();
        }
        self.answer_questions(requests);
        self.keep_footing();
        if self.job.is_some() {
            root.request_repaint_after(job::LOOK_EVERY);
        }
        let news =
            [self.head.repaint_after(), self.ar.repaint_after(), self.camera.repaint_after()];
        for after in news.into_iter().flatten() {
            root.request_repaint_after(after);
        }
    }

    /// One pass of a panel in a window of its own. True if something was done there that other
    /// windows may show.
    pub fn show_panel(&mut self, panel: Panel, root: &mut Ui) -> bool {
        let modal = self.ui.is_modal();
        let ctx = root.ctx();
        let viewport = Viewport {
            rect: Rect::NOTHING,
            pixels_per_point: root.pixels_per_point(),
            hovered: false,
            captured: false,
            keyboard: !modal && ctx.memory(|memory| memory.focused().is_none()),
        };
        let (events, touched) =
            ctx.input(|input| (device_events(input, &viewport), is_touched(input)));
        self.hear(Some(panel), &events);
        let mut requests = Vec::new();
        self.with_context(false, |ui, context| {
            ui::panels::show(root, panel, ui, context, &mut requests)
        });
        if !requests.is_empty() {
            root.request_repaint();
        }
        self.answer_questions(requests);
        self.keep_footing();
        touched
    }

    /// A panel's window was closed: the panel is back in its place, and what was held in its
    /// window is let go.
    pub fn put_back(&mut self, panel: Panel) {
        self.ui.detached.remove(&panel);
        self.hear(Some(panel), &[DeviceEvent::FocusLost]);
        self.panel_mappers.remove(&panel);
    }

    /// One pass of the board in a headset: everything that the window has beside its picture.
    pub fn show_on_board(&mut self, root: &mut Ui) {
        self.follow_job();
        let mut requests = Vec::new();
        self.with_context(true, |ui, context| ui::board::show(root, ui, context, &mut requests));
        if !requests.is_empty() {
            root.request_repaint();
        }
        self.answer_questions(requests);
    }

    /// Does what was asked for. A stroke that nobody wants to keep any more is taken back.
    fn answer_questions(&mut self, requests: Vec<UiRequest>) {
        for request in requests {
            self.carry_out(request);
        }
        self.settle_stroke_in_question();
    }

    fn with_context<T>(
        &mut self,
        in_headset: bool,
        show: impl FnOnce(&mut UiState, &UiContext) -> T,
    ) -> T {
        let context = UiContext {
            document: self.session.document(),
            path: self.session.path(),
            modified: self.session.modified(),
            presets: &self.presets,
            pristine: &self.pristine,
            times: self.times,
            in_headset,
            quad_buffered: self.quad_buffered,
            device: &self.device,
            pointed_vx: self.pointed(),
            pad: self.pads.status(),
            head: self.head.status(),
            ar: self.ar.status(),
            video: self.camera.status(),
        };
        let preset = self.ui.preset;
        let shown = show(&mut self.ui, &context);
        if self.ui.preset != preset {
            self.save_keys();
        }
        shown
    }

    fn set_picture(&mut self, rect: Rect, pixels_per_point: f32) {
        self.picture = rect;
        self.pixels_per_point = pixels_per_point;
        let size = (rect.size() * pixels_per_point).round().max(egui::Vec2::splat(1.0));
        self.turntable.set_size(UVec2::new(size.x as u32, size.y as u32));
    }

    /// Does what the devices say about the picture as it was last shown.
    fn listen(&mut self, root: &Ui) {
        let ctx = root.ctx();
        let hovered = ctx.read_response(picture_id()).is_some_and(|r| r.contains_pointer());
        let modal = self.ui.is_modal();
        let viewport = Viewport {
            rect: self.picture,
            pixels_per_point: root.pixels_per_point(),
            hovered: hovered && !modal,
            captured: self.mapper.captures_pointer(),
            keyboard: !modal && ctx.memory(|memory| memory.focused().is_none()),
        };
        let events = ctx.input(|input| device_events(input, &viewport));
        let shift_taps = ctx
            .input(|input| input.events.iter().filter(|event| self.shift_tap.feed(event)).count());
        self.hear(None, &events);
        let bindings = self.presets.get(self.ui.preset);
        if let Some(action) = bindings.and_then(|b| b.action(Trigger::ShiftTap))
            && viewport.keyboard
        {
            (0..shift_taps).for_each(|_| self.act(action));
        }
        if self.mapper.captures_pointer() && !viewport.captured {
            // A press on the picture takes the keyboard from the fields beside it.
            ctx.memory_mut(|memory| {
                if let Some(id) = memory.focused() {
                    memory.surrender_focus(id);
                }
            });
        }
    }

    /// Does what the events of a window mean: of a panel's, or of the main one. Each window holds
    /// keys of its own, so that one that loses the focus lets go of its own only.
    fn hear(&mut self, panel: Option<Panel>, events: &[DeviceEvent]) {
        let Some(bindings) = self.presets.get(self.ui.preset) else { return };
        let mapper = match panel {
            Some(panel) => self.panel_mappers.entry(panel).or_default(),
            None => &mut self.mapper,
        };
        let mut actions = Vec::new();
        for event in events {
            mapper.feed(event, bindings, &mut actions);
        }
        for (i, event) in actions.iter().enumerate() {
            // Of several moves without a button only the last is worth a look.
            let overtaken = matches!(event, ActionEvent::Hover(_))
                && matches!(actions.get(i + 1), Some(ActionEvent::Hover(_)));
            if !overtaken {
                self.answer(event);
            }
        }
    }

    pub(super) fn answer(&mut self, event: &ActionEvent) {
        match *event {
            ActionEvent::Tap(action) => self.act(action),
            ActionEvent::Begin { action, at } => {
                self.pointer = at.or(self.pointer);
                self.begin(action, at);
            }
            ActionEvent::Drag { action, at, by } => {
                self.pointer = Some(at);
                self.drag(action, at, by);
            }
            ActionEvent::End(action) => self.end(action),
            ActionEvent::Hover(at) => {
                self.pointer = Some(at);
                self.hover(at);
            }
            ActionEvent::Wheel { action, notches, at } => self.wheel(action, notches, at),
            ActionEvent::Left => self.pointer = None,
        }
    }

    /// What the overlay is drawn from.
    pub(super) fn scene(&self) -> OverlayScene<'_> {
        let sight = self.sight();
        let document = self.session.document();
        let target = self.pointer.and_then(|at| self.target(at));
        let middle = document.grid().dims().as_vec3() * 0.5;
        OverlayScene {
            hand: &self.ui.hand,
            document,
            view: &self.ui.view,
            theme: self.ui.theme,
            orientation: self.ui.orientation,
            seen: self.seen.as_deref(),
            pointer: self.pointer,
            depth: sight.depth(target.unwrap_or(middle)),
        }
    }

    pub(super) fn leave(&mut self) {
        self.leaving = true;
    }

    fn cursor(&self, root: &Ui) -> CursorIcon {
        if self.mapper.captures_pointer() {
            return if self.stroke.is_some() {
                CursorIcon::Crosshair
            } else {
                CursorIcon::Grabbing
            };
        }
        let at = root.input(|input| input.pointer.hover_pos()).map(|at| {
            let at = (at - self.picture.min) * root.pixels_per_point();
            Vec2::new(at.x, at.y)
        });
        match at.and_then(|at| self.target(at)) {
            Some(_) => CursorIcon::Crosshair,
            None => CursorIcon::Grab,
        }
    }
}

/// Whether a person does more than to move the pointer over a panel.
fn is_touched(input: &egui::InputState) -> bool {
    input.events.iter().any(|event| match event {
        egui::Event::PointerMoved(_) => input.pointer.any_down(),
        egui::Event::PointerGone | egui::Event::WindowFocused(_) => false,
        _ => true,
    })
}

fn picture_id() -> Id {
    Id::new("picture")
}
