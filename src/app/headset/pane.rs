//! Owns the picture of the board: an egui pass into an image of its own, which the headset shows
//! as a thing on the hand. The ray of the other hand is its mouse.

use std::sync::Arc;
use std::time::Duration;

use ash::vk;
use egui::epaint::ClippedShape;
use egui::{Color32, Context, Event, Id, LayerId, Order, PointerButton, Pos2, RawInput, Rect};
use egui::{Modifiers, MouseWheelUnit, Stroke, TexturesDelta, TouchPhase, ViewportId};
use glam::{UVec2, Vec2};

use crate::app::Workbench;
use crate::gpu::{Attachment, Device, GpuError, ImagePart, Load, Recorder, Serial, Use};
use crate::input::hands::HandAsk;
use crate::render::gui::Gui;
use crate::render::target::EyeImage;
use crate::shade::Pixels;

/// The board is drawn anew this often even if nothing calls for it: what the window does shows
/// there, too.
const REFRESH_S: f64 = 0.25;
const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// The board's interface and its picture. Fields are dropped in this order.
pub struct BoardPane {
    gui: Gui,
    picture: EyeImage,
    context: Context,
    pixels_per_point: f32,
    events: Vec<Event>,
    /// Where the ray points, in points.
    pointer: Option<Pos2>,
    /// When the next pass is due, in seconds of the program.
    due_s: f64,
    device: Arc<Device>,
}

/// What a pass leaves to be drawn.
pub struct Pass {
    shapes: Vec<ClippedShape>,
    textures: TexturesDelta,
}

impl BoardPane {
    /// With a picture of `size_px` pixels.
    pub fn new(
        device: &Arc<Device>,
        size_px: UVec2,
        pixels_per_point: f32,
    ) -> Result<BoardPane, GpuError> {
        use vk::ImageUsageFlags as Usage;
        let usage = Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC;
        Ok(BoardPane {
            gui: Gui::new(device, FORMAT, false)?,
            picture: EyeImage::new(device, "board", size_px, 1, FORMAT, usage)?,
            context: Context::default(),
            pixels_per_point,
            events: Vec::new(),
            pointer: None,
            due_s: 0.0,
            device: device.clone(),
        })
    }

    /// Hears what the hands do with the board.
    pub fn hear(&mut self, ask: &HandAsk) {
        let modifiers = Modifiers::NONE;
        match *ask {
            HandAsk::Point(at) => {
                let size = self.size_points();
                let at = Pos2::new(at.x * size.x, at.y * size.y);
                if self.pointer != Some(at) {
                    self.pointer = Some(at);
                    self.events.push(Event::PointerMoved(at));
                }
            }
            HandAsk::PointAway => {
                self.pointer = None;
                self.events.push(Event::PointerGone);
            }
            HandAsk::Click(pressed) => {
                // Released beside the board: where it was last.
                let last = || self.context.input(|input| input.pointer.latest_pos());
                if let Some(pos) = self.pointer.or_else(last) {
                    let button = PointerButton::Primary;
                    self.events.push(Event::PointerButton { pos, button, pressed, modifiers });
                }
            }
            HandAsk::Scroll(by) => self.events.push(Event::MouseWheel {
                unit: MouseWheelUnit::Point,
                delta: egui::vec2(by.x, by.y),
                phase: TouchPhase::Move,
                modifiers,
            }),
            _ => {}
        }
    }

    fn size_points(&self) -> Vec2 {
        self.picture.size().as_vec2() / self.pixels_per_point
    }

    /// Whether something calls for another pass at `now_s`.
    pub fn is_due(&self, now_s: f64) -> bool {
        !self.events.is_empty() || now_s >= self.due_s
    }

    /// Runs a pass of the interface, in which the workbench does what the person wants.
    pub fn pass(&mut self, bench: &mut Workbench, now_s: f64) -> Pass {
        let size = self.size_points();
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(size.x, size.y))),
            max_texture_side: Some(self.device.limits().max_image_dimension2_d as usize),
            time: Some(now_s),
            events: std::mem::take(&mut self.events),
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(self.pixels_per_point);
        }
        let pointer = self.pointer;
        let output = self.context.clone().run_ui(input, |root| {
            bench.show_on_board(root);
            if let Some(at) = pointer {
                draw_pointer(root.ctx(), at);
            }
        });
        let viewport = output.viewport_output.get(&ViewportId::ROOT);
        let again = viewport.map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.due_s = now_s + again.as_secs_f64().min(REFRESH_S);
        Pass { shapes: output.shapes, textures: output.textures_delta }
    }

    /// Records the picture of a pass; it is in the layout of [`Use::COPY_SOURCE`] then.
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        pass: &mut Pass,
    ) -> Result<ImagePart, GpuError> {
        self.gui.upload(&mut pass.textures)?;
        let points = self.context.pixels_per_point();
        let primitives = self.context.tessellate(std::mem::take(&mut pass.shapes), points);
        self.picture.renew(recorder, 0, Use::COLOUR_TARGET);
        let view = self.picture.image().view();
        let attachment = Attachment { view, load: Load::Colour([0.0; 4]), store: true };
        let size = self.picture.size().to_array();
        recorder.begin_rendering(size, Some(attachment), None);
        self.gui.draw(recorder, size, points, &primitives)?;
        recorder.end_rendering();
        self.picture.make(recorder, 0, Use::COPY_SOURCE);
        Ok(self.picture.image().layer(0))
    }

    /// After the submission that draws a pass.
    pub fn submitted(&mut self, pass: &mut Pass, serial: Serial) {
        self.gui.free_after(&mut pass.textures, serial);
    }

    /// The picture, in memory. Waits.
    pub fn read_back(&self) -> Result<Pixels, GpuError> {
        let image = self.picture.image();
        let bytes = crate::gpu::read_image_once(
            &self.device,
            image.layer(0),
            image.size(),
            4,
            Use::COPY_SOURCE,
        )?;
        Ok(Pixels { size: self.picture.size(), rgba: bytemuck::pod_collect_to_vec(&bytes) })
    }
}

/// A ring where the ray meets the board.
fn draw_pointer(ctx: &Context, at: Pos2) {
    let painter = ctx.layer_painter(LayerId::new(Order::Debug, Id::new("hand pointer")));
    painter.circle_stroke(at, 7.0, Stroke::new(3.0, Color32::BLACK));
    painter.circle_stroke(at, 7.0, Stroke::new(1.5, Color32::WHITE));
    painter.circle_filled(at, 2.0, Color32::WHITE);
}
