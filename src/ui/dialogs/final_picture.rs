//! The dialog of a final picture: how large and exact, what lights it, what is sharp, and the file that it becomes.
//! While the picture is made, its [`Preview`] is shown in the sign of long work.
//!
//! Asks with a [`FinalRequest`]; knows neither files nor how light is traced.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{
    ColorImage, Grid, Id, Image, Key, Modal, ScrollArea, TextureHandle, TextureOptions, Ui,
};
use glam::UVec2;

use crate::sculpture::Rgb;
use crate::shade::Pixels;
use crate::trace::{AreaLight, TraceOptions};
use crate::ui::dialogs::final_rows::{file, ground, lamp, lens, light, quality};
use crate::ui::dialogs::picture_size::PictureSize;
use crate::ui::widgets::theme;
use crate::ui::{UiContext, UiRequest, UiState};

/// The longest side of a picture, in pixels.
const MOST_PX: u32 = 8192;
/// The largest preview, in points.
const PREVIEW: [f32; 2] = [420.0, 300.0];
const WIDTH: f32 = 400.0;
/// Height of what is above and below the options, in points.
const BESIDE: f32 = 170.0;

/// The file that a final picture becomes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FinalFile {
    #[default]
    Png,
    Jpeg,
    Exr,
}

impl FinalFile {
    pub(in crate::ui) const ALL: [FinalFile; 3] = [FinalFile::Png, FinalFile::Jpeg, FinalFile::Exr];

    /// The ending of its name.
    pub const fn ending(self) -> &'static str {
        match self {
            FinalFile::Png => "png",
            FinalFile::Jpeg => "jpg",
            FinalFile::Exr => "exr",
        }
    }

    pub(in crate::ui) const fn name(self) -> &'static str {
        match self {
            FinalFile::Png => "PNG",
            FinalFile::Jpeg => "JPEG",
            FinalFile::Exr => "OpenEXR",
        }
    }

    pub(in crate::ui) const fn help(self) -> &'static str {
        match self {
            FinalFile::Png => "For screens, lossless",
            FinalFile::Jpeg => "For screens, small",
            FinalFile::Exr => "Linear light with distance, colour and normals, for compositing",
        }
    }
}

/// A lamp to the left of the viewer, which fills the shadows of the sun.
const USUAL_LAMP: AreaLight =
    AreaLight { azimuth_deg: -60.0, elevation_deg: 30.0, size: 1.0, strength: 0.5 };

/// A final picture that is asked for.
#[derive(Clone, PartialEq, Debug)]
pub struct FinalRequest {
    /// Pixels.
    pub size: UVec2,
    pub trace: TraceOptions,
    pub denoise: bool,
    pub exposure_ev: f32,
    pub file: FinalFile,
    /// On the graphics device, which shows voxels.
    pub on_gpu: bool,
}

/// The options chosen so far.
#[derive(Clone, PartialEq, Debug)]
pub struct FinalDialog {
    pub open: bool,
    pub size: PictureSize,
    pub trace: TraceOptions,
    /// The ground's colour, also while there is none.
    pub ground: Rgb,
    /// The lamp, also while there is none.
    pub lamp: AreaLight,
    pub denoise: bool,
    pub exposure_ev: f32,
    pub file: FinalFile,
    pub on_gpu: bool,
}

impl Default for FinalDialog {
    fn default() -> FinalDialog {
        let trace = TraceOptions::default();
        FinalDialog {
            open: false,
            size: PictureSize::OfView,
            ground: trace.ground.map_or(Rgb::STONE, |ground| ground.colour),
            lamp: USUAL_LAMP,
            trace,
            denoise: true,
            exposure_ev: 0.0,
            file: FinalFile::default(),
            on_gpu: false,
        }
    }
}

impl FinalDialog {
    fn wanted(&self, view_px: UVec2) -> FinalRequest {
        FinalRequest {
            size: self.size.px(view_px),
            trace: self.trace,
            denoise: self.denoise,
            exposure_ev: self.exposure_ev,
            file: self.file,
            on_gpu: self.on_gpu,
        }
    }
}

/// A picture in progress, as the thread that makes it shows it.
#[derive(Default)]
pub struct Preview {
    news: Arc<Mutex<Option<Pixels>>>,
    texture: Option<TextureHandle>,
}

impl Preview {
    /// Where the picture so far is put.
    pub fn news(&self) -> Arc<Mutex<Option<Pixels>>> {
        self.news.clone()
    }

    /// Shows what has been put there last.
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

pub fn show(root: &Ui, state: &mut UiState, context: &UiContext, requests: &mut Vec<UiRequest>) {
    if !state.dialogs.final_picture.open {
        return;
    }
    let response = Modal::new(Id::new("final picture")).show(root.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.heading("Final picture");
        ui.weak("Traces light through the sculpture as the view shows it.");
        ui.add_space(4.0);
        let dialog = &mut state.dialogs.final_picture;
        // While a field or a button has the keyboard, Enter is its own.
        let free = ui.memory(|memory| memory.focused().is_none());
        let enter = free && ui.input(|input| input.key_pressed(Key::Enter));
        ui.spacing_mut().slider_width = 190.0;
        // In a small window it scrolls, and the buttons stay.
        let room = (ui.ctx().content_rect().height() - BESIDE).max(80.0);
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            Grid::new("final picture").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
                dialog.size.row(ui, context.picture_px, MOST_PX);
                quality(ui, dialog);
                light(ui, &mut dialog.trace.light);
                lamp(ui, dialog);
                ground(ui, dialog);
                lens(ui, dialog);
                file(ui, dialog);
            });
        });
        if dialog.on_gpu {
            ui.weak("The graphics device traces the voxels' cubes, and shows no preview.");
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let make = ui.add(theme::primary(ui.visuals(), "Make picture"));
            let make = make
                .on_hover_text("Saved next to the sculpture under a new name; can be cancelled");
            if make.clicked() || enter {
                let wanted = dialog.wanted(context.picture_px);
                requests.push(UiRequest::FinalPicture(Box::new(wanted)));
                dialog.open = false;
            }
            if ui.button("Cancel").clicked() {
                dialog.open = false;
            }
            if ui.button("Defaults").on_hover_text("Reset to a clear day at 64 samples").clicked() {
                *dialog = FinalDialog { open: true, ..FinalDialog::default() };
            }
        });
    });
    if response.should_close() {
        state.dialogs.final_picture.open = false;
    }
}
