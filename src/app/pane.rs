//! A pane: one window of the program with everything that draws its interface, and the time of its next redraw. The
//! main window and every detached panel are panes.
//!
//! Each pane has an egui context, textures and a swapchain of its own; all share one device.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::epaint::ClippedShape;
use egui::{Ui, ViewportId};
use glam::{IVec2, UVec2, Vec2};
use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, Touch, WindowEvent};
use winit::keyboard::{Key, KeyCode, PhysicalKey};
use winit::window::{Window, WindowId};

use crate::gpu::{
    Attachment, Device, EyeImage, Frames, GpuError, ImagePart, Load, Recorder, ResourceUse,
    WindowSurface,
};
use crate::input::pen::{PenPointer, PenSample};
use crate::render::gui::{Gui, TextureChanges};
use crate::screen::pen::WindowKey;
use crate::screen::window::{WindowScreen, WindowTarget};
use crate::view::StereoLayout;
use crate::viewpoint::head::Monitor;

use super::glyphs::Glyphs;
use super::stereo_screen::{StereoPair, StereoScreen};

/// A window without its requested redraw after this time is not visible: on Wayland, such windows get no redraws.
const UNSEEN_AFTER: Duration = Duration::from_millis(250);
/// Time between two pictures where the refresh rate is unknown.
const USUAL_PERIOD: Duration = Duration::from_micros(16_667);
/// A picture may be this much early, since clocks are not exact.
const SLACK: Duration = Duration::from_millis(1);

/// A window with an interface. Fields are dropped in this order.
pub struct Pane {
    gui: Gui,
    /// Resources of stereo, once it was switched on.
    stereo: Option<StereoScreen>,
    frames: Frames,
    screen: WindowScreen,
    device: Arc<Device>,
    egui: egui_winit::State,
    window: Arc<Window>,
    /// How two eyes share the window.
    layout: StereoLayout,
    /// The eye whose picture the pointer is in.
    pointing_eye: usize,
    /// When the interface must be redrawn without an event.
    wake: Option<Instant>,
    /// Time of the request of a redraw that has not come.
    pending: Option<Instant>,
    /// Start of the last picture.
    begun: Option<Instant>,
    /// The last picture could not be presented because the window had changed. Another one is due.
    missed: bool,
    /// Changes of the interface's textures that are not yet uploaded or freed.
    textures: TextureChanges,
    glyphs: Glyphs,
    /// Acts as the pointer of a pen where the window system sends none.
    pen: PenPointer,
}

/// A picture being recorded.
pub struct RecordedFrame {
    pub recorder: Recorder,
    target: WindowTarget,
    /// The image holds a picture below the interface.
    pasted: bool,
}

/// The output of an egui pass, to be drawn.
pub struct Interface {
    pub shapes: Vec<ClippedShape>,
    pub pixels_per_point: f32,
    /// When the interface must be redrawn without an event.
    pub repaint_after: Duration,
    pub cursor: egui::CursorIcon,
}

impl Pane {
    /// Returns a pane for `window`, whose surface is `surface`.
    pub fn new(
        window: Arc<Window>,
        surface: WindowSurface,
        device: &Arc<Device>,
    ) -> Result<Pane, GpuError> {
        let screen = WindowScreen::new(device, surface, window.inner_size().into())?;
        let texture_side = device.limits().max_image_dimension2_d as usize;
        let scale = window.scale_factor() as f32;
        let egui = egui_winit::State::new(
            egui::Context::default(),
            ViewportId::ROOT,
            &window,
            Some(scale),
            window.theme(),
            Some(texture_side),
        );
        Ok(Pane {
            gui: Gui::new(device, screen.format())?,
            frames: Frames::new(device)?,
            screen,
            device: device.clone(),
            egui,
            window,
            stereo: None,
            layout: StereoLayout::Mono,
            pointing_eye: 0,
            wake: None,
            pending: None,
            begun: None,
            missed: false,
            textures: TextureChanges::default(),
            glyphs: Glyphs::default(),
            pen: PenPointer::default(),
        })
    }

    /// Drops everything except the window.
    pub fn into_window(self) -> Arc<Window> {
        self.window
    }

    /// Returns the position of the window on its monitor, if the system knows it.
    pub fn monitor(&self) -> Option<Monitor> {
        let window = self.window();
        let monitor = window.current_monitor()?;
        let (size, inner) = (monitor.size(), window.inner_size());
        let corner = monitor.position();
        let place = window.inner_position().ok();
        Some(Monitor {
            size_px: UVec2::new(size.width, size.height),
            window_px: place.map(|at| IVec2::new(at.x - corner.x, at.y - corner.y)),
            window_size_px: UVec2::new(inner.width, inner.height),
        })
        .filter(|monitor| monitor.size_px.min_element() > 0)
    }

