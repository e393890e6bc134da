//! The program without its windows: the owner of editor, viewpoint, controls and interface.
//!
//! Takes egui passes, device events and reports of the renderer; gives the contents of the next picture. It only holds
//! the parts and runs the passes; `dispatch` handles input. Knows no window and no Vulkan, so that all of it can be
//! tested without either.

mod key_focus;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use egui::{Context, CursorIcon, Id, Rect, Sense, Ui};
use glam::{Affine3A, Vec2};

use super::left::AbandonedWork;
use super::memory::Memory;
use super::overlay::OverlayScene;
use super::references;
use crate::config::Config;
use crate::controls::Controls;
use crate::editor::{Editor, job};
use crate::gpu::DeviceOptions;
use crate::input::events::{ViewportInput as InputArea, device_events};
use crate::input::pad::device::PadNews;
use crate::input::pen::{PenSample, PenTrack};
use crate::input::{Action, ActionEvent, Bindings, Buttons, Panel, Side, Trigger};
use crate::picking::Picker;
use crate::render::{Fallback, FrameReport, ReferencePicture};
use crate::screen::headset::BlendMode;
use crate::session::Session;
use crate::shade::ground::line_spacing_vx;
use crate::ui::{self, FrameTimes, UiContext, UiRequest, UiState, WindowOptions};
use crate::view::Eye;
use crate::viewpoint::ar::Ar;
use crate::viewpoint::head::{Monitor, TrackedHead};
use crate::viewpoint::{Viewpoint, ViewportRect};

use key_focus::{Around, HeardKeys, KeyFocus};

/// Time between two attempts to write a journal that failed.
const JOURNAL_LOOK: Duration = Duration::from_secs(2);

/// Facts reported by the window with its device, and by a headset.
pub struct Display {
    /// Name of the Vulkan device.
    pub device: String,
    /// Whether the window can have one layer per eye.
    pub quad_buffered: bool,
    pub times: FrameTimes,
    /// The ways in which a headset can blend pictures with the surroundings; empty without a headset.
    pub blends: Vec<BlendMode>,
    /// Area of the sculpture's picture in the window, in points.
    picture: Rect,
}

/// The whole program except the windows.
pub struct Workspace {
    pub editor: Editor,
    pub viewpoint: Viewpoint,
    pub controls: Controls,
    pub ui: UiState,
    pub display: Display,
    /// Tracks pens over the main window.
    pens: PenTrack,
    /// The owner of the keyboard in the main window and in each panel window.
    key_focus: BTreeMap<Option<Panel>, KeyFocus>,
    /// Remembers how the program was left.
    memory: Memory,
    pub(super) leaving: bool,
    /// The settings with which films and pictures without a window start.
    pub(super) config: Config,
    /// The device for them.
    pub render_device: DeviceOptions,
    /// The work left by earlier sessions, once [`Workspace::look_for_left`] knows the folder.
    pub(super) abandoned: AbandonedWork,
}

impl Workspace {
    pub fn new(session: Session, config: &Config, presets: Vec<Bindings>) -> Workspace {
        let mut workspace = Workspace {
            viewpoint: Viewpoint::new(
                session.document(),
                config.render.fov_deg,
                TrackedHead::new(&config.tracking, &config.screen, config.headset.enabled),
                Ar::new(&config.ar),
            ),
            editor: Editor::new(session),
            controls: Controls::new(presets, &config.gamepad),
            ui: UiState::new(&config.ui_options()),
            display: Display {
                device: String::new(),
                quad_buffered: false,
                times: FrameTimes::default(),
                blends: Vec::new(),
                picture: Rect::ZERO,
            },
            pens: PenTrack::default(),
            key_focus: BTreeMap::new(),
            memory: Memory::default(),
            leaving: false,
            config: config.clone(),
            render_device: DeviceOptions::default(),
            abandoned: AbandonedWork::default(),
        };
        workspace.look_from(Side::Corner);
        workspace.settle();
        if workspace.viewpoint.head.wanted() {
            workspace.start_head();
        }
        if workspace.viewpoint.ar.wanted() {
            workspace.start_ar();
        }
        workspace.settle();
        workspace
    }

