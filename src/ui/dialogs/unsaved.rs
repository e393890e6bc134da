//! The question before unsaved work is lost, by leaving or by another sculpture.
//!
//! Takes the waiting step, asks for it with or without saving first; saves nothing itself.

use egui::{Id, Modal, Ui};

use crate::editor::questions::Next;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

/// Open while a step waits for the answer.
impl Dialog for Option<Next> {
    fn is_open(&self) -> bool {
        self.is_some()
    }

    fn close(&mut self) -> bool {
        self.take().is_some()
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let requests = &mut *shared.requests;
        let Some(next) = &*self else { return };
        let mut answer = None;
        let response = Modal::new(Id::new("unsaved")).show(root.ctx(), |ui| {
            ui.set_width(320.0);
            ui.heading("You have unsaved changes");
            ui.add_space(4.0);
            ui.label(match next {
                Next::Leave => "Save them before quitting?",
                Next::Run(_) | Next::Recover(_) => "Save them before replacing this sculpture?",
            });
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                if ui.add(theme::primary(ui.visuals(), "Save")).clicked() {
                    answer = Some(Some(UiRequest::SaveFirst(next.clone())));
                }
                if ui.button("Don't save").clicked() {
                    answer = Some(Some(UiRequest::Go(next.clone())));
                }
                if ui.button("Cancel").clicked() {
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
