//! The question how to go on with a file that another program has open.

use egui::{Id, Modal, Ui};

use crate::editor::questions::InUse;
use crate::time_text::utc_text;
use crate::ui::widgets::theme;
use crate::ui::{UiRequest, UiState};

pub fn show(root: &Ui, state: &mut UiState, requests: &mut Vec<UiRequest>) {
    let Some(InUse { path, holder }) = &state.dialogs.in_use else { return };
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
    // Without an answer nothing is lost either: saving is refused as long as the other has the file open.
    if answer.is_some() || response.should_close() {
        requests.extend(answer);
        state.dialogs.in_use = None;
    }
}
