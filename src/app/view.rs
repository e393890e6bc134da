//! Owns the edge of the program: the window, the device behind it, egui's link to both.
//!
//! All that winit and Vulkan know of the program goes through here; what is drawn is decided by
//! the workbench.

use std::sync::Arc;
use std::time::Duration;

use egui::{ClippedPrimitive, TexturesDelta, ViewportId};
use winit::event::WindowEvent;
use winit::window::Window;

use super::painter::Painter;
use super::workbench::Workbench;
use crate::config::Config;
use crate::gpu::{
    Attachment, Device, Frames, GpuError, Load, Recorder, Use, ValidationLog, WindowHost,
};
use crate::render::gui::Gui;
use crate::screen::window::{Target, WindowScreen};
use crate::view::Eye;

/// A window with all that draws to it. Fields are dropped in this order.
pub struct View {
    painter: Painter,
    gui: Gui,
    frames: Frames,
    screen: WindowScreen,
    device: Arc<Device>,
    egui: egui_winit::State,
    window: Arc<Window>,
    /// Pictures shown.
    shown: u64,
}

/// A picture being made.
pub struct Frame {
    recorder: Recorder,
    target: Target,
}

/// What an egui pass leaves to be drawn.
pub struct Interface {
    primitives: Vec<ClippedPrimitive>,
    pixels_per_point: f32,
    textures: TexturesDelta,
    /// When the interface wants another picture by itself.
    pub repaint_after: Duration,
}

impl View {
    /// `eye`: of the first picture.
    pub fn new(window: Arc<Window>, config: &Config, eye: &Eye) -> Result<View, GpuError> {
        let mut host = WindowHost::new(window.clone());
        let device = Device::new(&mut host, &config.device_options())?;
        let size = window.inner_size();
        let screen = WindowScreen::new(&device, host.into_surface()?, size.into())?;

        let context = egui::Context::default();
        context.set_zoom_factor(config.window.scale);
        let texture_side = device.limits().max_image_dimension2_d as usize;
        let scale = window.scale_factor() as f32;
        let egui = egui_winit::State::new(
            context,
            ViewportId::ROOT,
            &window,
            Some(scale),
            window.theme(),
            Some(texture_side),
        );
        Ok(View {
            painter: Painter::new(&device, screen.format(), eye)?,
            gui: Gui::new(&device, screen.format(), screen.encodes_srgb())?,
            frames: Frames::new(&device)?,
            screen,
            device,
            egui,
            window,
            shown: 0,
        })
    }

    /// Gives everything back but the window.
    pub fn into_window(self) -> Arc<Window> {
        self.window
    }

    pub fn validation_log(&self) -> Arc<ValidationLog> {
        self.device.validation_log().clone()
    }

    pub fn request_redraw(&self) {
        self.window.request_redraw();
    }

    pub fn is_minimised(&self) -> bool {
        self.window.is_minimized().unwrap_or(false)
    }

    pub fn set_title(&self, bench: &Workbench) {
        let session = bench.session();
        let name = session.path().and_then(|p| p.file_name()).map(|n| n.to_string_lossy());
        let star = if session.modified() { "*" } else { "" };
        let name = name.as_deref().unwrap_or("untitled");
        self.window.set_title(&format!("{name}{star} – Virtual Sculpture"));
    }

    /// Hears an event of the window; true if it calls for another picture.
    pub fn hear(&mut self, event: &WindowEvent) -> bool {
        if let WindowEvent::Resized(size) = event {
            self.screen.resize((*size).into());
        }
        let redraw = matches!(event, WindowEvent::RedrawRequested);
        self.egui.on_window_event(&self.window, event).repaint && !redraw
    }

    /// Waits for a free image of the window; none while there is nothing to draw to.
    pub fn begin(&mut self) -> Result<Option<Frame>, GpuError> {
        let recorder = self.frames.begin()?;
        let target = self.screen.acquire(self.frames.slot())?;
        Ok(target.map(|target| Frame { recorder, target }))
    }

    /// Runs a pass of the interface, in which the workbench does what the person wants.
    pub fn interface(&mut self, bench: &mut Workbench) -> Interface {
        if bench.device.is_empty() {
            bench.device = self.device.device_name();
        }
        let input = self.egui.take_egui_input(&self.window);
        let context = self.egui.egui_ctx().clone();
        let output = context.run_ui(input, |root| bench.show(root));
        self.egui.handle_platform_output(&self.window, output.platform_output);
        let pixels_per_point = output.pixels_per_point;
        let repaint_after = output
            .viewport_output
            .get(&ViewportId::ROOT)
            .map_or(Duration::MAX, |v| v.repaint_delay);
        Interface {
            primitives: context.tessellate(output.shapes, pixels_per_point),
            pixels_per_point,
            textures: output.textures_delta,
            repaint_after,
        }
    }

    /// Puts the picture of the sculpture into its place in the window.
    pub fn draw_sculpture(
        &mut self,
        frame: &mut Frame,
        bench: &mut Workbench,
    ) -> Result<(), GpuError> {
        let slot = self.frames.slot();
        let picture = self.painter.paint(&mut frame.recorder, slot, bench)?;
        let (layer, size) = (picture.image().layer(0), picture.size().to_array());
        let part = frame.target.part();
        frame.recorder.image_barrier(part, Target::FIRST, Use::COPY_TARGET);
        let pixels_per_point = self.egui.egui_ctx().pixels_per_point();
        let corner = (bench.picture().min.to_vec2() * pixels_per_point).round();
        let at = [corner.x.max(0.0) as u32, corner.y.max(0.0) as u32];
        WindowScreen::paste(&mut frame.recorder, layer, size, &frame.target, at);
        Ok(())
    }

    /// Draws panels and windows over it.
    pub fn draw_interface(
        &mut self,
        frame: &mut Frame,
        interface: &mut Interface,
    ) -> Result<(), GpuError> {
        self.gui.upload(&mut interface.textures)?;
        let recorder = &mut frame.recorder;
        recorder.image_barrier(frame.target.part(), Use::COPY_TARGET, Use::COLOUR_TARGET);
        let target = Attachment { view: frame.target.view, load: Load::Keep, store: true };
        let size = frame.target.size;
        recorder.begin_rendering(size, Some(target), None);
        self.gui.draw(recorder, size, interface.pixels_per_point, &interface.primitives)?;
        recorder.end_rendering();
        recorder.image_barrier(frame.target.part(), Use::COLOUR_TARGET, Use::PRESENT);
        Ok(())
    }

    /// Hands the picture to the window.
    pub fn end(&mut self, frame: Frame, mut interface: Interface) -> Result<(), GpuError> {
        let Frame { recorder, target } = frame;
        let serial = self.frames.submit(recorder, &[target.wait()], &[target.signal()])?;
        self.gui.free_after(&mut interface.textures, serial);
        self.screen.present(&target)?;
        self.shown += 1;
        tracing::debug!(number = self.shown, "picture shown");
        Ok(())
    }
}
