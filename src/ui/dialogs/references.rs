//! The window of reference pictures, with the position of each.
//!
//! Changes the pictures at once; asks for the file or the clipboard with another one. Reads neither.

use std::path::Path;

use egui::{ComboBox, DragValue, RichText, ScrollArea, Slider, Ui, Window, pos2};

use crate::render::MAX_REFERENCES;
use crate::ui::dialogs::shared::{Dialog, DialogContext, FileTask, Opening};
use crate::ui::references::{HEIGHT_RANGE_VX, Layer, OFFSET_RANGE_VX, Reference, sides};
use crate::ui::tasks::PasteAs;
use crate::ui::widgets::names::capital;
use crate::ui::widgets::theme;

const WIDTH: f32 = 270.0;
/// Largest height of the list.
const HEIGHT: f32 = 420.0;

/// The window, open or not.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ReferencesWindow {
    pub open: bool,
}

impl Dialog for ReferencesWindow {
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
        if !self.open {
            return;
        }
        let mut open = true;
        Window::new("Reference pictures")
            .open(&mut open)
            .resizable(false)
            .default_width(WIDTH)
            .default_pos(pos2(theme::TOOLBOX_WIDTH + 32.0, 60.0))
            .show(root.ctx(), |ui| {
                ui.set_width(WIDTH);
                ScrollArea::vertical().max_height(HEIGHT).show(ui, |ui| {
                    list(ui, shared.references);
                });
                let room = shared.references.len() < MAX_REFERENCES;
                let full = format!("There are {MAX_REFERENCES} already");
                ui.horizontal(|ui| {
                    let add = ui.add_enabled(room, egui::Button::new("Add …"));
                    let add = add.on_hover_text("Choose a PNG or JPEG image to sculpt from");
                    if add.on_disabled_hover_text(&full).clicked() {
                        let path = shared.context.path.map(Path::to_path_buf);
                        shared.openings.push(Opening::Files(FileTask::Reference, path));
                    }
                    let paste = ui.add_enabled(room, egui::Button::new("Paste"));
                    let paste = paste.on_hover_text("Add the picture on the clipboard");
                    if paste.on_disabled_hover_text(&full).clicked() {
                        shared.paste = Some(PasteAs::Reference);
                    }
                });
            });
        self.open &= open;
    }
}

fn list(ui: &mut Ui, list: &mut Vec<Reference>) {
    if list.is_empty() {
        ui.label("Images in the scene to sculpt from: drawings, photographs, scans.");
    }
    let mut removed = None;
    for (i, reference) in list.iter_mut().enumerate() {
        ui.push_id(i, |ui| {
            ui.horizontal(|ui| {
                let name = RichText::new(reference.name()).strong();
                ui.checkbox(&mut reference.shown, name)
                    .on_hover_text(reference.path.display().to_string());
                if ui.button("Remove").clicked() {
                    removed = Some(i);
                }
            });
            if reference.pixels.is_none() {
                let text = "Not shown: its file could not be read";
                ui.colored_label(theme::error_colour(ui.visuals()), text);
            }
            place(ui, reference);
        });
        ui.separator();
    }
    if let Some(i) = removed {
        list.remove(i);
    }
}

fn place(ui: &mut Ui, reference: &mut Reference) {
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("side")
            .width(70.0)
            .selected_text(capital(reference.side.name()))
            .show_ui(ui, |ui| {
                for side in sides() {
                    ui.selectable_value(&mut reference.side, side, capital(side.name()));
                }
            });
        ComboBox::from_id_salt("layer")
            .width(70.0)
            .selected_text(capital(reference.layer.name()))
            .show_ui(ui, |ui| {
                for layer in Layer::ALL {
                    ui.selectable_value(&mut reference.layer, layer, capital(layer.name()));
                }
            });
        ui.checkbox(&mut reference.locked, "Lock to view")
            .on_hover_text("Show it only in views along that side");
    });
    ui.horizontal(|ui| {
        let label = ui.label("Opacity");
        ui.add(Slider::new(&mut reference.opacity, 0.05..=1.0).fixed_decimals(2))
            .labelled_by(label.id);
    });
    ui.horizontal(|ui| {
        let label = ui.label("Height");
        ui.add(DragValue::new(&mut reference.height_vx).range(HEIGHT_RANGE_VX).speed(1.0))
            .labelled_by(label.id)
            .on_hover_text("In voxels");
        ui.label("Offset");
        for (value, prefix) in [(0, "X "), (1, "Y ")] {
            let value = DragValue::new(&mut reference.offset_vx[value]).range(OFFSET_RANGE_VX);
            ui.add(value.prefix(prefix).speed(0.5)).on_hover_text(
                "Distance of its centre from the grid's centre, to the right (X) and up (Y), in voxels",
            );
        }
    });
}