    pub fn window(&self) -> &Window {
        &self.window
    }

    pub fn id(&self) -> WindowId {
        self.window.id()
    }

    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    pub fn screen(&self) -> &WindowScreen {
        &self.screen
    }

    /// Returns the slot of the frame begun last ([`Frames::slot`]).
    pub fn slot(&self) -> usize {
        self.frames.slot()
    }

    pub fn pixels_per_point(&self) -> f32 {
        self.egui.egui_ctx().pixels_per_point()
    }

    pub fn context(&self) -> &egui::Context {
        self.egui.egui_ctx()
    }

    /// Adds events from outside the window to the next pass.
    pub fn inject(&mut self, events: Vec<egui::Event>) {
        self.egui.egui_input_mut().events.extend(events);
    }

    /// Moves the system's pointer. Returns true if the system allows it.
    pub fn move_pointer(&self, at: egui::Pos2) -> bool {
        let at = at.to_vec2() * self.pixels_per_point();
        self.window.set_cursor_position(PhysicalPosition::new(at.x, at.y)).is_ok()
    }

    pub fn is_minimised(&self) -> bool {
        self.window.is_minimized().unwrap_or(false)
    }

    /// Requests a redraw. The window system decides when it comes (`WindowEvent::RedrawRequested`).
    pub fn redraw(&mut self) {
        self.pending.get_or_insert_with(Instant::now);
        self.window.request_redraw();
    }

    /// Notes that the requested redraw has come.
    pub fn begin_redraw(&mut self) {
        self.wake = None;
        self.pending = None;
    }

    /// Gives up waiting for the requested redraw.
    pub fn cancel_redraw(&mut self) {
        self.pending = None;
    }

    /// Returns when the screen can show another picture, if that is after `now`. Without this, pictures would go to the
    /// mailbox as fast as the device can draw.
    pub fn is_early(&self, now: Instant) -> Option<Instant> {
        let begun = self.begun.filter(|_| !self.screen.is_paced())?;
        let rate = self.window.current_monitor().and_then(|m| m.refresh_rate_millihertz());
        Some(begun + period(rate)).filter(|due| *due > now)
    }

    /// Returns whether the window is not visible: the requested redraw does not come.
    pub fn is_unseen(&self, now: Instant) -> bool {
        self.pending.is_some_and(|since| since + UNSEEN_AFTER <= now)
    }

    /// Returns whether the last picture was not presented, so that the window system still waits for it before it asks
    /// for another.
    pub fn has_missed(&self) -> bool {
        self.missed
    }

    /// Sets the time of the next redraw without an event.
    pub fn wake_at(&mut self, wake: Option<Instant>) {
        self.wake = wake;
    }

    /// Returns when the pane must be updated without an event.
    pub fn wake(&self) -> Option<Instant> {
        let unseen = self.pending.map(|since| since + UNSEEN_AFTER);
        self.wake.into_iter().chain(unseen).min()
    }

    /// Returns whether a redraw was requested and has not come.
    pub fn is_pending(&self) -> bool {
        self.pending.is_some()
    }

    /// Sets the stereo layout of the next pictures. Layers need a window that supports them
    /// ([`WindowScreen::can_layer`]).
    pub fn arrange(&mut self, layout: StereoLayout) {
        self.layout = layout;
        self.screen.set_layered(layout == StereoLayout::Layers);
    }

    /// Returns the eye whose picture the pointer is in: 0 for the left one or both.
    pub fn pointing_eye(&self) -> usize {
        self.pointing_eye
    }

    /// Returns the event with its position mapped into one eye's picture.
    fn unfold(&mut self, event: &WindowEvent) -> Option<WindowEvent> {
        let size: [u32; 2] = self.window.inner_size().into();
        let mut unfold = |at: PhysicalPosition<f64>| {
            let at = Vec2::new(at.x as f32, at.y as f32);
            let (eye, at) = self.layout.unfold(at, size.into());
            self.pointing_eye = eye;
            PhysicalPosition::new(f64::from(at.x), f64::from(at.y))
        };
        match event.clone() {
            WindowEvent::CursorMoved { device_id, position } => {
                Some(WindowEvent::CursorMoved { device_id, position: unfold(position) })
            }
            WindowEvent::Touch(touch) => {
                let location = unfold(touch.location);
                Some(WindowEvent::Touch(Touch { location, ..touch }))
            }
            _ => None,
        }
    }

    /// Returns the name that the window system uses for the window in pen events.
    pub fn pen_key(&self) -> Option<WindowKey> {
        WindowKey::of(&self.window)
    }

