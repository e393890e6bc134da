//! The window that lists keys and mouse, made from the table of bindings in use.

use egui::{Grid, RichText, ScrollArea, Ui, Window};

use super::top_bar::capital;
use super::{Facts, UiState};
use crate::input::Action;

const WIDTH: f32 = 520.0;
const HEIGHT: f32 = 460.0;

pub fn show(root: &Ui, state: &mut UiState, facts: &Facts) {
    let Some(bindings) = facts.bindings(state) else { return };
    let room = root.ctx().content_rect();
    Window::new("Keys and mouse")
        .open(&mut state.help_open)
        .resizable(false)
        .collapsible(false)
        .default_width(WIDTH)
        .default_pos(room.center() - egui::vec2(0.5 * WIDTH, 0.5 * HEIGHT))
        .show(root.ctx(), |ui| {
            ui.label(format!("{}. Other tables are in the menu.", bindings.text));
            ui.separator();
            let height = (room.height() - 170.0).min(HEIGHT);
            ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
                Grid::new("bindings").num_columns(2).striped(true).spacing([16.0, 5.0]).show(
                    ui,
                    |ui| {
                        for &action in Action::ALL {
                            let triggers: Vec<String> =
                                bindings.triggers(action).map(|t| t.to_string()).take(2).collect();
                            if !triggers.is_empty() {
                                ui.label(RichText::new(capital(&triggers.join(" or "))).strong());
                                ui.label(action.help().text);
                                ui.end_row();
                            }
                        }
                    },
                );
            });
        });
}
