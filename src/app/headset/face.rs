//! Owns the board's interface without its picture: an egui context of its own, the ray of a hand
//! as its mouse, and a keyboard over it while a field wants text.
//!
//! Takes what hands ask for and what is to be shown; gives shapes. Needs no device.

use std::time::Duration;

use egui::{
    Color32, Context, Event, FullOutput, Id, LayerId, Order, PointerButton, Pos2, RawInput,
};
use egui::{Modifiers, MouseWheelUnit, Rect, Stroke, TouchPhase, Ui, ViewportId};
use glam::{UVec2, Vec2};

use crate::input::hands::HandEvent;
use crate::ui::keyboard::Keyboard;

/// The board is drawn anew this often even if nothing calls for it: what the window does shows
/// there, too.
const REFRESH_S: f64 = 0.25;

/// A press that is longer is no click, in seconds.
const LONGEST_CLICK_S: f64 = 3.0;
/// A press on what can be dragged, too, is no click if it goes farther than this, in points.
const CLICK_DRIFT: f32 = 6.0;

/// What a press of the pointer is for until it is released.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Meant {
    Widgets,
    Keys,
}

/// The board's interface.
pub struct BoardFace {
    context: Context,
    size_px: UVec2,
    pixels_per_point: f32,
    /// The largest side of a texture, in pixels.
    texture_limit: usize,
    events: Vec<Event>,
    /// Where the ray points, in points.
    pointer: Option<Pos2>,
    /// The widgets have been told that the pointer is over them.
    told: bool,
    meant: Option<Meant>,
    /// Where the widget is that was pressed, while it is, if it can be clicked only.
    pressed: Option<Rect>,
    keyboard: Keyboard,
    /// What is drawn over the widgets has changed.
    stale: bool,
    /// When the next pass is due, in seconds of the program.
    due_s: f64,
}

impl BoardFace {
    pub fn new(size_px: UVec2, pixels_per_point: f32, texture_limit: usize) -> BoardFace {
        let context = Context::default();
        context.options_mut(|options| {
            options.input_options.max_click_duration = LONGEST_CLICK_S;
            options.input_options.max_click_dist = CLICK_DRIFT;
        });
        BoardFace {
            context,
            size_px,
            pixels_per_point,
            texture_limit,
            events: Vec::new(),
            pointer: None,
            told: false,
            meant: None,
            pressed: None,
            keyboard: Keyboard::default(),
            stale: false,
            due_s: 0.0,
        }
    }

    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Hears what the hands do with the board.
    pub fn hear(&mut self, event: &HandEvent) {
        let modifiers = Modifiers::NONE;
        match *event {
            HandEvent::Point(at) => {
                let size = self.size_points();
                let at = Pos2::new(at.x * size.x, at.y * size.y);
                if self.pointer.replace(at) != Some(at) {
                    self.lead();
                    self.stale = true;
                }
            }
            HandEvent::PointAway => {
                self.pointer = None;
                self.lead();
            }
            HandEvent::Click(true) => {
                self.meant = Some(if self.is_on_keys() { Meant::Keys } else { Meant::Widgets });
                if self.meant == Some(Meant::Keys) {
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
                if self.meant.take() == Some(Meant::Keys) {
                    self.keyboard.release();
                    tracing::debug!("key of the board released");
                    self.stale = true;
                } else {
                    // Released beside the board: where it was last.
                    let last = || self.context.input(|input| input.pointer.latest_pos());
                    if let Some(pos) = self.pointer.or_else(last) {
                        // It is heard whether this is too far for a click.
                        self.events.push(Event::PointerMoved(pos));
                        let (button, pressed) = (PointerButton::Primary, false);
                        self.events.push(Event::PointerButton { pos, button, pressed, modifiers });
                    }
                }
                self.lead();
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

    /// Whether the pointer is meant for the keyboard: a drag over widgets is not, wherever it goes.
    fn is_on_keys(&self) -> bool {
        match self.meant {
            Some(meant) => meant == Meant::Keys,
            None => self.pointer.is_some_and(|at| self.keyboard.covers(at)),
        }
    }

    /// Tells keyboard and widgets where the pointer is, each only of what is meant for it.
    fn lead(&mut self) {
        let on_keys = self.is_on_keys();
        self.stale |= self.keyboard.point(self.pointer.filter(|_| on_keys));
        match self.pointer.filter(|_| !on_keys) {
            Some(at) => {
                self.told = true;
                self.events.push(Event::PointerMoved(at));
            }
            None if std::mem::take(&mut self.told) => self.events.push(Event::PointerGone),
            None => {}
        }
    }

    /// Width and height in points, in which the person's choice of a size of text counts.
    fn size_points(&self) -> Vec2 {
        self.size_px.as_vec2() / (self.pixels_per_point * self.context.zoom_factor())
    }

    /// Whether something calls for another pass at `now_s`.
    pub fn is_due(&self, now_s: f64) -> bool {
        let due_s = self.keyboard.due_s().map_or(self.due_s, |due_s| due_s.min(self.due_s));
        self.stale || !self.events.is_empty() || now_s >= due_s
    }

    /// What is pressed and released within one widget is a click, wherever it was in between; but
    /// a widget that can be dragged as well has to tell one from the other by how far it goes.
    fn judge_clicks(&self) {
        let button = |event: &Event| match event {
            Event::PointerButton { pos, pressed, .. } => Some((*pos, *pressed)),
            _ => None,
        };
        let farthest = match (self.pressed, self.events.iter().find_map(button)) {
            (Some(_), None | Some((_, true))) => f32::INFINITY,
            (Some(widget), Some((pos, false))) if widget.contains(pos) => f32::INFINITY,
            (Some(_), Some((_, false))) => 0.0,
            (None, _) => CLICK_DRIFT,
        };
        self.context.options_mut(|options| options.input_options.max_click_dist = farthest);
    }

    /// Remembers the widget that was pressed in the last pass, until it is released.
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

    /// Runs a pass of what `show` shows.
    pub fn pass(&mut self, now_s: f64, mut show: impl FnMut(&mut Ui)) -> FullOutput {
        self.keyboard.hold(now_s, &self.context, &mut self.events);
        self.judge_clicks();
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
        self.due_s = now_s + again.as_secs_f64().min(REFRESH_S);
        let field = output.platform_output.ime.as_ref().map(|ime| ime.rect);
        self.stale = self.keyboard.follow(field, self.context.content_rect());
        if self.stale {
            // It has come or gone under the pointer.
            match &field {
                Some(_) => tracing::debug!("keyboard on the board"),
                None => tracing::debug!("keyboard gone"),
            }
            self.lead();
        }
        output
    }
}

/// A ring where the ray meets the board.
fn draw_pointer(ctx: &Context, at: Pos2) {
    let painter = ctx.layer_painter(LayerId::new(Order::Debug, Id::new("hand pointer")));
    painter.circle_stroke(at, 7.0, Stroke::new(3.0, Color32::BLACK));
    painter.circle_stroke(at, 7.0, Stroke::new(1.5, Color32::WHITE));
    painter.circle_filled(at, 2.0, Color32::WHITE);
}

#[cfg(test)]
#[path = "face_tests.rs"]
mod tests;
