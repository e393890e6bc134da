//! The bar along the top: files, history, the way of rendering, the switches of the picture, help
//! and the menu.

use egui::{Align, ComboBox, Frame, Layout, Margin, MenuBar, Ui};

use super::buttons::{action_button, explain};
use super::{Facts, Intent, UiState, recent, switches};
use crate::config::{RenderMode, Theme};
use crate::input::{Action, Panel, Side};

pub fn show(root: &mut Ui, state: &mut UiState, facts: &Facts, intents: &mut Vec<Intent>) {
    let frame = Frame::side_top_panel(root.style()).inner_margin(Margin::symmetric(8, 5));
    egui::Panel::top("top_bar").frame(frame).show(root, |ui| {
        MenuBar::new().ui(ui, |ui| {
            for (label, action) in [
                ("New", Action::New),
                ("Open", Action::Open),
                ("Save", Action::Save),
                ("Save as", Action::SaveAs),
                ("Export", Action::Export),
            ] {
                action_button(ui, state, facts, label, action, true, intents);
            }
            ui.separator();
            let history = facts.document.history();
            let (undos, redos) = (history.undo_count(), history.redo_count());
            let undo = format!("⟲ Undo {undos}");
            action_button(ui, state, facts, undo, Action::Undo, undos > 0, intents);
            let redo = format!("⟳ Redo {redos}");
            action_button(ui, state, facts, redo, Action::Redo, redos > 0, intents);
            ui.separator();
            render_mode(ui, state, facts);
            let wide = switches::fit(ui, facts);
            if wide {
                switches::bar(ui, state, facts, intents);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                menu(ui, !wide, state, facts, intents);
                if !facts.in_headset {
                    action_button(ui, state, facts, "Help", Action::Help, true, intents);
                }
            });
        });
    });
}

fn render_mode(ui: &mut Ui, state: &mut UiState, facts: &Facts) {
    let short = |mode: RenderMode| mode.label().trim_end_matches(" + software shader");
    let chosen = state.view.mode;
    let response = ComboBox::from_id_salt("render mode")
        .width(118.0)
        .selected_text(short(chosen))
        .show_ui(ui, |ui| {
            for mode in RenderMode::ALL {
                if ui.selectable_label(mode == chosen, mode.label()).clicked() {
                    state.view.choose_mode(mode);
                }
            }
        })
        .response;
    explain(response, state, facts, Action::NextRenderMode);
}

/// `narrow`: the bar has no room for the switches.
fn menu(ui: &mut Ui, narrow: bool, state: &mut UiState, facts: &Facts, intents: &mut Vec<Intent>) {
    ui.menu_button("Menu", |ui| {
        if narrow {
            switches::menu(ui, state, facts, intents);
        }
        recent::menu(ui, state, intents);
        ui.separator();
        for (label, action) in [("Fill the grid", Action::Fill), ("Clear the grid", Action::Clear)]
        {
            action_button(ui, state, facts, label, action, true, intents);
        }
        ui.separator();
        ui.menu_button("View", |ui| {
            for side in Side::ALL {
                let action = Action::LookFrom(side);
                action_button(ui, state, facts, capital(side.name()), action, true, intents);
            }
            ui.separator();
            action_button(ui, state, facts, "Frame all", Action::ResetView, true, intents);
            if !facts.in_headset {
                action_button(ui, state, facts, "Zoom in", Action::ZoomIn, true, intents);
                action_button(ui, state, facts, "Zoom out", Action::ZoomOut, true, intents);
            }
        });
        action_button(ui, state, facts, "Search actions …", Action::Palette, true, intents);
        if !facts.in_headset {
            at_the_desk(ui, state, facts, intents);
        }
        ui.menu_button("Theme", |ui| {
            ui.radio_value(&mut state.theme, Theme::Dark, "Dark");
            ui.radio_value(&mut state.theme, Theme::Light, "Light");
        });
        ui.menu_button("Interface size", |ui| {
            for (label, action) in [
                ("Larger", Action::ScaleUp),
                ("Smaller", Action::ScaleDown),
                ("Reset", Action::ScaleReset),
            ] {
                action_button(ui, state, facts, label, action, true, intents);
            }
        });
        action_button(ui, state, facts, "First steps", Action::Guide, true, intents);
        ui.separator();
        action_button(ui, state, facts, "Quit", Action::Quit, true, intents);
    });
}

/// What makes sense before a screen alone: keys, windows and pictures of the view.
fn at_the_desk(ui: &mut Ui, state: &mut UiState, facts: &Facts, intents: &mut Vec<Intent>) {
    ui.menu_button("Controls", |ui| {
        for (i, preset) in facts.presets.iter().enumerate() {
            ui.radio_value(&mut state.preset, i, capital(&preset.name)).on_hover_text(&preset.text);
        }
        ui.separator();
        action_button(ui, state, facts, "Edit controls …", Action::Help, true, intents);
    });
    for (label, action) in
        [("Full screen", Action::Fullscreen), ("Save picture", Action::Screenshot)]
    {
        action_button(ui, state, facts, label, action, true, intents);
    }
    ui.menu_button("Panels", |ui| {
        for panel in Panel::ALL {
            let mut torn = state.torn.contains(&panel);
            let response = ui.checkbox(&mut torn, format!("Detach {}", panel.title()));
            if explain(response, state, facts, Action::TearOff(panel)).clicked() {
                intents.push(Intent::Do(Action::TearOff(panel)));
            }
        }
    });
}

/// The text with its first letter in upper case.
pub fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}
