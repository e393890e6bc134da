//! The dialog of a final picture: its size and quality, light, focus and file. While the picture is made, the sign of
//! long work shows its [`Preview`].
//!
//! Asks with a [`crate::ui::pictures::FinalRequest`]; knows neither files nor how light is traced.

use std::sync::{Arc, Mutex, PoisonError};

use crate::shade::Pixels;
use crate::ui::dialogs::final_choices::FinalDialog;
use crate::ui::dialogs::final_rows::{file, ground, lamp, lens, light, quality};
use crate::ui::dialogs::shared::{Dialog, DialogContext};
use crate::ui::request::UiRequest;
use crate::ui::widgets::theme;
use egui::{
    ColorImage, Grid, Id, Image, Key, Modal, ScrollArea, TextureHandle, TextureOptions, Ui,
};

/// The longest side of a picture, in pixels.
const MOST_PX: u32 = 8192;
/// The largest preview, in points.
const PREVIEW: [f32; 2] = [420.0, 300.0];
const WIDTH: f32 = 400.0;
/// Height of the parts above and below the options, in points.
const BESIDE: f32 = 170.0;

/// A picture in progress, shown by the thread that makes it.
#[derive(Default)]
pub struct Preview {
    news: Arc<Mutex<Option<Pixels>>>,
    texture: Option<TextureHandle>,
}

impl Preview {
    /// Returns the slot for the unfinished picture.
    pub fn news(&self) -> Arc<Mutex<Option<Pixels>>> {
        self.news.clone()
    }

    /// Shows the newest unfinished picture.
    pub fn show(&mut self, ui: &mut Ui) {
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(Pixels { size, rgba }) = news {
            let size = [size.x as usize, size.y as usize];
            let picture = ColorImage::from_rgba_unmultiplied(size, rgba.as_flattened());
            match &mut self.texture {
                Some(texture) => texture.set(picture, TextureOptions::LINEAR),
                none => {
                    let load = ui.load_texture("final picture", picture, TextureOptions::LINEAR);
                    *none = Some(load);
                }
            }
        }
        if let Some(texture) = &self.texture {
            ui.vertical_centered(|ui| ui.add(Image::new(texture).max_size(PREVIEW.into())));
            ui.add_space(4.0);
        }
    }
}

impl Dialog for FinalDialog {
    fn is_open(&self) -> bool {
        self.open
    }

    fn close(&mut self) -> bool {
        std::mem::take(&mut self.open)
    }

    fn show(&mut self, root: &Ui, shared: &mut DialogContext) {
        let DialogContext { context, requests, .. } = shared;
        if !self.open {
            return;
        }
        let response = Modal::new(Id::new("final picture")).show(root.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.heading("Final picture");
            ui.weak("Traces light through the sculpture as the view shows it.");
            ui.add_space(4.0);
            // A focused field or button uses Enter itself.
            let free = ui.memory(|memory| memory.focused().is_none());
            let enter = free && ui.input(|input| input.key_pressed(Key::Enter));
            ui.spacing_mut().slider_width = 190.0;
            // In a small window the options scroll, and the buttons stay.
            let room = (ui.ctx().content_rect().height() - BESIDE).max(80.0);
            ScrollArea::vertical().max_height(room).show(ui, |ui| {
                Grid::new("final picture").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
                    self.size.row(ui, context.picture_px, MOST_PX);
                    quality(ui, self);
                    light(ui, &mut self.trace.light);
                    lamp(ui, self);
                    ground(ui, self);
                    lens(ui, self);
                    file(ui, self);
                });
            });
            if self.on_gpu {
                ui.weak("The graphics device traces the voxels' cubes, and shows no preview.");
            }
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                let make = ui.add(theme::primary(ui.visuals(), "Make picture"));
                let make = make.on_hover_text(
                    "Saved next to the sculpture under a new name; can be cancelled",
                );
                if make.clicked() || enter {
                    let wanted = self.wanted(context.picture_px);
                    requests.push(UiRequest::FinalPicture(Box::new(wanted)));
                    self.open = false;
                }
                if ui.button("Cancel").clicked() {
                    self.open = false;
                }
                if ui
                    .button("Defaults")
                    .on_hover_text("Reset to a clear day at 64 samples")
                    .clicked()
                {
                    *self = FinalDialog { open: true, ..FinalDialog::default() };
                }
            });
        });
        if response.should_close() {
            self.open = false;
        }
    }
}