    pub fn session(&self) -> &Session {
        self.editor.session()
    }

    pub fn session_mut(&mut self) -> &mut Session {
        self.editor.session_mut()
    }

    /// Returns the area of the picture in points.
    pub fn picture(&self) -> Rect {
        self.display.picture
    }

    /// Returns the eyes of the next picture: one, or the left and the right one.
    pub fn eyes(&self) -> Vec<Eye> {
        self.viewpoint.eyes(self.editor.document(), &self.ui.view.stereo)
    }

    /// Returns the eye whose picture the pointer is in.
    pub fn eye(&self) -> Eye {
        self.viewpoint.eye(self.editor.document(), &self.ui.view.stereo)
    }

    pub fn world_from_grid(&self) -> Affine3A {
        self.editor.document().world_from_grid()
    }

    /// Returns the picker for the picture as it was last shown.
    pub(super) fn picker(&self) -> Picker {
        self.viewpoint.picker(self.editor.document(), &self.ui.view.stereo)
    }

    /// Returns whether the person has left the program.
    pub fn is_leaving(&self) -> bool {
        self.leaving
    }

    /// Handles the request to close the window.
    pub fn ask_to_leave(&mut self) {
        self.act(Action::Quit);
    }

    /// Takes the newest frame of the camera.
    pub(super) fn follow_camera(&mut self) {
        let notice = self.viewpoint.follow_camera(&self.ui.view.video);
        self.show_notices(notice);
    }

    /// Loads the key tables of a file, and writes changes to it from now on.
    pub fn keep_keys_in(&mut self, path: PathBuf) {
        let notice = self.controls.keep_keys_in(path);
        self.show_notices(notice);
    }

    /// Keeps calibrations in a file, and loads the one there or the one that the settings name.
    pub fn keep_calibration_in(&mut self, path: PathBuf) {
        let notice = self.viewpoint.head.keep_calibration_in(path);
        self.show_notices(notice);
    }

    /// Sets the position of the program's window on the screen.
    pub fn on_screen(&mut self, monitor: Option<Monitor>) {
        self.viewpoint.head.set_monitor(monitor);
    }

    /// Restores the state in the file, if there is one, and saves the state there from now on.
    pub fn remember_in(&mut self, path: PathBuf, window: &WindowOptions) {
        self.memory.open(path, window, &mut self.ui, &mut self.editor.tool);
        references::read_remembered(&mut self.ui.references, &mut self.ui.toasts);
        self.editor.leave_ground();
        let session = self.editor.session();
        if let Some(path) = session.path() {
            self.ui.known_files.recent.note_open(path, session.assumed_up());
        }
    }

    /// Saves the state, if some time has passed since the last save.
    pub fn remember_at_rest(&mut self) {
        if self.memory.is_due() {
            self.remember();
        }
    }

    /// Saves the state, if it has changed.
    pub fn remember(&mut self) {
        self.memory.save(&self.ui, &self.editor.tool);
    }

    /// Handles pen samples over the main window, in its pixels. The window's own events carry their pointer.
    pub fn hear_pens(&mut self, samples: &[PenSample]) {
        self.ui.pen.is_used |= !samples.is_empty();
        samples.iter().for_each(|sample| self.pens.push(sample));
    }

    /// Sets the names of the tablets and pens.
    pub fn know_pens(&mut self, names: Vec<String>) {
        self.ui.pen.devices = names;
    }

    /// Polls trackers and the marker. Called once per picture, before the interface.
    pub fn track(&mut self) {
        self.track_at(self.viewpoint.head.clock_s());
    }

    /// Handles news of a pad at `now_s` seconds.
    pub fn handle_pad(&mut self, news: PadNews, now_s: f64) {
        let catching = self.ui.dialogs.keys.is_catching();
        let report = self.controls.handle_pad(news, now_s, catching);
        self.ui.dialogs.keys.hear(report.caught);
        self.show_notices(report.notice);
    }

