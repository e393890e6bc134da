//! The board's interface without its picture: an egui context of its own, the ray of a hand as its
//! mouse, and a keyboard over it while a text field has the focus.
//!
//! Takes controller events and a function that shows the widgets; gives shapes. Needs no device.

use std::time::Duration;

use egui::{
    Color32, Context, Event, FullOutput, Id, LayerId, Order, PointerButton, Pos2, RawInput,
};
use egui::{Modifiers, MouseWheelUnit, Rect, Stroke, TouchPhase, Ui, ViewportId};
use glam::{UVec2, Vec2};

use crate::app::glyphs::Glyphs;
use crate::input::hands::HandEvent;
use crate::ui::widgets::keyboard::Keyboard;

/// Longest time between two passes, in seconds. The board also shows changes made in the window.
const REFRESH_S: f64 = 0.25;

/// Longest press that is a click, in seconds.
const MAX_CLICK_S: f64 = 3.0;
/// Farthest that the pointer may move in a click on a widget that can also be dragged, in points.
const CLICK_DRIFT: f32 = 6.0;

/// The receiver of a press of the pointer until its release.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum PressTarget {
    Widgets,
    Keyboard,
}

/// The board's interface.
pub struct BoardUi {
    context: Context,
    size_px: UVec2,
    pixels_per_point: f32,
    /// The largest side of a texture, in pixels.
    texture_limit: usize,
    events: Vec<Event>,
    /// Where the ray points, in points.
    pointer: Option<Pos2>,
    /// egui has been told that the pointer is over the board.
    pointer_sent: bool,
    press_target: Option<PressTarget>,
    /// The rectangle of the pressed widget until it is released, if the widget cannot be dragged.
    pressed: Option<Rect>,
    keyboard: Keyboard,
    /// The content drawn over the widgets (keyboard, pointer) has changed.
    stale: bool,
    /// When the next pass is due, in seconds since the program's start.
    due_s: f64,
    glyphs: Glyphs,
}

impl BoardUi {
    pub fn new(size_px: UVec2, pixels_per_point: f32, texture_limit: usize) -> BoardUi {
        let context = Context::default();
        context.options_mut(|options| {
            options.input_options.max_click_duration = MAX_CLICK_S;
            options.input_options.max_click_dist = CLICK_DRIFT;
        });
        BoardUi {
            context,
            size_px,
            pixels_per_point,
            texture_limit,
            events: Vec::new(),
            pointer: None,
            pointer_sent: false,
            press_target: None,
            pressed: None,
            keyboard: Keyboard::default(),
            stale: false,
            due_s: 0.0,
            glyphs: Glyphs::default(),
        }
    }

    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Handles a controller event for the board.
    pub fn handle(&mut self, event: &HandEvent) {
        let modifiers = Modifiers::NONE;
        match *event {
            HandEvent::Point(at) => {
                let size = self.size_points();
                let share = at;
                let at = Pos2::new(at.x * size.x, at.y * size.y);
                if self.pointer.replace(at) != Some(at) {
                    tracing::trace!("board pointed at {:.3},{:.3}", share.x, share.y);
                    self.send_pointer();
                    self.stale = true;
                }
            }
            HandEvent::PointAway => {
                self.pointer = None;
                self.send_pointer();
            }
            HandEvent::Click(true) => {
                self.press_target = Some(if self.is_on_keyboard() {
                    PressTarget::Keyboard
                } else {
                    PressTarget::Widgets
                });
                if self.press_target == Some(PressTarget::Keyboard) {
                    self.keyboard.press(&self.context, &mut self.events);
                    tracing::debug!("key of the board pressed");
                    self.stale = true;
                } else if let Some(pos) = self.pointer {
                    let (button, pressed) = (PointerButton::Primary, true);
                    self.events.push(Event::PointerButton { pos, button, pressed, modifiers });
                }
                tracing::debug!("board pressed");
            }
            HandEvent::Click(false) => {
                if self.press_target.take() == Some(PressTarget::Keyboard) {
                    self.keyboard.release();
                    tracing::debug!("key of the board released");
                    self.stale = true;
                } else {
                    // Released beside the board: at the last position.
                    let last = || self.context.input(|input| input.pointer.latest_pos());
                    if let Some(pos) = self.pointer.or_else(last) {
                        // egui decides whether this is too far for a click.
                        self.events.push(Event::PointerMoved(pos));
                        let (button, pressed) = (PointerButton::Primary, false);
                        self.events.push(Event::PointerButton { pos, button, pressed, modifiers });
                    }
                }
                self.send_pointer();
                tracing::debug!("board released");
            }
            HandEvent::Scroll(by) => self.events.push(Event::MouseWheel {
                unit: MouseWheelUnit::Point,
                delta: egui::vec2(by.x, by.y),
                phase: TouchPhase::Move,
                modifiers,
            }),
            _ => {}
        }
    }

