//! The question before an irreversible step, for which the history has no room.
//!
//! Takes the refused command and the reason; asks for it anyway, or for nothing. Knows no history.

use egui::{Id, Modal, Ui};

use crate::command::Command;
use crate::editor::questions::Unkept;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

impl Dialog for Option<Unkept> {
    fn is_open(&self) -> bool {
        self.is_some()
    }

    fn close(&mut self) -> bool {
        self.take().is_some()
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let requests = &mut *shared.requests;
        let Some(Unkept { command, why }) = &*self else { return };
        // The end of a stroke is refused, but its result is visible.
        let [question, go_on, stop] = match command {
            Command::End => ["Keep a stroke that cannot be undone?", "Keep it", "Take it back"],
            Command::Undo { .. } => ["Undo a step that cannot be redone?", "Undo", "Cancel"],
            Command::Redo { .. } => ["Redo a step that cannot be undone?", "Redo", "Cancel"],
            _ => ["Do something that cannot be undone?", "Do it", "Cancel"],
        };
        let mut answer = None;
        let response = Modal::new(Id::new("unkept")).show(root.ctx(), |ui| {
            ui.set_width(360.0);
            ui.heading(question);
            ui.add_space(4.0);
            ui.label(why);
            ui.label("Earlier steps will be forgotten too.");
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if ui.button(go_on).clicked() {
                    answer = Some(Some(UiRequest::Irreversibly(command.clone())));
                }
                if ui.add(theme::primary(ui.visuals(), stop)).clicked() {
                    answer = Some(None);
                }
            });
        });
        if response.should_close() {
            answer = Some(None);
        }
        if let Some(answer) = answer {
            *self = None;
            requests.extend(answer);
        }
    }
}