    /// Rumbles the pad according to the voxels that the tool has changed since the last call.
    pub fn shake_pad(&mut self, now_s: f64) {
        let felt = self.editor.is_stroking();
        self.controls.pads.shake(now_s, self.editor.voxels_changed(), felt);
    }

    /// Runs a pass of the interface: reads the devices, shows the panels, and executes the requests.
    pub fn show(&mut self, root: &mut Ui) {
        self.follow_job();
        self.follow_camera();
        self.listen(root);
        let mut requests = Vec::new();
        let picture =
            self.with_context(false, |ui, context| ui::show(root, ui, context, &mut requests).rect);
        self.controls.pads.draw_pointer(root.ctx());
        let response = root.interact(picture, picture_id(), Sense::hover());
        self.set_picture(picture, root.pixels_per_point());
        if response.contains_pointer() && !self.ui.dialogs.is_modal() {
            root.set_cursor_icon(self.cursor(root));
        }
        self.finish_pass(root, requests);
        self.keep_anchor();
        self.dwell(root);
        self.autosave(root);
        if self.editor.is_busy() {
            root.request_repaint_after(job::LOOK_EVERY);
        }
        if let Some(after) = self.viewpoint.repaint_after() {
            root.request_repaint_after(after);
        }
        if self.session().journal_trouble().is_some() {
            // It is retried, and the mark goes when that succeeds.
            root.request_repaint_after(JOURNAL_LOOK);
        }
    }

    /// Runs a pass of a panel in a window of its own. Returns true if something was done there that other windows may
    /// have to show.
    pub fn show_panel(&mut self, panel: Panel, root: &mut Ui) -> bool {
        let HeardKeys { keyboard, kept } = self.hear_keys(Some(panel), root, false);
        let area = InputArea {
            rect: Rect::NOTHING,
            pixels_per_point: root.pixels_per_point(),
            hovered: false,
            captured: false,
            keyboard,
            kept,
        };
        let (events, touched) = root.ctx().input(|input| {
            (device_events(input, &area, &mut PenTrack::default()), is_touched(input))
        });
        for event in self.controls.handle(Some(panel), &events) {
            self.answer_event(&event);
        }
        self.catch_up();
        let mut requests = Vec::new();
        self.with_context(false, |ui, context| {
            ui::panels::show(root, panel, ui, context, &mut requests);
        });
        self.finish_pass(root, requests);
        self.keep_anchor();
        touched
    }

    /// Docks a panel whose window was closed, and releases input held there.
    pub fn put_back(&mut self, panel: Panel) {
        self.ui.layout.detached.remove(&panel);
        self.key_focus.remove(&Some(panel));
        for event in self.controls.panel_closed(panel) {
            self.answer_event(&event);
        }
    }

    /// Runs a pass of the board in a headset: everything that the window shows beside its picture.
    pub fn show_on_board(&mut self, root: &mut Ui) {
        self.follow_job();
        let mut requests = Vec::new();
        self.with_context(true, |ui, context| ui::board::show(root, ui, context, &mut requests));
        self.finish_pass(root, requests);
        self.autosave(root);
    }

    /// Shows only the messages, for a headset with its board closed.
    pub fn show_messages(&mut self, root: &mut Ui) {
        ui::widgets::theme::apply(root.ctx(), self.ui.appearance.theme, self.ui.appearance.scale);
        let within = root.max_rect();
        self.ui.toasts.show(root, within);
    }

    /// Continues a tool that acts while it is held.
    fn dwell(&mut self, root: &Ui) {
        let now_s = root.input(|input| input.time);
        let picker = self.picker();
        if let Some(after_s) = self.editor.dwell(now_s, false, &picker) {
            root.request_repaint_after(Duration::from_secs_f64(after_s));
        }
        self.settle();
    }

    /// Continues such a tool in a hand.
    pub fn dwell_in_hand(&mut self, now_s: f64) {
        let picker = self.picker();
        self.editor.dwell(now_s, true, &picker);
        self.settle();
    }

