//! The bar along the top: files, history, the render mode, the switches of the picture, help and the menu.

use egui::{Align, ComboBox, Frame, Layout, Margin, MenuBar, Ui};

use crate::input::{Action, Axis, Panel, Side};
use crate::render::RenderMode;
use crate::sculpture::orientation::Up;
use crate::ui::context::UiContext;
use crate::ui::memory::upright;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::{action_button, explain, menu_entry, menu_switch};
use crate::ui::widgets::names::{capital, preset_name};
use crate::ui::widgets::spot::{self, Spot};
use crate::ui::window_options::Theme;
use crate::ui::{recent_menu, switches};

pub fn show(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
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
                action_button(ui, context, label, action, true, requests);
            }
            ui.separator();
            let history = context.document.history();
            let (undos, redos) = (history.undo_count(), history.redo_count());
            let undo = format!("⟲ Undo {undos}");
            action_button(ui, context, undo, Action::Undo, undos > 0, requests);
            let redo = format!("⟳ Redo {redos}");
            action_button(ui, context, redo, Action::Redo, redos > 0, requests);
            ui.separator();
            render_mode(ui, state, context);
            let wide = switches::fit(ui, context);
            if wide {
                switches::bar(ui, state, context, requests);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                menu(ui, !wide, state, context, requests);
                if !context.in_headset {
                    action_button(ui, context, "Help", Action::Help, true, requests);
                }
            });
        });
    });
}

fn render_mode(ui: &mut Ui, state: &mut UiState, context: &UiContext) {
    spot::begin(ui.ctx(), &mut state.layout.led_to, false);
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
    spot::mark(&response, Spot::RenderMode);
    explain(response, context, Action::NextRenderMode);
}

/// Shows the menu. `narrow`: the bar has no room for the switches.
fn menu(
    ui: &mut Ui,
    narrow: bool,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    ui.menu_button("Menu", |ui| {
        if narrow {
            switches::menu(ui, state, context, requests);
        }
        recent_menu::menu(ui, state, requests);
        let unsaved = ui.button("Unsaved work …");
        let unsaved =
            unsaved.on_hover_text("Lists the work of earlier sessions that did not end properly");
        if unsaved.clicked() {
            requests.push(UiRequest::ListLeft);
        }
        save_automatically(ui, &mut state.autosave.minutes);
        ui.separator();
        for (label, action) in [
            ("Canvas …", Action::Canvas),
            ("Fill the grid", Action::Fill),
            ("Clear the grid", Action::Clear),
        ] {
            menu_entry(ui, context, label, action, requests);
        }
        ui.menu_button("Colours and masks", |ui| {
            for (label, action) in [
                ("Colours …", Action::Tints),
                ("Masks …", Action::Masks),
                ("Invert the mask", Action::InvertMask),
                ("Clear the mask", Action::ClearMask),
            ] {
                menu_entry(ui, context, label, action, requests);
            }
        });
        turn_upright(ui, context, requests);
        ui.separator();
        ui.menu_button("View", |ui| {
            for side in Side::ALL {
                let action = Action::LookFrom(side);
                menu_entry(ui, context, &capital(side.name()), action, requests);
            }
            ui.separator();
            menu_entry(ui, context, "Frame all", Action::ResetView, requests);
            if !context.in_headset {
                menu_entry(ui, context, "Zoom in", Action::ZoomIn, requests);
                menu_entry(ui, context, "Zoom out", Action::ZoomOut, requests);
                let on = &mut state.view.orthographic;
                menu_switch(ui, context, on, "Orthographic", Action::ToggleOrthographic);
                let text = "Reference pictures …";
                menu_entry(ui, context, text, Action::References, requests);
            }
        });
        menu_entry(ui, context, "Search actions …", Action::Palette, requests);
        if !context.in_headset {
            at_the_desk(ui, state, context, requests);
        }
        ui.menu_button("Theme", |ui| {
            ui.radio_value(&mut state.appearance.theme, Theme::Dark, "Dark");
            ui.radio_value(&mut state.appearance.theme, Theme::Light, "Light");
        });
        ui.menu_button("Interface size", |ui| {
            for (label, action) in [
                ("Larger", Action::ScaleUp),
                ("Smaller", Action::ScaleDown),
                ("Reset", Action::ScaleReset),
            ] {
                menu_entry(ui, context, label, action, requests);
            }
        });
        menu_entry(ui, context, "First steps", Action::Guide, requests);
        ui.separator();
        menu_entry(ui, context, "Quit", Action::Quit, requests);
    });
}

/// Chooses the minutes after which unsaved changes of a named sculpture are saved.
fn save_automatically(ui: &mut Ui, minutes: &mut u32) {
    const CHOICES_MIN: [u32; 4] = [1, 5, 15, 60];
    let response = ui.menu_button("Save automatically", |ui| {
        ui.radio_value(minutes, 0, "Never");
        // One from the settings, which allow others.
        let other = (*minutes != 0 && !CHOICES_MIN.contains(minutes)).then_some(*minutes);
        for choice in CHOICES_MIN.into_iter().chain(other) {
            let label = match choice {
                1 => "Every minute".to_string(),
                60 => "Every hour".to_string(),
                choice => format!("Every {choice} minutes"),
            };
            ui.radio_value(minutes, choice, label);
        }
    });
    response.response.on_hover_text(
        "Saves the sculpture to its file. A sculpture without a name is not saved, but the journal keeps it",
    );
}

/// Shows ways to reorient the whole sculpture, for scans that lie on their face or back.
fn turn_upright(ui: &mut Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
    ui.menu_button("Turn upright", |ui| {
        for (up, _) in Up::NAMED.into_iter().filter(|(up, _)| *up != Up::Y) {
            let action = Action::TurnUpright(up);
            menu_entry(ui, context, upright::label(up), action, requests);
        }
        ui.separator();
        for (label, axis) in [
            ("Rotate 90° about X", Axis::X),
            ("Rotate 90° about Y", Axis::Y),
            ("Rotate 90° about Z", Axis::Z),
        ] {
            let action = Action::RotateGrid(axis);
            menu_entry(ui, context, label, action, requests);
        }
    });
}

/// Shows the items that only make sense at a screen: keys, windows and pictures of the view.
fn at_the_desk(
    ui: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    ui.menu_button("Controls", |ui| {
        for (i, preset) in context.presets.iter().enumerate() {
            let radio = ui.radio(i == context.preset, preset_name(&preset.name));
            if radio.on_hover_text(&preset.text).clicked() && i != context.preset {
                requests.push(UiRequest::UsePreset(i));
            }
        }
        ui.separator();
        menu_entry(ui, context, "Edit controls …", Action::Help, requests);
    });
    for (label, action) in [
        ("Full screen", Action::Fullscreen),
        ("Hide panels", Action::TogglePanels),
        ("Save picture", Action::Screenshot),
        ("Copy picture", Action::CopyScreenshot),
        ("Final picture …", Action::FinalPicture),
        ("Film …", Action::Film),
        ("Print check …", Action::PrintCheck),
    ] {
        menu_entry(ui, context, label, action, requests);
    }
    ui.menu_button("Panels", |ui| {
        for panel in Panel::ALL {
            let mut detached = state.layout.detached.contains(&panel);
            let (label, action) = (format!("Detach {}", panel.title()), Action::Detach(panel));
            if menu_switch(ui, context, &mut detached, &label, action).clicked() {
                requests.push(UiRequest::Do(action));
            }
        }
    });
}
