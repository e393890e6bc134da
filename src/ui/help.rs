//! The window that lists keys and mouse, made from the table of bindings in use.

use egui::{Grid, RichText, ScrollArea, Ui, Window};

use super::{Facts, UiState};
use crate::input::Action;

pub fn show(root: &Ui, state: &mut UiState, facts: &Facts) {
    let Some(bindings) = facts.bindings(state) else { return };
    let room = root.ctx().content_rect();
    Window::new("Keys and mouse")
        .open(&mut state.help_open)
        .resizable(false)
        .collapsible(false)
        .default_width(440.0)
        .default_pos(room.center() - egui::vec2(240.0, 240.0))
        .show(root.ctx(), |ui| {
            ui.label(format!("{}.", bindings.text));
            ui.label("The wheel over the sculpture zooms; both tables are in the menu.");
            ui.separator();
            ScrollArea::vertical().max_height((room.height() - 180.0).min(420.0)).show(ui, |ui| {
                Grid::new("bindings").num_columns(2).striped(true).spacing([16.0, 4.0]).show(
                    ui,
                    |ui| {
                        for &action in Action::ALL {
                            let triggers: Vec<String> =
                                bindings.triggers(action).map(|t| t.to_string()).collect();
                            if !triggers.is_empty() {
                                ui.label(RichText::new(triggers.join(" or ")).strong());
                                ui.label(action.help().text);
                                ui.end_row();
                            }
                        }
                    },
                );
            });
        });
}