    /// Saves changes that have been unsaved for long, if the person wants that.
    fn autosave(&mut self, root: &Ui) {
        let minutes = u64::from(self.ui.autosave.minutes);
        let every = (minutes > 0).then(|| Duration::from_secs(60 * minutes));
        let is_free = !self.ui.dialogs.is_modal();
        if let Some(after) = self.editor.autosave(every, Instant::now(), is_free) {
            root.request_repaint_after(after);
        }
        self.settle();
    }

    fn finish_pass(&mut self, root: &Ui, requests: Vec<UiRequest>) {
        if let Some(complaint) = ui::widgets::numbers::see(root.ctx()) {
            self.ui.toasts.note(complaint);
        }
        if !requests.is_empty() {
            root.request_repaint();
        }
        self.answer_requests(requests);
    }

    fn with_context<T>(
        &mut self,
        in_headset: bool,
        show: impl FnOnce(&mut UiState, &UiContext) -> T,
    ) -> T {
        let document = self.editor.document();
        let picker = self.picker();
        let context = UiContext {
            document,
            path: self.editor.session().path(),
            recording: self.editor.session().recording(),
            picture_px: self.viewpoint.turntable.eye().size,
            assumed_up: self.editor.session().assumed_up(),
            modified: self.editor.session().modified(),
            unsafe_because: self.editor.session().journal_trouble(),
            tool: &self.editor.tool,
            drawn: self.editor.progress(),
            presets: self.controls.presets(),
            pristine: self.controls.pristine(),
            preset: self.controls.preset,
            times: self.display.times,
            in_headset,
            blends: &self.display.blends,
            quad_buffered: self.display.quad_buffered,
            device: &self.display.device,
            line_spacing_vx: line_spacing_vx(document.grid().dims()),
            axes_in_picture: picker.sight().axes_in_picture(),
            pointed_vx: self.editor.pointer().and_then(|at| picker.voxel(document.grid(), at)),
            pad: self.controls.pads.status(),
            head: self.viewpoint.head.status(),
            ar: self.viewpoint.ar.status(),
            video: self.viewpoint.camera.status(),
        };
        show(&mut self.ui, &context)
    }

    fn set_picture(&mut self, rect: Rect, pixels_per_point: f32) {
        self.display.picture = rect;
        let px = rect * pixels_per_point;
        self.viewpoint.set_viewport(ViewportRect {
            corner_px: Vec2::new(px.min.x, px.min.y),
            size_px: Vec2::new(px.width(), px.height()),
        });
    }

    /// Returns which keys of a window go to the sculpture instead of a dialog or a field.
    fn hear_keys(&mut self, panel: Option<Panel>, root: &Ui, hovered: bool) -> HeardKeys {
        let dialogs = &self.ui.dialogs;
        let around = Around {
            asking: dialogs.is_asking(),
            modal: dialogs.is_modal(),
            closable: dialogs.has_window(),
            hovered,
        };
        self.key_focus.entry(panel).or_default().pass(root.ctx(), around)
    }

    /// Handles device input that concerns the picture as it was last shown.
    fn listen(&mut self, root: &Ui) {
        let ctx = root.ctx();
        let hovered = ctx.read_response(picture_id()).is_some_and(|r| r.contains_pointer());
        let HeardKeys { keyboard, kept } = self.hear_keys(None, root, hovered);
        let area = InputArea {
            rect: self.display.picture,
            pixels_per_point: root.pixels_per_point(),
            hovered: hovered && !self.ui.dialogs.is_modal(),
            captured: self.controls.is_dragging(),
            keyboard,
            kept,
        };
        self.hear_pen_buttons(ctx);
        let events = ctx.input(|input| device_events(input, &area, &mut self.pens));
        self.pens.finish();
        let taps = ctx.input(|input| self.controls.take_shift_taps(&input.events));
        let events = self.controls.handle(None, &events);
        let pressed = |event: &ActionEvent| matches!(event, ActionEvent::Begin { at: Some(_), .. });
        let is_pressed = events.iter().any(pressed);
        for event in events {
            self.answer_event(&event);
        }
        self.catch_up();
        if area.keyboard {
            taps.into_iter().for_each(|action| self.act(action));
        }
        if is_pressed || self.controls.is_dragging() && !area.captured {
            // A press on the picture takes the keyboard from the fields beside it.
            ctx.memory_mut(|memory| {
                if let Some(id) = memory.focused() {
                    memory.surrender_focus(id);
                }
            });
        }
    }