    /// Handles a pen sample over the window, and returns it with its position mapped into one eye's picture. If no
    /// other pointer is sent for it (`leads_pointer`, with the position in points), the next pass receives one.
    pub fn hear_pen(&mut self, sample: &PenSample, leads_pointer: bool) -> PenSample {
        let scale = if leads_pointer { self.window.scale_factor() as f32 } else { 1.0 };
        let size: [u32; 2] = self.window.inner_size().into();
        let (eye, position_px) = self.layout.unfold(sample.position_px * scale, size.into());
        let sample = PenSample { position_px, ..*sample };
        if leads_pointer {
            self.pointing_eye = eye;
            let modifiers = self.context().input(|input| input.modifiers);
            let events = self.pen.events(&sample, self.pixels_per_point(), modifiers);
            self.inject(events);
        }
        sample
    }

    /// Handles an event of the window. Returns true if it calls for another picture.
    pub fn handle_event(&mut self, event: &WindowEvent) -> bool {
        let unfolded = self.unfold(event);
        let event = unfolded.as_ref().unwrap_or(event);
        if let WindowEvent::Resized(size) = event {
            self.screen.resize((*size).into());
        }
        let redraw = matches!(event, WindowEvent::RedrawRequested);
        let before = self.egui.egui_input_mut().events.len();
        let repaint = self.egui.on_window_event(&self.window, event).repaint && !redraw;
        let input = self.egui.egui_input_mut();
        // Ctrl+V with an empty clipboard would give no event at all.
        if input.events.len() == before && is_paste_key(event) {
            input.events.push(egui::Event::Paste(String::new()));
        }
        repaint
    }

    /// Waits up to `patience` for a free image of the window. Returns `None` while there is none.
    pub fn begin(&mut self, patience: Duration) -> Result<Option<RecordedFrame>, GpuError> {
        let begun = Instant::now();
        let recorder = self.frames.begin()?;
        let target = self.screen.acquire(self.frames.slot(), patience)?;
        if target.is_some() {
            self.begun = Some(begun);
        }
        Ok(target.map(|target| RecordedFrame { recorder, target, pasted: false }))
    }

    /// Runs a pass of the interface, which `show` fills. Its textures wait for the next picture.
    pub fn interface(&mut self, show: impl FnMut(&mut Ui)) -> Interface {
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let mut output = context.run_ui(input, show);
        put_candidates_at_the_cursor(&mut output.platform_output);
        let cursor = output.platform_output.cursor_icon;
        self.egui.handle_platform_output(&self.window, output.platform_output);
        let viewport = output.viewport_output.get(&ViewportId::ROOT);
        self.textures.append(output.textures_delta);
        let fonts = self.glyphs.look(&context, &output.shapes);
        let repaint_after = viewport.map_or(Duration::MAX, |v| v.repaint_delay);
        Interface {
            shapes: output.shapes,
            pixels_per_point: output.pixels_per_point,
            repaint_after: fonts.map_or(repaint_after, |soon| soon.min(repaint_after)),
            cursor,
        }
    }

    /// Returns whether textures wait for the next picture.
    pub fn has_textures(&self) -> bool {
        !self.textures.is_empty()
    }

    /// Returns the error, once, if memory was lacking for a part of the interface ([`Gui::take_lack`]).
    pub fn take_lack(&mut self) -> Option<GpuError> {
        self.gui.take_lack()
    }

    /// Records the interface over the pasted picture, or over nothing.
    pub fn draw(
        &mut self,
        frame: &mut RecordedFrame,
        interface: &Interface,
    ) -> Result<(), GpuError> {
        let RecordedFrame { recorder, target, pasted } = frame;
        self.gui.upload(recorder, self.frames.slot(), &mut self.textures)?;
        let context = self.egui.egui_ctx();
        let primitives = context.tessellate(interface.shapes.clone(), interface.pixels_per_point);
        let (before, load) = match pasted {
            true => (ResourceUse::COPY_TARGET, Load::Keep),
            false => (WindowTarget::FIRST, Load::Colour([0.0, 0.0, 0.0, 1.0])),
        };
        recorder.image_barrier(target.part(), before, ResourceUse::COLOUR_TARGET);
        let attachment = Attachment { view: target.view(0), load, store: true };
        recorder.begin_rendering(target.size, Some(attachment), None);
        self.gui.draw(recorder, target.size, interface.pixels_per_point, primitives)?;
        recorder.end_rendering();
        recorder.image_barrier(target.part(), ResourceUse::COLOUR_TARGET, ResourceUse::PRESENT);
        Ok(())
    }

