//! Owns the messages that appear over the sculpture and go by themselves; errors stay longer and
//! can be dismissed.

use egui::{Align2, Area, Color32, Frame, Id, Order, RichText, Stroke, Ui};

use super::theme;

const NOTE_S: f64 = 4.0;
const ERROR_S: f64 = 15.0;
const MOST: usize = 4;
const WIDTH: f32 = 380.0;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Tone {
    Note,
    Error,
}

#[derive(Clone, PartialEq, Debug)]
struct Toast {
    tone: Tone,
    text: String,
    /// Time of the interface at which it goes; set when it is first shown.
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

    /// The texts on screen.
    pub fn texts(&self) -> impl Iterator<Item = (Tone, &str)> {
        self.list.iter().map(|toast| (toast.tone, toast.text.as_str()))
    }

    fn push(&mut self, tone: Tone, text: String) {
        // The same message again is shown once, anew.
        self.list.retain(|toast| toast.text != text);
        self.list.push(Toast { tone, text, until: None });
        let surplus = self.list.len().saturating_sub(MOST);
        self.list.drain(..surplus);
    }

    /// Shows the messages at the lower edge of `within`.
    pub fn show(&mut self, ui: &Ui, within: egui::Rect) {
        let now = ui.input(|input| input.time);
        for toast in &mut self.list {
            let life = if toast.tone == Tone::Error { ERROR_S } else { NOTE_S };
            toast.until.get_or_insert(now + life);
        }
        self.list.retain(|toast| toast.until.is_none_or(|until| until > now));
        let Some(next) = self.list.iter().filter_map(|toast| toast.until).reduce(f64::min) else {
            return;
        };
        ui.ctx().request_repaint_after_secs((next - now) as f32);

        let mut dismissed = None;
        Area::new(Id::new("toasts"))
            .order(Order::Foreground)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(within.center_bottom() - egui::vec2(0.0, 12.0))
            .show(ui.ctx(), |ui| {
                ui.set_max_width(WIDTH.min(within.width() - 24.0));
                for (i, toast) in self.list.iter().enumerate() {
                    if show_one(ui, toast) {
                        dismissed = Some(i);
                    }
                }
            });
        if let Some(i) = dismissed {
            self.list.remove(i);
        }
    }
}

/// True if it was dismissed.
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
                let button = egui::Button::new("✖").fill(Color32::TRANSPARENT).small();
                close && ui.add(button).on_hover_text("Dismiss").clicked()
            })
            .inner
        })
        .inner
}