    /// Lets a pen button, which egui reports as another button, be assigned as an awaited trigger.
    fn hear_pen_buttons(&mut self, ctx: &Context) {
        let Some(button) = self.pens.take_heard() else { return };
        if self.ui.dialogs.keys.is_catching() {
            let modifiers = ctx.input(|input| input.modifiers).into();
            let buttons = Buttons::NONE.with(button);
            self.ui.dialogs.keys.hear(Some(Trigger::Mouse { buttons, modifiers }));
        }
    }

    fn cursor(&self, root: &Ui) -> CursorIcon {
        if self.controls.is_dragging() {
            return match self.editor.is_stroking() || self.editor.is_drawing() {
                true => CursorIcon::Crosshair,
                false => CursorIcon::Grabbing,
            };
        }
        if self.editor.is_drawing() {
            // A drawing that takes several presses accepts a press anywhere.
            return CursorIcon::Crosshair;
        }
        let at = root.input(|input| input.pointer.hover_pos()).map(|at| {
            let at = (at - self.display.picture.min) * root.pixels_per_point();
            Vec2::new(at.x, at.y)
        });
        match at.and_then(|at| self.editor.target(at, &self.picker())) {
            Some(_) => CursorIcon::Crosshair,
            None => CursorIcon::Grab,
        }
    }

    /// Returns the values for the overlay of the next picture.
    pub(super) fn overlay_scene(&self) -> OverlayScene<'_> {
        let document = self.editor.document();
        let (grid, picker) = (document.grid(), self.picker());
        let target = self.editor.pointer().and_then(|at| self.editor.target(at, &picker));
        OverlayScene {
            tool: &self.editor.tool,
            document,
            view: &self.ui.view,
            theme: self.ui.appearance.theme,
            seen: self.viewpoint.pick_map(document).map(|map| &**map),
            pointer: self.editor.pointer(),
            stroking: self.editor.is_stroking(),
            sketch: self.editor.sketch(&picker),
            marker_guide: self.editor.marker_guide(),
            depth: picker.sight().depth(target.unwrap_or(grid.dims().as_vec3() * 0.5)),
        }
    }

    /// Returns the reference pictures of the window's next picture.
    pub(super) fn reference_pictures(&self) -> Vec<ReferencePicture> {
        let axes = self.picker().sight().axes_in_picture();
        let grid = self.editor.document().grid();
        references::pictures(&self.ui.references, grid, self.ui.view.up, &axes)
    }

    /// Handles the renderer's report about the window's picture.
    pub fn take_report(&mut self, report: FrameReport) {
        let FrameReport { pick_maps, times, fallbacks, .. } = report;
        self.take_fallbacks(&fallbacks);
        if let Some(map) = pick_maps.get(self.viewpoint.pointing_eye).or(pick_maps.first()) {
            self.viewpoint.set_pick_map(map.clone(), self.editor.document());
        }
        self.display.times.sample_ms = times.sample_ms;
        self.display.times.shade_ms = times.shade_ms;
    }

    /// Adopts the modes that the renderer has fallen back to, and says so.
    pub(super) fn take_fallbacks(&mut self, fallbacks: &[Fallback]) {
        for Fallback { reason, to } in fallbacks {
            let text = format!("{reason}; switched to {}", to.label());
            tracing::warn!("{text}");
            self.ui.toasts.error(text);
            self.ui.view.mode = *to;
        }
    }
}

/// Returns whether the input is more than the pointer moving over a panel.
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
