//! Owns the messages that appear over the sculpture and fade by themselves; errors stay longer and can be dismissed.
//! They avoid dialogs and menus.

use egui::{Align2, Area, Color32, Context, Frame, Id, Order, Rect, RichText, Stroke, Ui};

use crate::ui::widgets::theme;

const NOTE_S: f64 = 4.0;
const ERROR_S: f64 = 15.0;
/// Time for which a message fades.
const FADE_S: f64 = 0.7;
/// Time between two pictures of a fading message.
const FADE_STEP_S: f64 = 1.0 / 30.0;
const MOST: usize = 4;
const WIDTH: f32 = 380.0;
/// Width beside a dialog that fills most of the window.
const NARROW: f32 = 290.0;
/// Distance from the edge of the picture, in points.
const MARGIN: f32 = 12.0;
/// Positions of the messages, best first.
const PLACES: [Align2; 6] = [
    Align2::CENTER_BOTTOM,
    Align2::CENTER_TOP,
    Align2::LEFT_BOTTOM,
    Align2::RIGHT_BOTTOM,
    Align2::LEFT_TOP,
    Align2::RIGHT_TOP,
];

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Tone {
    Note,
    Error,
}

#[derive(Clone, PartialEq, Debug)]
struct Toast {
    tone: Tone,
    text: String,
    /// Time of the interface at which it disappears; set when it is first shown.
    until: Option<f64>,
}

/// The messages on screen, oldest first.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Toasts {
    list: Vec<Toast>,
}

impl Toasts {
    pub fn note(&mut self, text: impl Into<String>) {
        self.push(Tone::Note, text.into());
    }

    pub fn error(&mut self, text: impl Into<String>) {
        self.push(Tone::Error, text.into());
    }

    /// Returns the texts on screen.
    pub fn texts(&self) -> impl Iterator<Item = (Tone, &str)> {
        self.list.iter().map(|toast| (toast.tone, toast.text.as_str()))
    }

    fn push(&mut self, tone: Tone, text: String) {
        // A repeated message is shown only once, as a new one.
        self.list.retain(|toast| toast.text != text);
        self.list.push(Toast { tone, text, until: None });
        let surplus = self.list.len().saturating_sub(MOST);
        self.list.drain(..surplus);
    }

    /// Shows the messages in `within`, at its lower edge or where no dialog is. If dialogs leave no room, the messages
    /// lie under them and last until they become visible.
    pub fn show(&mut self, ui: &Ui, within: Rect) {
        let (ctx, id) = (ui.ctx(), Id::new("toasts"));
        let now = ctx.input(|input| input.time);
        for toast in &mut self.list {
            toast.until.get_or_insert(now + toast.tone.life_s());
        }
        self.list.retain(|toast| toast.until.is_none_or(|until| until > now));
        let Some(next) = self.list.iter().filter_map(|toast| toast.until).reduce(f64::min) else {
            return;
        };
        let fades_in = next - FADE_S - now;
        ctx.request_repaint_after_secs(fades_in.max(FADE_STEP_S) as f32);

        let usual = 48.0 * self.list.len() as f32;
        let height = ctx.memory(|memory| memory.area_rect(id)).map_or(usual, |rect| rect.height());
        let own = ToastArea {
            within: within.shrink(MARGIN),
            width: WIDTH.min(within.width() - 2.0 * MARGIN),
        };
        let rooms = [own, ToastArea { within: ctx.content_rect().shrink(MARGIN), width: NARROW }];
        let place = free_place(height, &rooms, &windows(ctx, id));
        let (align, room) = place.unwrap_or((PLACES[0], own));
        let mut dismissed = None;
        let response = Area::new(id)
            .order(if place.is_some() { Order::Foreground } else { Order::Background })
            .pivot(align)
            .fixed_pos(align.pos_in_rect(&room.within))
            .show(ctx, |ui| {
                ui.set_max_width(room.width);
                for (i, toast) in self.list.iter().enumerate() {
                    ui.scope(|ui| {
                        let left_s = toast.until.map_or(f64::MAX, |until| until - now);
                        ui.set_opacity((left_s / FADE_S).min(1.0) as f32);
                        if show_one(ui, toast) {
                            dismissed = Some(i);
                        }
                    });
                }
            })
            .response;
        if place.is_some() {
            // The shade of a dialog must not cover them.
            ctx.move_to_top(response.layer_id);
        }
        for toast in &mut self.list {
            // A message that is hidden or being read stays.
            if place.is_none() {
                toast.until = Some(now + toast.tone.life_s());
            } else if response.contains_pointer() {
                toast.until = toast.until.map(|until| until.max(now + 2.0 * FADE_S));
            }
        }
        if let Some(i) = dismissed {
            self.list.remove(i);
        }
    }
}

impl Tone {
    fn life_s(self) -> f64 {
        if self == Tone::Error { ERROR_S } else { NOTE_S }
    }
}

/// Returns the areas of dialogs, menus and other windows over the picture, except `own`.
fn windows(ctx: &Context, own: Id) -> Vec<Rect> {
    let screen = ctx.content_rect().shrink(1.0);
    ctx.memory(|memory| {
        let layers = memory.areas().visible_layer_ids().into_iter();
        layers
            .filter(|layer| matches!(layer.order, Order::Middle | Order::Foreground))
            .filter(|layer| layer.id != own)
            .filter_map(|layer| memory.area_rect(layer.id))
            // The shade behind a dialog is over everything.
            .filter(|rect| !rect.contains_rect(screen))
            .collect()
    })
}

/// An area for messages, and their width.
#[derive(Clone, Copy)]
struct ToastArea {
    within: Rect,
    width: f32,
}

/// Returns the first free place for something of `height` at the edges of the rooms.
fn free_place(height: f32, rooms: &[ToastArea], windows: &[Rect]) -> Option<(Align2, ToastArea)> {
    let places = rooms.iter().flat_map(|room| PLACES.map(|align| (align, *room)));
    places.into_iter().find(|(align, ToastArea { within, width })| {
        let rect = align.anchor_size(align.pos_in_rect(within), egui::vec2(*width, height));
        windows.iter().all(|window| !window.intersects(rect))
    })
}

/// Shows a message. Returns true if it was dismissed.
fn show_one(ui: &mut Ui, toast: &Toast) -> bool {
    let accent = match toast.tone {
        Tone::Note => ui.visuals().hyperlink_color,
        Tone::Error => theme::error_colour(ui.visuals()),
    };
    Frame::popup(ui.style())
        .stroke(Stroke::new(1.0, accent))
        .inner_margin(8.0)
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                let (mark, colour) = match toast.tone {
                    Tone::Note => ("ℹ", accent),
                    Tone::Error => ("⚠", accent),
                };
                ui.label(RichText::new(mark).color(colour).size(16.0));
                let close = toast.tone == Tone::Error;
                let room = ui.available_width() - if close { 26.0 } else { 0.0 };
                ui.allocate_ui(egui::vec2(room, 0.0), |ui| {
                    ui.set_min_width(room);
                    ui.add(egui::Label::new(&toast.text).wrap());
                });
                let button = egui::Button::new("✖").fill(Color32::TRANSPARENT);
                close && ui.add(button).on_hover_text("Dismiss").clicked()
            })
            .inner
        })
        .inner
}