    /// Returns whether the pointer acts on the keyboard. It does not during a drag that began on a widget.
    fn is_on_keyboard(&self) -> bool {
        match self.press_target {
            Some(target) => target == PressTarget::Keyboard,
            None => self.pointer.is_some_and(|at| self.keyboard.covers(at)),
        }
    }

    /// Sends the pointer's position to the keyboard or to the widgets.
    fn send_pointer(&mut self) {
        let on_keyboard = self.is_on_keyboard();
        self.stale |= self.keyboard.point(self.pointer.filter(|_| on_keyboard));
        match self.pointer.filter(|_| !on_keyboard) {
            Some(at) => {
                self.pointer_sent = true;
                self.events.push(Event::PointerMoved(at));
            }
            None if std::mem::take(&mut self.pointer_sent) => self.events.push(Event::PointerGone),
            None => {}
        }
    }

    /// Returns the width and height in points, at the chosen text size.
    fn size_points(&self) -> Vec2 {
        self.size_px.as_vec2() / (self.pixels_per_point * self.context.zoom_factor())
    }

    /// Returns whether another pass is due at `now_s`.
    pub fn is_due(&self, now_s: f64) -> bool {
        let due_s = self.keyboard.due_s().map_or(self.due_s, |due_s| due_s.min(self.due_s));
        self.stale || !self.events.is_empty() || now_s >= due_s
    }

    /// Sets how far the pointer may move in a click. Press and release within one widget are a click; on a widget that
    /// can also be dragged, the distance decides.
    fn set_click_distance(&self) {
        let button = |event: &Event| match event {
            Event::PointerButton { pos, pressed, .. } => Some((*pos, *pressed)),
            _ => None,
        };
        let distance = match (self.pressed, self.events.iter().find_map(button)) {
            (Some(_), None | Some((_, true))) => f32::INFINITY,
            (Some(widget), Some((pos, false))) if widget.contains(pos) => f32::INFINITY,
            (Some(_), Some((_, false))) => 0.0,
            (None, _) => CLICK_DRIFT,
        };
        self.context.options_mut(|options| options.input_options.max_click_dist = distance);
    }

    /// Remembers the widget pressed in the last pass until it is released.
    fn note_pressed(&mut self) {
        let pointer = |input: &egui::InputState| {
            (input.pointer.primary_pressed(), input.pointer.primary_down())
        };
        let (pressed, down) = self.context.input(pointer);
        if pressed {
            let widget = self.context.viewport(|viewport| viewport.hits.click);
            let widget = widget.filter(|widget| !widget.sense.senses_drag());
            self.pressed = widget.map(|widget| widget.interact_rect);
        }
        self.pressed = self.pressed.filter(|_| down);
    }

    /// Runs a pass of the widgets that `show` adds.
    pub fn pass(&mut self, now_s: f64, mut show: impl FnMut(&mut Ui)) -> FullOutput {
        self.keyboard.hold(now_s, &self.context, &mut self.events);
        self.set_click_distance();
        let size = self.size_points();
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, egui::vec2(size.x, size.y))),
            max_texture_side: Some(self.texture_limit),
            time: Some(now_s),
            events: std::mem::take(&mut self.events),
            ..RawInput::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(self.pixels_per_point);
        }
        let (pointer, keyboard) = (self.pointer, &self.keyboard);
        let output = self.context.clone().run_ui(input, |root| {
            show(root);
            keyboard.paint(root.ctx());
            if let Some(at) = pointer {
                draw_pointer(root.ctx(), at);
            }
        });
        self.note_pressed();
        let viewport = output.viewport_output.get(&ViewportId::ROOT);
        let again = viewport.map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        let again =
            self.glyphs.look(&self.context, &output.shapes).map_or(again, |soon| soon.min(again));
        self.due_s = now_s + again.as_secs_f64().min(REFRESH_S);
        let field = output.platform_output.ime.as_ref().map(|ime| ime.rect);
        self.stale = self.keyboard.follow(field, self.context.content_rect());
        if self.stale {
            // The keyboard has appeared or disappeared under the pointer.
            match &field {
                Some(_) => tracing::debug!("keyboard on the board"),
                None => tracing::debug!("keyboard gone"),
            }
            self.send_pointer();
        }
        output
    }
}

/// Draws a ring where the ray hits the board.
fn draw_pointer(ctx: &Context, at: Pos2) {
    let painter = ctx.layer_painter(LayerId::new(Order::Debug, Id::new("hand pointer")));
    painter.circle_stroke(at, 7.0, Stroke::new(3.0, Color32::BLACK));
    painter.circle_stroke(at, 7.0, Stroke::new(1.5, Color32::WHITE));
    painter.circle_filled(at, 2.0, Color32::WHITE);
}

#[cfg(test)]
#[path = "board_ui_tests.rs"]
mod tests;