    /// Records the pictures of two eyes with their upper left corner at the pixel `corner`, and the interface over
    /// them.
    pub fn draw_stereo(
        &mut self,
        frame: &mut RecordedFrame,
        interface: &Interface,
        pictures: &mut EyeImage,
        corner: IVec2,
    ) -> Result<(), GpuError> {
        let RecordedFrame { recorder, target, .. } = frame;
        self.gui.upload(recorder, self.frames.slot(), &mut self.textures)?;
        let context = self.egui.egui_ctx();
        let primitives = context.tessellate(interface.shapes.clone(), interface.pixels_per_point);
        let size = UVec2::from(target.size);
        let stereo = match &mut self.stereo {
            Some(stereo) => stereo,
            none => none.insert(StereoScreen::new(&self.device, self.screen.format(), size)?),
        };
        stereo.begin_interface(recorder, size)?;
        self.gui.draw(recorder, target.size, interface.pixels_per_point, primitives)?;
        recorder.end_rendering();
        let pair = StereoPair { pictures, corner, layout: self.layout };
        stereo.compose(recorder, self.frames.slot(), target, pair)
    }

    /// Presents the picture. Returns false if the window has changed too much; another one is due at once then
    /// ([`Pane::has_missed`]).
    pub fn end(&mut self, frame: RecordedFrame) -> Result<bool, GpuError> {
        let RecordedFrame { recorder, target, .. } = frame;
        self.frames.submit(recorder, &[target.wait()], &[target.signal()])?;
        self.gui.free(&mut self.textures);
        // Wayland asks for the next picture when this one has become visible.
        self.window.pre_present_notify();
        let shown = self.screen.present(&target)?;
        self.missed = !shown;
        Ok(shown)
    }
}

/// Places an input method's candidates at the cursor instead of the field, which may be long.
fn put_candidates_at_the_cursor(output: &mut egui::PlatformOutput) {
    if let Some(ime) = &mut output.ime {
        ime.rect = ime.cursor_rect;
    }
}

/// Returns the shortest time between two pictures at a refresh rate.
fn period(millihertz: Option<u32>) -> Duration {
    let rate = millihertz.filter(|rate| (10_000..=1_000_000).contains(rate));
    let period = rate.map_or(USUAL_PERIOD, |rate| Duration::from_secs(1000) / rate);
    period.saturating_sub(SLACK)
}

/// Returns whether the paste key was pressed: V, or the key at its position on keyboards without Latin letters.
fn is_paste_key(event: &WindowEvent) -> bool {
    let WindowEvent::KeyboardInput { event, is_synthetic: false, .. } = event else { return false };
    let latin = match &event.logical_key {
        Key::Character(text) => egui::Key::from_name(text),
        _ => None,
    };
    let pressed = event.state == ElementState::Pressed && !event.repeat;
    let placed = || event.physical_key == PhysicalKey::Code(KeyCode::KeyV);
    pressed && latin.map_or_else(placed, |key| key == egui::Key::V)
}

impl RecordedFrame {
    /// Copies a picture of `size` pixels, in the layout of [`ResourceUse::COPY_SOURCE`], below the interface,
    /// with its upper left corner at the pixel `at`.
    pub fn paste(&mut self, picture: ImagePart, size: [u32; 2], at: [u32; 2]) {
        self.recorder.image_barrier(
            self.target.part(),
            WindowTarget::FIRST,
            ResourceUse::COPY_TARGET,
        );
        WindowScreen::paste(&mut self.recorder, picture, size, &self.target, at);
        self.pasted = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_method_is_told_where_the_letter_is_that_is_written() {
        let context = egui::Context::default();
        let mut text = "a sculpture with a name of some length".to_string();
        let mut pass = |events| {
            let input = egui::RawInput { events, ..egui::RawInput::default() };
            let mut field = egui::Rect::NOTHING;
            let mut output = context.run_ui(input, |ui| {
                let response = ui.add(egui::TextEdit::singleline(&mut text).desired_width(600.0));
                response.request_focus();
                field = response.rect;
            });
            output.textures_delta.clear();
            put_candidates_at_the_cursor(&mut output.platform_output);
            (output.platform_output.ime.map(|ime| ime.rect), field)
        };
        pass(Vec::new());
        pass(vec![egui::Event::WindowFocused(true)]);
        let (place, field) = pass(Vec::new());
        let place = place.expect("a field has the focus");
        assert!(place.width() < 10.0 && field.contains_rect(place), "{place:?} in {field:?}");
        assert!(place.left() > field.left() + 100.0, "at the end of the text");
    }

    #[test]
    fn the_period_follows_the_refresh_rate_and_is_never_zero() {
        let ms = |rate| period(rate).as_secs_f32() * 1e3;
        assert!((ms(Some(60_000)) - 15.67).abs() < 0.01);
        assert!((ms(Some(144_000)) - 5.94).abs() < 0.01);
        // An implausible rate counts as unknown: otherwise there would be no wait at all.
        for none in [None, Some(0), Some(1), Some(u32::MAX)] {
            assert!((ms(none) - 15.67).abs() < 0.01, "{none:?}");
        }
    }
}
