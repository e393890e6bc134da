//! The interface of the video behind the sculpture: a switch, its source, its placement on the screen, and the state of
//! the camera.

use egui::{ComboBox, TextEdit, Ui};

use crate::input::Action;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::state::UiState;
use crate::ui::widgets::buttons::explain;
use crate::ui::widgets::numbers;
use crate::video::{Address, Fit};
use crate::viewpoint::camera::{VideoState, VideoStatus};

fn words(video: &VideoStatus) -> String {
    let size = video.size.map_or(String::new(), |[w, h]| format!(", {w} × {h}"));
    match &video.state {
        VideoState::Off => "Off".to_string(),
        VideoState::Opening => "Opening …".to_string(),
        VideoState::Live => format!("Live{size}"),
        VideoState::Ended => format!("End of the video{size}"),
        VideoState::Lost(error) => format!("Lost, trying to reconnect: {error}"),
        VideoState::Failed(error) => error.clone(),
    }
}

/// Shows this section of the options.
pub fn options(
    ui: &mut Ui,
    state: &mut UiState,
    context: &UiContext,
    requests: &mut Vec<UiRequest>,
) {
    let mut on = state.view.video.on;
    let response = ui.checkbox(&mut on, "Video background");
    if explain(response, context, Action::ToggleVideo).changed() {
        requests.push(UiRequest::Do(Action::ToggleVideo));
    }
    if !on && !context.ar.on {
        return;
    }
    source(ui, state);
    ui.horizontal(|ui| {
        let video = &mut state.view.video;
        let name = |fit: Fit| match fit {
            Fit::Fit => "Fit",
            Fit::Fill => "Fill",
            Fit::Stretch => "Stretch",
        };
        ComboBox::from_id_salt("video fit").width(84.0).selected_text(name(video.fit)).show_ui(
            ui,
            |ui| {
                for fit in [Fit::Fill, Fit::Fit, Fit::Stretch] {
                    ui.selectable_value(&mut video.fit, fit, name(fit));
                }
            },
        );
        ui.checkbox(&mut video.mirror, "Mirrored")
            .on_hover_text("Flip left and right, as in a mirror");
    });
    let stats = context.video.stats;
    ui.label(words(&context.video)).on_hover_text(format!(
        "{} frames: {} skipped in favour of newer ones, {} damaged",
        stats.decoded, stats.unseen, stats.broken
    ));
}

/// Shows the source. It changes when Enter is pressed or the field is left, so that no partial address is opened.
fn source(ui: &mut Ui, state: &mut UiState) {
    let id = ui.make_persistent_id("video source");
    let source = &mut state.view.video.source;
    let mut text = ui.data_mut(|data| data.get_temp::<String>(id)).unwrap_or(source.clone());
    let field = TextEdit::singleline(&mut text).hint_text("First camera").desired_width(176.0);
    let response = ui.add(field).on_hover_text(
        "v4l2:/dev/video0, a .y4m or .mjpeg video, a folder of PNGs, or http://phone:8080/video; \
         leave empty for the first camera",
    );
    numbers::words(&response);
    if !response.lost_focus() {
        if response.has_focus() {
            ui.data_mut(|data| data.insert_temp(id, text));
        }
        return;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    let text = text.trim().to_string();
    match text.is_empty() {
        true => *source = text,
        false => match text.parse::<Address>() {
            Ok(_) => *source = text,
            Err(error) => state.toasts.error(error.to_string()),
        },
    }
}
