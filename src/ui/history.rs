//! The list of steps, with the present between the steps to undo and those to redo. A click goes there.

use egui::{Button, RichText, ScrollArea, Ui};

use crate::command::Command;
use crate::ui::context::UiContext;
use crate::ui::request::UiRequest;
use crate::ui::widgets::names::capital;

/// Shows the list. `height`: its largest height, in points.
pub fn show(ui: &mut Ui, context: &UiContext, height: f32, requests: &mut Vec<UiRequest>) {
    let history = context.document.history();
    let undos = history.undo_count();
    let start = if history.dropped() > 0 {
        format!("({} older steps discarded)", history.dropped())
    } else {
        "Start".to_string()
    };
    let labels = std::iter::once(start).chain(history.undo_labels().map(words));
    ScrollArea::vertical().id_salt("history").max_height(height).stick_to_bottom(true).show(
        ui,
        |ui| {
            ui.spacing_mut().item_spacing.y = 1.0;
            for (done, label) in labels.enumerate() {
                let back = undos - done;
                let button = Button::selectable(back == 0, label).frame_when_inactive(false);
                if row(ui, button) && back > 0 {
                    requests.push(UiRequest::Run(Command::Undo { steps: Some(back as u32) }));
                }
            }
            for (i, label) in history.redo_labels().enumerate() {
                let text = RichText::new(words(label)).weak().italics();
                let button = Button::selectable(false, text).frame_when_inactive(false);
                if row(ui, button) {
                    requests.push(UiRequest::Run(Command::Redo { steps: Some(i as u32 + 1) }));
                }
            }
        },
    );
    let mib = history.bytes() as f64 / f64::from(1 << 20);
    let budget = context.document.limits().history_bytes >> 20;
    ui.weak(format!("{mib:.1} of {budget} MiB"));
}

fn row(ui: &mut Ui, button: Button) -> bool {
    let size = egui::vec2(ui.available_width(), 0.0);
    ui.add(button.min_size(size).truncate()).clicked()
}

/// Returns a label in the words of the toolbox instead of those of scripts.
pub fn words(label: &str) -> String {
    match label.split_once(' ').unwrap_or((label, "")) {
        ("subtract", what) => format!("Cut {what}"),
        ("recolour", what) => format!("Paint {what}"),
        ("dye", what) => format!("Recolour {what}"),
        ("paintbrush", _) => "Brush".to_string(),
        ("array", _) => "Repeat".to_string(),
        _ => capital(label),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn steps_are_called_as_in_the_toolbox() {
        for (label, shown) in [
            ("subtract ellipsoid", "Cut ellipsoid"),
            ("recolour pyramid", "Paint pyramid"),
            ("paintbrush", "Brush"),
            ("dye marker", "Recolour marker"),
            ("array", "Repeat"),
            ("my own stroke", "My own stroke"),
        ] {
            assert_eq!(super::words(label), shown);
        }
    }
}
