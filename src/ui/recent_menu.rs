//! The menu of the files opened or saved last.
//!
//! Opens a chosen file as it was opened before; removes a missing file from the list. Reads no file.

use egui::{RichText, Ui};

use crate::command::Command;
use crate::ui::memory::recent::{Recent, path_of};
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;

/// Shows the entries of the menu. Reports a missing file and removes it from the list.
pub fn menu(ui: &mut Ui, state: &mut UiState, requests: &mut Vec<UiRequest>) {
    ui.menu_button("Open recent", |ui| {
        if state.known_files.recent.commands().is_empty() {
            ui.weak("No recent files");
            return;
        }
        let mut chosen = None;
        for command in state.known_files.recent.commands() {
            let Some(path) = path_of(command) else { continue };
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            let folder = path.parent().unwrap_or(path).display().to_string();
            let text = RichText::new(shortened(&name));
            if ui.button(text).on_hover_text(folder).clicked() {
                chosen = Some(command.clone());
            }
        }
        ui.separator();
        if ui.button("Clear this list").clicked() {
            state.known_files.recent = Recent::default();
        }
        let Some(command) = chosen else { return };
        let Some(path) = path_of(&command) else { return };
        if path.try_exists().is_ok_and(|exists| !exists) {
            let name = path.display();
            state.toasts.error(format!("{name} no longer exists; removed from the recent files"));
            state.known_files.recent.forget(path);
        } else {
            let Command::Open { path, import } = command else { return };
            let at_once = ui.input(|input| input.modifiers.shift);
            state.dialogs.import.open(path, import, at_once, requests);
        }
    });
}

/// Returns a name that fits into a menu.
fn shortened(name: &str) -> String {
    const MOST: usize = 40;
    match name.chars().count() {
        ..=MOST => name.to_string(),
        count => {
            let (head, tail) = (MOST / 2, count - (MOST / 2 - 1));
            name.chars().take(head).chain(['…']).chain(name.chars().skip(tail)).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_shortened_in_their_middle() {
        assert_eq!(shortened("head.vsc"), "head.vsc");
        let long = format!("{}ü.vsc", "ä".repeat(300));
        assert_eq!(shortened(&long).chars().count(), 40);
        assert!(shortened(&long).ends_with("ü.vsc"));
    }
}
