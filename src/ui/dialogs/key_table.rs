//! The window of keys and mouse: every action with its triggers in the present preset, editable in place.
//!
//! Gives changes as requests; [`super::key_catch`] waits for triggers.

use egui::{Button, ComboBox, Grid, RichText, ScrollArea, TextEdit, Ui, WidgetInfo, WidgetType};
use egui::{Response, Window};

use crate::input::group::Group;
use crate::input::remap::KeyChange;
use crate::input::{Action, Bindings, Trigger};
use crate::ui::context::UiContext;
use crate::ui::dialogs::key_catch::KeyCatch;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::filter::Filter;
use crate::ui::widgets::names::{capital, preset_name};
use crate::ui::widgets::numbers;

const WIDTH: f32 = 580.0;
const HEIGHT: f32 = 470.0;
/// Height of everything above the list, title included.
const HEAD: f32 = 110.0;
const TEXT_WIDTH: f32 = 262.0;
const TRIGGERS_WIDTH: f32 = 256.0;

/// The state that the window remembers.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct KeyTable {
    pub open: bool,
    filter: String,
    /// Waits for the next key or button.
    pub catch: KeyCatch,
}

impl KeyTable {
    /// Returns whether a trigger or the answer to a question about one is awaited.
    pub fn is_catching(&self) -> bool {
        self.catch.is_open()
    }

    /// Waits for a trigger for `action`.
    pub fn listen_for(&mut self, action: Action) {
        self.catch.listen_for(action);
    }

    /// Takes a trigger from a device other than keyboard and mouse, if one is awaited.
    pub fn hear(&mut self, trigger: Option<Trigger>) {
        self.catch.hear(trigger);
    }
}

impl Dialog for KeyTable {
    fn is_open(&self) -> bool {
        self.open
    }

    fn is_modal(&self) -> bool {
        false
    }

    fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { context, requests, .. } = shared;
        let preset = context.preset;
        let (Some(bindings), Some(pristine)) =
            (context.presets.get(preset), context.pristine.get(preset))
        else {
            return;
        };
        let room = root.ctx().content_rect();
        let height = (room.height() - 190.0).min(HEIGHT);
        let mut open = self.open;
        Window::new("Controls")
            .open(&mut open)
            .resizable(false)
            .collapsible(false)
            .default_size([WIDTH, height + HEAD])
            .default_pos(room.center() - 0.5 * egui::vec2(WIDTH, height + HEAD))
            .show(root.ctx(), |ui| {
                head(ui, self, context, bindings != pristine, requests);
                ui.weak(format!("{}.", bindings.text));
                ui.separator();
                ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
                    rows(ui, self, bindings, pristine, requests);
                });
            });
        self.open = open;
    }
}

/// Shows the choice of the preset, the filter, and the button that restores the preset.
fn head(
    ui: &mut Ui,
    table: &mut KeyTable,
    context: &UiContext,
    changed: bool,
    requests: &mut Vec<UiRequest>,
) {
    ui.horizontal(|ui| {
        let name =
            |i: usize| context.presets.get(i).map_or(String::new(), |p| preset_name(&p.name));
        ComboBox::from_id_salt("preset").selected_text(name(context.preset)).show_ui(ui, |ui| {
            for (i, preset) in context.presets.iter().enumerate() {
                let label = ui.selectable_label(i == context.preset, name(i));
                if label.on_hover_text(&preset.text).clicked() && i != context.preset {
                    requests.push(UiRequest::UsePreset(i));
                }
            }
        });
        let field = TextEdit::singleline(&mut table.filter)
            .hint_text("Filter by name or key")
            .desired_width(240.0);
        let response = ui.add(field);
        numbers::words(&response);
        response.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, "Filter"));
        ui.add_enabled_ui(changed, |ui| {
            ui.menu_button("Reset all", |ui| {
                let text = format!("Discard all changes to {}", name(context.preset));
                if ui.button(text).clicked() {
                    requests.push(UiRequest::Keys(KeyChange::ResetAll));
                }
            });
        });
    });
}

fn rows(
    ui: &mut Ui,
    state: &mut KeyTable,
    bindings: &Bindings,
    pristine: &Bindings,
    requests: &mut Vec<UiRequest>,
) {
    let filter = Filter::new(&state.filter);
    let mut any = false;
    for group in Group::ALL {
        let taken: Vec<Action> = Action::ALL
            .iter()
            .copied()
            .filter(|action| action.help().group == group && takes(&filter, *action, bindings))
            .collect();
        if taken.is_empty() {
            continue;
        }
        any = true;
        ui.add_space(4.0);
        ui.label(RichText::new(group.title()).strong());
        Grid::new(group.title()).num_columns(3).striped(true).spacing([8.0, 3.0]).show(ui, |ui| {
            for action in taken {
                row(ui, state, action, bindings, pristine, requests);
                ui.end_row();
            }
        });
    }
    if !any {
        ui.weak("No matches.");
    }
}

fn takes(filter: &Filter, action: Action, bindings: &Bindings) -> bool {
    let triggers: Vec<String> = bindings.triggers(action).map(|t| t.to_string()).collect();
    let help = action.help();
    filter.takes(&[
        help.text,
        help.name,
        action.help().synonyms,
        action.help().group.title(),
        &triggers.join(" "),
    ])
}

fn row(
    ui: &mut Ui,
    state: &mut KeyTable,
    action: Action,
    bindings: &Bindings,
    pristine: &Bindings,
    requests: &mut Vec<UiRequest>,
) {
    let help = action.help();
    ui.scope(|ui| {
        ui.set_width(TEXT_WIDTH);
        let label = egui::Label::new(help.text).wrap();
        ui.add(label).on_hover_text(format!("\"{}\" in bindings.toml", help.name));
    });
    ui.scope(|ui| {
        ui.set_width(TRIGGERS_WIDTH);
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(4.0, 3.0);
            // Comes first, so that all are aligned.
            let add = named(ui.add(Button::new("+")), format!("Add to: {}", help.text));
            if add.on_hover_text("Add a key or button").clicked() {
                state.listen_for(action);
            }
            for trigger in bindings.triggers(action) {
                let text = capital(&trigger.to_string());
                let chip = ui.add(Button::new(format!("{text}  ✖")));
                let chip = named(chip, format!("Remove {text} from: {}", help.text));
                if chip.on_hover_text("Remove").clicked() {
                    requests.push(UiRequest::Keys(KeyChange::Unbind(trigger)));
                }
            }
        });
    });
    if bindings.differs(action, pristine) {
        let reset = named(ui.add(Button::new("⟲")), format!("Reset: {}", help.text));
        if reset.on_hover_text("Reset to the preset").clicked() {
            requests.push(UiRequest::Keys(KeyChange::Reset(action)));
        }
    } else {
        ui.label("");
    }
}

/// Gives a button a name that differs from others of its kind.
fn named(button: Response, name: String) -> Response {
    button.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, name.clone()));
    button
}
