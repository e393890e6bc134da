//! The question about a file that another program has open.
//!
//! Takes the file and its holder; asks with requests. Looks at no file.

use egui::{Id, Modal, Ui};

use crate::editor::questions::InUse;
use crate::time_text::utc_text;
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;

impl Dialog for Option<InUse> {
    fn is_open(&self) -> bool {
        self.is_some()
    }

    fn close(&mut self) -> bool {
        self.take().is_some()
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let requests = &mut *shared.requests;
        let Some(InUse { path, holder }) = &*self else { return };
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let mut answer = None;
        let response = Modal::new(Id::new("file in use")).show(root.ctx(), |ui| {
        ui.set_width(380.0);
        ui.heading("The file is open elsewhere");
        ui.add_space(4.0);
        let since = holder.since_unix_s.map(|unix_s| format!(", since {}", utc_text(unix_s)));
        ui.label(format!(
            "{name} is open in another program: {holder}{}. If both save it, the work of one is lost.",
            since.unwrap_or_default()
        ))
        .on_hover_text(path.display().to_string());
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let button = ui.add(theme::primary(ui.visuals(), "Open a copy"));
            if button.on_hover_text("Continue without a name; saving asks for one").clicked() {
                answer = Some(UiRequest::BecomeCopy);
            }
            let button = ui.button("Read only");
            if button.on_hover_text("Keep the name; saving asks for another").clicked() {
                answer = Some(UiRequest::KeepReadOnly);
            }
        });
    });
        // Without an answer nothing is lost: saving is refused as long as the other program has the file open.
        if answer.is_some() || response.should_close() {
            requests.extend(answer);
            *self = None;
        }
    }
}
