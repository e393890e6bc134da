//! The interface on a hand in a headset: toolbox, options, history and everything that opens over them. It has no
//! picture of the sculpture, which is in the room.

use egui::{CentralPanel, Frame, Margin, Panel as Side, RichText, ScrollArea, Ui};

use crate::input::hands::HandSide;
use crate::ui::context::UiContext;
use crate::ui::dialogs::busy;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::{numbers, theme};
use crate::ui::{history, options, toolbox, top_bar, upright};

const TOOLBOX_WIDTH: f32 = 190.0;
const HISTORY_WIDTH: f32 = 290.0;
/// Height of the list of steps, in points; below it stand the hands' hints.
const HISTORY_HEIGHT: f32 = 250.0;

/// The controls of the hands, for the first time that the board is opened.
const HINTS: [(&str, &str); 8] = [
    ("Trigger", "use the tool; click here"),
    ("Grip", "grab, move and rotate the sculpture"),
    ("Both grips", "scale the sculpture"),
    ("Stick up, down", "resize the tool; scroll here"),
    ("A, X or stick click", "pick the colour that the tool touches"),
    ("Other stick left, right", "undo, redo"),
    ("Menu, or other trigger", "show or hide this panel"),
    ("Hold menu", "bring the sculpture in front of you"),
];

/// Shows everything in `root` and adds the person's requests to `requests`.
pub fn show(
    root: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    theme::apply(root.ctx(), state.appearance.theme, state.appearance.scale);
    if !state.dialogs.files.is_open() {
        numbers::hear(root.ctx());
    }
    top_bar::show(root, state, context, requests);
    upright::strip(root, state, context, requests);
    let enabled = !state.dialogs.is_modal();
    let frame = Frame::central_panel(root.style()).inner_margin(Margin::same(8));
    Side::left("board tools").exact_size(TOOLBOX_WIDTH).resizable(false).frame(frame).show(
        root,
        |ui| {
            ui.add_enabled_ui(enabled, |ui| {
                ScrollArea::vertical()
                    .auto_shrink(false)
                    .show(ui, |ui| toolbox::content(ui, state, context, requests));
            });
        },
    );
    Side::right("board history").exact_size(HISTORY_WIDTH).resizable(false).frame(frame).show(
        root,
        |ui| {
            ui.add_enabled_ui(enabled, |ui| {
                history::show(ui, context, HISTORY_HEIGHT, requests);
                ui.separator();
                ui.horizontal(|ui| {
                    ui.label("Tool in");
                    for side in HandSide::ALL {
                        ui.selectable_value(&mut state.headset.hand_side, side, side.label());
                    }
                });
                if context.blends.len() > 1 {
                    ui.horizontal(|ui| {
                        ui.label("Surroundings");
                        let now = state.headset.blend.nearest(context.blends);
                        for &blend in context.blends {
                            if ui.selectable_label(now == Some(blend), blend.label()).clicked() {
                                state.headset.blend = blend;
                            }
                        }
                    });
                }
                for (hand, does) in HINTS {
                    ui.label(RichText::new(hand).strong().small());
                    ui.label(RichText::new(does).small());
                }
            });
        },
    );
    let middle = CentralPanel::default().frame(frame).show(root, |ui| {
        ui.add_enabled_ui(enabled, |ui| {
            ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| options::content(ui, state, context, requests));
        });
    });
    state.show_dialogs(root, context, requests);
    state.toasts.show(root, middle.response.rect);
    // The texture of a preview belongs to one interface, that of the window.
    busy::show(root, state.dialogs.busy.as_ref(), None, requests);
}
