//! Asks for the layout of a raw file, which does not state it.
//!
//! Shows the typed text and its error; reads neither.

use std::path::Path;

use egui::{Key, TextEdit, Ui};

use crate::format::{READ_ENDINGS, is_raw};
use crate::ui::widgets::{numbers, theme};

const HELP: &str = "WIDTHxHEIGHTxDEPTH:TYPE[:skip=BYTES][:size=SX,SY,SZ]\n\
    where TYPE is u8, u16le, u16be, i16le, i16be, f32le, f32be, rgb8 or rgba8";

/// Asks for the layout of a raw file. Returns true if Enter was pressed in the field.
pub fn layout(ui: &mut Ui, path: &Path, text: &mut String, error: Option<&String>) -> bool {
    match is_raw(path) {
        true => ui.label("A raw file does not describe its contents."),
        false => ui.label(format!(
            "Neither name nor contents identify this file. If it holds only voxels, describe their layout; other \
             readable formats: .{}",
            READ_ENDINGS.join(", .")
        )),
    };
    ui.add_space(4.0);
    let label = ui.label("Layout");
    let field = TextEdit::singleline(text).hint_text("128x256x256:u8");
    let field = ui.add(field.desired_width(f32::INFINITY)).labelled_by(label.id);
    numbers::words(&field);
    ui.weak(HELP);
    if let Some(error) = error {
        ui.colored_label(theme::error_colour(ui.visuals()), error);
    }
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}
